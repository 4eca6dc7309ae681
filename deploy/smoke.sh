#!/bin/bash
# Does an installed Beamroom work? deploy/smoke.sh [http[s]://HOST:PORT [PLAN]]   (http://127.0.0.1:8080, first readable plan)
# Asks a running daemon what a browser and a script would: alive, ready, page, plans, open, a picture, a WebSocket.
# Needs nothing but bash, and for https:// the command of OpenSSL; it looks at no certificate.
# Ends with "smoke: N passed, N failed, N skipped".
set -u
url=${1:-http://127.0.0.1:8080}
plan=${2:-}
scheme=${url%%://*}
address=${url#*://}
address=${address%%/*}
host=${address%:*} port=${address##*:}
[ "$port" != "$address" ] || { [ "$scheme" = https ] && port=443 || port=80; }
answer=$(mktemp)
trap 'rm -f "$answer"' EXIT
passed=0 failed=0

request() { # request [HEADER...]: of $method, $path, $body
    printf '%s %s HTTP/1.1\r\nHost: %s\r\n' "$method" "$path" "$address"
    [ $# -gt 0 ] && printf '%s\r\n' "$@"
    [[ "$*" == *Upgrade* ]] || printf 'Connection: close\r\n'
    [ "$method" = GET ] || printf 'Content-Type: application/json\r\nContent-Length: %d\r\n' "${#body}"
    printf '\r\n%s' "$body"
}
# call METHOD PATH [BODY [HEADER...]]: status in $status, whole answer in the file $answer
call() {
    local method=$1 path=$2 body=${3:-}
    shift $(($# < 3 ? $# : 3))
    status=0
    : >"$answer"
    if [ "$scheme" = https ]; then
        request "$@" | timeout "${CALL_SECONDS:-30}" openssl s_client -quiet -connect "$host:$port" >"$answer" 2>/dev/null
    else
        exec 3<>"/dev/tcp/$host/$port" || return 1
        request "$@" >&3
        timeout "${CALL_SECONDS:-30}" cat <&3 >"$answer" 2>/dev/null
        exec 3<&- 3>&-
    fi
    status=$(head -n 1 "$answer" | tr -d '\0' | sed -nE 's|^HTTP/1\.[01] ([0-9]{3}).*|\1|p')
}
says() { grep -qaE "$1" "$answer"; }
field() { tr -d '\r\n' <"$answer" | grep -aoE "\"$1\": *\"[^\"]*\"" | head -n 1 | sed -E 's/.*: *"(.*)"$/\1/'; }
check() { # check SENTENCE COMMAND...
    local sentence=$1
    shift
    if "$@"; then
        passed=$((passed + 1))
        echo "  ok      $sentence"
    else
        failed=$((failed + 1))
        echo "  FAILED  $sentence (status ${status:-none}): $(tail -n 1 "$answer" | tr -d '\0' | cut -c 1-300)"
    fi
}
is() { [ "${status:-}" = "$1" ] && { [ $# = 1 ] || says "$2"; }; }

first_readable_plan() { # the first of /api/v1/plans whose state is not "unreadable"
    tr -d '\r\n' <"$answer" | grep -aoE '\{[^{}]*"id": *"[^"]*"[^{}]*' | grep -avE '"state": *"unreadable"' | head -n 1 |
        sed -E 's/.*"id": *"([^"]*)".*/\1/'
}
loaded() { # waits for a job: loaded JOB
    local state
    for _ in $(seq 120); do
        call GET "/api/v1/jobs/$1"
        state=$(field state)
        case $state in
        done) return 0 ;;
        failed | cancelled) return 1 ;;
        esac
        sleep 0.5
    done
    return 1
}

if ! (exec 3<>"/dev/tcp/$host/$port") 2>/dev/null; then
    echo "  FAILED  nobody answers at $url"
    echo "smoke: 0 passed, 1 failed, 0 skipped"
    exit 1
fi
call GET /healthz
check "alive" is 200
for _ in $(seq 40); do # a daemon that has just started is still looking for a way to draw
    call GET /readyz
    [ "$status" = 503 ] || break
    sleep 0.25
done
check "able to render" is 200
call GET /api/v1/version
check "says its version and how it renders" is 200 '"version"'
call GET /api/v1/openapi.json
check "describes its API" is 200 '"openapi"'
call GET /metrics
check "has metrics" is 200 '^# TYPE '
call GET /
check "serves the page" is 200 '<!doctype html|<!DOCTYPE html'
call GET / '' 'Accept-Encoding: gzip'
check "serves the page compressed" is 200 '^Content-Encoding: gzip'
call GET /api/v1/no-such-thing
check "an unknown path is a problem with a sentence" is 404 'application/problem\+json'
call GET /api/v1/plans
check "lists plans" is 200 '"plans"'
[ -n "$plan" ] || plan=$(first_readable_plan)
call POST "/api/v1/plans/$plan/open" '{}'
check "opens the plan '$plan'" is 202
job=$(field id)
check "the plan loads" loaded "$job"
call POST "/api/v1/plans/$plan/render" '{"scene":{},"view":{"kind":"3d","size_px":[320,240]},"format":"jpeg"}'
check "renders a picture" is 200 $'Content-Type: image/jpeg'
check "the picture is a JPEG" says $'\xff\xd8\xff'
call POST /api/v1/rooms "{\"plan\":\"$plan\"}"
check "opens a room" is 201
room=$(field id)
CALL_SECONDS=2 call GET "/api/v1/rooms/$room/ws" '' 'Connection: Upgrade' 'Upgrade: websocket' 'Sec-WebSocket-Version: 13' \
    'Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ=='
# RFC 6455 1.3 gives the accept value of this key
check "speaks WebSocket" is 101 's3pPLMBiTxaQ9kYGzzhZRbK\+xOo='
call DELETE "/api/v1/rooms/$room"
check "closes the room" is 204

echo "smoke: $passed passed, $failed failed, 0 skipped"
[ "$failed" = 0 ]
