/* Bytes of a client to messages. What RFC 6455 says beyond the cases of ws_cases.h: masks, lengths, memory.
 */
#include "core/base/mem.h"
#include "server/ws/parser.h"
#include "tests/check.h"

/* The masked "Hello" of RFC 6455 5.7 */
static const uint8_t hello[] = { 0x81, 0x85, 0x37, 0xfa, 0x21, 0x3d, 0x7f, 0x9f, 0x4d, 0x51, 0x58 };

static struct ws_event read_all(struct ws_parser *parser, const uint8_t *bytes, size_t n)
{
    struct ws_event event;
    size_t n_taken = ws_parser_take(parser, bytes, n, &event);
    assert_true(n_taken <= n);
    return event;
}

/* The event that these bytes alone give. */
static struct ws_event read_one(const uint8_t *bytes, size_t n)
{
    struct ws_parser parser;
    ws_parser_init(&parser, 65536, true);
    struct ws_event event = read_all(&parser, bytes, n);
    ws_parser_finish(&parser);
    return event;
}

static void assert_breaks(const uint8_t *bytes, size_t n, unsigned code, const char *words)
{
    struct ws_event event = read_one(bytes, n);
    assert_int_equal(event.type, WS_EVENT_BROKEN);
    assert_int_equal(event.code, code);
    assert_non_null(strstr(event.reason, words));
    assert_true(strlen(event.reason) <= WS_MAX_REASON);
    assert_int_equal(read_one(bytes, n - 1).type, WS_EVENT_NONE); /* the last byte is the one that shows it */
}

static void the_masked_hello_of_the_rfc_is_read(void **state)
{
    struct ws_parser parser;
    (void)state;
    ws_parser_init(&parser, 65536, false);
    for (size_t n_first = 0; n_first < sizeof hello; n_first++) { /* parted at each byte */
        assert_int_equal(read_all(&parser, hello, n_first).type, WS_EVENT_NONE);
        struct ws_event event = read_all(&parser, hello + n_first, sizeof hello - n_first);
        assert_int_equal(event.type, WS_EVENT_MESSAGE);
        assert_int_equal(event.kind, WS_TEXT);
        assert_int_equal(event.n, 5);
        assert_memory_equal(event.bytes, "Hello", 5);
    }
    ws_parser_finish(&parser);
}

static void what_is_not_masked_breaks_it(void **state)
{
    (void)state;
    assert_breaks((const uint8_t[]){ 0x81, 0x05 }, 2, 1002, "not masked");
    assert_breaks((const uint8_t[]){ 0x89, 0x00 }, 2, 1002, "not masked");
    assert_breaks((const uint8_t[]){ 0x88, 0x02 }, 2, 1002, "not masked");
}

static void a_length_in_more_bytes_than_it_needs_breaks_it(void **state)
{
    (void)state;
    assert_breaks((const uint8_t[]){ 0x81, 0xfe, 0, 125 }, 4, 1002, "more bytes than it needs");
    assert_breaks((const uint8_t[]){ 0x81, 0xff, 0, 0, 0, 0, 0, 0, 0xff, 0xff }, 10, 1002, "more bytes than it needs");
    assert_breaks((const uint8_t[]){ 0x81, 0xff, 0x80, 0, 0, 0, 0, 0, 0, 0 }, 10, 1002, "2^63");
    assert_int_equal(read_one((const uint8_t[]){ 0x81, 0xfe, 0, 126 }, 4).type, WS_EVENT_NONE);
    assert_int_equal(read_one((const uint8_t[]){ 0x81, 0xff, 0, 0, 0, 0, 0, 1, 0, 0 }, 10).type, WS_EVENT_NONE);
}

static void a_message_that_is_too_large_breaks_it_before_it_comes(void **state)
{
    (void)state;
    assert_breaks((const uint8_t[]){ 0x81, 0xff, 0, 0, 0, 0, 0, 1, 0, 1 }, 10, 1009, "too large");
    assert_breaks((const uint8_t[]){ 0x81, 0xff, 0x7f, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff }, 10, 1009,
                  "too large");
    /* 5 bytes, then a fragment of 65532: together one more than 65536 */
    static const uint8_t fragments[] = { 0x01, 0x85, 0, 0, 0, 0, 'a', 'b', 'c', 'd', 'e', 0x80, 0xfe, 0xff, 0xfc };
    assert_breaks(fragments, sizeof fragments, 1009, "too large");
}

static void memory_grows_with_what_has_come_and_is_given_back(void **state)
{
    static const uint8_t announced[] = { 0x81, 0xff, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 'x' };
    struct ws_parser parser;
    struct ws_event event;
    (void)state;
    ws_parser_init(&parser, 65536, false);
    assert_int_equal(read_all(&parser, announced, sizeof announced).type, WS_EVENT_NONE);
    assert_true(parser.n_allocated <= 512); /* of 65536 that were announced */
    uint8_t *rest = mem_new(65535);
    memset(rest, 'x', 65535);
    event = read_all(&parser, rest, 65535);
    assert_int_equal(event.type, WS_EVENT_MESSAGE);
    assert_int_equal(event.n, 65536);
    assert_int_equal(parser.n_allocated, 65536);
    assert_int_equal(read_all(&parser, rest, 0).type, WS_EVENT_NONE);
    assert_true(parser.n_allocated <= WS_MESSAGE_KEPT);
    ws_parser_finish(&parser);
    free(rest);
}

static void nothing_is_read_after_a_close_or_a_break(void **state)
{
    static const uint8_t closed[] = { 0x88, 0x80, 0, 0, 0, 0 };
    struct ws_parser parser;
    struct ws_event event;
    (void)state;
    ws_parser_init(&parser, 65536, false);
    assert_int_equal(read_all(&parser, closed, sizeof closed).type, WS_EVENT_CLOSE);
    assert_int_equal(ws_parser_take(&parser, hello, sizeof hello, &event), sizeof hello);
    assert_int_equal(event.type, WS_EVENT_NONE);
    ws_parser_finish(&parser);
    ws_parser_init(&parser, 65536, false);
    assert_int_equal(read_all(&parser, (const uint8_t[]){ 0x83 }, 1).type, WS_EVENT_BROKEN);
    assert_int_equal(ws_parser_take(&parser, hello, sizeof hello, &event), sizeof hello);
    assert_int_equal(event.type, WS_EVENT_NONE);
    ws_parser_finish(&parser);
}

static void a_close_after_a_text_that_is_not_whole_is_a_close(void **state)
{
    static const uint8_t bytes[] = { 0x01, 0x81, 0, 0, 0, 0, 0xe2, 0x88, 0x85, 0, 0, 0, 0, 0x03, 0xe8, 'b', 'y', 'e' };
    struct ws_parser parser;
    (void)state;
    ws_parser_init(&parser, 65536, false);
    struct ws_event event = read_all(&parser, bytes, sizeof bytes);
    assert_int_equal(event.type, WS_EVENT_CLOSE); /* its reason is not the rest of the text's character */
    assert_int_equal(event.code, 1000);
    ws_parser_finish(&parser);
}

static void a_ping_inside_a_character_leaves_the_text_whole(void **state)
{
    static const uint8_t bytes[] = { 0x01, 0x82, 0, 0,    0,    0,    0xe2, 0x82, 0x89, 0x81, 0,
                                     0,    0,    0, 0xff, 0x80, 0x81, 0,    0,    0,    0,    0xac };
    struct ws_parser parser;
    struct ws_event event;
    (void)state;
    ws_parser_init(&parser, 65536, false);
    size_t n_taken = ws_parser_take(&parser, bytes, sizeof bytes, &event);
    assert_int_equal(event.type, WS_EVENT_PING);
    assert_int_equal(n_taken, 15);
    event = read_all(&parser, bytes + n_taken, sizeof bytes - n_taken);
    assert_int_equal(event.type, WS_EVENT_MESSAGE);
    assert_memory_equal(event.bytes, "\xe2\x82\xac", 3); /* the euro sign */
    ws_parser_finish(&parser);
}

static void a_servers_header_has_the_shortest_length(void **state)
{
    static const struct {
        uint64_t n;
        uint8_t head[10];
        size_t n_head;
    } cases[] = { { 0, { 0x82, 0 }, 2 },
                  { 125, { 0x82, 125 }, 2 },
                  { 126, { 0x82, 126, 0, 126 }, 4 },
                  { 256, { 0x82, 126, 1, 0 }, 4 },
                  { 65535, { 0x82, 126, 0xff, 0xff }, 4 },
                  { 65536, { 0x82, 127, 0, 0, 0, 0, 0, 1, 0, 0 }, 10 } };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        uint8_t head[10];
        assert_int_equal(ws_write_head(head, WS_BINARY, cases[i].n), cases[i].n_head);
        assert_memory_equal(head, cases[i].head, cases[i].n_head);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_masked_hello_of_the_rfc_is_read),
        cmocka_unit_test(what_is_not_masked_breaks_it),
        cmocka_unit_test(a_length_in_more_bytes_than_it_needs_breaks_it),
        cmocka_unit_test(a_message_that_is_too_large_breaks_it_before_it_comes),
        cmocka_unit_test(memory_grows_with_what_has_come_and_is_given_back),
        cmocka_unit_test(nothing_is_read_after_a_close_or_a_break),
        cmocka_unit_test(a_close_after_a_text_that_is_not_whole_is_a_close),
        cmocka_unit_test(a_ping_inside_a_character_leaves_the_text_whole),
        cmocka_unit_test(a_servers_header_has_the_shortest_length),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
