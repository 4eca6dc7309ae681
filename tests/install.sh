#!/bin/bash
# Installs into a folder of its own, checks what landed, and runs the installed daemon on the demo plan.
# Ends with "install: N passed, N failed, N skipped" after the smoke test's own line.
set -u
root=$PWD/build/test/root
log=build/test/install-daemon.log
passed=0 failed=0
check() { # check SENTENCE COMMAND...
    local sentence=$1
    shift
    if "$@" >/dev/null 2>&1; then passed=$((passed + 1)); else failed=$((failed + 1)); echo "FAILED: $sentence"; fi
}
rm -rf "$root"
check "make install with DESTDIR and PREFIX" "${MAKE:-make}" install DESTDIR="$root" PREFIX=/usr SYSCONFDIR=/etc
for program in beamroomd beamroom-render beamroom-paper beamroom; do
    check "$program is there" test -x "$root/usr/bin/$program"
    check "$program --help" "$root/usr/bin/$program" --help
    check "$program --version" "$root/usr/bin/$program" --version
    check "$program has a man page" sh -c "ls '$root'/usr/share/man/man?/$program.?"
done
check "the page" test -s "$root/usr/share/beamroom/web/index.html"
check "the pinned libraries" test -s "$root/usr/share/beamroom/web/lib/lit-html.js"
check "their licences" grep -q 'BSD 3-Clause' "$root/usr/share/beamroom/web/licences.txt"
check "the licence of the font in the renderer" grep -q 'Bitstream' "$root/usr/share/doc/beamroom/dejavu-font.copyright"
check "our licence, and the table of others'" sh -c "grep -q 'Apache License' '$root/usr/share/doc/beamroom/LICENSE' && test -s '$root/usr/share/doc/beamroom/THIRD-PARTY.md'"
check "the compressed page" sh -c "ls '$root'/usr/share/beamroom/web/page/main-*.js.gz '$root'/usr/share/beamroom/web/page/main-*.js.br"
check "the unit names the installed program" grep -q '^ExecStart=/usr/bin/beamroomd ' "$root/usr/lib/systemd/system/beamroomd.service"
check "nothing is left to fill in" sh -c "! grep -rE '@[A-Z]+@' '$root/usr/lib' '$root/etc'"
every_key() { # the sample configuration and --help name the same settings
    diff <("$root/usr/bin/beamroomd" --help | sed -nE 's/^ +--([a-z-]+) .*/\1/p' | grep -vE '^(config|version|help|backup|verify-audit|audit-head|stub|recording-speed)$' | sort -u) \
        <(sed -nE 's/^(# )?([a-z-]+) = .*/\2/p' "$root/etc/beamroom/beamroomd.conf" | sort -u)
}
check "the sample configuration has every key" every_key
echo "# mine" >>"$root/etc/beamroom/beamroomd.conf"
check "a second install" "${MAKE:-make}" install DESTDIR="$root" PREFIX=/usr SYSCONFDIR=/etc
check "keeps a configuration that was changed" grep -q '^# mine$' "$root/etc/beamroom/beamroomd.conf"

# the sample configuration, with only its places moved here
data=$(mktemp -d)
chmod 755 "$data" # root's daemon becomes another user, who has to get there
sed -e "s|^plans = .*|plans = $PWD/build/demo/plans|; s|^data = .*|data = $data/state|; s|^listen = .*|listen = 127.0.0.1:0|" \
    -e "s|^web = /usr|web = $root/usr|" "$root/etc/beamroom/beamroomd.conf" >"$data/beamroomd.conf"
: >"$log"
"$root/usr/bin/beamroomd" --config "$data/beamroomd.conf" >"$log" 2>&1 </dev/null &
daemon=$!
for _ in $(seq 100); do
    grep -q '^ready ' "$log" && break
    kill -0 $daemon 2>/dev/null || break
    sleep 0.1
done
url=$(sed -n 's/^ready \(http:[^ ]*\).*/\1/p' "$log" | head -n 1)
check "the installed daemon serves with the sample configuration" test -n "$url"
whose() { # root's daemon is another user's by now, if that one can get here; another user's stays his
    local uid
    uid=$(sed -nE 's/^Uid:\s+([0-9]+).*/\1/p' "/proc/$daemon/status")
    if [ "$(id -u)" = 0 ] && ! grep -q 'staying root: user .* cannot reach' "$log"; then [ "$uid" != 0 ]; else [ "$uid" = "$(id -u)" ]; fi
}
check "the daemon is an ordinary user's" whose
smoke=0
if [ -n "$url" ]; then deploy/smoke.sh "$url" phantom || smoke=1; else cat "$log"; fi
kill -TERM $daemon 2>/dev/null
wait $daemon
check "the daemon stops cleanly on SIGTERM" test $? = 0
rm -rf "$data"

echo "install: $passed passed, $failed failed, 0 skipped"
[ "$failed" = 0 ] && [ "$smoke" = 0 ]
