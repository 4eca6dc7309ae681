#!/bin/bash
# Fuzzes each door for a while: run.sh FOLDER-OF-PROGRAMS; FUZZ_SECONDS each (60), a name in ONLY runs that one alone.
# FUZZ_SEED fixes what is tried, so that two runs differ by the code alone; without it each run tries something else.
# Starts from tests/fuzz/corpus/<name>/ (checked in: small, one per shape of input) and what earlier runs found
# (build/fuzz/corpus/<name>/). A crash leaves its input in build/fuzz/found/<name>/: make a unit test of it.
set -u
programs=$1
seconds=${FUZZ_SECONDS:-60}
passed=0 failed=0
# every name of the protocol is a word worth trying
words=build/fuzz/words.dict
grep -hoE '"name": *"[^"]+"' proto/*.json | sed -E 's/.*: *("[^"]+")/\1/' | sort -u >"$words"
for source in tests/fuzz/fuzz_*.c; do
    name=$(basename "$source" .c)
    program=$programs/$name
    name=${name#fuzz_}
    [ -z "${ONLY:-}" ] || [ "$ONLY" = "$name" ] || continue
    grown=build/fuzz/corpus/$name found=build/fuzz/found/$name log=build/fuzz/$name.log
    mkdir -p "$grown" "$found"
    seeds=()
    [ ! -d "tests/fuzz/corpus/$name" ] || seeds=("tests/fuzz/corpus/$name")
    if UBSAN_OPTIONS=print_stacktrace=1 "$program" -seed="${FUZZ_SEED:-0}" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=2048 -max_len=65536 \
        -dict="$words" -print_final_stats=1 -artifact_prefix="$found/" "$grown" "${seeds[@]}" >"$log" 2>&1 </dev/null; then
        passed=$((passed + 1))
        echo "  $name: $(sed -n 's/^stat::number_of_executed_units: *//p' "$log") inputs in $seconds s," \
            "$(sed -nE 's/.* cov: ([0-9]+) .*/\1/p' "$log" | tail -n 1) edges"
    else
        failed=$((failed + 1))
        echo "FAILED: $name; the input is in $found, the log in $log"
        tail -n 40 "$log"
    fi
done
echo "fuzz: $passed passed, $failed failed, 0 skipped"
[ "$failed" = 0 ]
