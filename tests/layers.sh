#!/bin/bash
# Holds the includes to tests/layers.txt: layers.sh [ROOT]; prints each one that breaks a rule, and fails then.
set -eu
cd "${1:-.}"
find core server tests \( -name '*.[ch]' -o -name '*.cc' \) -type f 2>/dev/null | sort | xargs -r grep -HnE '^[[:space:]]*#[[:space:]]*include' |
awk -v rules="${LAYERS:-tests/layers.txt}" '
function folder_of(path) { sub(/\/[^\/]*$/, "", path); return path }
# the folder itself, or the nearest one above it that has a rule
function layer_of(folder) {
    while (folder != "" && !(folder in allowed)) { if (folder !~ /\//) return ""; folder = folder_of(folder) }
    return folder
}
function inside(path, place) { return path == place || index(path, place "/") == 1 }
function glob(pattern) { gsub(/\./, "\\.", pattern); gsub(/\*/, ".*", pattern); return "^" pattern "$" }
function exists(path,   line, found) { found = (getline line < path) >= 0; close(path); return found }
function complain(text) { print text; bad++ }
BEGIN {
    while ((getline line < rules) > 0) {
        sub(/#.*/, "", line)
        if (line ~ /^[[:space:]]*$/) continue
        split(line, side, /:[[:space:]]*/)
        if (side[1] ~ /^only [^*\/]*\.h$/) generated[substr(side[1], 6)] = 1
        if (side[1] ~ /^only /) { n_only++; only_name[n_only] = substr(side[1], 6); only_home[n_only] = side[2] }
        else { allowed[side[1]] = side[2] }
    }
    if (n_only == 0) { print rules ": no rules read"; exit 2 }
}
{
    split($0, part, ":")
    file = part[1]; at = part[1] ":" part[2]
    text = substr($0, length(at) + 2)
    n_includes++
    if (match(text, /[<"][^>"]+[>"]/) == 0) { complain(at ": an include this check cannot read: " text); next }
    quoted = substr(text, RSTART, 1) == "\""
    name = substr(text, RSTART + 1, RLENGTH - 2)

    for (i = 1; i <= n_only; i++) {
        if (name !~ glob(only_name[i])) continue
        n = split(only_home[i], home, " "); ok = 0
        for (j = 1; j <= n; j++) ok = ok || inside(file, home[j])
        if (!ok) complain(at ": only " only_home[i] " may include " name)
    }
    if (!quoted) { if (name ~ /^(core|server|tests)\//) complain(at ": our own headers stand in quotation marks: " name); next }
    if (name !~ /\// && name in generated) next # its home was looked at above
    if (name ~ /^\.|\/\.\.?\//  || !exists(name)) { complain(at ": " name " is not a path from the root"); next }

    from = layer_of(folder_of(file)); to = folder_of(name)
    if (from == "") { complain(at ": " folder_of(file) " has no line in " rules); next }
    if (to == folder_of(file) || layer_of(to) == from) next
    n = split(allowed[from], may, " "); ok = 0
    for (j = 1; j <= n; j++) ok = ok || name == may[j] || layer_of(to) == may[j] || (may[j] == "core" && inside(to, "core")) || to == may[j]
    if (!ok) complain(at ": " from " may not include " name " (" (layer_of(to) == "" ? to : layer_of(to)) ")")
}
END {
    if (bad) { print bad " of " n_includes " includes break tests/layers.txt"; exit 1 }
    if (n_includes < 2) { print "no includes found"; exit 1 }
}'
