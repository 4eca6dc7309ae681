#!/bin/bash
# Lines run by the tests, per folder, from gcov's counts: cover.sh VARIANT-FOLDER. Details: gcov -o on one object.
set -u
find "$1/obj/core" "$1/obj/server" -name '*.gcda' 2>/dev/null | while read -r data; do
    gcov -n -r "$data" 2>/dev/null
done | awk '
/^File / { file = $2; gsub(/\x27/, "", file) }
/^Lines executed:/ && file ~ /\.c$/ && !(file in seen) {
    split($0, part, /[:% ]+/); seen[file] = 1
    folder = file; sub(/\/[^\/]*$/, "", folder)
    lines[folder] += part[5]; run[folder] += part[3] * part[5] / 100; file = ""
}
END {
    for (folder in lines) { printf "%-20s %6d lines %6.1f %%\n", folder, lines[folder], 100 * run[folder] / lines[folder] | "sort"; all += lines[folder]; hit += run[folder] }
    close("sort")
    if (all) printf "%-20s %6d lines %6.1f %%\n", "all", all, 100 * hit / all
}'
