/* RFC 6455 case by case against an echo server (ws_cases.h): sizes, pings, reserved bits, fragments, closing, large
 * messages. UTF-8: test_ws_conformance_utf8.c. */
#include "core/base/mem.h"
#include "tests/check.h"
#include "tests/unit/ws_cases.h"

/* ---- 1: sizes --------------------------------------------------------------------------------------------------- */

static void sizes(void **state)
{
    static const size_t sizes_[] = { 0, 125, 126, 127, 128, 65535, 65536, 65536 };
    const struct ws_case *number = *state;
    size_t n = sizes_[number->c - 1];
    unsigned kind = number->b == 1 ? TEXT : BINARY;
    uint8_t *payload = make_payload(n);
    ws_client_add(&client, kind, payload, n);
    ws_client_flush(&client, number->c == 8 ? 997 : 0);
    ws_client_expect(&client, kind, payload, n);
    ends_well();
    free(payload);
}

/* ---- 2: pings and pongs ----------------------------------------------------------------------------------------- */

static void ten_pings(size_t n_chop)
{
    char text[20];
    for (int i = 0; i < 10; i++) {
        (void)snprintf(text, sizeof text, "payload-%d", i);
        add_text(PING, text);
    }
    ws_client_flush(&client, n_chop);
    for (int i = 0; i < 10; i++) {
        (void)snprintf(text, sizeof text, "payload-%d", i);
        ws_client_expect(&client, PONG, text, strlen(text));
    }
    ends_well();
}

static void pings(void **state)
{
    static const uint8_t odd[] = { 0x00, 0xff, 0xfe, 0xfd, 0xfc, 0xfb, 0x00, 0xff };
    const struct ws_case *number = *state;
    uint8_t *large = make_payload(126);
    const void *payload = number->b == 3   ? (const void *)odd
                          : number->b >= 4 ? (const void *)large
                                           : (const void *)hello;
    size_t n = number->b == 1 ? 0 : number->b == 2 ? strlen(hello) : number->b == 3 ? sizeof odd : 125;
    switch (number->b) {
    case 5:
        ws_client_send(&client, PING, large, 126);
        ws_client_expect_end(&client, CODE_PROTOCOL);
        break;
    case 7: /* pongs that nobody asked for */
    case 8:
    case 9:
        ws_client_send(&client, PONG, hello, number->b == 7 ? 0 : strlen(hello));
        if (number->b == 9) {
            ws_client_send(&client, PING, hello, strlen(hello));
            ws_client_expect(&client, PONG, hello, strlen(hello));
        }
        ends_well();
        break;
    case 10: ten_pings(0); break;
    case 11: ten_pings(1); break;
    default:
        ws_client_add(&client, PING, payload, n);
        ws_client_flush(&client, number->b == 6);
        ws_client_expect(&client, PONG, payload, n);
        ends_well();
    }
    free(large);
}

/* ---- 3, 4: reserved bits and opcodes ---------------------------------------------------------------------------- */

/* The wrong frame alone, or between a text, which is echoed, and a ping, which is not answered. */
static void refuses_frame(unsigned first, size_t n_payload, bool is_between, size_t n_chop)
{
    if (is_between)
        add_text(TEXT, hello);
    ws_client_add(&client, first, hello, n_payload);
    if (is_between)
        add_text(PING, "");
    ws_client_flush(&client, n_chop);
    if (is_between)
        expect_text(hello);
    ws_client_expect_end(&client, CODE_PROTOCOL);
}

static void reserved_bits(void **state)
{
    static const struct {
        unsigned kind;
        size_t n, n_chop;
        bool is_between;
    } table[] = { { TEXT, 13, 0, false },   { TEXT, 13, 0, true },  { TEXT, 13, 8, true }, { TEXT, 13, 1, true },
                  { BINARY, 13, 0, false }, { PING, 13, 0, false }, { CLOSE, 0, 0, false } };
    const struct ws_case *number = *state;
    int i = number->b - 1;
    refuses_frame(table[i].kind | (unsigned)number->b << 4, table[i].n, table[i].is_between, table[i].n_chop);
}

static void reserved_opcodes(void **state)
{
    const struct ws_case *number = *state;
    unsigned opcode = FIN | ((number->b == 1 ? 2U : 10U) + (unsigned)number->c); /* 3 to 7, 11 to 15 */
    refuses_frame(opcode, number->c % 2 ? 0 : strlen(hello), number->c >= 3, number->c == 5 ? 1 : 0);
}

/* ---- 5: fragments ----------------------------------------------------------------------------------------------- */

enum chop { AT_ONCE, BY_FRAME, BY_OCTET };

/* One more frame; sent now, or with the others. */
static void piece(unsigned first, const char *text, enum chop chop)
{
    add_text(first, text);
    if (chop == BY_FRAME)
        ws_client_flush(&client, 0);
}

static void fragments(void **state)
{
    const struct ws_case *number = *state;
    int b = number->b;
    enum chop chop = b == 4 || b == 7 || b == 10 || b == 13 || b == 20 ? BY_FRAME
                     : b == 5 || b == 8 || b == 11 || b == 14          ? BY_OCTET
                                                                       : AT_ONCE;
    bool is_pinged = b >= 6 && b <= 8, is_stray = b >= 9 && b <= 14;
    if (b <= 2) {
        piece(b == 1 ? 9 : 10, "fragment1", chop);
        piece(CONTINUED, "fragment2", chop);
    } else if (b <= 8) {
        piece(1, "fragment1", chop);
        if (is_pinged)
            piece(PING, "ping payload", chop);
        piece(CONTINUED, "fragment2", chop);
    } else if (is_stray) {
        piece(b <= 11 ? CONTINUED : 0, "non-continuation payload", chop);
        piece(TEXT, hello, chop);
    } else if (b == 15) {
        piece(1, "fragment1", chop);
        piece(CONTINUED, "fragment2", chop);
        piece(CONTINUED, "fragment3", chop);
        piece(TEXT, hello, chop);
    } else if (b <= 17) {
        piece(b == 16 ? 0 : CONTINUED, "fragment1", chop);
        piece(1, "fragment2", chop);
        piece(CONTINUED, "fragment3", chop);
    } else if (b == 18) {
        piece(1, "fragment1", chop);
        piece(TEXT, "fragment2", chop);
    } else {
        piece(1, "fragment1", chop);
        piece(0, "fragment2", chop);
        piece(PING, "pongme 1!", chop);
        piece(0, "fragment3", chop);
        piece(0, "fragment4", chop);
        piece(PING, "pongme 2!", chop);
        piece(CONTINUED, "fragment5", chop);
    }
    ws_client_flush(&client, chop == BY_OCTET);
    if (is_pinged)
        ws_client_expect(&client, PONG, "ping payload", 12);
    if (b >= 19) {
        ws_client_expect(&client, PONG, "pongme 1!", 9);
        ws_client_expect(&client, PONG, "pongme 2!", 9);
        expect_text("fragment1fragment2fragment3fragment4fragment5");
    } else if ((b >= 3 && b <= 8) || b == 15) {
        expect_text("fragment1fragment2");
    }
    if ((b >= 3 && b <= 8) || b >= 19)
        ends_well();
    else
        ws_client_expect_end(&client, CODE_PROTOCOL);
}

/* ---- 7: closing ------------------------------------------------------------------------------------------------- */

static void close_and_more(void **state)
{
    const struct ws_case *number = *state;
    static const uint8_t normal[] = { 1000 >> 8, 1000 & 255 };
    uint8_t *large = make_payload(256 << 10);
    if (number->c == 1)
        add_text(TEXT, hello);
    if (number->c == 5)
        add_text(1, "fragment1");
    if (number->c == 6)
        ws_client_add(&client, TEXT, large, 256 << 10);
    ws_client_add(&client, CLOSE, normal, 2);
    if (number->c == 2)
        ws_client_add(&client, CLOSE, normal, 2);
    if (number->c == 3 || number->c == 6)
        add_text(PING, "");
    if (number->c == 4)
        add_text(TEXT, hello);
    if (number->c == 5)
        add_text(CONTINUED, "fragment2");
    ws_client_flush(&client, 0);
    if (number->c == 1)
        expect_text(hello);
    if (number->c == 6)
        ws_client_expect(&client, TEXT, large, 256 << 10);
    ws_client_expect_end(&client, 1000);
    free(large);
}

static void close_payloads(void **state)
{
    const struct ws_case *number = *state;
    uint8_t *reason = make_payload(124);
    reason[number->c == 5 ? 123 : 124] = 0;
    if (number->c <= 2)
        ws_client_send(&client, CLOSE, "a", number->c == 1 ? 0 : 1);
    else
        send_close(1000, number->c == 3 ? "" : number->c == 4 ? hello : (const char *)reason);
    ws_client_expect_end(&client, number->c == 1 ? 0 : number->c == 2 || number->c == 6 ? CODE_PROTOCOL : 1000);
    free(reason);
}

static void close_with_bad_reason(void **state)
{
    (void)state;
    send_close(1000, "\xce\xba\xe1\xbd\xb9\xcf\x83\xce\xbc\xce\xb5\xed\xa0\x80"
                     "edited");
    ws_client_expect_end(&client, CODE_NOT_UTF8);
}

static void close_codes(void **state)
{
    static const unsigned good[] = { 1000, 1001, 1002, 1003, 1007, 1008, 1009, 1010, 1011, 3000, 3999, 4000, 4999 };
    static const unsigned bad[] = { 0, 999, 1004, 1005, 1006, 1016, 1100, 2000, 2999 }, outside[] = { 5000, 65535 };
    const struct ws_case *number = *state;
    unsigned code = number->b == 7 ? good[number->c - 1] : number->b == 9 ? bad[number->c - 1] : outside[number->c - 1];
    send_close(code, number->b == 7 ? "good code" : "");
    ws_client_expect_end(&client, number->b == 7 ? code : CODE_PROTOCOL);
}

/* ---- 9, 10: large messages, many of them ------------------------------------------------------------------------ */

static void large_messages(void **state)
{
    const struct ws_case *number = *state;
    bool is_text = number->b % 2, is_fragmented = number->b == 3 || number->b == 4 || number->a == 10,
         is_chopped = number->b == 5 || number->b == 6;
    static const size_t sizes_[] = { 64 << 10, 256 << 10, 1 << 20, 4 << 20, 8 << 20, 16 << 20 };
    size_t n = number->a == 10 ? 65536 : is_fragmented ? 4 << 20 : is_chopped ? 1 << 20 : sizes_[number->c - 1];
    size_t n_fragment = number->a == 10 ? 1300
                        : is_fragmented ? (size_t)64 << 2 * (number->c - 1)
                                        : n; /* 64 bytes to 4 MiB */
    uint8_t *payload = make_payload(n);
    for (size_t at = 0; at < n; at += n_fragment) {
        size_t n_now = n - at < n_fragment ? n - at : n_fragment;
        ws_client_add(&client, (at == 0 ? is_text ? 1U : 2U : 0U) | (at + n_now == n ? FIN : 0U), payload + at, n_now);
    }
    ws_client_flush(&client, is_chopped ? (size_t)64 << (number->c - 1) : 0);
    ws_client_expect(&client, is_text ? TEXT : BINARY, payload, n);
    ends_well();
    free(payload);
}

static void thousand_messages(void **state)
{
    const struct ws_case *number = *state;
    static const size_t sizes_[] = { 0, 16, 64, 256, 1024, 4096 };
    size_t n = sizes_[number->c - 1];
    unsigned kind = number->b % 2 ? TEXT : BINARY;
    uint8_t *payload = make_payload(n);
    for (int i = 0; i < 1000; i++) {
        ws_client_send(&client, kind, payload, n);
        ws_client_expect(&client, kind, payload, n);
    }
    ends_well();
    free(payload);
}

int main(void)
{
    static const struct ws_group groups[] = {
        { 1, 1, 8, sizes },
        { 1, 2, 8, sizes },
        { 2, 0, 11, pings },
        { 3, 0, 7, reserved_bits },
        { 4, 1, 5, reserved_opcodes },
        { 4, 2, 5, reserved_opcodes },
        { 5, 0, 20, fragments },
        { 7, 1, 6, close_and_more },
        { 7, 3, 6, close_payloads },
        { 7, 5, 1, close_with_bad_reason },
        { 7, 7, 13, close_codes },
        { 7, 9, 9, close_codes },
        { 7, 13, 2, close_codes },
        { 9, 1, 6, large_messages },
        { 9, 2, 6, large_messages },
        { 9, 3, 9, large_messages },
        { 9, 4, 9, large_messages },
        { 9, 5, 6, large_messages },
        { 9, 6, 6, large_messages },
        { 9, 7, 6, thousand_messages },
        { 9, 8, 6, thousand_messages },
        { 10, 1, 1, large_messages },
    };
    return ws_cases_run(groups, sizeof groups / sizeof groups[0], 156);
}
