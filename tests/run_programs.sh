#!/bin/bash
# Runs test programs one by one: run_programs.sh NAME PROGRAM...
# Counts cmocka's tests, or the program itself where it is not cmocka's; exit 77 of a program means skipped, shown as
# such. RUNNER, when set, stands in front of every program. Ends with "NAME: N passed, N failed, N skipped".
set -u
name=$1
shift
passed=0 failed=0 skipped=0
summary() { sed -n "s/^\[  $1 *\] \([0-9][0-9]*\) test(s).*/\1/p" <<<"$out" | tail -n 1; }
for program in "$@"; do
    out=$(${RUNNER:-} timeout -k 10 "${PROGRAM_SECONDS:-300}" "$program" 2>&1 </dev/null)
    status=$?
    ok=$(grep -cE '^\[       OK \]' <<<"$out")
    bad=$(summary FAILED) skip=$(summary SKIPPED)
    case $status in
    0) [ "$((ok + ${skip:-0}))" -gt 0 ] || ok=1 ;;
    77)
        ok=0 skip=1
        echo "skipped: $program: $(tail -n 1 <<<"$out")"
        ;;
    *)
        [ "${bad:-0}" -gt 0 ] || bad=1
        echo "FAILED: $program (exit $status)"
        echo "$out"
        ;;
    esac
    passed=$((passed + ok)) failed=$((failed + ${bad:-0})) skipped=$((skipped + ${skip:-0}))
    [ $status = 77 ] || grep -E '^\[  SKIPPED \] [^0-9]' <<<"$out" | sort -u | sed "s|^|  $(basename "$program"): |"
done
echo "$name: $passed passed, $failed failed, $skipped skipped"
[ "$failed" = 0 ]
