# shellcheck shell=bash
# Part of ./dev: `./dev fresh`, a bare Debian in a folder, in which ./dev is run as a stranger would.

readonly fresh=build/fresh
readonly fresh_picture=/tmp/first.jpg # in the bare system

freshHelp() {
    cat <<'END'
./dev fresh bookworm|trixie [run | test [PART...] | unit] [--cold]

Runs ./dev run (the default; until the page shows its first picture), ./dev test, or both ./dev run and ./dev test unit
in a bare Debian of that release, with a clone of HEAD and nothing else installed. It needs root, and prints what each
step took.
The bare system is build/fresh/RELEASE, new at each call. Kept between calls: the bare system as debootstrap made it,
downloaded packages (apt, npm) and ccache's results. --cold: packages and compiled files are not kept.
END
}

# What this machine needs to reach its mirrors (settings of apt and npm, certificates), given to the bare system.
freshMirrors() { # freshMirrors ROOT
    local bundle=/etc/ssl/certs/ca-certificates.crt
    apt-config dump | grep -E '^Acquire::(Check-|http|https)' >"$1/etc/apt/apt.conf.d/99mirror" || true
    [[ ! -f $bundle ]] || cp $bundle "$1/root/certificates.crt"
    ! command -v npm >/dev/null || echo "registry=$(npm config get registry)" >"$1/root/.npmrc"
}

# The bare system of a release, as debootstrap makes it: once, kept as an archive.
freshBase() { # freshBase RELEASE
    local codename=$1 base=$PWD/$fresh/$1.tar mirror
    [[ ! -f $base ]] || return 0
    mirror=$(apt-get indextargets --format '$(COMPONENT) $(REPO_URI)' 'Created-By: Packages' |
        awk '$1 == "main" && $2 !~ /security/ { print $2; exit }')
    rm -rf "$fresh/$codename.part"
    debootstrap --variant=minbase "$codename" "$fresh/$codename.part" "${mirror:-http://deb.debian.org/debian}" \
        >"$fresh/$codename.log" 2>&1 || die "debootstrap failed: $fresh/$codename.log"
    rm -f "$fresh/$codename.part"/var/cache/apt/archives/*.deb
    tar -C "$fresh/$codename.part" -cf "$base.part" .
    mv "$base.part" "$base"
    rm -rf "$fresh/$codename.part"
}

freshSystem() { # freshSystem RELEASE COLD
    local codename=$1 cold=$2 system=$PWD/$fresh/$1 changed
    rm -rf "$system"
    mkdir -p "$system"
    tar -C "$system" -xf "$fresh/$codename.tar"
    echo force-unsafe-io >"$system/etc/dpkg/dpkg.cfg.d/unsafe-io" # as images of containers have it
    freshMirrors "$system"
    mkdir -p "$system"/root/.cache/ccache "$system"/root/.npm
    [[ -n $cold ]] || mkdir -p "$fresh/kept/$codename"/{apt/partial,npm,ccache}
    git clone -q --no-hardlinks . "$system/root/brume"
    changed=$(git status --porcelain --untracked-files=no | wc -l)
    ((changed == 0)) || echo "dev: $changed changed files are not committed: the clone is of HEAD, without them."
}

# freshCommand RELEASE COLD COMMAND...: in the bare system, with mounts and processes of its own, which end with it. It
# takes the place of the (sub)shell that calls it.
freshCommand() {
    local codename=$1 cold=$2 system=$PWD/$fresh/$1
    shift 2
    # shellcheck disable=SC2016 # expanded by the inner shell
    exec unshare --mount --pid --fork --kill-child bash -euc '
        root=$1 kept=$2
        shift 2
        mount -t proc proc "$root/proc"
        mount --rbind /sys "$root/sys"
        mount -t tmpfs tmpfs "$root/dev"
        for device in null zero full random urandom tty; do
            touch "$root/dev/$device"
            mount --bind "/dev/$device" "$root/dev/$device"
        done
        mkdir "$root"/dev/{shm,pts}
        mount -t tmpfs tmpfs "$root/dev/shm"
        mount -t devpts -o newinstance,ptmxmode=0666 devpts "$root/dev/pts"
        ln -s pts/ptmx "$root/dev/ptmx"
        ln -s /proc/self/fd "$root/dev/fd"
        for i in 0:stdin 1:stdout 2:stderr; do ln -s "/proc/self/fd/${i%:*}" "$root/dev/${i#*:}"; done
        cp /etc/resolv.conf /etc/hosts "$root/etc/" 2>/dev/null || true
        if [[ -n $kept ]]; then
            mount --bind "$kept/apt" "$root/var/cache/apt/archives"
            mount --bind "$kept/npm" "$root/root/.npm"
            mount --bind "$kept/ccache" "$root/root/.cache/ccache"
        fi
        exec chroot "$root" "$@"' fresh "$system" "$([[ -n $cold ]] || echo "$PWD/$fresh/kept/$codename")" \
        /usr/bin/env -i HOME=/root PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 \
        ${CI:+CI="$CI"} ${http_proxy:+http_proxy="$http_proxy"} ${https_proxy:+https_proxy="$https_proxy"} \
        NODE_EXTRA_CA_CERTS=/root/certificates.crt bash -c 'cd /root/brume && exec "$@"' fresh "$@"
}

# Until the server's page is there and the scene's own camera has a picture: what somebody sees in a browser.
freshRun() { # freshRun RELEASE COLD
    local log=$fresh/$1-run.log address='' pid
    : >"$log" # no address of an earlier server may be there
    freshCommand "$1" "$2" ./dev run --port 0 >"$log" 2>&1 &
    pid=$!
    # unshare heeds no SIGTERM. What it began ends with it.
    # shellcheck disable=SC2064 # of this server
    trap "kill -KILL $pid 2>/dev/null || true; wait $pid || true" EXIT
    while [[ -z $address ]]; do
        kill -0 "$pid" 2>/dev/null || die "./dev run ended in the bare system: $(tail -n 15 "$log")"
        address=$(sed -n 's/^listening on //p' "$log")
        sleep 0.2
    done
    # All is read: a pipe that `grep -q` closes early is an error of curl's now and then.
    curl -fsS "$address/" | grep '<script' >/dev/null || die "$address/ has no page"
    curl -fsS --retry 60 --retry-delay 1 --retry-all-errors -o "$fresh/$1/$fresh_picture" "$address/snapshot.jpg"
    echo "   first picture: $(file -b "$fresh/$1/$fresh_picture" 2>/dev/null || stat -c '%s bytes' "$fresh/$1/$fresh_picture")"
}

commandFresh() {
    local codename=${1:-} what=run cold='' arguments=()
    [[ "${1:-}" != --help && "${1:-}" != -h ]] || {
        freshHelp
        return
    }
    [[ $codename =~ ^(bookworm|trixie)$ ]] || die "./dev fresh takes bookworm or trixie; see ./dev fresh --help"
    shift
    while (($# > 0)); do
        case "$1" in
        --cold) cold=1 ;;
        *) arguments+=("$1") ;;
        esac
        shift
    done
    what=${arguments[0]:-run}
    [[ $what =~ ^(run|test|unit)$ ]] || die "./dev fresh RELEASE takes run, test or unit, not '$what'"
    ((EUID == 0)) || die "a bare system needs root: run ./dev fresh as root."
    mkdir -p build
    setUp debootstrap curl git
    rm -rf "$ctest_times" # of this folder's tests, not of those in the bare system
    test_parts="fresh $codename ${arguments[*]:-run}${cold:+ --cold}"
    trap summary EXIT
    exec {lock_fd}>"build/fresh-$codename.lock"
    flock -n "$lock_fd" || die "another ./dev fresh $codename is at work."
    mkdir -p $fresh
    step "A bare Debian ($codename)" freshBase "$codename"
    passed || return 0
    step "The clone of HEAD in it" freshSystem "$codename" "$cold"
    passed || return 0
    if [[ $what == test ]]; then
        step "./dev ${arguments[*]}" freshCommand "$codename" "$cold" ./dev "${arguments[@]}"
        return
    fi
    step "./dev run, until the first picture" freshRun "$codename" "$cold"
    [[ $what == run ]] || step "./dev test unit" freshCommand "$codename" "$cold" ./dev test unit
}
