#pragma once
/* A client of RFC 6455 for tests, in the thread of the server it talks to, over a socket pair: it can send any bytes,
 * in any pieces. It shares no code with server/ws. */
#include "server/ws/ws.h"

struct ws_client {
    struct ws *ws;
    int fd;
    uint8_t *out, *in;
    size_t n_out, size_out, n_in, size_in;
    bool has_ended; /* the server's end */
};

struct ws_answer { /* one frame of the server's */
    uint8_t opcode;
    const uint8_t *bytes; /* good until the next call */
    size_t n;
};

enum {
    FIN = 0x80,
    TEXT = FIN | 1,
    BINARY = FIN | 2,
    CONTINUED = FIN | 0,
    CLOSE = FIN | 8,
    PING = FIN | 9,
    PONG = FIN | 10
};

/* Opens a connection to the room 7q4k-m2wz. */
void ws_client_open(struct ws_client *client, struct ws *ws);
void ws_client_finish(struct ws_client *client);
/* Lets the server do what can be done now, and reads what it sent. */
void ws_client_serve(struct ws_client *client);
/* Adds a masked frame to what is sent by the next flush; first: FIN, reserved bits and opcode. */
void ws_client_add(struct ws_client *client, unsigned first, const void *payload, size_t n);
void ws_client_add_raw(struct ws_client *client, const void *bytes, size_t n);
/* Sends it, n_chop bytes at a time with the server running between (0: as much as fits), until all is sent or the
 * server has ended. */
void ws_client_flush(struct ws_client *client, size_t n_chop);
void ws_client_send(struct ws_client *client, unsigned first, const void *payload, size_t n); /* add and flush */
/* Waits for a frame; false: the server ended instead. Fails the test when neither comes within 60 s. */
bool ws_client_next(struct ws_client *client, struct ws_answer *answer);
/* Like ws_client_next; the test fails unless it is this frame. */
void ws_client_expect(struct ws_client *client, unsigned first, const void *payload, size_t n);
/* The next frame is a close with this code (0: without one), and then the server ends. */
void ws_client_expect_end(struct ws_client *client, unsigned code);
