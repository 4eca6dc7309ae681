#!/bin/bash
# Suites one after the other: tests/all.sh test|deep|deploy, what `make test`, `make test-deep` and `make test-deploy` run. Each suite's full output
# stays in build/test/<suite>.log. Ends with one line, "N passed, N failed, N skipped", over all of them.
set -u
group=${1:-}
logs=build/test
mkdir -p "$logs"
jobs=-j$(nproc)
total_passed=0 total_failed=0 total_skipped=0
rows=()

suite() { # suite NAME MAKE-ARGUMENT...
    local name=$1 log=$logs/$1.log start=$SECONDS status counts passed failed skipped
    shift
    echo "== $name"
    ${MAKE:-make} --no-print-directory "$@" >"$log" 2>&1 </dev/null
    status=$?
    # what a suite says about itself: "name: N passed, N failed, N skipped", one or several
    counts=$(sed -nE 's/^[^:]+: ([0-9]+) passed, ([0-9]+) failed, ([0-9]+) skipped$/\1 \2 \3/p' "$log" |
        awk '{ p += $1; f += $2; s += $3 } END { print p + 0, f + 0, s + 0 }')
    read -r passed failed skipped <<<"$counts"
    if [ $status != 0 ]; then
        [ "$failed" -gt 0 ] || failed=1
        tail -n 200 "$log"
    else
        # a build has no tests to count: it is one itself; any other suite that ran nothing has lost its tests
        if [ "$((passed + failed + skipped))" = 0 ]; then
            if [[ $name == build* ]]; then passed=1; else failed=1; echo "FAILED: $name ran no test"; fi
        fi
        grep -iE '^ *(skipped|.*SKIPPED|﹣)' "$log"
    fi
    rows+=("$(printf '%-28s %6d passed %4d failed %4d skipped %5d s' "$name" "$passed" "$failed" "$skipped" $((SECONDS - start)))")
    total_passed=$((total_passed + passed)) total_failed=$((total_failed + failed)) total_skipped=$((total_skipped + skipped))
}

# All other suites of `make test` at once, from one queue: a row for each.
queue() {
    local log=$logs/queue.log start=$SECONDS status passed failed skipped name any=0
    echo "== all suites from one queue"
    ${MAKE:-make} --no-print-directory "$jobs" test-queue 2>&1 </dev/null | tee "$log" | grep --line-buffered -vE '^[^: ]+: [0-9]+ passed, [0-9]+ failed, [0-9]+ skipped$'
    status=${PIPESTATUS[0]}
    while read -r name passed failed skipped; do
        rows+=("$(printf '%-28s %6d passed %4d failed %4d skipped' "$name" "$passed" "$failed" "$skipped")")
        total_passed=$((total_passed + passed)) total_failed=$((total_failed + failed)) total_skipped=$((total_skipped + skipped))
        any=1
    done < <(sed -nE 's/^total ([^: ]+): ([0-9]+) passed, ([0-9]+) failed, ([0-9]+) skipped$/\1 \2 \3 \4/p; s/^(api-alone): ([0-9]+) passed, ([0-9]+) failed, ([0-9]+) skipped$/\1 \2 \3 \4/p' "$log")
    rows+=("$(printf '%-28s %47d s' "(these together)" $((SECONDS - start)))")
    [ $any = 1 ] && { [ "$status" = 0 ] || [ "$total_failed" -gt 0 ]; } || { total_failed=$((total_failed + 1)); tail -n 40 "$log"; }
}

programs="unit-programs render-programs faults-programs"
case $group in
test)
    suite build-gcc "$jobs" WERROR=1 all $programs bench-objects
    queue
    ;;
deep)
    # clang's warnings do not depend on how it optimises
    suite build-clang "$jobs" CC=clang WERROR=1 OPTIMIZE="-O1 -g0" programs ${programs//-programs/-objects} bench-programs
    suite unit-address-undefined "$jobs" SAN=address,undefined test-unit
    suite unit-thread "$jobs" SAN=thread test-unit
    suite render-address-undefined "$jobs" SAN=address,undefined test-render
    suite render-thread "$jobs" SAN=thread test-render
    suite render-long "$jobs" test-render-long
    suite faults "$jobs" SAN=address,undefined FAULTS=whole test-faults
    suite long test-long LONG_TESTS=rest
    suite firefox test-firefox
    FUZZ_SEED=1 suite fuzz fuzz FUZZ_SECONDS="${FUZZ_SECONDS:-3}"
    ;;
deploy)
    suite build "$jobs" all demo
    suite deploy test-proxies
    grep -E '^ *(▶|✔|✖) .*ms\)$' "$logs/deploy.log" # how long each part took
    ;;
*)
    echo "usage: tests/all.sh test|deep|deploy" >&2
    exit 2
    ;;
esac

echo
printf '%s\n' "${rows[@]}"
echo "in all ${SECONDS} s; logs in $logs"
echo "$total_passed passed, $total_failed failed, $total_skipped skipped"
[ "$total_failed" = 0 ]
