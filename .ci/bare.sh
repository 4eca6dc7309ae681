#!/bin/bash
# A bare Debian 12 in a folder: nothing but what Debian calls minimal, git and make.
#   .ci/bare.sh make FOLDER                 makes it, with the package sources, certificates and npm settings of this machine
#   .ci/bare.sh enter FOLDER COMMAND...     runs a command in it, as root, in namespaces of its own: what the command leaves running ends with it
# Needs root; both say why they fail.
# Debian 12 alone is taken from the machine's package sources, so that no other
# packages of it (another node, another compiler) get in.
set -u

# Stanzas of the machine's sources that are Debian's own: address and folder of each "deb" of the suite bookworm*.
bare_sources() {
    cat /etc/apt/sources.list /etc/apt/sources.list.d/*.list 2>/dev/null | sed -nE 's/^deb +(\[[^]]*\] +)?([^ ]+) +(bookworm[^ ]*) +.*/\2 \3/p'
    awk 'function flush() { if (types ~ /deb( |$)/) { n = split(suites, s, " "); m = split(uris, u, " ")
             for (i = 1; i <= n; i++) for (j = 1; j <= m; j++) if (s[i] ~ /^bookworm/) print u[j], s[i] } types = suites = uris = "" }
         /^$/ { flush() } /^Types:/ { $1 = ""; types = $0 } /^URIs:/ { $1 = ""; uris = $0 } /^Suites:/ { $1 = ""; suites = $0 }
         END { flush() }' RS='\n' /etc/apt/sources.list.d/*.sources 2>/dev/null
}

make_bare() { # make_bare FOLDER
    local root=$1 mirror file
    chmod 755 "$root" # the daemon does not stay root
    [ "$(id -u)" = 0 ] || { echo "a bare Debian needs root" >&2; return 1; }
    deploy/packages ci || return 1
    mirror=$(bare_sources | awk '$2 == "bookworm" { print $1; exit }')
    [ -n "$mirror" ] || { echo "this machine has no package source of Debian 12" >&2; return 1; }
    debootstrap --variant=minbase --include=git,make,ca-certificates bookworm "$root" "$mirror" >"$root.log" 2>&1 ||
        { tail -n 20 "$root.log" >&2; return 1; }
    bare_sources | awk '{ print "deb", $1, $2, "main" }' >"$root/etc/apt/sources.list"
    for file in /etc/apt/apt.conf.d/*; do # proxies and the like; not what belongs to packages of this machine
        ! grep -qE '^[^/#]*(Acquire|Proxy)' "$file" || cp "$file" "$root/etc/apt/apt.conf.d/"
    done
    for file in /etc/resolv.conf /etc/hosts /usr/etc/npmrc "$HOME/.npmrc"; do
        [ ! -e "$file" ] || install -D -m 644 "$(readlink -f "$file")" "$root$file"
    done
    # nodedir is where this machine's own node stands
    [ ! -e "$root$HOME/.npmrc" ] || sed -i '/^nodedir/d' "$root$HOME/.npmrc"
    if compgen -G '/usr/local/share/ca-certificates/*.crt' >/dev/null; then
        cp /usr/local/share/ca-certificates/*.crt "$root/usr/local/share/ca-certificates/"
        chroot "$root" update-ca-certificates >>"$root.log" 2>&1 || return 1
    fi
    chroot "$root" apt-get -q update >>"$root.log" 2>&1 || { tail -n 20 "$root.log" >&2; return 1; }
}

enter_bare() { # enter_bare FOLDER COMMAND...
    local root=$1
    shift
    # shellcheck disable=SC2016  # expanded inside
    exec unshare --mount --pid --fork --kill-child --propagation private bash -c '
        root=$1
        shift
        for folder in /proc /sys /dev /dev/pts /dev/shm; do
            mkdir -p "$root$folder"
            case $folder in
            /proc) mount -t proc proc "$root/proc" ;;
            *) mount --bind "$folder" "$root$folder" ;;
            esac || exit 1
        done
        exec chroot "$root" /usr/bin/env -i HOME="$HOME" PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 CI=true "$@"
    ' bash "$root" "$@"
}

case ${1:-} in
make) make_bare "$2" ;;
enter) shift && enter_bare "$@" ;;
*) echo "usage: .ci/bare.sh make FOLDER | enter FOLDER COMMAND..." >&2; exit 2 ;;
esac
