#!/bin/bash
# What a compiler does not say: layers, headers that stand alone, calls we never make, scripts that parse.
# Ends with "lint: N passed, N failed, N skipped".
set -u
passed=0 failed=0
check() { # check SENTENCE COMMAND...: passes when the command succeeds; its output is shown when it does not
    local sentence=$1 out
    shift
    if out=$("$@" 2>&1); then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAILED: $sentence"
        echo "$out" | head -n 40 | sed 's/^/  /'
    fi
}
sources() { git ls-files -co --exclude-standard -- "$@" | while read -r file; do [ ! -e "$file" ] || echo "$file"; done; }

# The check itself is checked: in a copy with one planted include it has to find exactly that.
planted() { # planted FILE INCLUDE EXPECTED-WORDS
    local file=$copy/$1 out status
    mkdir -p "$(dirname "$file")"
    [ ! -e "$file" ] || { echo "$1 is there already"; return 1; }
    echo "#include $2" >"$file"
    out=$(tests/layers.sh "$copy")
    status=$?
    rm "$file"
    [ $status = 1 ] && grep -q "^$1:.*$3" <<<"$out" && [ "$(grep -c "^$1:" <<<"$out")" = 1 ] && return 0
    echo "planted $2 in $1; the check said (exit $status):"
    echo "$out"
    return 1
}
# And the one for the doors of the gate: a way past it has to be found.
planted_door() {
    local folder out status
    folder=$(mktemp -d)
    mkdir -p "$folder/core/scene"
    printf 'double f(const struct dose *dose) { return dose->components[0].values->low; }\n' >"$folder/core/scene/planted.c"
    out=$(DOORS=$PWD/tests/doors.txt tests/doors.sh "$folder")
    status=$?
    rm -rf "$folder"
    [ $status = 1 ] && grep -q '^core/scene/planted.c:1:' <<<"$out" && return 0
    echo "a planted way to a dose's values; the check said (exit $status):"
    echo "$out"
    return 1
}
# So is the one for circles: two folders that include each other, and two files that call each other, have to be found.
planted_circle() {
    local copy out
    copy=$(mktemp -d)
    mkdir -p "$copy/core/one" "$copy/core/two" "$copy/build/obj/core/one"
    printf '#include "core/two/b.h"\nint a(void);\nint b(void);\nint a(void) { return b(); }\n' >"$copy/core/one/a.c"
    printf 'int a(void);\nint b(void);\nint b(void) { return a(); }\n' >"$copy/core/one/b.c"
    printf '#pragma once\n#include "core/one/a.h"\n' >"$copy/core/two/b.h"
    printf '#pragma once\n' >"$copy/core/one/a.h"
    (cd "$copy" && "${CC:-gcc}" -I. -c core/one/a.c -o build/obj/core/one/a.o &&
        "${CC:-gcc}" -I. -c core/one/b.c -o build/obj/core/one/b.o)
    out=$(cd "$copy" && "$OLDPWD/tests/circles.sh" build)
    local status=$?
    rm -rf "$copy"
    [ $status = 1 ] && grep -q "circle of folders" <<<"$out" && grep -q "circle of files in core/one" <<<"$out" && return 0
    echo "two planted circles; the check said (exit $status):"
    echo "$out"
    return 1
}
# And the one for documents: a path that is not there, a package without a row, a version that differs.
planted_documents() {
    local folder out fault status=0
    folder=$(mktemp -d)
    cp --parents ./*.md Makefile package.json package-lock.json tests/deploy/package.json tests/firefox/package.json deploy/packages deploy/promised.mjs deploy/beamroomd.conf docs/threads.md docs/admin.md "$folder"
    printf '\nSee `core/base/planted.c`, and [a page](planted.md).\n' >>"$folder/docs/threads.md"
    sed -i 's/^bench="/&planted-dev /' "$folder/deploy/packages"
    sed -i 's/"version": "[0-9.]*",/"version": "9.9.9",/' "$folder/package.json"
    head -c 5000 /dev/zero | tr '\0' x >>"$folder/README.md"
    sed -i "s/chrome: '[0-9]*'/chrome: '999'/" "$folder/deploy/promised.mjs"
    echo '# planted-setting = 1' >>"$folder/deploy/beamroomd.conf"
    mkdir "$folder/docs/decisions" && printf '# 99. Planted\n\n## Decision\n' >"$folder/docs/decisions/99-planted.md"
    out=$("${NODE:-node}" tests/documents.mjs "$folder") && status=1
    for fault in 'threads.md:.*core/base/planted.c is not there' 'threads.md:.*planted.md leads nowhere' 'no row for planted-dev' 'package.json:1: version 9.9.9' \
        'README.md:1: [0-9]* bytes' 'promise chrome 999' '99-planted.md:1: its headings' '99-planted.md:1: not in' \
        'the setting planted-setting is not named'; do
        grep -q "$fault" <<<"$out" || { echo "not found: $fault"; status=1; }
    done
    rm -rf "$folder"
    return $status
}
# The README of each folder is held to it: each planted fault has to be found, by its very sentence.
planted_readmes() {
    local folder out expected
    folder=$(mktemp -d)
    mkdir -p "$folder/core/one/deep" "$folder/core/two"
    touch "$folder"/core/one/{a.c,a.h,b.c,cc.c} "$folder"/core/one/deep/{d.c,e.c} "$folder/core/two/f.c"
    { printf '# one\n`a.h`, `a.h`; `gone.c`; `c*.c` and `*c.c`; `core/two/g.h`; `x*.c`\n'; yes . | head -n 29; } >"$folder/core/one/README.md"
    expected='core/two/ has no README.md, nor has a folder above it
core/one/README.md has 31 lines; at most 30
core/one/README.md:2 names gone.c, which does not exist
core/one/README.md:2 names core/two/g.h, which does not exist
core/one/README.md:2 names x*.c, which nothing matches
core/one/a.h is named 2 times in core/one/README.md: lines 2, 2
core/one/b.c is not named in core/one/README.md
core/one/cc.c is matched by 2 patterns in core/one/README.md
core/one/deep/ has no README.md, and core/one/README.md names none of its 2 files'
    out=$(git -C "$folder" init -q 2>&1 && "${NODE:-node}" tests/readmes.mjs "$folder")
    rm -rf "$folder"
    [ "$out" = "$expected" ] && return 0
    diff <(echo "$expected") <(echo "$out")
    return 1
}
# No file of C or JavaScript asks to be two; of other kinds a note says it. short_enough [ROOT]
short_enough() {
    local long
    long=$(cd "${1:-.}" && find core server tests web -name '*.[ch]' -o -name '*.cc' -o -name '*.hh' -o -name '*.js' -o -name '*.mjs' | xargs wc -l | awk '$2 != "total" && $1 > 600')
    [ -z "$long" ] || { echo "more than 600 lines: $long"; return 1; }
}
planted_long_file() {
    local folder out
    folder=$(mktemp -d)
    mkdir -p "$folder/core/plan" "$folder/server" "$folder/tests" "$folder/web"
    yes '/* . */' | head -n 600 >"$folder/core/plan/short.c"
    yes '/* . */' | head -n 601 | tee "$folder/core/plan/planted.c" >"$folder/web/planted.js"
    out=$(short_enough "$folder")
    local status=$?
    rm -rf "$folder"
    [ $status = 1 ] && grep -q 'core/plan/planted.c' <<<"$out" && grep -q 'web/planted.js' <<<"$out" && ! grep -q 'short.c' <<<"$out" && return 0
    echo "two planted files of 601 lines; the check said (exit $status):"
    echo "$out"
    return 1
}
no_calls() {
    ! grep -nE '(^|[^a-zA-Z0-9_.>])(sprintf|vsprintf|strcpy|strcat|strtok|gets|system|popen|setlocale|alloca|atoi|atof)[[:space:]]*\(' \
        $(sources '*.c' '*.h' '*.cc' '*.hh')
}
locks_in_base() { ! grep -nE 'pthread_(mutex|cond|rwlock|spin)' $(sources 'core/*.[ch]' 'core/*.cc' 'server/*.[ch]' | grep -v '^core/base/'); }
no_flags() { ! grep -nE -e '-f(fast-math|unsafe-math-optimizations)' Makefile; }
header_stands_alone() {
    "${CC:-gcc}" -std=c17 -D_DEFAULT_SOURCE -D_POSIX_C_SOURCE=200809L -I. -Ibuild/gen -Wall -Wextra -Werror -fsyntax-only -include "$1" -x c /dev/null
}
export -f header_stands_alone
on_all_cores() { xargs -P "$(nproc)" "$@"; }
# a.h that a.c includes before all else has been compiled alone by the build
included_first() { sources '*.c' | xargs awk '/^#include/ { print FILENAME, $2; nextfile }' | sed -nE 's/^(.*)\.c "\1\.h"$/\1.h/p'; }
headers_stand_alone() {
    local twice
    twice=$(sources '*.h' | xargs grep -L '^#pragma once')
    [ -z "$twice" ] || { echo "no #pragma once: $twice"; return 1; }
    comm -23 <(sources '*.h' | sort) <(included_first | sort) | on_all_cores -I{} bash -c 'header_stands_alone {}'
}
scripts_parse() {
    local script bad status=0
    for script in $(sources deploy tests .ci | xargs -r grep -lE '^#!/bin/(ba)?sh'); do
        bash -n "$script" || status=1
        [ -x "$script" ] || { echo "$script: not executable"; status=1; }
    done
    # one process for all of them; what is wrong with one is said by --check
    bad=$("${NODE:-node}" --experimental-vm-modules --no-warnings tests/parse.mjs $(sources '*.js' '*.mjs')) || status=1
    for script in $bad; do "${NODE:-node}" --check "$script"; done
    return $status
}
json_parses() { "${NODE:-node}" tests/api/strict_json.mjs $(sources '*.json' | grep -v '/fixtures/bad/') build/gen/openapi.json; }
laid_out() { sources '*.c' '*.h' '*.cc' '*.hh' '*.inc' | on_all_cores -n 50 clang-format --dry-run -Werror; }
biome() { node_modules/.bin/biome "$@"; }
scripts_and_styles() { biome check --error-on-warnings; }
planted_script() {
    local folder out
    folder=$(mktemp -d)
    mkdir -p "$folder/web/js" "$folder/web/css"
    cp biome.jsonc "$folder"
    printf 'export const count = missing\n' >"$folder/web/js/planted.js"
    printf 'a {\n  colour: red;\n}\n' >"$folder/web/css/planted.css"
    out=$(biome=$PWD/node_modules/.bin/biome && cd "$folder" && "$biome" check --reporter=github 2>&1)
    rm -rf "$folder"
    grep -q noUndeclaredVariables <<<"$out" && grep -q noUnknownProperty <<<"$out" && grep -q 'title=format,file=[^,]*planted.js' <<<"$out" && return 0
    echo "$out"
    return 1
}
page_layers() { "${NODE:-node}" tests/page_layers.mjs; }
planted_import() {
    local folder out
    folder=$(mktemp -d)
    mkdir -p "$folder/web/js/features/clip" "$folder/web/js/features/beams" "$folder/web/js/room"
    echo 'export const beams = 1;' >"$folder/web/js/features/beams/beams.js"
    printf "import { beams } from '../beams/beams.js';\nexport { beams };\n" >"$folder/web/js/features/clip/clip.js"
    printf "export const later = () => import('../features/beams/beams.js');\n" >"$folder/web/js/room/room.js"
    out=$("${NODE:-node}" tests/page_layers.mjs "$folder")
    rm -rf "$folder"
    grep -q '^web/js/features/clip/clip.js:1: features/clip may not import features/beams' <<<"$out" &&
        grep -q '^web/js/room/room.js:1: room may not import features/beams' <<<"$out" && return 0
    echo "two planted imports; the check said:"
    echo "$out"
    return 1
}
planted_sentence() {
    local folder out expected
    folder=$(mktemp -d)
    mkdir -p "$folder/core" "$folder/server/wire" "$folder/proto"
    printf '{ "about": "", "problems": [["said", "so {n %%d}"], ["not-said", "not so"]], "report": [], "fits": [] }\n' >"$folder/proto/sentences.json"
    printf 'f(problem_set(p, T, "", "", "so " "%%d", g(1, 2)));\nf(problem_set(p, T, "", "", is ? "%%s" : "new", x));\n' >"$folder/server/a.c"
    expected='server/a.c:2: "new" is not in proto/sentences.json, problems
proto/sentences.json, problems: nothing says not-said, "not so"'
    out=$("${NODE:-node}" tests/sentences.mjs "$folder")
    local status=$?
    rm -rf "$folder"
    [ $status = 1 ] && [ "$out" = "$expected" ] && return 0
    echo "a sentence without a row and a row that nothing says; the check said (exit $status):"
    echo "$out"
    return 1
}
page_words() { "${NODE:-node}" tests/page_words.mjs; }
planted_words() {
    local folder out expected
    folder=$(mktemp -d)
    mkdir -p "$folder/web/js/clip" "$folder/web/js/parts"
    printf "import { say } from './clip/clip.js';\n\nsay();\n" >"$folder/web/js/main.js"
    cat >"$folder/web/js/clip/clip.js" <<'JS'
import { html } from '../parts/html.js';
import { say } from './words.js';
import { say as later } from './later_words.js';

const names = { axial: 'Axial cut', icon: 'eye-off' };
export const clip = (ui, n) => html`<p class="a note" title="Planted one" data-key="Aa bb">${say.none} mm<b>Planted two</b>${n ? 'planted' : names.axial} ${n === 'all of' ? icon('eye') : later.name}${later.one({ m: n })}</p>
  <i class=${`old ${n}`} aria-label=${`planted ${n}`} @click=${() => ui.notify('ok', `Planted ${n} more`)}></i>`;
JS
    printf "export const say = sentences('clip', {\n  some: 'Some',\n});\n" >"$folder/web/js/clip/words.js"
    printf "export const say = sentences('clip.later', {\n  name: 'Name',\n  one: '{n} of one',\n});\n" >"$folder/web/js/clip/later_words.js"
    expected='web/js/clip/clip.js:6: web/js/clip/words.js has no "none"
web/js/clip/clip.js:6: "one" of web/js/clip/later_words.js gets no value for n
web/js/clip/words.js:2: nothing reads "some"
web/js/clip/clip.js is loaded at once, and imports web/js/clip/later_words.js
web/js/clip/clip.js:6: stands outside of a table of words: Planted one
web/js/clip/clip.js:6: stands outside of a table of words: Planted two
web/js/clip/clip.js:5: stands outside of a table of words: Axial cut
web/js/clip/clip.js:6: stands outside of a table of words: planted
web/js/clip/clip.js:7: stands outside of a table of words: planted {}
web/js/clip/clip.js:7: stands outside of a table of words: Planted {} more'
    out=$("${NODE:-node}" tests/page_words.mjs "$folder")
    rm -rf "$folder"
    [ "$out" = "$expected" ] && return 0
    diff <(echo "$expected") <(echo "$out")
    return 1
}
comments_begin() { "${NODE:-node}" tests/comments.mjs $(sources '*.c' '*.h' '*.cc' '*.hh' '*.inc' '*.glsl' '*.vert' '*.frag' '*.js' '*.mjs' '*.css'); }
planted_comment() {
    local file out
    file=$(mktemp)
    printf '#pragma once\n/* What a planted header is for. */\nint a; /* of a field: a phrase */\n/* Of a\n * thing. */\n// Code.\n// From here on\n' >"$file"
    out=$("${NODE:-node}" tests/comments.mjs "$file")
    rm "$file"
    [ "$(sed 's/^[^:]*:\([0-9]*\):.*/\1/' <<<"$out" | tr '\n' ' ')" = "2 4 " ] && return 0
    echo "two planted comments, in lines 2 and 4; the check said:"
    echo "$out"
    return 1
}
no_addresses_in_the_lock() { ! grep -nE '"resolved"|https?://[^"]*\.tgz' package-lock.json tests/deploy/package-lock.json tests/firefox/package-lock.json; }

copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT
cp -r --parents core server tests/layers.txt "$copy"
check "includes follow tests/layers.txt" tests/layers.sh
check "a core file that includes a server header is found" planted core/base/planted.c '"server/wire/json.h"' 'not a path\|may not include'
check "an edge against the direction is found" planted core/math/planted.c '"core/volume/volume.h"' 'core/math may not include'
check "a library outside its home is found" planted core/plan/planted.c '<GL/gl.h>' 'only core/render/gl'
check "an include that is not from the root is found" planted core/volume/planted.c '"../base/error.h"' 'not a path from the root'
check "what the gate guards is reached through its doors (tests/doors.txt)" tests/doors.sh
check "a way past the gate is found" planted_door
check "no folder and no file of a folder is in a circle" tests/circles.sh "${BEAMROOM_BIN:-build/release}"
check "a circle of folders and one of files are found" planted_circle
check "documents name what is there: paths, packages with their licences, one version" "${NODE:-node}" tests/documents.mjs
check "a path, a package and a version that are not are found" planted_documents
check "a stranger's questions lead from README.md to their files (docs/testing.md)" "${NODE:-node}" tests/ways.mjs
check "the README of each folder names its files, each once, and nothing that is not there" "${NODE:-node}" tests/readmes.mjs
check "faults of such a README are found" planted_readmes
check "no file of C or JavaScript has more than 600 lines" short_enough
check "a file of 601 lines is found" planted_long_file
check "no banned calls" no_calls
check "C is laid out as .clang-format says (clang-format -i FILE)" laid_out
check "JavaScript and CSS are laid out and free of mistakes as biome.jsonc says (npx biome check --write FILE)" scripts_and_styles
check "a name that nobody declares, an unknown property of CSS and a line out of layout are found" planted_script
check "the page's imports follow tests/page_layers.txt" page_layers
check "an import from one feature to another, and one upwards, are found" planted_import
check "what a person reads on the page stands in tables of words (tests/page_words.mjs)" page_words
check "texts outside of a table, keys that are missing or too many, and a table of later in what is loaded at once are found" planted_words
check "each sentence of the server is in proto/sentences.json, and each of those is said (tests/sentences.mjs)" "${NODE:-node}" tests/sentences.mjs
check "a sentence without a row and a row that nothing says are found" planted_sentence
check "comments begin with their subject (tests/comments.mjs)" comments_begin
check "comments that begin in the middle are found" planted_comment
check "locks stand in core/base alone" locks_in_base
check "no value-changing float flags" no_flags
check "each header compiles alone, once" headers_stand_alone
check "scripts parse and can be run" scripts_parse
check "nothing is newer than the browsers and the node that deploy/promised.mjs promises" "${NODE:-node}" tests/oldest.mjs
check "JSON files parse, with no name twice in an object" json_parses
check "the npm lock names no addresses" no_addresses_in_the_lock

wc -l $(sources '*.css' '*.py') | awk '$2 != "total" && $1 > 600 { print "note: " $2 " has " $1 " lines; over 600 asks to be two" }'
echo "lint: $passed passed, $failed failed, 0 skipped"
[ "$failed" = 0 ]
