/* Reads one line of SERA's tables of points. */
#include "core/formats/sera/sera_row.h"

#include <math.h>
#include <string.h>

#include "core/formats/text.h"

enum { WIDTH = 10, REGION_WIDTH = 4, N_BEFORE = 4, WORD_SIZE = 32 };
static const double most = 1e30;

static bool is_blank(char c)
{
    return c == ' ' || c == '\t';
}

static size_t count_words(const char *line, size_t n)
{
    size_t n_words = 0;
    for (size_t i = 0; i < n; i++)
        n_words += !is_blank(line[i]) && (i == 0 || is_blank(line[i - 1]));
    return n_words;
}

bool sera_row_is_fixed(const char *line, size_t n, size_t n_values)
{
    size_t full = 3 * WIDTH + REGION_WIDTH + n_values * WIDTH;
    while (n > 0 && is_blank(line[n - 1]))
        n--;
    return n == full || count_words(line, n) != N_BEFORE + n_values;
}

/* Finds the i-th field without its blanks; false when the line ends before it. */
static bool field(const char *line, size_t n, bool is_fixed, size_t i, size_t *from, size_t *to)
{
    if (is_fixed) {
        *from = i < 3 ? i * WIDTH : i == 3 ? 3 * WIDTH : 3 * WIDTH + REGION_WIDTH + (i - N_BEFORE) * WIDTH;
        size_t end = *from + (i == 3 ? REGION_WIDTH : WIDTH);
        *to = end < n ? end : n;
        if (*from >= n)
            return false;
    } else {
        *from = i == 0 ? 0 : *to;
        while (*from < n && is_blank(line[*from]))
            ++*from;
        for (*to = *from; *to < n && !is_blank(line[*to]); ++*to) {
        }
    }
    while (*from < *to && is_blank(line[*from]))
        ++*from;
    while (*from < *to && is_blank(line[*to - 1]))
        --*to;
    return *from < *to;
}

static double number(const char *line, size_t from, size_t to, struct sera_row *row)
{
    char word[WORD_SIZE];
    double value;
    size_t n = to - from;
    if (n < sizeof word) {
        memcpy(word, line + from, n);
        word[n] = 0;
        bool is_number = text_number(word, &value);
        if (is_number && fabs(value) <= most)
            return value;
        if (is_number || strspn(word, "*") == n) {
            row->n_unprinted++;
            return NAN;
        }
    }
    row->n_unread++;
    return NAN;
}

bool sera_row_parse(const char *line, size_t n, bool is_fixed, size_t n_values, struct sera_row *row)
{
    size_t from = 0, to = 0;
    row->n_unprinted = row->n_unread = 0;
    for (size_t i = 0; i < N_BEFORE + n_values; i++) {
        if (!field(line, n, is_fixed, i, &from, &to))
            return false;
        double value = number(line, from, to, row);
        if (i < 3)
            row->at[i] = value;
        else if (i == 3)
            row->region = value == floor(value) && value >= 0 && value <= 9999 ? value : NAN;
        else
            row->values[i - N_BEFORE] = value;
    }
    while (to < n && is_blank(line[to]))
        to++;
    return to == n;
}
