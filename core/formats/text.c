/* Reads the lines, keys and numbers of SERA's text files. */
#include "core/formats/text.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

void text_start(struct text *text, const uint8_t *data, size_t size)
{
    *text = (struct text){ .at = (const char *)data, .end = (const char *)data + size, .most_lines = TEXT_MAX_LINES };
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v';
}

static char lower(char c)
{
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

bool text_line(struct text *text, char line[TEXT_LINE_SIZE])
{
    if (text->at >= text->end || text->line >= text->most_lines)
        return false;
    text->line++;
    const char *end = memchr(text->at, '\n', (size_t)(text->end - text->at));
    if (!end)
        end = text->end;
    const char *from = text->at, *to = from;
    while (to < end && *to != '#' && *to != 0)
        to++;
    while (from < to && is_blank(*from))
        from++;
    while (to > from && is_blank(to[-1]))
        to--;
    size_t n = (size_t)(to - from) < TEXT_LINE_SIZE - 1 ? (size_t)(to - from) : TEXT_LINE_SIZE - 1;
    memcpy(line, from, n);
    line[n] = 0;
    text->at = end < text->end ? end + 1 : end;
    return true;
}

static char *trim(char *word)
{
    while (is_blank(*word))
        word++;
    size_t n = strlen(word);
    while (n > 0 && is_blank(word[n - 1]))
        word[--n] = 0;
    return word;
}

bool text_split(char *line, const char *separator, char **key, char **value)
{
    char *at = strstr(line, separator);
    if (!at)
        return false;
    *at = 0;
    *key = trim(line);
    *value = trim(at + strlen(separator));
    size_t n = strlen(*value);
    if (n >= 2 && ((*value)[0] == '\'' || (*value)[0] == '"') && (*value)[n - 1] == (*value)[0]) {
        (*value)[n - 1] = 0;
        *value = trim(*value + 1);
    }
    return true;
}

bool text_number(const char *word, double *value)
{
    char plain[64];
    size_t n = 0;
    bool has_exponent = false, has_digit = false;
    for (const char *c = word; *c; c++) {
        if (n + 2 >= sizeof plain)
            return false;
        if (*c >= '0' && *c <= '9') {
            has_digit = true;
        } else if (*c == 'e' || *c == 'E' || *c == 'd' || *c == 'D') {
            has_exponent = true;
            plain[n++] = 'e';
            continue;
        } else if ((*c == '+' || *c == '-') && has_digit && !has_exponent) {
            has_exponent = true;
            plain[n++] = 'e';
        } else if (*c != '.' && *c != '+' && *c != '-') {
            return false;
        }
        plain[n++] = *c;
    }
    plain[n] = 0;
    char *end;
    errno = 0;
    double number = strtod(plain, &end);
    if (!has_digit || *end != 0 || !isfinite(number))
        return false;
    *value = number;
    return true;
}

bool text_equal(const char *a, const char *b)
{
    while (*a && lower(*a) == lower(*b)) {
        a++;
        b++;
    }
    return lower(*a) == lower(*b);
}

bool text_has_ending(const char *name, const char *ending)
{
    size_t n = strlen(name), m = strlen(ending);
    return n > m && text_equal(name + n - m, ending);
}

/* Length of the valid UTF-8 sequence at c; 0 when there is none. */
static size_t utf8_length(const unsigned char *c)
{
    if (c[0] < 0x80)
        return c[0] >= 32 && c[0] != 127;
    size_t n = c[0] >= 0xc2 && c[0] <= 0xdf ? 2 : (c[0] & 0xf0) == 0xe0 ? 3 : c[0] >= 0xf0 && c[0] <= 0xf4 ? 4 : 0;
    for (size_t i = 1; i < n; i++)
        if ((c[i] & 0xc0) != 0x80)
            return 0;
    if ((c[0] == 0xe0 && c[1] < 0xa0) || (c[0] == 0xed && c[1] > 0x9f) || (c[0] == 0xf0 && c[1] < 0x90) ||
        (c[0] == 0xf4 && c[1] > 0x8f))
        return 0;
    return n;
}

void text_clean(const char *in, char *out, size_t size)
{
    size_t n = 0;
    const unsigned char *c = (const unsigned char *)in;
    while (*c) {
        size_t length = utf8_length(c);
        size_t wide = length ? length : 1;
        if (n + wide >= size)
            break;
        if (length)
            memcpy(out + n, c, length);
        else
            out[n] = '?';
        n += wide;
        c += wide;
    }
    out[n] = 0;
}
