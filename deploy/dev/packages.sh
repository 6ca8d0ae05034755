# shellcheck shell=bash
# Part of ./dev: installs the packages that a command needs, by apt.

asRoot() {
    if ((EUID == 0)); then
        "$@"
    elif [[ -n "${CI:-}" ]]; then
        sudo -n "$@" # nobody there to type a password
    else
        sudo "$@"
    fi
}

# A line that says how far apt is, each second; on a terminal only.
aptProgress() {
    [[ -t 1 ]] || return 0
    while sleep 1; do
        awk '/ newly installed/ { all = $3 } /^Unpacking / { ++unpacked } /^Setting up / { ++ready }
            END { if (all) printf "\r   apt: of %d packages %d are unpacked, %d are ready ", all, unpacked, ready }' $apt_log
    done
}

# What apt says is long: it goes to a file, and its end is shown when it fails.
aptGet() {
    local progress status=0
    aptProgress &
    progress=$!
    asRoot env DEBIAN_FRONTEND=noninteractive \
        apt-get -q -o DPkg::Lock::Timeout=600 -o Acquire::Retries=3 "$@" >>$apt_log 2>&1 || status=$?
    kill $progress 2>/dev/null || true
    wait $progress 2>/dev/null || true
    [[ ! -t 1 ]] || echo
    ((status != 0)) || return 0
    tail -n 20 $apt_log >&2
    die "apt-get $1 failed, see above and $apt_log." \
        "Once the reason is gone (network? mirror? password?), run this again."
}

# The machine's own source of Debian 12, once more, with the suite changed to its backports: same mirror, same key.
addBackports() {
    local entry release_name file number target
    # shellcheck disable=SC2016 # apt's own names in $()
    entry=$(apt-get indextargets --format '$(CODENAME) $(COMPONENT) $(RELEASE) $(SOURCESENTRY)' 'Created-By: Packages' |
        awk '$1 == "bookworm" && $2 == "main" { print $3, $4; exit }')
    [[ -n "$entry" ]] || die "no apt source of Debian 12 (bookworm main) was found, so its backports cannot be added.
     Install $mesa_package $mesa_least or newer from bookworm-backports, then run this again."
    read -r release_name file <<<"$entry"
    number=${file##*:} file=${file%:*} # of the line in a .list, of the stanza in a .sources
    target=/etc/apt/sources.list.d/brume-backports.${file##*.}
    say "Adding an apt source, $target:" \
        "bookworm-backports from the mirror that this machine uses, for $mesa_package only"
    if [[ "$file" == *.sources ]]; then
        awk -v RS= -v number="$number" '/(^|\n)Types:/ && ++n == number' "$file" |
            sed -e '/^#/d' -e 's/^Types:.*/Types: deb/' -e 's/^Suites:.*/Suites: bookworm-backports/'
    else
        sed -n "${number}p" "$file" | sed -E "s/([[:space:]])$release_name([[:space:]])/\1bookworm-backports\2/"
    fi | asRoot tee "$target"
    aptGet update
}

installMesa() { # installMesa SUITE_CODENAME
    local from=()
    if [[ "$1" == bookworm ]]; then
        apt-cache madison "$mesa_package" | grep bookworm-backports >/dev/null || addBackports
        from=(-t bookworm-backports)
    fi
    aptGet install -y --no-install-recommends "${from[@]}" "$mesa_package"
}

# setUpPackages PACKAGE...: installs those that are missing, and Mesa when it is missing or too old.
setUpPackages() {
    local codename status missing=() mesa_needed=1 package version
    # shellcheck source=/dev/null
    codename=$(. /etc/os-release && echo "${VERSION_CODENAME:-}")
    if ! command -v dpkg-query >/dev/null; then
        echo "dev: not a Debian: nothing is installed for you. CMake will name what is missing."
        return
    fi
    if [[ "$codename" == bookworm ]]; then
        set -- "${@/#libboost-dev/libboost1.81-dev}"
    fi
    status=$(dpkg-query -W -f '${Package} ${db:Status-Status} ${Version}\n' "$@" "$mesa_package" 2>/dev/null || true)
    for package in "$@"; do
        grep -qF "$package installed " <<<"$status" || missing+=("$package")
    done
    version=$(awk -v p="$mesa_package" '$1 == p && $2 == "installed" { print $3 }' <<<"$status")
    [[ -z "$version" ]] || ! atLeast "${version#*:}" "$mesa_least" || mesa_needed=
    [[ -n "$mesa_needed" || ${#missing[@]} -gt 0 ]] || return 0

    local wanted=("${missing[@]}" ${mesa_needed:+"$mesa_package"})
    if ((EUID != 0)) && ! command -v sudo >/dev/null; then
        die "these packages are missing, and installing them needs root or sudo: ${wanted[*]}"
    fi
    case "$codename" in
    bookworm | trixie) ;;
    *) echo "dev: this knows Debian 12 and 13; on '${codename:-this system}' it tries the names of Debian 13." ;;
    esac
    say "Installing packages with apt: ${wanted[*]}"
    echo "   This takes a minute or more; what apt says goes to $apt_log."
    : >$apt_log
    aptGet update
    ((${#missing[@]} == 0)) || aptGet install -y --no-install-recommends "${missing[@]}"
    [[ -z "$mesa_needed" ]] || installMesa "$codename"
}
