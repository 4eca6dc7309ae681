/* Codes and values of sentences: sentence.h. */
#include "core/sentence/sentence.h"

#include <inttypes.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { DEFAULT_PRECISION = 6, NUMBER_SIZE = 400 }; /* of printf; %f of the largest double has 316 digits */

/* The bytes of a character of UTF-8 that begins so. */
static size_t character_length(unsigned char first)
{
    return first < 0xC0 ? 1 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
}

/* The length of text within most bytes (negative: all of it), without a part of a character at its end. As for printf,
 * text need not end within most bytes: nothing behind them is read. */
static size_t whole_length(const char *text, int most)
{
    if (most < 0)
        return strlen(text);
    const size_t n = strnlen(text, (size_t)most);
    size_t last = n; /* behind the beginning of the last character */
    while (last > 0 && ((unsigned char)text[last - 1] & 0xC0) == 0x80)
        last--;
    const bool is_cut = n == (size_t)most && last > 0 && last - 1 + character_length((unsigned char)text[last - 1]) > n;
    return is_cut ? last - 1 : n;
}

bool sentence_add_text(struct sentence_facts *facts, bool is_first, const char *text, int precision)
{
    if (!text)
        text = "(null)"; /* as printf has it */
    size_t at = strlen(facts->values), n = whole_length(text, precision);
    if (at + n + 2 > sizeof facts->values)
        return false;
    if (!is_first)
        facts->values[at++] = SENTENCE_BREAK;
    for (size_t i = 0; i < n; i++)
        facts->values[at++] = text[i] == SENTENCE_BREAK ? ' ' : text[i];
    facts->values[at] = '\0';
    return true;
}

bool sentence_add_number(struct sentence_facts *facts, bool is_first, const struct sentence_place *place, double number)
{
    char text[NUMBER_SIZE];
    int precision = place->precision < 0 ? DEFAULT_PRECISION : place->precision;
    if (!isfinite(number))
        text[0] = '\0';
    else if (place->type == SENTENCE_GENERAL)
        (void)snprintf(text, sizeof text, "%.*g", precision, number);
    else
        (void)snprintf(text, sizeof text, "%.*f", place->type == SENTENCE_FIXED ? precision : 0, number);
    return sentence_add_text(facts, is_first, text, -1);
}

static bool add_whole(struct sentence_facts *facts, bool is_first, uint64_t number, bool is_negative)
{
    char text[32];
    (void)snprintf(text, sizeof text, "%s%" PRIu64, is_negative ? "-" : "", number);
    return sentence_add_text(facts, is_first, text, -1);
}

static bool add_signed(struct sentence_facts *facts, bool is_first, long long number)
{
    return add_whole(facts, is_first, number < 0 ? 0 - (uint64_t)number : (uint64_t)number, number < 0);
}

const struct sentence *sentence_find(const char *code)
{
    for (size_t i = 0; i < n_sentences; i++)
        if (strcmp(sentences[i].code, code) == 0)
            return &sentences[i];
    return NULL;
}

static const char behind_subject[] = "%s ";

/* has_subject: the format is what stands behind "%s ". */
static const struct sentence *of_format(const char *format, bool has_subject)
{
    size_t n = has_subject ? sizeof behind_subject - 1 : 0;
    for (size_t i = 0; i < n_sentences; i++)
        if (strncmp(sentences[i].format, behind_subject, n) == 0 && strcmp(sentences[i].format + n, format) == 0)
            return &sentences[i];
    return NULL;
}

/* subject: the first value; NULL: it is one of the arguments. */
static void describe(struct sentence_facts *facts, const char *subject, const char *format, va_list args)
{
    *facts = (struct sentence_facts){ 0 };
    const struct sentence *sentence = of_format(format, subject != NULL);
    bool fits = sentence != NULL && (!subject || sentence_add_text(facts, true, subject, -1));
    for (int i = subject ? 1 : 0; fits && i < sentence->n_places; i++) {
        const struct sentence_place *place = &sentence->places[i];
        switch (place->type) {
        case SENTENCE_TEXT:
            fits = sentence_add_text(facts, i == 0, va_arg(args, const char *), place->precision);
            break;
        case SENTENCE_INT: fits = add_signed(facts, i == 0, va_arg(args, int)); break;
        case SENTENCE_LONG: fits = add_signed(facts, i == 0, va_arg(args, long)); break;
        case SENTENCE_LLONG: fits = add_signed(facts, i == 0, va_arg(args, long long)); break;
        case SENTENCE_UINT: fits = add_whole(facts, i == 0, va_arg(args, unsigned), false); break;
        case SENTENCE_ULONG: fits = add_whole(facts, i == 0, va_arg(args, unsigned long), false); break;
        case SENTENCE_ULLONG: fits = add_whole(facts, i == 0, va_arg(args, unsigned long long), false); break;
        case SENTENCE_SIZE: fits = add_whole(facts, i == 0, va_arg(args, size_t), false); break;
        case SENTENCE_UINT32: fits = add_whole(facts, i == 0, va_arg(args, uint32_t), false); break;
        case SENTENCE_UINT64: fits = add_whole(facts, i == 0, va_arg(args, uint64_t), false); break;
        case SENTENCE_FIXED:
        case SENTENCE_GENERAL: fits = sentence_add_number(facts, i == 0, place, va_arg(args, double)); break;
        }
    }
    if (fits)
        (void)snprintf(facts->code, sizeof facts->code, "%s", sentence->code);
    else
        *facts = (struct sentence_facts){ 0 };
}

void sentence_describe(struct sentence_facts *facts, const char *format, va_list args)
{
    describe(facts, NULL, format, args);
}

void sentence_describe_of(struct sentence_facts *facts, const char *subject, const char *format, va_list args)
{
    describe(facts, subject, format, args);
}
