#!/bin/bash
# Holds the ways to what the gate guards to tests/doors.txt: doors.sh [ROOT]; prints each line that breaks a rule, and fails then.
set -eu
cd "${1:-.}"
rules=${DOORS:-tests/doors.txt} bad=0 n=0
folders=()
for folder in core/scene core/pick core/render core/annotate core/pipeline server/renderer; do [ -d "$folder" ] && folders+=("$folder"); done
while IFS= read -r line; do
    case $line in '' | '#'*) continue ;; esac
    pattern=${line%:*} places=" ${line##*:} " n=$((n + 1))
    while IFS= read -r found; do
        file=${found%%:*}
        case $places in *" $file "*) continue ;; esac
        echo "$found: matches '$pattern', which may stand in${places:-nowhere} only"
        bad=$((bad + 1))
    done < <(grep -rnE --include='*.[ch]' -- "$pattern" "${folders[@]}" | grep -vE '^[^:]*:[0-9]+: *(/\*|\*)' || true)
done < "$rules"
[ "$n" -gt 0 ] || { echo "$rules: no rules read"; exit 1; }
[ "$bad" -eq 0 ] || { echo "$bad lines break $rules"; exit 1; }
