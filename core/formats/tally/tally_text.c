/* Words and numbers of a code's text file. */
#include "core/formats/tally/tally_text.h"

#include "core/formats/text.h"

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\0';
}

bool tally_word(struct tally_line *line, char word[TALLY_WORD_SIZE])
{
    size_t n = 0;
    while (line->at < line->end && is_blank(*line->at))
        line->at++;
    for (; line->at < line->end && !is_blank(*line->at); line->at++)
        if (n < TALLY_WORD_SIZE - 1)
            word[n++] = *line->at;
    word[n] = '\0';
    return n > 0;
}

bool tally_number(struct tally_line *line, double *value)
{
    char word[TALLY_WORD_SIZE];
    return tally_word(line, word) && text_number(word, value);
}

void tally_copy(const struct tally_line *line, char *out, size_t size)
{
    char copy[256];
    const char *at = line->at, *end = line->end;
    while (at < end && is_blank(*at))
        at++;
    while (end > at && is_blank(end[-1]))
        end--;
    size_t n = (size_t)(end - at) < sizeof copy - 1 ? (size_t)(end - at) : sizeof copy - 1;
    for (size_t i = 0; i < n; i++)
        copy[i] = at[i] ? at[i] : ' ';
    copy[n] = '\0';
    text_clean(copy, out, size);
}
