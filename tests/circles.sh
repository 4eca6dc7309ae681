#!/bin/bash
# Finds circles: circles.sh BUILD, where BUILD has obj/core and obj/server (build/release).
#   Of folders: one that includes another, directly or by others, which includes it.
#   Of files of one folder: an object file that uses a symbol of another which, directly or by others, uses one of it.
# Prints each circle, a line a member, and fails then. tsort finds them.
set -eu
build=${1:?usage: circles.sh BUILD}
status=0

report() { # report TITLE: edges "A B" on standard input
    local title=$1 out
    out=$(tsort 2>&1 >/dev/null) || true
    [ -n "$out" ] || return 0
    echo "circle of $title:"
    sed -n 's/^tsort: \([^-].*\)/  \1/p' <<<"$out"
    status=1
}

folder_edges() {
    grep -rnE '^[[:space:]]*#[[:space:]]*include[[:space:]]+"(core|server)/' core server --include='*.[ch]' --include='*.cc' |
        sed -E 's#^(.*)/[^/:]*:[0-9]+:.*"(.*)/[^/"]*".*#\1 \2#' | awk '$1 != $2' | sort -u
}

symbol_edges() { # of the object files given
    nm -P --defined-only -g "$@" >"$symbols.defined"
    nm -P -u "$@" >"$symbols.used"
    awk '
        /:$/ { file = $0; sub(/:$/, "", file); sub(/.*\//, "", file); next }
        FNR == NR { home[$1] = file; next }
        ($1 in home) && home[$1] != file { print file, home[$1] }' "$symbols.defined" "$symbols.used" | sort -u
}

symbols=$(mktemp)
trap 'rm -f "$symbols"*' EXIT
n=0
report "folders" < <(folder_edges)
for folder in $(find core server -type d | sort); do
    objects=$(find "$folder" -maxdepth 1 \( -name '*.c' -o -name '*.cc' \) | sort | sed -E "s#^(.*)\.cc?\$#$build/obj/\1.o#")
    [ "$(wc -w <<<"$objects")" -gt 1 ] || continue
    n=$((n + 1))
    report "files in $folder" < <(symbol_edges $objects)
done
[ $n -gt 0 ] || { echo "no folder of several files was found"; exit 2; }
exit $status
