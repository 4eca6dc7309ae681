#!/bin/bash
# Runs test programs one by one: run_programs.sh NAME PROGRAM...; exit 77 of one means skipped, shown as such.
set -u
name=$1
shift
passed=0 failed=0 skipped=0
for program in "$@"; do
    out=$("$program" 2>&1)
    case $? in
    0) passed=$((passed + 1)) ;;
    77)
        skipped=$((skipped + 1))
        echo "skipped: $program: $(tail -n 1 <<<"$out")"
        ;;
    *)
        failed=$((failed + 1))
        echo "FAILED: $program"
        echo "$out"
        ;;
    esac
    grep -E '^(\[  SKIPPED|skipped)' <<<"$out" | sed "s|^|  $(basename "$program"): |"
done
echo "$name: $passed passed, $failed failed, $skipped skipped"
[ "$failed" = 0 ]
