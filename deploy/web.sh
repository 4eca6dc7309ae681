#!/bin/bash
# Puts the page together: deploy/web.sh DEST GENERATED
#   DEST/...      the files of web/ as they are
#   DEST/lib/     the pinned libraries, single ES modules: lit-html.js (directives in lib/directives/), signals-core.js, uplot.js with uplot.css;
#                 the font Inter with the signs of Western European languages
#   DEST/gen/     the tables and the reference page generated from proto/
#   and what deploy/page.mjs makes of them: index.html with few requests, and everything compressed
# Built beside DEST and moved into place, so a running daemon never serves a half-written page.
set -eu
dest=$1 generated=$2
part=$dest.part
rm -rf "$part"
mkdir -p "$part/lib/directives" "$part/gen"
[ ! -d web ] || cp -r web/. "$part/"
find "$part" -name README.md -delete # they are for whoever changes the page

# The libraries' source maps stay behind, so the comments that name them go too.
library() { sed 's|//# sourceMappingURL=.*$||' "node_modules/$1" >"$part/lib/$2"; }
for module in lit-html directive directive-helpers directives/class-map directives/live directives/repeat; do
    library "lit-html/$module.js" "$module.js"
done
library @preact/signals-core/dist/signals-core.module.js signals-core.js
library uplot/dist/uPlot.esm.js uplot.js
cp node_modules/uplot/dist/uPlot.min.css "$part/lib/uplot.css"
cp node_modules/uplot/LICENSE "$part/lib/LICENSE.uplot"
cp node_modules/lit-html/LICENSE "$part/lib/LICENSE.lit-html"
cp node_modules/@preact/signals-core/LICENSE "$part/lib/LICENSE.signals-core"
cp node_modules/@fontsource-variable/inter/files/inter-latin-wght-normal.woff2 "$part/lib/"
cp node_modules/@fontsource-variable/inter/LICENSE "$part/lib/LICENSE.inter"

for file in "$generated"/*.js "$generated"/*.html "$generated"/openapi.json; do
    [ ! -e "$file" ] || cp "$file" "$part/gen/"
done
"${NODE:-node}" deploy/page.mjs "$part"
rm -rf "$dest"
mv "$part" "$dest"
