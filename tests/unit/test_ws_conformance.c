/* RFC 6455 case by case against an echo server: the 301 cases without compression of the Autobahn Testsuite 25.10.1, by
 * their numbers. What a case sends and expects was written from its published description and from the RFC. Where the
 * RFC leaves a choice, the test asks for the strict one: text that is not UTF-8 is refused as soon as a byte shows it,
 * every ping is answered in order. */
#include "core/base/clock.h"
#include "core/base/mem.h"
#include "tests/check.h"
#include "tests/unit/ws_client.h"

enum { N_CASES = 301, LARGEST = 16 << 20, CODE_PROTOCOL = 1002, CODE_NOT_UTF8 = 1007 };

static struct ws *ws;
static struct ws_client client;

/* ---- the echo server -------------------------------------------------------------------------------------------- */

static bool has_room(void *context, const char *room_id)
{
    (void)context;
    return strcmp(room_id, "7q4k-m2wz") == 0;
}

static void opened(void *context, struct ws_connection *connection, const char *room_id)
{
    (void)context;
    (void)connection;
    (void)room_id;
}

static void echo(void *context, struct ws_connection *connection, enum ws_opcode kind, const char *bytes, size_t n)
{
    (void)context;
    ws_send_message(connection, kind, bytes, n);
}

static bool is_greeted(void *context, struct ws_connection *connection)
{
    (void)context;
    (void)connection;
    return true;
}

static void closed(void *context, struct ws_connection *connection)
{
    (void)context;
    (void)connection;
}

static void nothing(void *context)
{
    (void)context;
}

static int start(void **state)
{
    const struct ws_callbacks callbacks = { has_room, opened, echo, is_greeted, closed, nothing, nothing, NULL };
    struct ws_limits limits = ws_limits_default; /* but for the sizes and numbers of group 9 */
    (void)state;
    limits.takes_binary = true;
    limits.max_message_bytes = limits.max_waiting_bytes = LARGEST;
    limits.bytes = (struct rate_limit){ .per_s = INT64_C(1) << 30, .burst = INT64_C(1) << 30 };
    ws = ws_create(&callbacks, &limits, NULL, NULL);
    assert_non_null(ws);
    ws_client_open(&client, ws);
    return 0;
}

static int end(void **state)
{
    (void)state;
    ws_client_finish(&client);
    ws_destroy(ws);
    return 0;
}

/* ---- what cases are made of ------------------------------------------------------------------------------------- */

static const char hello[] = "Hello, world!";

static void send_close(unsigned code, const char *reason)
{
    uint8_t bytes[200] = { (uint8_t)(code >> 8), (uint8_t)code };
    size_t n = strlen(reason);
    memcpy(bytes + 2, reason, n);
    ws_client_send(&client, CLOSE, bytes, 2 + n);
}

/* The connection still works as it should: it is closed with 1000, and nothing else comes. */
static void ends_well(void)
{
    send_close(1000, "");
    ws_client_expect_end(&client, 1000);
}

static void add_text(unsigned first, const char *text)
{
    ws_client_add(&client, first, text, strlen(text));
}

static void expect_text(const char *text)
{
    ws_client_expect(&client, TEXT, text, strlen(text));
}

/* n bytes; a text is of printable ASCII */
static uint8_t *make_payload(size_t n)
{
    uint8_t *bytes = mem_new(n + 1);
    for (size_t i = 0; i < n; i++)
        bytes[i] = (uint8_t)('!' + i * 31 % 94);
    return bytes;
}

struct number { /* of a case: its group and place, and what a table of its group says */
    char name[24];
    int a, b, c;
};

/* ---- 1: sizes --------------------------------------------------------------------------------------------------- */

static void sizes(void **state)
{
    static const size_t sizes_[] = { 0, 125, 126, 127, 128, 65535, 65536, 65536 };
    const struct number *number = *state;
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
    const struct number *number = *state;
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
    const struct number *number = *state;
    int i = number->b - 1;
    refuses_frame(table[i].kind | (unsigned)number->b << 4, table[i].n, table[i].is_between, table[i].n_chop);
}

static void reserved_opcodes(void **state)
{
    const struct number *number = *state;
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
    const struct number *number = *state;
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

/* ---- 6: UTF-8 --------------------------------------------------------------------------------------------------- */

/* Groups 6.5 to 6.23, each of single texts in order; "-" in front: not UTF-8. Hexadecimal; 6.12.8, 6.13 and 6.22 are
 * made below. */
static const struct {
    int group;
    const char *texts;
} utf8_table[] = {
    { 5,
      "68656c6c6f24776f726c64 68656c6c6fc2a2776f726c64 68656c6c6fe282ac776f726c64 68656c6c6ff0a4ada2776f726c64 cebae1bdb9cf83cebcceb5" },
    { 6,
      "-ce ceba -cebae1 -cebae1bd cebae1bdb9 -cebae1bdb9cf cebae1bdb9cf83 -cebae1bdb9cf83ce cebae1bdb9cf83cebc -cebae1bdb9cf83cebcce cebae1bdb9cf83cebcceb5" },
    { 7, "00 c280 e0a080 f0908080" },
    { 8, "-f888808080 -fc8480808080" },
    { 9, "7f dfbf efbfbf f48fbfbf" },
    { 10, "-f7bfbfbf -fbbfbfbfbf -fdbfbfbfbfbf" },
    { 11, "ed9fbf ee8080 efbfbd f48fbfbf -f4908080" },
    { 12, "-80 -bf -80bf -80bf80 -80bf80bf -80bf80bf80 -80bf80bf80bf -*" },
    { 13, "-* -* -* -* -*" },
    { 14, "-c0 -e080 -f08080 -f8808080 -fc80808080 -df -efbf -f7bfbf -fbbfbfbf -fdbfbfbfbf" },
    { 15, "-c0e080f08080f8808080fc80808080dfefbff7bfbffbbfbfbffdbfbfbfbf" },
    { 16, "-fe -ff -fefeffff" },
    { 17, "-c0af -e080af -f08080af -f8808080af -fc80808080af" },
    { 18, "-c1bf -e09fbf -f08fbfbf -f887bfbfbf -fc83bfbfbfbf" },
    { 19, "-c080 -e08080 -f0808080 -f880808080 -fc8080808080" },
    { 20, "-eda080 -edadbf -edae80 -edafbf -edb080 -edbe80 -edbfbf" },
    { 21,
      "-eda080edb080 -eda080edbfbf -edadbfedb080 -edadbfedbfbf -edae80edb080 -edae80edbfbf -edafbfedb080 -edafbfedbfbf" },
    { 22, "* * * * * * * * * * * * * * * * * * * * * * * * * * * * * * * * * *" },
    { 23, "efbfb9 efbfba efbfbb efbfbc efbfbd efbfbe efbfbf" },
};

static size_t from_hexadecimal(const char *digits, uint8_t bytes[200])
{
    size_t n = 0;
    for (unsigned value; sscanf(digits + 2 * n, "%2x", &value) == 1 && digits[2 * n] > ' '; n++)
        bytes[n] = (uint8_t)value;
    return n;
}

/* Texts that a line of the table is too short for. */
static size_t make_text(int group, int c, uint8_t bytes[200])
{
    static const unsigned first[] = { 0xc0, 0xe0, 0xf0, 0xf8, 0xfc, 0xfe };
    size_t n = 0;
    if (group == 12) { /* all 64 continuation bytes */
        for (unsigned byte = 0x80; byte <= 0xbf; byte++)
            bytes[n++] = (uint8_t)byte;
    } else if (group == 13) { /* all first bytes of sequences of 2, 3 ... 6 bytes, each before a blank */
        for (unsigned byte = first[c - 1]; byte < first[c]; byte++) {
            bytes[n++] = (uint8_t)byte;
            bytes[n++] = ' ';
        }
    } else { /* the last two code points of each plane, which are no characters but may be sent */
        unsigned code = (unsigned)(c - 1) / 2 << 16 | 0xfffe | (unsigned)(c - 1) % 2;
        if (code > 0xffff) {
            bytes[n++] = (uint8_t)(0xf0 | code >> 18);
            bytes[n++] = (uint8_t)(0x80 | (code >> 12 & 63));
        } else {
            bytes[n++] = (uint8_t)(0xe0 | code >> 12);
        }
        bytes[n++] = (uint8_t)(0x80 | (code >> 6 & 63));
        bytes[n++] = (uint8_t)(0x80 | (code & 63));
    }
    return n;
}

static void utf8_texts(void **state)
{
    const struct number *number = *state;
    const char *text = utf8_table[number->b - 5].texts;
    uint8_t bytes[200];
    for (int i = 1; i < number->c; i++)
        text = strchr(text, ' ') + 1;
    bool is_wrong = *text == '-';
    text += is_wrong;
    size_t n = *text == '*' ? make_text(number->b, number->c, bytes) : from_hexadecimal(text, bytes);
    assert_true(n > 0);
    ws_client_send(&client, TEXT, bytes, n);
    if (is_wrong) {
        ws_client_expect_end(&client, CODE_NOT_UTF8);
    } else {
        ws_client_expect(&client, TEXT, bytes, n);
        ends_well();
    }
}

static void send_by_octet_fragments(const uint8_t *bytes, size_t n)
{
    for (size_t i = 0; i < n; i++)
        ws_client_add(&client, (i == 0 ? 1U : 0U) | (i + 1 == n ? FIN : 0U), bytes + i, 1);
    ws_client_flush(&client, 0);
}

static void utf8_fragments(void **state)
{
    static const char valid[] = "Hello-\xc2\xb5@\xc3\x9f\xc3\xb6\xc3\xa4\xc3\xbc\xc3\xa0\xc3\xa1-UTF-8!!",
                      greek[] = "\xce\xba\xe1\xbd\xb9\xcf\x83\xce\xbc\xce\xb5";
    static const char wrong[] = "\xce\xba\xe1\xbd\xb9\xcf\x83\xce\xbc\xce\xb5\xed\xa0\x80"
                                "edited";
    const struct number *number = *state;
    const char *text = number->b == 2 && number->c == 4 ? greek : valid;
    if (number->b == 1) {
        text = number->c == 3 ? "middle frame payload" : "";
        add_text(number->c == 1 ? TEXT : 1, "");
        if (number->c > 1) {
            add_text(0, text);
            add_text(CONTINUED, "");
        }
        ws_client_flush(&client, 0);
    } else if (number->b == 2 && number->c == 1) {
        ws_client_send(&client, TEXT, valid, strlen(valid));
    } else if (number->b == 2 && number->c == 2) { /* between two characters */
        ws_client_add(&client, 1, valid, 12);
        ws_client_send(&client, CONTINUED, valid + 12, strlen(valid) - 12);
    } else if (number->b == 2) {
        send_by_octet_fragments((const uint8_t *)text, strlen(text));
    } else {
        if (number->c == 1)
            ws_client_send(&client, TEXT, wrong, strlen(wrong));
        else
            send_by_octet_fragments((const uint8_t *)wrong, strlen(wrong));
        ws_client_expect_end(&client, CODE_NOT_UTF8);
        return;
    }
    expect_text(text);
    ends_well();
}

/* Refused at the byte that shows it, although the message, and in .3 and .4 the frame, is not whole. */
static void utf8_at_once(void **state)
{
    static const char text[] = "\xce\xba\xe1\xbd\xb9\xcf\x83\xce\xbc\xce\xb5\xf4\x90\x80\x80"
                               "edited";
    const struct number *number = *state;
    size_t n_first = number->c % 2 ? 11 : 12, n_until = 13; /* after f4 only 80 to 8f may come */
    struct ws_answer answer;
    if (number->c <= 2) {
        ws_client_send(&client, 1, text, n_first);
        ws_client_add(&client, 0, text + n_first, number->c == 1 ? 4 : 1);
        ws_client_flush(&client, 0);
    } else {
        ws_client_add(&client, TEXT, text, strlen(text));
        size_t n_head = client.n_out - strlen(text);
        client.n_out = n_head + n_first;
        ws_client_flush(&client, 0);
        ws_client_serve(&client);
        assert_int_equal(client.n_in, 0);
        assert_false(client.has_ended);
        ws_client_add(&client, TEXT, text, strlen(text));
        memmove(client.out, client.out + n_head + n_first, client.n_out - n_head - n_first);
        client.n_out = n_until - n_first;
        ws_client_flush(&client, 0);
    }
    ws_client_expect_end(&client, CODE_NOT_UTF8);
    assert_false(ws_client_next(&client, &answer));
}

/* ---- 7: closing ------------------------------------------------------------------------------------------------- */

static void close_and_more(void **state)
{
    const struct number *number = *state;
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
    const struct number *number = *state;
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
    const struct number *number = *state;
    unsigned code = number->b == 7 ? good[number->c - 1] : number->b == 9 ? bad[number->c - 1] : outside[number->c - 1];
    send_close(code, number->b == 7 ? "good code" : "");
    ws_client_expect_end(&client, number->b == 7 ? code : CODE_PROTOCOL);
}

/* ---- 9, 10: large messages, many of them ------------------------------------------------------------------------ */

static void large_messages(void **state)
{
    const struct number *number = *state;
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
    const struct number *number = *state;
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

/* ---- the list --------------------------------------------------------------------------------------------------- */

int main(void)
{
    static struct CMUnitTest tests[N_CASES];
    static struct number numbers[N_CASES];
    const struct {
        int a, b, n; /* cases a.b.1 to a.b.n; b 0: a.1 to a.n */
        void (*run)(void **state);
    } groups[] = {
        { 1, 1, 8, sizes },
        { 1, 2, 8, sizes },
        { 2, 0, 11, pings },
        { 3, 0, 7, reserved_bits },
        { 4, 1, 5, reserved_opcodes },
        { 4, 2, 5, reserved_opcodes },
        { 5, 0, 20, fragments },
        { 6, 1, 3, utf8_fragments },
        { 6, 2, 4, utf8_fragments },
        { 6, 3, 2, utf8_fragments },
        { 6, 4, 4, utf8_at_once },
        { 6, 5, 5, utf8_texts },
        { 6, 6, 11, utf8_texts },
        { 6, 7, 4, utf8_texts },
        { 6, 8, 2, utf8_texts },
        { 6, 9, 4, utf8_texts },
        { 6, 10, 3, utf8_texts },
        { 6, 11, 5, utf8_texts },
        { 6, 12, 8, utf8_texts },
        { 6, 13, 5, utf8_texts },
        { 6, 14, 10, utf8_texts },
        { 6, 15, 1, utf8_texts },
        { 6, 16, 3, utf8_texts },
        { 6, 17, 5, utf8_texts },
        { 6, 18, 5, utf8_texts },
        { 6, 19, 5, utf8_texts },
        { 6, 20, 7, utf8_texts },
        { 6, 21, 8, utf8_texts },
        { 6, 22, 34, utf8_texts },
        { 6, 23, 7, utf8_texts },
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
    size_t n = 0;
    for (size_t g = 0; g < sizeof groups / sizeof groups[0]; g++)
        for (int i = 1; i <= groups[g].n && n < N_CASES; i++, n++) {
            struct number *number = &numbers[n];
            *number = (struct number){ .a = groups[g].a, .b = groups[g].b ? groups[g].b : i, .c = groups[g].b ? i : 0 };
            (void)snprintf(number->name, sizeof number->name, number->c ? "case_%d.%d.%d" : "case_%d.%d", number->a,
                           number->b, number->c);
            tests[n] = (struct CMUnitTest){ number->name, groups[g].run, start, end, number };
        }
    if (n != N_CASES)
        return 1;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
