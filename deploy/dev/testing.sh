# shellcheck shell=bash
# Part of ./dev: the parts of `./dev test`, and the summary at its end.

# Labels of the quick tests, which need no Vulkan and can run side by side.
readonly without_device='^(unit|fuzz|reference)$'
steps=() # "result|seconds|name" of each step taken
last=ok  # result of the last one

# step NAME COMMAND...: runs it, keeps its result for the summary. A step that fails does not stop the others;
# `passed || return 0` does. (Never call this left of || or &&: bash then ignores `set -e` inside.)
step() {
    local name=$1 begin=$SECONDS status
    shift
    say "$name"
    set +e
    (
        set -e
        "$@"
    )
    status=$?
    set -e
    last=ok
    ((status == 0)) || last=FAILED
    steps+=("$last|$((SECONDS - begin))|$name")
}
passed() { [[ "$last" == ok ]]; }

# The ten entries of ctest that took longest.
slowest() {
    [[ -d "$ctest_times" ]] || return 0
    printf '   The slowest of ctest:\n'
    sed -nE 's/.*<testcase name="([^"]*)".* time="([^"]*)".*/\2 \1/p' "$ctest_times"/*.xml | sort -rn |
        awk 'NR <= 10 { printf "%15.1f s  %s\n", $1, $2 }'
}

summary() {
    local status=$? line result seconds name
    printf '\n== Summary of ./dev test %s\n' "$test_parts"
    for line in "${steps[@]}"; do
        IFS='|' read -r result seconds name <<<"$line"
        printf '   %-7s %5d s  %s\n' "$result" "$seconds" "$name"
        [[ "$result" == ok ]] || status=1
    done
    slowest
    if ((status == 0)); then
        printf '== PASSED in %d s\n' "$SECONDS"
    else
        printf '== FAILED after %d s\n' "$SECONDS"
    fi
    exit "$status"
}

setUp() { # setUp PACKAGE...
    lock packages
    setUpPackages "$@"
    unlock
}
build() { # build PRESET [TARGET...]
    lock build
    buildCpp "$@"
    unlock
}
page() {
    lock page
    buildWeb
    unlock
}
pageTest() {
    page
    (cd $web && npm run --silent test)
}
# What tests start neither reads the user's learnt costs nor learns them beside other tests: plans are of the built-in
# costs. Compiled shaders are kept for all of them. Servers compile ahead only where a test asks for it.
testEnvironment() {
    rm -rf build/test-cache
    export XDG_CACHE_HOME=$PWD/build/test-cache MESA_SHADER_CACHE_DIR=$PWD/build/shaders BRUME_FIXED_COSTS=true
    export BRUME_AHEAD=off
}
# Several tests run side by side; those that measure time run alone (ALONE in CMakeLists.txt).
# What tests start must not keep the lock when it outlives them: {lock_fd}>&-
runCtest() { # runCtest PRESET [CTEST ARGUMENT...]
    local preset=$1
    shift
    lock test
    mkdir -p "$ctest_times"
    testEnvironment
    [[ $preset != asan ]] || export LSAN_OPTIONS="suppressions=$PWD/tests/asan.supp"
    [[ $preset != tsan ]] || export TSAN_OPTIONS="suppressions=$PWD/tests/network/tsan.supp" # of the driver's
    ctest --test-dir "build/$preset" -j "$(($(nproc) + 1))" \
        --output-on-failure --no-tests=error --output-junit "$(mktemp "$PWD/$ctest_times/XXXXXX.xml")" "$@" \
        {lock_fd}>&-
    unlock
}
browserTest() {
    npmInstall tests/browser
    runCtest release -L '^browser$'
}

package() (
    lock build
    lock page
    rm -rf $release/packages
    (cd $release && cpack -G DEB >package.log) || die "cpack failed: $release/package.log"
)
deployTest() {
    lock test
    npmInstall tests/deploy
    npmInstall tests/browser # drives the page of who has signed in
    testEnvironment
    /usr/bin/python3 -m unittest discover -s tests/deploy -p '*_test.py' {lock_fd}>&-
    unlock
}

# canFuzz: is there a clang with libFuzzer?
canFuzz() {
    mkdir -p build
    echo 'extern "C" int LLVMFuzzerTestOneInput(const unsigned char*, unsigned long) { return 0; }' |
        clang++ -fsanitize=fuzzer,address,undefined -x c++ - -o build/can-fuzz >build/can-fuzz.log 2>&1
}

# fuzzOne SECONDS TARGET: from its seeds and from what earlier runs have found, which stays in build/fuzz/corpus.
fuzzOne() {
    local seconds=$1 target=$2 from options log
    from=(tests/fuzz/seeds/"$target")
    case "$target" in
    message) from=(protocol/examples) ;;
    scene) from+=(server/scenes) ;;
    esac
    options=(-max_total_time="$seconds" -max_len=8192 -timeout=10 -rss_limit_mb=2048 -print_final_stats=1)
    [[ ! -f tests/fuzz/dictionaries/$target.dict ]] || options+=(-dict="tests/fuzz/dictionaries/$target.dict")
    log=build/fuzz/$target.log
    mkdir -p build/fuzz/corpus/"$target" build/fuzz/crashes
    if ! "build/fuzz/bin/fuzz-$target" "${options[@]}" -artifact_prefix="build/fuzz/crashes/$target-" \
        build/fuzz/corpus/"$target" "${from[@]}" >"$log" 2>&1; then
        tail -n 40 "$log" >&2
        die "fuzzing found the above; build/fuzz/bin/fuzz-$target build/fuzz/crashes/$target-... runs it again."
    fi
    printf '   %-8s %s s, %s inputs, %s in the corpus\n' "$target" "$seconds" \
        "$(awk '/number_of_executed_units/ { print $2 }' "$log")" "$(find build/fuzz/corpus/"$target" -type f | wc -l)"
}

# fuzz SECONDS TARGET...: as many side by side as there are cores.
fuzz() {
    local seconds=$1 target running=() failed=
    shift
    build fuzz "${@/#/fuzz-}"
    for target in "$@"; do
        if ((${#running[@]} == $(nproc))); then
            wait "${running[0]}" || failed=1
            running=("${running[@]:1}")
        fi
        fuzzOne "$seconds" "$target" &
        running+=($!)
    done
    for target in "${running[@]}"; do
        wait "$target" || failed=1
    done
    [[ -z "$failed" ]]
}

# The real server and its viewers, built with a sanitizer; no report is allowed. It compiles ahead, as in use.
underLoad() { # underLoad PRESET
    lock test
    env -u BRUME_AHEAD python3 tests/network/sanitized.py --programs "build/$1/bin" {lock_fd}>&-
    unlock
}

# testPart PART: one of those that `./dev test` takes; see ./dev help.
testPart() {
    case "$1" in
    all)
        step "Build" build release
        passed || return 0
        step "Build the page" page
        step "Tests: page" pageTest
        step "Install what drives the browser" npmInstall tests/browser
        step "Tests: unit, fuzz, reference, net, gpu, hard, bench, integration, browser" runCtest release
        step "Package" package
        step "Tests: deploy" deployTest
        if canFuzz; then
            step "Fuzz, 1 s each" fuzz 1 "${fuzz_targets[@]}"
        else
            say "Not fuzzed: there is no clang with libFuzzer. ./dev fuzz installs it."
        fi
        ;;
    unit)
        step "Build the unit tests" build release tests-unit tests-fuzz tests-reference
        passed || return 0
        step "Tests: unit, fuzz, reference" runCtest release -L "$without_device"
        step "Tests: page" pageTest
        ;;
    gpu | hard | bench | net)
        step "Build the $1 tests" build release "tests-$1"
        passed || return 0
        step "Tests: $1" runCtest release -L "^$1\$"
        ;;
    integration)
        step "Build" build release
        passed || return 0
        step "Tests: integration" runCtest release -L '^integration$'
        ;;
    browser)
        step "Build the server" build release brume-server
        passed || return 0
        step "Build the page" page
        passed || return 0
        step "Tests: browser" browserTest
        ;;
    deploy)
        step "Build" build release brume-server brume-client brume-load
        passed || return 0
        step "Build the page" page
        passed || return 0
        step "Package" package
        step "Tests: deploy" deployTest
        ;;
    asan | tsan) # of what needs Vulkan only the whole server under load: a software driver is slow under sanitizers
        step "Build ($1)" build "$1" tests-unit tests-fuzz tests-reference tests-net brume-server brume-load
        passed || return 0
        step "Tests: unit, fuzz, reference, net ($1)" runCtest "$1" -L '^(unit|fuzz|reference|net)$'
        step "The server under load ($1)" underLoad "$1"
        ;;
    esac
}
