/* Finds the component of a BNCT dose, and the ppm of boron-10, in the description of an RT Dose object. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/formats/dicom/dicom_rtdose.h"
#include "core/formats/text.h"

enum { MOST_WORDS = 16, WORD_SIZE = 20 };

struct words {
    char words[MOST_WORDS][WORD_SIZE]; /* lower case, letters and digits */
    size_t n;
};

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* Splits into letter groups and numbers, lower case: "B-10 dose (15.5ppm)" gives b 10 dose 15.5 ppm. */
static void split_words(const char *text, struct words *words)
{
    words->n = 0;
    for (const char *c = text; *c && words->n < MOST_WORDS;) {
        bool is_number = is_digit(*c);
        size_t n = 0;
        const char *from = c;
        while (is_number ? is_digit(*c) || (*c == '.' && is_digit(c[1])) : is_letter(*c))
            c++;
        for (const char *at = from; at < c && n < WORD_SIZE - 1; at++)
            words->words[words->n][n++] = *at >= 'A' && *at <= 'Z' ? (char)(*at - 'A' + 'a') : *at;
        words->words[words->n][n] = 0;
        words->n += n > 0;
        if (c == from)
            c++;
    }
}

static bool has_word(const struct words *words, const char *word)
{
    for (size_t i = 0; i < words->n; i++)
        if (strcmp(words->words[i], word) == 0)
            return true;
    return false;
}

/* Two neighbouring words in either order: B-10, 10B. */
static bool has_pair(const struct words *words, const char *one, const char *other)
{
    for (size_t i = 0; i + 1 < words->n; i++)
        if ((strcmp(words->words[i], one) == 0 && strcmp(words->words[i + 1], other) == 0) ||
            (strcmp(words->words[i], other) == 0 && strcmp(words->words[i + 1], one) == 0))
            return true;
    return false;
}

/* Returns true if the words name exactly one component. A neutron dose without another word counts as fast: the part
 * that comes from neither boron nor gammas. */
static bool quantity_from_words(const struct words *words, enum dose_quantity *quantity)
{
    bool is_neutron = has_word(words, "neutron") || has_word(words, "neutrons");
    bool is_found[DOSE_N_QUANTITIES] = { false };
    is_found[DOSE_BORON] = has_word(words, "boron") || has_pair(words, "b", "10");
    is_found[DOSE_NITROGEN] =
        has_word(words, "nitrogen") || has_pair(words, "n", "14") || (is_neutron && has_word(words, "thermal"));
    is_found[DOSE_FAST] =
        has_word(words, "fast") || has_word(words, "recoil") || has_word(words, "hydrogen") ||
        (is_neutron && !is_found[DOSE_NITROGEN] && !is_found[DOSE_BORON] && !has_word(words, "capture"));
    is_found[DOSE_GAMMA] = has_word(words, "gamma") || has_word(words, "gammas") || has_word(words, "photon") ||
                           has_word(words, "photons");
    size_t n = 0;
    for (int i = 0; i < DOSE_N_QUANTITIES; i++)
        if (is_found[i]) {
            *quantity = (enum dose_quantity)i;
            n++;
        }
    if (n == 0 && has_word(words, "total")) {
        *quantity = DOSE_TOTAL;
        n = 1;
    }
    return n == 1;
}

/* The number directly before "ppm"; NaN if there is none. */
static double ppm_from_words(const struct words *words)
{
    double ppm;
    for (size_t i = 1; i < words->n; i++)
        if (strcmp(words->words[i], "ppm") == 0 && text_number(words->words[i - 1], &ppm) && ppm > 0)
            return ppm;
    return NAN;
}

/* Parses "BNCT:quantity;key=value;...". */
static bool component_by_grammar(const char *text, enum dose_quantity *quantity, double *ppm)
{
    if (strncmp(text, "BNCT:", 5) != 0)
        return false;
    char rest[80], *field, *next = rest;
    snprintf(rest, sizeof rest, "%s", text + 5);
    bool is_first = true;
    while ((field = next)) {
        next = strchr(field, ';');
        if (next)
            *next++ = 0;
        while (*field == ' ')
            field++;
        field[strcspn(field, " ")] = 0;
        double value;
        if (is_first && !dose_quantity_from_word(field, quantity))
            return false;
        if (!is_first && strncmp(field, "ppm=", 4) == 0 && text_number(field + 4, &value) && value > 0)
            *ppm = value;
        is_first = false;
    }
    return true;
}

bool rtdose_component_from_text(const char *text, enum dose_quantity *quantity, double *ppm, bool *is_stated)
{
    enum dose_quantity found;
    double found_ppm = NAN;
    *is_stated = component_by_grammar(text, &found, &found_ppm);
    if (!*is_stated) {
        struct words words;
        split_words(text, &words);
        if (!quantity_from_words(&words, &found))
            return false;
        found_ppm = ppm_from_words(&words);
    }
    *quantity = found;
    *ppm = found_ppm;
    return true;
}
