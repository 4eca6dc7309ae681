#!/bin/bash
# Runs suites of node's own test runner: run_node.sh NAME FILE...; ends with "NAME: N passed, N failed, N skipped".
# The report in full stays in build/test/NAME.tap. TEST_CONCURRENCY files run side by side, else one after the other.
set -u
name=$1
shift
[ $# -gt 0 ] || { echo "$name: 0 passed, 0 failed, 0 skipped"; exit 0; }
mkdir -p build/test
tap=build/test/$name.tap
timeout -k 10 "${SUITE_SECONDS:-1300}" "${NODE:-node}" --test --test-concurrency="${TEST_CONCURRENCY:-1}" --test-reporter=spec --test-reporter-destination=stdout \
    --test-reporter=tap --test-reporter-destination="$tap" "$@" </dev/null
status=$?
total() { sed -n "s/^# $1 \([0-9]*\)$/\1/p" "$tap" | tail -n 1; }
passed=$(total pass) failed=$(($(total fail) + $(total cancelled))) skipped=$(($(total skipped) + $(total todo)))
[ $status = 0 ] || [ "$failed" -gt 0 ] || failed=1
echo "$name: ${passed:-0} passed, $failed failed, $skipped skipped"
[ "$failed" = 0 ]
