#!/bin/bash
# Shows that a rearrangement changed nothing that is seen from outside: records a hash of every picture of the render suite on
# each back end and of every answer to the tests of tests/api (by HTTP, by WebSocket, to bytes of one's own), and compares records.
#   tests/same.sh record FILE      FILE.texts holds the texts that were hashed. PARALLEL programs or files run at once (1)
#   tests/same.sh compare OLD NEW  prints what differs, and fails if anything does
# BEAMROOM_BIN, BEAMROOM_WEB, BEAMROOM_DEMO as for all tests. ONLY=pictures|answers; FILES="..." records these files of tests/api.
# tests/answers.mjs says what is masked in answers, tests/render/recorded.c records pictures.
set -u
bin=${BEAMROOM_BIN:-build/release}

# Tests of which nothing is recorded:
load="burst fair missing rest slow slow_disk" # how it answers under load, or late
chance="kills late_join replayed_meeting"     # random moments, random meetings
place="full_disk_items full_recording"        # how much fits on a disk
left_out=" $load $chance $place "

picture_program() { # picture_program FOLDER PROGRAM
    local name
    name=$(basename "$2")
    BEAMROOM_SAME=$1/$name "$2" >"$1/log.$name" 2>&1 </dev/null || [ $? = 77 ] || { echo "FAILED: $2"; echo "$name FAILED" >"$1/$name"; }
}
answer_file() { # answer_file FOLDER FILE
    local name
    name=$(basename "$2" .test.mjs)
    BEAMROOM_SAME=$1/answers.$name "${NODE:-node}" --import ./tests/answers.mjs --test "$2" >"$1/log.$name" 2>&1 </dev/null && return
    echo "FAILED: $2"
    grep -A16 '^ *not ok' "$1/log.$name" | head -n 40
    echo "$name.test.mjs FAILED" >"$1/answers.$name"
}
export -f picture_program answer_file

record() { # record FILE
    local file=$1 work
    work=$(mktemp -d)
    mkdir -p "$(dirname "$file")" "$work/texts"
    if [ "${ONLY:-}" != answers ]; then
        find "$bin/render" -name 'test_*' -type f -perm -u+x | sort |
            xargs -P "${PARALLEL:-1}" -I{} bash -c 'picture_program "$1" "$2"' _ "$work" {}
    fi
    if [ "${ONLY:-}" != pictures ]; then
        for part in ${FILES:-tests/api/*.test.mjs}; do
            [[ $left_out == *" $(basename "$part" .test.mjs) "* ]] || echo "$part"
        done | xargs -P "${PARALLEL:-1}" -I{} bash -c 'answer_file "$1" "$2"' _ "$work" {}
    fi
    find "$work" -maxdepth 1 -type f ! -name 'log.*' -exec cat {} + | LC_ALL=C sort -V >"$file"
    rm -rf "$file.texts"
    mv "$work/texts" "$file.texts"
    rm -rf "$work"
    echo "$1: $(grep -c '^test_' "$file") pictures, $(grep -vc '^test_' "$file") answers"
}

# An answer that only one of two runs had came or not by chance; it differs if the other run has another one of the same test to the same call.
both_sides() {
    awk '{ call = $3; sub(/_[0-9]+(_[^_]*)?$/, "", call); key = $2 " " call; side[key, $1] = 1; line[NR] = $0; of[NR] = key }
        END { for (i = 1; i <= NR; i++) if (line[i] ~ /^. test_/ || (side[of[i], "<"] && side[of[i], ">"])) print line[i] }'
}
# What failed in one of the two is said and not compared: record it again with FILES. What only NEW has is no difference.
compare() { # compare OLD NEW
    local failed new_ones differ n
    failed=$(sed -n 's/ FAILED$//p' "$1" "$2" | sort -u | tr '\n' ' ')
    new_ones=$(comm -13 <(cut -d' ' -f1 "$1" | sort -u) <(cut -d' ' -f1 "$2" | sort -u) | tr '\n' ' ')
    comparable() { awk -v out=" $failed$new_ones" 'index(out, " " $1 " ") == 0' "$1"; }
    [ -z "$failed" ] || echo "not compared, as they failed: $failed"
    [ -z "$new_ones" ] || echo "only in $2: $new_ones"
    differ=$(diff <(comparable "$1") <(comparable "$2") | sed -n '/^[<>]/p' | both_sides)
    if [ -z "$differ" ]; then
        n=$(comparable "$1" | grep -c '^test_')
        echo "the same: $n pictures, $(($(comparable "$1" | wc -l) - n)) answers"
        return 0
    fi
    head -n "${MOST:-60}" <<<"$differ"
    echo "$(wc -l <<<"$differ") lines differ"
    return 1
}

if [ "${1:-}" = record ] && [ $# = 2 ]; then
    record "$2"
elif [ "${1:-}" = compare ] && [ $# = 3 ] && [ -r "$2" ] && [ -r "$3" ]; then
    compare "$2" "$3"
else
    echo "usage: tests/same.sh record FILE | compare OLD NEW" >&2
    exit 2
fi
