#pragma once
/* Lines and words of a code's text file, in place and of any length. Inline, but for numbers. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

struct tally_text {
    const char *at, *end;
    size_t line; /* number of the line read last, from 1 */
};
struct tally_line {
    const char *at, *end; /* what is left of it */
    size_t number;
};

static inline void tally_text_start(struct tally_text *text, const uint8_t *data, size_t size)
{
    *text = (struct tally_text){ (const char *)data, (const char *)data + size, 0 };
}
static inline bool tally_next_line(struct tally_text *text, struct tally_line *line)
{
    if (text->at >= text->end)
        return false;
    const char *end = memchr(text->at, '\n', (size_t)(text->end - text->at));
    *line = (struct tally_line){ text->at, end ? end : text->end, ++text->line };
    text->at = end ? end + 1 : text->end;
    return true;
}
/* The place of words in the rest of a line; NULL: not there. */
static inline const char *tally_find(const struct tally_line *line, const char *words)
{
    size_t n = strlen(words);
    for (const char *at = line->at; (size_t)(line->end - at) >= n; at++)
        if (memcmp(at, words, n) == 0)
            return at;
    return NULL;
}
/* Goes behind words; false: they are not there. */
static inline bool tally_skip(struct tally_line *line, const char *words)
{
    const char *at = tally_find(line, words);
    if (at)
        line->at = at + strlen(words);
    return at != NULL;
}

enum { TALLY_WORD_SIZE = 48 };
/* The next word between blanks, cut at its size; false at the end of the line. */
bool tally_word(struct tally_line *line, char word[TALLY_WORD_SIZE]);
/* The next word as a finite number; false: none, or no number. */
bool tally_number(struct tally_line *line, double *value);
/* A copy of the line, cut and cleaned, without outer blanks. */
void tally_copy(const struct tally_line *line, char *out, size_t size);
