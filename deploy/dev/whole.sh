# shellcheck shell=bash
# Part of ./dev: `./dev test whole`, everything that `./dev test` has no time for.

readonly whole_page=docs/results/data/whole.md
# In this order; those at the end take longest.
readonly whole_parts=(page unit net gpu hard bench integration swiftshader browser firefox deploy fuzz clang lint netem
    fairness nodes soak asan tsan bookworm trixie)

wholeHelp() {
    cat <<END
./dev test whole [PART...]

Every case by every method, on both drivers; statistics; overload and load; several servers; bad links; sanitizers with
the device; Clang; clang-tidy; fuzzing, 60 s each; both Debians from bare. It takes hours and root.
Parts: ${whole_parts[*]}
A part that passed for the same sources is not run again: a run that was interrupted goes on where it was. Any part may
be run by itself; the page keeps what it says of the others.
Verdicts and times go to $whole_page, outputs to build/whole.
END
}

# A hash of all sources but the measured results, which a run itself changes.
sourcesHash() { git ls-files -s | grep -v $'\tdocs/' | sha256sum | cut -c1-12; }

wholePart() { # wholePart PART
    local out=$PWD/build/whole
    export BRUME_TESTS=whole
    case "$1" in
    page)
        page
        (cd $web && npm run --silent test)
        ;;
    unit) runCtest release -L "$without_device" ;;
    net | gpu | hard | bench | integration) runCtest release -L "^$1\$" ;;
    swiftshader) # every test of pictures, with a second implementation of Vulkan
        tests/gpu/with_swiftshader.sh "$release/tests/gpu_tests"
        tests/gpu/with_swiftshader.sh "$release/tests/hard_tests"
        ;;
    browser) browserTest ;;
    firefox) BRUME_BROWSER=firefox browserTest ;;
    deploy)
        package
        deployTest
        ;;
    fuzz) fuzz 60 "${fuzz_targets[@]}" ;;
    clang) build clang ;; # everything, by another compiler
    lint) commandLint ;;
    netem) asRoot python3 tests/network/links.py --programs "$release/bin" --out "$out/links.md" ;;
    fairness) /usr/bin/python3 tests/network/fairness.py --programs "$release/bin" --out "$out/fairness.md" ;;
    nodes) python3 tests/network/nodes.py --programs "$release/bin" --out "$out/cluster.md" ;;
    soak) python3 tests/network/soak.py --programs "$release/bin" --minutes 10 --out "$out/soak.md" ;;
    asan) # each behaviour once: statistics and products of cases show a sanitizer nothing new
        export BRUME_TESTS=''
        build asan
        runCtest asan -LE '^(bench|browser)$' # bench measures, and draws what the others draw; the page was tested
        underLoad asan
        ;;
    tsan) # what has threads of ours besides: these; the driver's are not instrumented
        export BRUME_TESTS=''
        build tsan
        runCtest tsan -L '^(unit|fuzz|net|integration)$' -E '^(plan_test|closed_forms_test)$'
        runCtest tsan -R '^gpu_tests/(frame_loop|error_meter)_test$'
        underLoad tsan
        ;;
    bookworm | trixie) BRUME_TESTS='' ./dev fresh "$1" test ;;
    esac
}

# The table of all parts: verdicts for these sources, and where there is none what the page has said so far. What
# people have written below the table stays.
wholeTable() { # wholeTable SOURCES BEFORE
    local part verdict seconds day commit row
    printf '# Everything, once\n\n`./dev test whole` on %s. Each part has the commit that it was run for.\n\n' \
        "$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1), $(nproc) cores, $(sed -n 's/^PRETTY_NAME="\(.*\)"/\1/p' /etc/os-release)"
    printf '| part | verdict | time | day | commit |\n|---|---|---|---|---|\n'
    for part in "${whole_parts[@]}"; do
        row=$(grep "^| $part |" <<<"$2" || true)
        if [[ -f build/whole/$1/$part ]]; then
            IFS='|' read -r verdict seconds day commit <"build/whole/$1/$part"
            row="| $part | $verdict | $seconds s | $day | $commit |"
        fi
        printf '%s\n' "${row:-| $part | not run | | | |}"
    done
    awk '/^\|/ { said = ""; next } { said = said $0 "\n" } END { printf "%s", said }' <<<"$2" # below the table
}

commandWhole() { # [PART...]
    local part sources begin parts=("$@")
    [[ "${1:-}" != --help ]] || {
        wholeHelp
        return
    }
    for part in "$@"; do
        [[ " ${whole_parts[*]} " == *" $part "* ]] ||
            die "the whole has no part '$part'. There are: ${whole_parts[*]}"
    done
    ((${#parts[@]} > 0)) || parts=("${whole_parts[@]}")
    sources=$(sourcesHash)
    test_parts="whole $*"
    trap summary EXIT
    step "Set-up" setUp "${build_packages[@]}" "${page_packages[@]}" "${lint_packages[@]}" "${fuzz_packages[@]}" \
        "${network_packages[@]}" "${deploy_packages[@]}" "${python_packages[@]}" \
        vulkan-validationlayers "${browser_packages[@]}" webkit2gtk-driver openssl faketime qemu-user debootstrap
    passed || exit 1
    step "Build" build release
    passed || exit 1
    step "Build the page" page
    mkdir -p "build/whole/$sources"
    for part in "${parts[@]}"; do
        if grep -qs '^passed' "build/whole/$sources/$part"; then
            say "$part passed before"
            continue
        fi
        begin=$SECONDS
        step "$part (output: build/whole/$part.log)" wholeLogged "$part"
        passed || tail -n 25 "build/whole/$part.log"
        if passed; then last=passed; else last=FAILED; fi
        echo "$last|$((SECONDS - begin))|$(date +%F)|$(git rev-parse --short HEAD)" >"build/whole/$sources/$part"
        wholeTable "$sources" "$(cat $whole_page 2>/dev/null || true)" >$whole_page.new
        mv $whole_page.new $whole_page
    done
}

wholeLogged() { # wholeLogged PART
    exec >"build/whole/$1.log" 2>&1
    wholePart "$1"
}
