#pragma once
/* Parses the bytes of a WebSocket client into messages (RFC 6455, server side). A violation of the protocol is reported
 * at its first byte and ends the parser. Knows no sockets, no clock, and nothing of the messages' contents. In the
 * parser, "frame" is RFC 6455's word for a part of a message; elsewhere a frame is a picture with its header. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    WS_MAX_CONTROL = 125,   /* bytes of a ping, a pong or a close (RFC 6455 5.5) */
    WS_MAX_REASON = 123,    /* bytes of the reason in a close */
    WS_MESSAGE_KEPT = 4096, /* bytes of memory kept between messages; more is freed */
};

enum ws_opcode { WS_CONTINUATION = 0, WS_TEXT = 1, WS_BINARY = 2, WS_CLOSE = 8, WS_PING = 9, WS_PONG = 10 };

/* RFC 6455 7.4.1 */
enum ws_close_code {
    WS_CLOSE_NORMAL = 1000,
    WS_CLOSE_GOING_AWAY = 1001,
    WS_CLOSE_PROTOCOL = 1002,
    WS_CLOSE_UNSUPPORTED = 1003,
    WS_CLOSE_NO_CODE = 1005, /* never sent; stands for a close without a code */
    WS_CLOSE_NOT_UTF8 = 1007,
    WS_CLOSE_POLICY = 1008,
    WS_CLOSE_TOO_LARGE = 1009,
    WS_CLOSE_INTERNAL = 1011,
};

enum ws_event_type {
    WS_EVENT_NONE,    /* all bytes were taken; more must come */
    WS_EVENT_MESSAGE, /* a whole text (checked UTF-8) or binary message */
    WS_EVENT_PING,
    WS_EVENT_PONG,
    WS_EVENT_CLOSE, /* code: the client's, or WS_CLOSE_NO_CODE. The parser has ended. */
    WS_EVENT_BROKEN /* code: to close with; reason: a sentence of at most WS_MAX_REASON bytes. The parser has
                        ended. */
};

struct ws_event {
    enum ws_event_type type;
    enum ws_opcode kind;  /* of a message: WS_TEXT or WS_BINARY */
    const uint8_t *bytes; /* of a message, ping or pong; not zero-terminated; valid until the next call */
    size_t n;
    uint16_t code;
    const char *reason;
};

struct ws_parser { /* in the caller's storage; its members are parser.c's */
    size_t max_message_bytes;
    bool takes_binary, has_ended, is_delivered;
    uint8_t head[14]; /* header of the frame that is being read */
    size_t n_head;
    bool is_in_payload, is_final;
    enum ws_opcode opcode;
    uint64_t n_payload, n_left;
    enum ws_opcode kind; /* of the message under way; WS_CONTINUATION: none */
    uint8_t *message;
    size_t n_message, n_allocated;
    uint8_t utf8_more, utf8_low, utf8_high; /* continuation bytes a character still needs, and the range of the next */
    uint8_t control[WS_MAX_CONTROL];
};

/* max_message_bytes: limit of a message, all fragments together. takes_binary false: a binary message gives
 * WS_EVENT_BROKEN with WS_CLOSE_UNSUPPORTED. */
void ws_parser_init(struct ws_parser *parser, size_t max_message_bytes, bool takes_binary);
void ws_parser_finish(struct ws_parser *parser);
/* Takes bytes up to the end of the next event; returns how many. To be called until it gives WS_EVENT_NONE. After
 * WS_EVENT_CLOSE or WS_EVENT_BROKEN it takes and drops all bytes. */
size_t ws_parser_take(struct ws_parser *parser, const uint8_t *bytes, size_t n, struct ws_event *event);

/* Writes a server's frame header: FIN set, not masked, the shortest form of the length. Returns its bytes, at most 10.
 */
size_t ws_write_head(uint8_t head[10], enum ws_opcode opcode, uint64_t n_payload);
