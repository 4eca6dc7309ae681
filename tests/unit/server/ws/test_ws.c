#define _GNU_SOURCE
/* Connections over a socket pair whose other end is the test: what waits is bounded, what is old drops, who sends too
 * much is closed. */
#include <unistd.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "tests/check.h"
#include "tests/unit/ws_client.h"
#include "wire_gen.h"

static struct ws *ws;
static struct ws_connection *connection;
static struct ws_client client;
static int n_closed;
static char came[200000];
static size_t n_came, n_messages;

static bool has_room(void *context, const struct handshake *handshake)
{
    (void)context;
    return strcmp(handshake->room_id, "7q4k-m2wz") == 0;
}

static void opened(void *context, struct ws_connection *new_connection, const struct handshake *handshake)
{
    (void)context;
    assert_string_equal(handshake->room_id, "7q4k-m2wz");
    connection = new_connection;
}

static void message_came(void *context, struct ws_connection *from, enum ws_opcode kind, const char *text, size_t n)
{
    (void)context;
    (void)from;
    assert_int_equal(kind, WS_TEXT);
    memcpy(came, text, n);
    n_came = n;
    n_messages++;
}

static bool is_greeted(void *context, struct ws_connection *from)
{
    (void)context;
    (void)from;
    return true;
}

static void closed(void *context, struct ws_connection *from)
{
    (void)context;
    (void)from;
    n_closed++;
    connection = NULL;
}

static void nothing(void *context)
{
    (void)context;
}

static void serve_a_while(void)
{
    for (int i = 0; i < 20; i++) {
        ws_wake_at(ws, clock_now_us() + 5000);
        ws_serve(ws);
    }
}

static void wait_for_messages(size_t n)
{
    for (int64_t until_us = clock_now_us() + 60000000; n_messages < n && clock_now_us() < until_us;) {
        ws_wake_at(ws, clock_now_us() + 5000);
        ws_serve(ws);
    }
    assert_int_equal(n_messages, n);
}

static void start_with(const struct ws_limits *limits)
{
    const struct ws_callbacks callbacks = {
        has_room, opened, message_came, is_greeted, closed, nothing, nothing, NULL
    };
    n_closed = 0;
    n_came = n_messages = 0;
    ws = ws_create(&callbacks, limits, NULL, NULL);
    assert_non_null(ws);
    ws_client_open(&client, ws);
    assert_non_null(connection);
}

static int start(void **state)
{
    (void)state;
    start_with(&ws_limits_default);
    return 0;
}

static int end(void **state)
{
    (void)state;
    ws_destroy(ws);
    ws_client_finish(&client);
    return 0;
}

/* Reads all that is there; how many bytes. */
static size_t drain(uint8_t *bytes, size_t size)
{
    size_t n = 0;
    for (int quiet = 0; quiet < 3;) {
        ssize_t got = read(client.fd, bytes + n, size - n);
        if (got <= 0) {
            quiet++;
            serve_a_while();
        } else {
            n += (size_t)got;
            assert_true(n < size);
        }
    }
    return n;
}

/* A text as "a17 ": key 0, number 17. */
static void send_latest(uint32_t key, int number)
{
    char text[32];
    (void)snprintf(text, sizeof text, "%c%d ", (char)('a' + key), number);
    ws_send_latest(connection, key, text);
}

static void of_texts_with_a_key_who_does_not_read_is_left_with_the_newest(void **state)
{
    (void)state;
    char *large = mem_new(8192);
    memset(large, 'x', 8191);
    for (int i = 0; i < 100; i++) { /* fill what the kernel takes, and leave some to wait */
        ws_send_text(connection, large);
        if (i % 10 == 0)
            serve_a_while();
    }
    for (int i = 0; i < 100000; i++) { /* an hour of a pointer */
        send_latest(0, i);
        send_latest(1, -i);
    }
    ws_send_text(connection, "after");
    assert_non_null(connection); /* not too slow: nothing of it piled up */
    struct ws_answer answer = { 0 };
    do
        assert_true(ws_client_next(&client, &answer));
    while (answer.bytes[0] == 'x');
    assert_memory_equal(answer.bytes, "after", answer.n); /* what is said once goes first, then keys in their turn */
    ws_client_expect(&client, TEXT, "a99999 ", 7);
    ws_client_expect(&client, TEXT, "b-99999 ", 8);
    assert_int_equal(n_closed, 0);
    free(large);
}

static void who_closes_is_sent_no_latest_text_any_more(void **state)
{
    static uint8_t bytes[4096];
    (void)state;
    send_latest(0, 7);
    ws_close(connection, WS_CLOSE_NORMAL);
    size_t n = drain(bytes, sizeof bytes - 1);
    bytes[n] = 0;
    assert_null(strstr((char *)bytes, "a7 "));
}

static void who_does_not_read_is_closed_after_256_messages(void **state)
{
    (void)state;
    char *text = mem_new(8192);
    memset(text, 'x', 8191);
    for (int i = 0; i < 100; i++) { /* fill what the kernel takes */
        ws_send_text(connection, text);
        if (i % 10 == 0)
            serve_a_while();
    }
    assert_int_equal(n_closed, 0);
    text[10] = 0;
    for (int i = 0; i < 300 && connection; i++)
        ws_send_text(connection, text);
    serve_a_while();
    assert_int_equal(n_closed, 1);
    free(text);
}

static void who_does_not_read_is_closed_after_4_mib(void **state)
{
    (void)state;
    char *text = mem_new(1 << 20);
    memset(text, 'x', (1 << 20) - 1);
    for (int i = 0; i < 7 && n_closed == 0; i++) {
        ws_send_text(connection, text);
        serve_a_while();
    }
    assert_int_equal(n_closed, 1);
    free(text);
}

static void a_newer_frame_replaces_one_that_has_not_gone_out(void **state)
{
    static uint8_t bytes[4 << 20];
    (void)state;
    uint32_t before = 0, n_frames = 0, newest = 0;
    for (uint32_t sequence = 1; sequence <= 40; sequence++) { /* nobody reads */
        struct frame *picture = mem_new(sizeof *picture);
        *picture = (struct frame){ .bytes = mem_new(100000), .n_bytes = 100000, .references = 1 };
        struct frame_header header = { .codec = 1,
                                       .scale_percent = 100,
                                       .view = 1,
                                       .sequence = sequence,
                                       .width_px = 1,
                                       .height_px = 1,
                                       .payload_bytes = 100000 };
        ws_send_frame(connection, &header, picture);
        frame_unref(picture); /* the connection holds its own */
        serve_a_while();
    }
    size_t n = drain(bytes, sizeof bytes);
    for (size_t at = 0; at < n;) { /* FIN + binary, 64 bit length */
        struct frame_header header;
        size_t header_bytes;
        if (bytes[at] == 0x89) { /* a ping: the machine is so busy that the connection was silent for seconds */
            at += 2 + (size_t)(bytes[at + 1] & 0x7f);
            continue;
        }
        n_frames++;
        assert_int_equal(bytes[at], 0x82);
        assert_int_equal(bytes[at + 1], 127);
        assert_true(at + 10 + 100112 <= n);
        assert_true(frame_header_read(bytes + at + 10, 100112, &header, &header_bytes, NULL));
        assert_true(header.sequence > before);
        before = newest = header.sequence;
        at += 10 + 100112;
    }
    assert_int_equal(newest, 40);     /* the newest is there */
    assert_in_range(n_frames, 2, 10); /* and not the forty */
}

static void closing_lets_the_last_words_out(void **state)
{
    struct ws_answer answer;
    (void)state;
    ws_bye(connection, WS_CLOSE_NORMAL, "enough", -1);
    ws_send_text(connection, "nothing may come after it");
    assert_true(ws_client_next(&client, &answer));
    assert_int_equal(answer.opcode, WS_TEXT);
    assert_non_null(memmem(answer.bytes, answer.n, "\"reason\":\"enough\"", 17));
    ws_client_expect_end(&client, 1000);
}

static void a_close_says_the_code_it_was_asked_for(void **state)
{
    struct ws_answer answer;
    (void)state;
    ws_bye(connection, WS_CLOSE_GOING_AWAY, "the server is being stopped", 2000);
    assert_true(ws_client_next(&client, &answer));
    assert_int_equal(answer.opcode, WS_TEXT);
    assert_non_null(memmem(answer.bytes, answer.n, "\"retry_ms\":2000", 15));
    ws_client_expect_end(&client, 1001);
}

static void after_a_close_a_client_has_a_second_to_end_its_side(void **state)
{
    (void)state;
    int64_t start_us = clock_now_us();
    ws_close(connection, WS_CLOSE_NORMAL);
    ws_client_expect_end(&client,
                         1000); /* the server's side is ended; the connection is kept so that the close arrives */
    assert_int_equal(n_closed, 0);
    while (n_closed == 0) {
        ws_wake_at(ws, clock_now_us() + 5000);
        ws_serve(ws);
    }
    assert_true(clock_now_us() - start_us >= WS_LINGER_MS * 1000);
}

static void a_client_that_ends_its_side_is_closed_at_once(void **state)
{
    (void)state;
    ws_close(connection, WS_CLOSE_NORMAL);
    ws_client_expect_end(&client, 1000);
    int64_t start_us = clock_now_us();
    (void)close(client.fd);
    client.fd = -1;
    ws_wake_at(ws, start_us + 10000000);
    ws_serve(ws); /* woken by the end of the socket alone */
    assert_int_equal(n_closed, 1);
}

static void a_pong_waits_for_the_message_that_is_partly_sent(void **state)
{
    enum { N = 1 << 20 };
    (void)state;
    char *text = mem_new(N + 1);
    memset(text, 'x', N);
    ws_send_text(connection, text);
    for (int i = 0; i < 20; i++) { /* part of it is in the kernel; the client does not read */
        ws_wake(ws);
        ws_serve(ws);
    }
    ws_client_send(&client, PING, "now", 3);
    ws_client_expect(&client, TEXT, text, N);
    ws_client_expect(&client, PONG, "now", 3);
    free(text);
}

static void pongs_that_nobody_reads_are_bounded_and_the_newest_is_kept(void **state)
{
    static uint8_t ping[125];
    enum { N_PINGS = 150 }; /* under the limit of pings */
    struct ws_answer answer;
    char *text = mem_new((1 << 20) + 1);
    int n_pongs = 0;
    (void)state;
    memset(text, 'x', 1 << 20); /* more than the kernel takes */
    ws_send_text(connection, text);
    for (int i = 0; i < 20; i++) {
        ws_wake(ws);
        ws_serve(ws);
    }
    for (int i = 0; i < N_PINGS; i++) {
        ping[0] = (uint8_t)i;
        ws_client_add(&client, PING, ping, sizeof ping);
    }
    assert_int_equal(write(client.fd, client.out, client.n_out), (ssize_t)client.n_out);
    client.n_out = 0;
    for (int i = 0; i < 20; i++) {
        ws_wake(ws);
        ws_serve(ws);
    }
    ws_client_expect(&client, TEXT, text, 1 << 20);
    for (int expected = N_PINGS - WS_MAX_PONGS; expected < N_PINGS; expected++, n_pongs++) {
        assert_true(ws_client_next(&client, &answer));
        assert_int_equal(answer.opcode, WS_PONG);
        assert_int_equal(answer.bytes[0], expected);
    }
    assert_int_equal(n_pongs, WS_MAX_PONGS);
    free(text);
}

static void a_message_of_exactly_the_limit_is_taken_and_one_byte_more_closes_with_1009(void **state)
{
    (void)state;
    uint8_t *text = mem_new(WIRE_MAX_CLIENT_BYTES + 1);
    memset(text, 'x', WIRE_MAX_CLIENT_BYTES + 1);
    ws_client_send(&client, TEXT, text, WIRE_MAX_CLIENT_BYTES);
    wait_for_messages(1);
    assert_int_equal(n_came, WIRE_MAX_CLIENT_BYTES);
    ws_client_send(&client, 1, text, WIRE_MAX_CLIENT_BYTES - 1); /* in two fragments as well */
    ws_client_send(&client, CONTINUED, text, 1);
    wait_for_messages(2);
    ws_client_add(&client, TEXT, text, WIRE_MAX_CLIENT_BYTES + 1);
    client.n_out = 10; /* before a byte of it comes: its length is enough */
    ws_client_flush(&client, 0);
    ws_client_expect_end(&client, 1009);
    assert_int_equal(n_messages, 2);
    free(text);
}

static void binary_messages_close_with_1003(void **state)
{
    (void)state;
    ws_client_send(&client, BINARY, "x", 1);
    ws_client_expect_end(&client, 1003);
    assert_int_equal(n_messages, 0);
}

/* ---- how much may come ------------------------------------------------------------------------------------------ */

/* 5 at once and then one a second: fifty at once are too many on every machine that takes less than 45 s for them. */
static const struct rate_limit five = { .per_s = 1, .burst = 5 };

static void expect_refusal(const char *words)
{
    struct ws_answer answer;
    do
        assert_true(ws_client_next(&client, &answer));
    while (answer.opcode != WS_TEXT);
    assert_non_null(memmem(answer.bytes, answer.n, "\"type\":\"bye\"", 12));
    assert_non_null(memmem(answer.bytes, answer.n, words, strlen(words)));
    assert_non_null(memmem(answer.bytes, answer.n, "\"retry_ms\":5000", 15));
    ws_client_expect_end(&client, 1008);
}

static void more_messages_than_the_limit_close_with_1008(void **state)
{
    struct ws_limits limits = ws_limits_default;
    (void)state;
    limits.messages = five;
    start_with(&limits);
    for (int i = 0; i < 5; i++)
        ws_client_send(&client, TEXT, "x", 1);
    wait_for_messages(5);
    for (int i = 0; i < 50; i++)
        ws_client_add(&client, TEXT, "x", 1);
    ws_client_flush(&client, 0);
    expect_refusal("more than 1 messages a second, or 5 at once");
    assert_in_range(n_messages, 5, 54);
}

static void more_pings_than_the_limit_close_with_1008(void **state)
{
    struct ws_limits limits = ws_limits_default;
    (void)state;
    limits.controls = five;
    start_with(&limits);
    for (int i = 0; i < 5; i++) {
        ws_client_send(&client, PING, "x", 1);
        ws_client_expect(&client, PONG, "x", 1);
    }
    for (int i = 0; i < 50; i++)
        ws_client_add(&client, PONG, "x", 1); /* unasked ones count as well */
    ws_client_flush(&client, 0);
    expect_refusal("more than 1 pings and pongs a second, or 5 at once");
}

static void more_bytes_than_the_limit_close_with_1008(void **state)
{
    struct ws_limits limits = ws_limits_default;
    static uint8_t text[5000];
    (void)state;
    limits.bytes = (struct rate_limit){ .per_s = 100, .burst = 6000 };
    start_with(&limits);
    memset(text, 'x', sizeof text);
    ws_client_send(&client, TEXT, text, sizeof text);
    wait_for_messages(1);
    ws_client_add(&client, 1, "", 0);
    for (int i = 0; i < 5000; i++)
        ws_client_add(&client, 0, "", 0); /* empty fragments are neither messages nor pings; 30 kB */
    ws_client_flush(&client, 0);
    expect_refusal("more than 100 bytes a second, or 6000 at once");
    assert_int_equal(n_messages, 1);
}

static void a_person_with_eight_views_at_sixty_pictures_a_second_is_under_every_limit(void **state)
{
    struct rate messages = { 0 }, bytes = { 0 };
    const int64_t start_us = 1000000;
    (void)state;
    for (int64_t i = 0; i < 60 * 60; i++) /* a minute; each 60th of a second a change and an answer of each view */
        for (int k = 0; k < 16; k++) {
            assert_true(rate_allows(&messages, &ws_limits_default.messages, 1, start_us + i * 1000000 / 60));
            assert_true(rate_allows(&bytes, &ws_limits_default.bytes, 2000, start_us + i * 1000000 / 60));
        }
}

static void a_rate_allows_its_burst_at_once_and_not_one_more(void **state)
{
    const struct rate_limit limit = { .per_s = 10, .burst = 3 };
    struct rate rate = { 0 };
    int64_t now_us = 5000000;
    (void)state;
    for (int i = 0; i < 3; i++)
        assert_true(rate_allows(&rate, &limit, 1, now_us));
    assert_false(rate_allows(&rate, &limit, 1, now_us));
    rate = (struct rate){ 0 };
    for (int i = 0; i < 1000; i++) /* ten a second for ever */
        assert_true(rate_allows(&rate, &limit, 1, now_us += 100000));
    assert_true(rate_allows(&rate, &limit, 2, now_us)); /* of the burst one is worked off each tenth of a second */
    assert_false(rate_allows(&rate, &limit, 1, now_us));
    rate = (struct rate){ 0 };
    assert_true(rate_allows(&rate, &limit, 3, now_us));
    assert_false(rate_allows(&rate, &limit, 1, now_us + 99000)); /* 1 ms too early, which it pays for */
    rate = (struct rate){ 0 };
    assert_true(rate_allows(&rate, &limit, 3, now_us));
    assert_true(rate_allows(&rate, &limit, 1, now_us + 100000));
}

int main(void)
{
#define T(name) cmocka_unit_test_setup_teardown(name, start, end)
    const struct CMUnitTest tests[] = {
        T(who_does_not_read_is_closed_after_256_messages),
        T(of_texts_with_a_key_who_does_not_read_is_left_with_the_newest),
        T(who_closes_is_sent_no_latest_text_any_more),
        T(who_does_not_read_is_closed_after_4_mib),
        T(a_newer_frame_replaces_one_that_has_not_gone_out),
        T(closing_lets_the_last_words_out),
        T(a_close_says_the_code_it_was_asked_for),
        T(after_a_close_a_client_has_a_second_to_end_its_side),
        T(a_client_that_ends_its_side_is_closed_at_once),
        T(a_pong_waits_for_the_message_that_is_partly_sent),
        T(pongs_that_nobody_reads_are_bounded_and_the_newest_is_kept),
        T(a_message_of_exactly_the_limit_is_taken_and_one_byte_more_closes_with_1009),
        T(binary_messages_close_with_1003),
        cmocka_unit_test_teardown(more_messages_than_the_limit_close_with_1008, end),
        cmocka_unit_test_teardown(more_pings_than_the_limit_close_with_1008, end),
        cmocka_unit_test_teardown(more_bytes_than_the_limit_close_with_1008, end),
        cmocka_unit_test(a_person_with_eight_views_at_sixty_pictures_a_second_is_under_every_limit),
        cmocka_unit_test(a_rate_allows_its_burst_at_once_and_not_one_more),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
