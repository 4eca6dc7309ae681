/* Bytes from a WebSocket client. Parsed in one piece and byte by byte they must give the same events; messages stay
 * within their limits, texts are UTF-8 by an independent check, and no event follows the end. */
#include "server/ws/parser.h"
#include "tests/fuzz/fuzz.h"

enum { LIMIT = 300, MOST_EVENTS = 4096 };

struct event_digest { /* an event and a digest of its bytes */
    enum ws_event_type type;
    size_t n;
    unsigned code, sum;
};

/* UTF-8 check by RFC 3629, by decoding: shortest form, no surrogates, at most U+10FFFF. */
static bool is_utf8(const uint8_t *bytes, size_t n)
{
    for (size_t i = 0; i < n;) {
        size_t more = bytes[i] < 0x80       ? 0
                      : bytes[i] >> 5 == 6  ? 1
                      : bytes[i] >> 4 == 14 ? 2
                      : bytes[i] >> 3 == 30 ? 3
                                            : 9;
        if (more == 9 || n - i <= more)
            return false;
        uint32_t code = more ? bytes[i] & (0x3fU >> more) : bytes[i];
        for (size_t k = 1; k <= more; k++) {
            if (bytes[i + k] >> 6 != 2)
                return false;
            code = code << 6 | (bytes[i + k] & 63);
        }
        static const uint32_t least[] = { 0, 0x80, 0x800, 0x10000 };
        if (code < least[more] || (code >= 0xd800 && code < 0xe000) || code > 0x10ffff)
            return false;
        i += 1 + more;
    }
    return true;
}

static void check(const struct ws_event *event)
{
    switch (event->type) {
    case WS_EVENT_NONE: break;
    case WS_EVENT_MESSAGE:
        REQUIRE(event->n <= LIMIT && event->bytes);
        REQUIRE(event->kind == WS_BINARY || (event->kind == WS_TEXT && is_utf8(event->bytes, event->n)));
        break;
    case WS_EVENT_PING:
    case WS_EVENT_PONG: REQUIRE(event->n <= WS_MAX_CONTROL); break;
    case WS_EVENT_CLOSE:
        REQUIRE(event->code >= 1000 && event->code <= 4999 && event->code != 1006 && event->code != 1015);
        break;
    case WS_EVENT_BROKEN:
        REQUIRE(event->reason && strlen(event->reason) <= WS_MAX_REASON);
        REQUIRE(event->code == WS_CLOSE_PROTOCOL || event->code == WS_CLOSE_NOT_UTF8 ||
                event->code == WS_CLOSE_TOO_LARGE);
        break;
    }
}

static size_t read_all(const uint8_t *data, size_t n, size_t n_piece, struct event_digest events[MOST_EVENTS])
{
    struct ws_parser parser;
    struct ws_event event;
    size_t n_events = 0;
    bool has_ended = false;
    ws_parser_init(&parser, LIMIT, true);
    for (size_t at = 0; at < n;) {
        size_t n_now = n - at < n_piece ? n - at : n_piece, n_taken = ws_parser_take(&parser, data + at, n_now, &event);
        REQUIRE(n_taken <= n_now && (n_taken == n_now || event.type != WS_EVENT_NONE));
        REQUIRE(n_taken > 0 && parser.n_allocated <= 512);
        at += n_taken;
        check(&event);
        if (event.type == WS_EVENT_NONE)
            continue;
        REQUIRE(!has_ended);
        has_ended = event.type == WS_EVENT_CLOSE || event.type == WS_EVENT_BROKEN;
        struct event_digest one = { event.type, event.n, event.code, 0 };
        for (size_t i = 0; i < event.n; i++)
            one.sum = one.sum * 31 + event.bytes[i];
        if (n_events < MOST_EVENTS)
            events[n_events++] = one;
    }
    ws_parser_finish(&parser);
    return n_events;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    static struct event_digest whole[MOST_EVENTS], parts[MOST_EVENTS];
    size_t n_whole = read_all(data, n, n, whole), n_parts = read_all(data, n, 1, parts);
    REQUIRE(n_whole == n_parts);
    for (size_t i = 0; i < n_whole; i++)
        REQUIRE(whole[i].type == parts[i].type && whole[i].n == parts[i].n && whole[i].code == parts[i].code &&
                whole[i].sum == parts[i].sum);
    return 0;
}
