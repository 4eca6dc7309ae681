#!/bin/bash
# Runs test programs: run_programs.sh NAME PROGRAM...; PARALLEL of them at once (1).
# Counts cmocka's tests, or the program itself where it is not cmocka's; exit 77 of a program means skipped, shown as
# such. RUNNER, when set, stands in front of every program. Ends with "NAME: N passed, N failed, N skipped".
set -u
name=$1
shift
passed=0 failed=0 skipped=0
outputs=$(mktemp -d)
trap 'rm -rf "$outputs"' EXIT
start() { # start NUMBER PROGRAM
    ${RUNNER:-} timeout -k 10 "${PROGRAM_SECONDS:-300}" "$2" >"$outputs/$1.out" 2>&1 </dev/null
    echo $? >"$outputs/$1.status"
}
summary() { sed -n "s/^\[  $1 *\] \([0-9][0-9]*\) test(s).*/\1/p" <<<"$out" | tail -n 1; }
judge() { # judge NUMBER PROGRAM
    local program=$2 out status ok bad skip
    out=$(<"$outputs/$1.out")
    status=$(<"$outputs/$1.status")
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
    [ "$status" = 77 ] || grep -E '^\[  SKIPPED \] [^0-9]' <<<"$out" | sort -u | sed "s|^|  $(basename "$program"): |"
}
number=0
for program in "$@"; do
    while [ "$(jobs -pr | wc -l)" -ge "${PARALLEL:-1}" ]; do wait -n; done
    number=$((number + 1))
    start $number "$program" &
done
wait
number=0
for program in "$@"; do
    number=$((number + 1))
    judge $number "$program"
done
echo "$name: $passed passed, $failed failed, $skipped skipped"
[ "$failed" = 0 ]
