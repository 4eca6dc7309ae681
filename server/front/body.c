/* Finds the end of a request body, byte by byte. */
#include "server/front/body.h"

#include <string.h>

void body_begin(struct body *body, bool is_chunked, uint64_t length)
{
    *body = (struct body){ .place = is_chunked   ? BODY_SIZE
                                    : length > 0 ? BODY_DATA
                                                 : BODY_ENDED,
                           .is_chunked = is_chunked,
                           .n_left = length };
}

static int digit_of(char byte)
{
    if (byte >= '0' && byte <= '9')
        return byte - '0';
    if (byte >= 'a' && byte <= 'f')
        return byte - 'a' + 10;
    return byte >= 'A' && byte <= 'F' ? byte - 'A' + 10 : -1;
}

static bool refuse(struct problem *problem, char found, const char *expected)
{
    return problem_set(problem, PROBLEM_REQUEST, "", "", "the chunked body has the byte 0x%02x; expected is %s",
                       (unsigned)(unsigned char)found, expected);
}

/* A byte of the line in front of a chunk: its size and extensions. */
static bool read_size_byte(struct body *body, char byte, struct problem *problem)
{
    int digit = digit_of(byte);
    if (++body->n_line > BODY_MAX_CHUNK_LINE)
        return problem_set(problem, PROBLEM_REQUEST, "", "",
                           "a chunk's first line has more than %d bytes; at most so many are read",
                           BODY_MAX_CHUNK_LINE);
    if (body->place == BODY_SIZE_LF) {
        if (byte != '\n')
            return refuse(problem, byte, "the end of the line, CR and LF, after a chunk's size");
        body->place = body->n_left > 0 ? BODY_DATA : BODY_TRAILER;
        body->n_line = 0;
        body->is_line_empty = true;
        return true;
    }
    if (byte == '\r' && body->n_digits > 0) {
        body->place = BODY_SIZE_LF;
        return true;
    }
    if (body->place == BODY_EXTENSION)
        return (unsigned char)byte >= 32 || byte == '\t' ||
               refuse(problem, byte, "no control character in a chunk's extension");
    if (byte == ';' && body->n_digits > 0) {
        body->place = BODY_EXTENSION;
        return true;
    }
    if (digit < 0)
        return refuse(problem, byte, "a chunk's size in hexadecimal digits, then CR and LF");
    if (++body->n_digits > BODY_MAX_CHUNK_DIGITS)
        return problem_set(problem, PROBLEM_REQUEST, "", "",
                           "a chunk's size has more than %d digits; at most so many are read", BODY_MAX_CHUNK_DIGITS);
    body->n_left = body->n_left * 16 + (uint64_t)digit;
    return true;
}

/* A byte of the fields after the last chunk, up to the empty line. They are not used. */
static bool read_trailer_byte(struct body *body, char byte, struct problem *problem)
{
    if (++body->n_line > BODY_MAX_TRAILERS)
        return problem_set(problem, PROBLEM_HEADERS_TOO_LARGE, "", "",
                           "more than %d bytes come after the last chunk; at most so many are read", BODY_MAX_TRAILERS);
    if (body->place == BODY_TRAILER_LF) {
        if (byte != '\n')
            return refuse(problem, byte, "LF after a CR");
        body->place = body->is_line_empty ? BODY_ENDED : BODY_TRAILER;
        body->is_line_empty = true;
    } else if (byte == '\r') {
        body->place = BODY_TRAILER_LF;
    } else if ((unsigned char)byte < 32 && byte != '\t') {
        return refuse(problem, byte, "no control character after the last chunk");
    } else {
        body->is_line_empty = false;
    }
    return true;
}

static bool read_framing_byte(struct body *body, char byte, struct problem *problem)
{
    switch (body->place) {
    case BODY_SIZE:
    case BODY_EXTENSION:
    case BODY_SIZE_LF: return read_size_byte(body, byte, problem);
    case BODY_DATA_CR:
    case BODY_DATA_LF:
        if (byte != (body->place == BODY_DATA_CR ? '\r' : '\n'))
            return refuse(problem, byte, "the end of the chunk, CR and LF");
        if (body->place == BODY_DATA_CR) {
            body->place = BODY_DATA_LF;
        } else {
            body->place = BODY_SIZE;
            body->n_line = body->n_digits = 0;
        }
        return true;
    case BODY_TRAILER:
    case BODY_TRAILER_LF: return read_trailer_byte(body, byte, problem);
    case BODY_DATA:
    case BODY_ENDED: break;
    }
    return true;
}

bool body_take(struct body *body, const char *bytes, size_t n, size_t *n_taken, struct problem *problem)
{
    size_t at = 0;
    while (at < n && body->place != BODY_ENDED) {
        if (body->place == BODY_DATA) {
            size_t n_data = n - at < body->n_left ? n - at : (size_t)body->n_left;
            at += n_data;
            body->n_left -= n_data;
            if (body->n_left == 0)
                body->place = body->is_chunked ? BODY_DATA_CR : BODY_ENDED;
        } else if (!read_framing_byte(body, bytes[at++], problem)) {
            return false;
        }
    }
    *n_taken = at;
    return true;
}
