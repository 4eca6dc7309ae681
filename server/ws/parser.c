/* Parses frames byte by byte, unmasks and checks them, and puts messages together. */
#include "server/ws/parser.h"

#include <stdlib.h>
#include <string.h>

enum { FIRST_ALLOCATION = 512 };

void ws_parser_init(struct ws_parser *parser, size_t max_message_bytes, bool takes_binary)
{
    *parser = (struct ws_parser){ .max_message_bytes = max_message_bytes, .takes_binary = takes_binary };
}

void ws_parser_finish(struct ws_parser *parser)
{
    free(parser->message);
    parser->message = NULL;
    parser->n_allocated = 0;
}

static bool fail(struct ws_parser *parser, struct ws_event *event, uint16_t code, const char *reason)
{
    parser->has_ended = true;
    *event = (struct ws_event){ .type = WS_EVENT_BROKEN, .code = code, .reason = reason };
    return false;
}

/* ---- UTF-8 ------------------------------------------------------------------------------------------------------ */

static bool begin_character(struct ws_parser *parser, uint8_t byte)
{
    parser->utf8_low = 0x80;
    parser->utf8_high = 0xbf;
    if (byte >= 0xc2 && byte <= 0xdf) { /* 0xc0 and 0xc1 are overlong */
        parser->utf8_more = 1;
    } else if (byte >= 0xe0 && byte <= 0xef) {
        parser->utf8_more = 2;
        parser->utf8_low = byte == 0xe0 ? 0xa0 : 0x80;  /* no overlong form */
        parser->utf8_high = byte == 0xed ? 0x9f : 0xbf; /* no surrogate */
    } else if (byte >= 0xf0 && byte <= 0xf4) {
        parser->utf8_more = 3;
        parser->utf8_low = byte == 0xf0 ? 0x90 : 0x80;  /* no overlong form */
        parser->utf8_high = byte == 0xf4 ? 0x8f : 0xbf; /* not above U+10FFFF */
    } else {
        return false;
    }
    return true;
}

/* Checks the next bytes of a text (RFC 3629). At its end utf8_more must be 0. */
static bool check_utf8(struct ws_parser *parser, const uint8_t *bytes, size_t n)
{
    for (size_t i = 0; i < n;) {
        uint64_t eight;
        if (!parser->utf8_more && n - i >= sizeof eight) {
            memcpy(&eight, bytes + i, sizeof eight);
            if (!(eight & UINT64_C(0x8080808080808080))) {
                i += sizeof eight;
                continue;
            }
        }
        uint8_t byte = bytes[i++];
        if (parser->utf8_more) {
            if (byte < parser->utf8_low || byte > parser->utf8_high)
                return false;
            parser->utf8_more--;
            parser->utf8_low = 0x80;
            parser->utf8_high = 0xbf;
        } else if (byte >= 0x80 && !begin_character(parser, byte)) {
            return false;
        }
    }
    return true;
}

/* ---- the header of a frame -------------------------------------------------------------------------------------- */

static bool is_control(enum ws_opcode opcode)
{
    return opcode >= WS_CLOSE;
}

static bool check_first_byte(struct ws_parser *parser, struct ws_event *event)
{
    uint8_t byte = parser->head[0];
    parser->is_final = byte & 0x80;
    parser->opcode = (enum ws_opcode)(byte & 0x0f);
    if (byte & 0x70)
        return fail(parser, event, WS_CLOSE_PROTOCOL, "a reserved bit is set; no extension was agreed on");
    switch (parser->opcode) {
    case WS_CONTINUATION:
        return parser->kind != WS_CONTINUATION ||
               fail(parser, event, WS_CLOSE_PROTOCOL, "a continuation without a message that it continues");
    case WS_BINARY:
        if (!parser->takes_binary)
            return fail(parser, event, WS_CLOSE_UNSUPPORTED, "binary messages are not read; expected is text");
        /* fall through */
    case WS_TEXT:
        return parser->kind == WS_CONTINUATION ||
               fail(parser, event, WS_CLOSE_PROTOCOL, "a message begins inside another's fragments");
    case WS_CLOSE:
    case WS_PING:
    case WS_PONG: return parser->is_final || fail(parser, event, WS_CLOSE_PROTOCOL, "a control frame is in fragments");
    default: return fail(parser, event, WS_CLOSE_PROTOCOL, "an opcode that is reserved");
    }
}

static bool check_second_byte(struct ws_parser *parser, struct ws_event *event)
{
    uint8_t byte = parser->head[1], length = byte & 0x7f;
    if (!(byte & 0x80))
        return fail(parser, event, WS_CLOSE_PROTOCOL, "a client's frame is not masked");
    if (is_control(parser->opcode) && length > WS_MAX_CONTROL)
        return fail(parser, event, WS_CLOSE_PROTOCOL, "a control frame of more than 125 bytes");
    if (parser->opcode == WS_CLOSE && length == 1)
        return fail(parser, event, WS_CLOSE_PROTOCOL, "a close of 1 byte; a code has 2");
    return true;
}

/* Bytes of the header, as far as the bytes read so far tell. */
static size_t head_bytes(const struct ws_parser *parser)
{
    if (parser->n_head < 2)
        return 2;
    uint8_t length = parser->head[1] & 0x7f;
    return length < 126 ? 6 : length == 126 ? 8 : 14;
}

static bool check_length(struct ws_parser *parser, struct ws_event *event)
{
    size_t n_bytes = head_bytes(parser) - 6;
    uint64_t n = n_bytes ? 0 : parser->head[1] & 0x7f;
    for (size_t i = 0; i < n_bytes; i++)
        n = n << 8 | parser->head[2 + i];
    if (n_bytes == 8 && n >> 63)
        return fail(parser, event, WS_CLOSE_PROTOCOL, "a length of 2^63 bytes or more");
    if (n_bytes && n < (n_bytes == 2 ? 126 : 65536))
        return fail(parser, event, WS_CLOSE_PROTOCOL, "a length in more bytes than it needs");
    if (!is_control(parser->opcode) && n > parser->max_message_bytes - parser->n_message)
        return fail(parser, event, WS_CLOSE_TOO_LARGE, "the message is too large");
    parser->n_payload = parser->n_left = n;
    return true;
}

/* Reads bytes of the header. Returns false with a WS_EVENT_BROKEN. */
static bool read_head(struct ws_parser *parser, const uint8_t **at, const uint8_t *end, struct ws_event *event)
{
    while (*at < end && !parser->is_in_payload) {
        parser->head[parser->n_head++] = *(*at)++;
        if (parser->n_head == 1 && !check_first_byte(parser, event))
            return false;
        if (parser->n_head == 2 && !check_second_byte(parser, event))
            return false;
        size_t n_all = head_bytes(parser);
        if (parser->n_head == n_all - 4 && n_all > 2 &&
            !check_length(parser, event)) /* all but the four bytes of the mask were read */
            return false;
        if (parser->n_head < n_all || n_all == 2)
            continue;
        parser->is_in_payload = true;
        if (!is_control(parser->opcode) && parser->opcode != WS_CONTINUATION)
            parser->kind = parser->opcode;
    }
    return true;
}

/* ---- the payload ------------------------------------------------------------------------------------------------ */

static void unmask(const struct ws_parser *parser, uint8_t *out, const uint8_t *in, size_t n)
{
    const uint8_t *mask = parser->head + parser->n_head - 4;
    uint64_t offset = parser->n_payload - parser->n_left;
    uint8_t turned[8];
    uint64_t eight, key;
    size_t i = 0;
    for (size_t k = 0; k < sizeof turned; k++)
        turned[k] = mask[(offset + k) & 3];
    memcpy(&key, turned, sizeof key);
    for (; n - i >= sizeof eight; i += sizeof eight) {
        memcpy(&eight, in + i, sizeof eight);
        eight ^= key;
        memcpy(out + i, &eight, sizeof eight);
    }
    for (; i < n; i++)
        out[i] = in[i] ^ turned[i & 7];
}

/* Memory grows with the bytes received, not with the announced length. */
static bool make_space(struct ws_parser *parser, size_t n)
{
    size_t n_needed = parser->n_message + n, n_new = parser->n_allocated ? parser->n_allocated : FIRST_ALLOCATION;
    if (n_needed <= parser->n_allocated)
        return true;
    while (n_new < n_needed)
        n_new *= 2;
    if (n_new > parser->max_message_bytes)
        n_new = parser->max_message_bytes;
    uint8_t *larger = realloc(parser->message, n_new);
    if (!larger)
        return false;
    parser->message = larger;
    parser->n_allocated = n_new;
    return true;
}

static bool read_payload(struct ws_parser *parser, const uint8_t **at, const uint8_t *end, struct ws_event *event)
{
    size_t n = (size_t)(end - *at);
    uint8_t *out;
    if (n > parser->n_left)
        n = (size_t)parser->n_left;
    if (n == 0)
        return true;
    if (is_control(parser->opcode)) {
        out = parser->control + (parser->n_payload - parser->n_left);
    } else {
        if (!make_space(parser, n))
            return fail(parser, event, WS_CLOSE_INTERNAL, "no memory for the message");
        out = parser->message + parser->n_message;
        parser->n_message += n;
    }
    unmask(parser, out, *at, n);
    *at += n;
    parser->n_left -= n;
    if (!is_control(parser->opcode) && parser->kind == WS_TEXT && !check_utf8(parser, out, n))
        return fail(parser, event, WS_CLOSE_NOT_UTF8, "a text is not UTF-8");
    return true;
}

/* ---- whole frames ----------------------------------------------------------------------------------------------- */

/* RFC 6455 7.4: codes that are defined and may be sent, those registered since, and those for libraries and programs.
 */
static bool code_may_be_sent(unsigned code)
{
    return (code >= 1000 && code <= 1014 && code != 1004 && code != 1005 && code != 1006) ||
           (code >= 3000 && code <= 4999);
}

static bool finish_close(struct ws_parser *parser, struct ws_event *event)
{
    size_t n = (size_t)parser->n_payload;
    unsigned code = n >= 2 ? (unsigned)parser->control[0] << 8 | parser->control[1] : WS_CLOSE_NO_CODE;
    if (n >= 2 && !code_may_be_sent(code))
        return fail(parser, event, WS_CLOSE_PROTOCOL, "a close with a code that may not be sent");
    parser->utf8_more = 0; /* drops the state of an unfinished text */
    if (n > 2 && (!check_utf8(parser, parser->control + 2, n - 2) || parser->utf8_more))
        return fail(parser, event, WS_CLOSE_NOT_UTF8, "the reason of a close is not UTF-8");
    parser->has_ended = true;
    *event = (struct ws_event){ .type = WS_EVENT_CLOSE, .code = (uint16_t)code };
    return true;
}

/* Handles a whole frame, which may complete a message. */
static void finish_frame(struct ws_parser *parser, struct ws_event *event)
{
    parser->is_in_payload = false;
    parser->n_head = 0;
    if (parser->opcode == WS_CLOSE) {
        (void)finish_close(parser, event);
    } else if (is_control(parser->opcode)) {
        *event = (struct ws_event){ .type = parser->opcode == WS_PING ? WS_EVENT_PING : WS_EVENT_PONG,
                                    .bytes = parser->control,
                                    .n = (size_t)parser->n_payload };
    } else if (parser->is_final) {
        if (parser->kind == WS_TEXT && parser->utf8_more) {
            (void)fail(parser, event, WS_CLOSE_NOT_UTF8, "a text ends inside a character");
            return;
        }
        *event = (struct ws_event){ .type = WS_EVENT_MESSAGE,
                                    .kind = parser->kind,
                                    .bytes = parser->message ? parser->message : parser->control,
                                    .n = parser->n_message };
        parser->kind = WS_CONTINUATION;
        parser->is_delivered = true;
    }
}

size_t ws_parser_take(struct ws_parser *parser, const uint8_t *bytes, size_t n, struct ws_event *event)
{
    const uint8_t *at = bytes, *end = bytes + n;
    *event = (struct ws_event){ .type = WS_EVENT_NONE };
    if (parser->is_delivered) {
        parser->is_delivered = false;
        parser->n_message = 0;
        if (parser->n_allocated > WS_MESSAGE_KEPT)
            ws_parser_finish(parser);
    }
    while (at < end && event->type == WS_EVENT_NONE && !parser->has_ended) {
        if (!read_head(parser, &at, end, event) || !parser->is_in_payload)
            break;
        if (read_payload(parser, &at, end, event) && parser->n_left == 0)
            finish_frame(parser, event);
    }
    return parser->has_ended ? n : (size_t)(at - bytes);
}

size_t ws_write_head(uint8_t head[10], enum ws_opcode opcode, uint64_t n_payload)
{
    size_t n_bytes = n_payload < 126 ? 0 : n_payload < 65536 ? 2 : 8;
    head[0] = (uint8_t)(0x80 | opcode);
    head[1] = (uint8_t)(n_bytes == 0 ? n_payload : n_bytes == 2 ? 126 : 127);
    for (size_t i = 0; i < n_bytes; i++)
        head[2 + i] = (uint8_t)(n_payload >> 8 * (n_bytes - 1 - i));
    return 2 + n_bytes;
}
