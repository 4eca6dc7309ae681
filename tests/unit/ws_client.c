/* A WebSocket client for tests: builds frames and parses what comes back. */
#include "tests/unit/ws_client.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "tests/check.h"

static const uint8_t mask[4] = { 0x37, 0xfa, 0x21, 0x3d };

void ws_client_open(struct ws_client *client, struct ws *ws)
{
    static const char request[] =
        "GET /api/v1/rooms/7q4k-m2wz/ws HTTP/1.1\r\nHost: here\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
        "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n";
    const struct handshake handshake = {
        .room_id = "7q4k-m2wz", .key = "dGhlIHNhbXBsZSBub25jZQ==", .host = "here", .n_head = sizeof request - 1
    };
    const int socket_bytes = 64 << 10; /* what the kernel holds of the unread, the same on every machine */
    int ends[2];
    *client = (struct ws_client){ .ws = ws };
    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends), 0);
    client->fd = ends[0];
    assert_int_equal(setsockopt(ends[1], SOL_SOCKET, SO_SNDBUF, &socket_bytes, sizeof socket_bytes), 0);
    assert_int_equal(write(client->fd, request, sizeof request - 1), (ssize_t)sizeof request - 1);
    ws_adopt(ws, ends[1], &handshake, &(struct ws_count){ NULL, NULL });
    char answer[300] = "";
    assert_true(read(client->fd, answer, sizeof answer - 1) > 0);
    assert_memory_equal(answer, "HTTP/1.1 101 ", 13);
    /* the accept value of RFC 6455, section 1.3, for this key */
    assert_non_null(strstr(answer, "\r\nSec-WebSocket-Accept: s3pPLMBiTxaQ9kYGzzhZRbK+xOo=\r\n"));
    assert_string_equal(answer + strlen(answer) - 4, "\r\n\r\n");
}

void ws_client_finish(struct ws_client *client)
{
    (void)close(client->fd);
    free(client->out);
    free(client->in);
}

static void make_space(uint8_t **bytes, size_t *size, size_t n)
{
    if (n <= *size)
        return;
    *size = n + n / 2 + 4096;
    *bytes = realloc(*bytes, *size);
    assert_non_null(*bytes);
}

void ws_client_serve(struct ws_client *client)
{
    ws_wake(client->ws);
    ws_serve(client->ws);
    for (ssize_t n = 1; n > 0 && !client->has_ended;) {
        make_space(&client->in, &client->size_in, client->n_in + 65536);
        n = recv(client->fd, client->in + client->n_in, 65536, MSG_DONTWAIT);
        if (n > 0)
            client->n_in += (size_t)n;
        else if (n == 0 || (errno != EAGAIN && errno != EINTR))
            client->has_ended = true;
    }
}

void ws_client_add_raw(struct ws_client *client, const void *bytes, size_t n)
{
    make_space(&client->out, &client->size_out, client->n_out + n);
    if (n)
        memcpy(client->out + client->n_out, bytes, n);
    client->n_out += n;
}

void ws_client_add(struct ws_client *client, unsigned first, const void *payload, size_t n)
{
    uint8_t head[14] = { (uint8_t)first, (uint8_t)(0x80 | n) };
    size_t n_head = 2;
    if (n > 65535) {
        head[1] = 0x80 | 127;
        for (; n_head < 10; n_head++)
            head[n_head] = (uint8_t)((uint64_t)n >> 8 * (9 - n_head));
    } else if (n > 125) {
        head[1] = 0x80 | 126;
        head[n_head++] = (uint8_t)(n >> 8);
        head[n_head++] = (uint8_t)n;
    }
    memcpy(head + n_head, mask, 4);
    ws_client_add_raw(client, head, n_head + 4);
    ws_client_add_raw(client, payload, n);
    for (size_t i = 0; i < n; i++)
        client->out[client->n_out - n + i] ^= mask[i % 4];
}

void ws_client_flush(struct ws_client *client, size_t n_chop)
{
    for (size_t at = 0; at < client->n_out && !client->has_ended;) {
        size_t n = client->n_out - at;
        ssize_t sent =
            send(client->fd, client->out + at, n_chop && n > n_chop ? n_chop : n, MSG_NOSIGNAL | MSG_DONTWAIT);
        if (sent < 0 && errno != EAGAIN && errno != EINTR)
            break; /* the server has ended: what it said is still to be read */
        at += sent > 0 ? (size_t)sent : 0;
        ws_client_serve(client);
    }
    client->n_out = 0;
}

void ws_client_send(struct ws_client *client, unsigned first, const void *payload, size_t n)
{
    ws_client_add(client, first, payload, n);
    ws_client_flush(client, 0);
}

/* The first frame of what came; its bytes with the header, 0: not whole yet. */
static size_t parse(const struct ws_client *client, struct ws_answer *answer)
{
    const uint8_t *in = client->in;
    size_t n_head = client->n_in < 2 || in[1] < 126 ? 2 : in[1] == 126 ? 4 : 10;
    if (client->n_in < n_head)
        return 0;
    assert_int_equal(in[0] & 0xf0, FIN); /* whole messages, no reserved bits */
    assert_int_equal(in[1] & 0x80, 0);   /* a server does not mask */
    uint64_t n = n_head == 2 ? in[1] : 0;
    for (size_t i = 2; i < n_head; i++)
        n = n << 8 | in[i];
    if (client->n_in - n_head < n)
        return 0;
    *answer = (struct ws_answer){ in[0] & 15, in + n_head, (size_t)n };
    return n_head + (size_t)n;
}

bool ws_client_next(struct ws_client *client, struct ws_answer *answer)
{
    static uint8_t *kept; /* of the last answer */
    int64_t until_us = clock_now_us() + 60000000;
    for (;;) {
        size_t n = parse(client, answer);
        if (n) {
            free(kept);
            kept = malloc(n);
            assert_non_null(kept);
            memcpy(kept, client->in, n);
            answer->bytes = kept + (n - answer->n);
            client->n_in -= n;
            memmove(client->in, client->in + n, client->n_in);
            return true;
        }
        if (client->has_ended) {
            assert_int_equal(client->n_in, 0); /* no half frame */
            return false;
        }
        if (clock_now_us() > until_us)
            fail_msg("neither a frame nor the end came");
        ws_wake_at(client->ws, clock_now_us() + 2000);
        ws_serve(client->ws);
        ws_client_serve(client);
    }
}

void ws_client_expect(struct ws_client *client, unsigned first, const void *payload, size_t n)
{
    struct ws_answer answer;
    assert_true(ws_client_next(client, &answer));
    assert_int_equal(answer.opcode | FIN, first);
    assert_int_equal(answer.n, n);
    assert_true(n == 0 || memcmp(answer.bytes, payload, n) == 0);
}

void ws_client_expect_end(struct ws_client *client, unsigned code)
{
    struct ws_answer answer;
    assert_true(ws_client_next(client, &answer));
    assert_int_equal(answer.opcode | FIN, CLOSE);
    if (code == 0) {
        assert_int_equal(answer.n, 0);
    } else {
        assert_true(answer.n >= 2 && answer.n <= 125);
        assert_int_equal(answer.bytes[0] << 8 | answer.bytes[1], code);
    }
    assert_false(ws_client_next(client, &answer));
}
