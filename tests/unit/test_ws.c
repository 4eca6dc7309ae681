/* Connections over a socket pair whose other end is the test: what waits is bounded, what is old drops. */
#include <sys/socket.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "server/ws/ws.h"
#include "tests/check.h"

static struct ws *ws;
static struct ws_connection *connection;
static int n_closed, other_end;
static char came[200000];
static size_t n_came;

static bool has_room(void *context, const char *room_id)
{
    (void)context;
    return strcmp(room_id, "7q4k-m2wz") == 0;
}

static void opened(void *context, struct ws_connection *new_connection, const char *room_id)
{
    (void)context;
    assert_string_equal(room_id, "7q4k-m2wz");
    connection = new_connection;
}

static void text_came(void *context, struct ws_connection *from, const char *text, size_t n)
{
    (void)context;
    (void)from;
    memcpy(came, text, n);
    n_came = n;
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

static int start(void **state)
{
    static const char request[] = "GET /api/v1/rooms/7q4k-m2wz/ws HTTP/1.1\r\nHost: here\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
                                  "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n";
    const struct ws_callbacks callbacks = { has_room, opened, text_came, is_greeted, closed, nothing, nothing, NULL };
    int ends[2];
    (void)state;
    n_closed = 0;
    n_came = 0;
    ws = ws_create(&callbacks, NULL, NULL);
    assert_non_null(ws);
    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends), 0);
    other_end = ends[0];
    const int socket_bytes = 64 << 10; /* what the kernel holds of the unread, the same on every machine */
    assert_int_equal(setsockopt(ends[1], SOL_SOCKET, SO_SNDBUF, &socket_bytes, sizeof socket_bytes), 0);
    assert_int_equal(write(other_end, request, sizeof request - 1), (ssize_t)sizeof request - 1);
    ws_adopt(ws, ends[1]);
    serve_a_while();
    assert_non_null(connection);
    char answer[1024] = "";
    assert_true(read(other_end, answer, sizeof answer - 1) > 0);
    /* the accept value of RFC 6455, section 1.3, for this key */
    assert_non_null(strstr(answer, "s3pPLMBiTxaQ9kYGzzhZRbK+xOo="));
    return 0;
}

static int end(void **state)
{
    (void)state;
    ws_destroy(ws);
    (void)close(other_end);
    return 0;
}

/* Reads all that is there; how many bytes. */
static size_t drain(uint8_t *bytes, size_t size)
{
    size_t n = 0;
    for (int quiet = 0; quiet < 3;) {
        ssize_t got = read(other_end, bytes + n, size - n);
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
        struct room_picture *picture = mem_new(sizeof *picture);
        *picture = (struct room_picture){ .bytes = mem_new(100000), .n_bytes = 100000, .references = 1 };
        struct frame_header header = { .codec = 1, .scale_percent = 100, .view = 1, .sequence = sequence, .width_px = 1, .height_px = 1, .payload_bytes = 100000 };
        ws_send_frame(connection, &header, picture);
        room_picture_drop(picture); /* the connection holds its own */
        serve_a_while();
    }
    size_t n = drain(bytes, sizeof bytes);
    for (size_t at = 0; at < n; n_frames++) { /* FIN + binary, 64 bit length */
        struct frame_header header;
        size_t header_bytes;
        assert_int_equal(bytes[at], 0x82);
        assert_int_equal(bytes[at + 1], 127);
        assert_true(at + 10 + 100112 <= n);
        assert_true(frame_header_read(bytes + at + 10, 100112, &header, &header_bytes, NULL));
        assert_true(header.sequence > before);
        before = newest = header.sequence;
        at += 10 + 100112;
    }
    assert_int_equal(newest, 40);   /* the newest is there */
    assert_in_range(n_frames, 2, 10); /* and not the forty */
}

static void closing_lets_the_last_words_out(void **state)
{
    static uint8_t bytes[4096];
    (void)state;
    ws_bye(connection, "enough", -1);
    serve_a_while();
    size_t n = drain(bytes, sizeof bytes);
    assert_int_equal(bytes[0], 0x81);
    bytes[n] = 0;
    assert_non_null(strstr((char *)bytes + 2, "\"reason\":\"enough\""));
    assert_int_equal(bytes[2 + bytes[1]], 0x88); /* then the close frame */
}

static void a_message_of_exactly_the_limit_is_taken(void **state)
{
    (void)state;
    uint8_t *frame = mem_new(14 + WIRE_MAX_CLIENT_BYTES);
    const uint8_t head[14] = { 0x81, 0xff, 0, 0, 0, 0, 0, WIRE_MAX_CLIENT_BYTES >> 16, 0, 0 }; /* mask of zeros */
    memcpy(frame, head, sizeof head);
    memset(frame + 14, 'x', WIRE_MAX_CLIENT_BYTES);
    for (size_t at = 0, n = 14 + WIRE_MAX_CLIENT_BYTES; at < n;) {
        ssize_t wrote = write(other_end, frame + at, n - at);
        at += wrote > 0 ? (size_t)wrote : 0;
        serve_a_while();
    }
    assert_int_equal(n_came, WIRE_MAX_CLIENT_BYTES);
    assert_int_equal(n_closed, 0);
    free(frame);
}

int main(void)
{
#define T(name) cmocka_unit_test_setup_teardown(name, start, end)
    const struct CMUnitTest tests[] = {
        T(who_does_not_read_is_closed_after_256_messages),
        T(who_does_not_read_is_closed_after_4_mib),
        T(a_newer_frame_replaces_one_that_has_not_gone_out),
        T(closing_lets_the_last_words_out),
        T(a_message_of_exactly_the_limit_is_taken),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
