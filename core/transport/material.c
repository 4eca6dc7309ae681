/* Compositions of tissue, and which of them a region's name suggests. */
#include "core/transport/material.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

/* Source: ICRU Report 46 (1992) for brain, skin and cranium; ICRU Report 44 (1989) for the rest. Weight fractions of H,
 * C, N, O, Na, Mg, P, S, Cl, K, Ca. Iron (blood, 0.001) is left out. */
static const struct material tissues[] = {
    { "brain", 1.04, { .107, .145, .022, .712, .002, 0, .004, .002, .003, .003, 0 }, 0 },
    { "skin", 1.09, { .100, .204, .042, .645, .002, 0, .001, .002, .003, .001, 0 }, 0 },
    { "cranium", 1.61, { .050, .212, .040, .435, .001, .002, .081, .003, 0, 0, .176 }, 0 },
    { "cortical-bone", 1.92, { .034, .155, .042, .435, .001, .002, .103, .003, 0, 0, .225 }, 0 },
    { "muscle", 1.05, { .102, .143, .034, .710, .001, 0, .002, .003, .001, .004, 0 }, 0 },
    { "adipose", 0.95, { .114, .598, .007, .278, .001, 0, 0, .001, .001, 0, 0 }, 0 },
    { "soft-tissue", 1.06, { .102, .143, .034, .708, .002, 0, .003, .003, .002, .003, 0 }, 0 },
    { "blood", 1.06, { .102, .110, .033, .745, .001, 0, .001, .002, .003, .002, 0 }, 0 },
    { "eye-lens", 1.07, { .096, .195, .057, .646, .001, 0, .001, .003, .001, 0, 0 }, 0 },
    { "lung", 0.26, { .103, .105, .031, .749, .002, 0, .002, .003, .003, .002, 0 }, 0 }, /* inflated, adult */
    { "lung-deflated", 1.05, { .103, .105, .031, .749, .002, 0, .002, .003, .003, .002, 0 }, 0 },
    { "water", 1.00, { .1119, 0, 0, .8881, 0, 0, 0, 0, 0, 0, 0 }, 0 },
};
enum { N_TISSUES = sizeof tissues / sizeof *tissues };
static const char *const symbols[N_ELEMENTS] = { "H", "C", "N", "O", "Na", "Mg", "P", "S", "Cl", "K", "Ca" };

bool material_of_word(const char *word, struct material *material, struct error *err)
{
    for (int i = 0; i < N_TISSUES; i++)
        if (strcasecmp(word, tissues[i].word) == 0) {
            *material = tissues[i];
            return true;
        }
    char words[240] = "";
    size_t length = 0;
    for (int i = 0; i < N_TISSUES && length < sizeof words; i++)
        length += (size_t)snprintf(words + length, sizeof words - length, "%s%.23s", i ? ", " : "", tissues[i].word);
    return error_set(err, ERROR_NOT_FOUND, "'%.24s' is no material; there are air, %s", word, words);
}

bool material_set_element(struct material *material, const char *symbol, double fraction, struct error *err)
{
    for (int i = 0; i < N_ELEMENTS; i++)
        if (strcasecmp(symbol, symbols[i]) == 0) {
            material->weight[i] = fraction;
            return true;
        }
    return error_set(err, ERROR_NOT_FOUND,
                     "'%.3s' is no element that is known; there are H, C, N, O, Na, Mg, P, S, Cl, K, Ca", symbol);
}

/* ---- names of regions --------------------------------------------------------------------------------------------- */

/* How a part lies in a name: at the start of a word, as a whole word, as the first word; a sinus of the skull. */
enum part { STARTS, WHOLE, FIRST, SINUS };

/* In the order in which they are looked for: a cranial nerve is no bone. */
static const struct {
    const char *part;
    enum part how;
    const char *word;
} suggestions[] = {
    { "air", WHOLE, "air" },          { "airway", STARTS, "air" },
    { "sinus", SINUS, "air" },        { "buffer", STARTS, "air" },
    { "void", WHOLE, "air" },         { "outside", WHOLE, "air" },
    { "lens", STARTS, "eye-lens" },   { "scalp", STARTS, "skin" },
    { "skin", STARTS, "skin" },       { "nerve", STARTS, "brain" },
    { "skull", STARTS, "cranium" },   { "crani", STARTS, "cranium" },
    { "bone", STARTS, "cranium" },    { "mandib", STARTS, "cranium" },
    { "maxilla", WHOLE, "cranium" },  { "brain", STARTS, "brain" },
    { "tumo", STARTS, "brain" },      { "gtv", STARTS, "brain" },
    { "ptv", STARTS, "brain" },       { "ctv", STARTS, "brain" },
    { "edema", STARTS, "brain" },     { "oedema", STARTS, "brain" },
    { "target", STARTS, "brain" },    { "chiasm", STARTS, "brain" },
    { "cerebe", STARTS, "brain" },    { "muscle", STARTS, "muscle" },
    { "tongue", STARTS, "muscle" },   { "fat", WHOLE, "adipose" },
    { "blood", STARTS, "blood" },     { "lung", STARTS, "lung" },
    { "water", STARTS, "water" },     { "phantom", STARTS, "water" },
    { "eye", STARTS, "soft-tissue" }, { "parotid", STARTS, "soft-tissue" },
    { "body", FIRST, "soft-tissue" }, { "head", FIRST, "soft-tissue" },
};

enum { MAX_WORDS = 64 };
struct words {
    const char *at[MAX_WORDS];
    size_t length[MAX_WORDS], n;
};

static bool is_small(char c)
{
    return c >= 'a' && c <= 'z';
}

static bool is_capital(char c)
{
    return c >= 'A' && c <= 'Z';
}

/* Letters beyond ASCII count as letters. */
static bool is_letter(char c)
{
    return is_small(c) || is_capital(c) || (unsigned char)c >= 128;
}

/* Runs of letters, "OpticNerve" as two. */
static void split(const char *name, struct words *words)
{
    words->n = 0;
    for (const char *at = name; *at && words->n < MAX_WORDS;) {
        size_t length = 0;
        while (is_letter(at[length]) && !(length > 0 && is_small(at[length - 1]) && is_capital(at[length])))
            length++;
        if (length > 0) {
            words->at[words->n] = at;
            words->length[words->n++] = length;
        }
        at += length > 0 ? length : 1;
    }
}

static bool starts(const struct words *words, size_t i, const char *part)
{
    size_t length = strlen(part);
    return words->length[i] >= length && strncasecmp(words->at[i], part, length) == 0;
}

static bool is_word(const struct words *words, size_t i, const char *part)
{
    return words->length[i] == strlen(part) && starts(words, i, part);
}

/* "Sinuses" too. */
static bool is_skulls_sinus(const struct words *words, size_t i)
{
    static const char *const places[] = { "maxill", "front", "ethmoid", "sphenoid", "paranasal" };
    bool is_of_skull = false;
    for (size_t j = 0; j < words->n; j++)
        for (size_t k = 0; k < sizeof places / sizeof *places; k++)
            is_of_skull |= starts(words, j, places[k]);
    return is_of_skull && (is_word(words, i, "sinus") || is_word(words, i, "sinuses"));
}

/* Cuts off what a name takes away: "brain minus PTV", the PTV of "Lungs-PTV". */
static void cut(const char *name, struct words *words)
{
    for (size_t i = 0; i < words->n; i++) {
        const char *at = words->at[i];
        bool is_minus = is_word(words, i, "minus") || is_word(words, i, "without") || is_word(words, i, "not");
        bool is_taken = at - name >= 2 && at[-1] == '-' && at[-2] != ' ' && words->length[i] >= 3 &&
                        strncasecmp(at + 1, "tv", 2) == 0;
        if (is_minus || is_taken)
            words->n = i;
    }
}

/* A structure around a target or away from it, to shape the dose: it says nothing of the tissue in it. */
static bool is_helper(const char *name, const struct words *words)
{
    for (const char *at = name; *at; at++)
        if (strncasecmp(at, "avoid", 5) == 0)
            return true;
    for (size_t i = 0; i < words->n; i++)
        if (is_word(words, i, "ring") || is_word(words, i, "shell") || (is_word(words, i, "outside") && words->n > 1))
            return true;
    return false;
}

static bool is_suggested(const struct words *words, size_t i, const char *part, enum part how)
{
    switch (how) {
    case STARTS: return starts(words, i, part);
    case WHOLE: return is_word(words, i, part);
    case FIRST: return i == 0 && is_word(words, i, part);
    case SINUS: return is_skulls_sinus(words, i);
    }
    return false;
}

const char *material_word_of_region(const char *region_name)
{
    struct words words;
    split(region_name, &words);
    if (is_helper(region_name, &words))
        return "";
    size_t n_all = words.n;
    cut(region_name, &words);
    for (size_t i = 0; i < sizeof suggestions / sizeof *suggestions; i++)
        for (size_t j = 0; j < words.n; j++)
            if (is_suggested(&words, j, suggestions[i].part, suggestions[i].how))
                return suggestions[i].word;
    return words.n == 0 && n_all > 0 ? "" : NULL;
}

bool material_check(const struct material *material, struct error *err)
{
    if (!(material->g_cm3 > 0 && material->g_cm3 <= MATERIAL_MAX_G_CM3))
        return error_set(err, ERROR_RANGE, "material %s: density %g g/cm3, above 0 to %g expected", material->word,
                         material->g_cm3, MATERIAL_MAX_G_CM3);
    if (!(material->boron_ppm >= 0 && material->boron_ppm <= MATERIAL_MAX_PPM))
        return error_set(err, ERROR_RANGE, "material %s: %g ppm of boron-10, 0 to %g expected", material->word,
                         material->boron_ppm, MATERIAL_MAX_PPM);
    double sum = 0;
    for (int i = 0; i < N_ELEMENTS; i++) {
        if (!(material->weight[i] >= 0 && material->weight[i] <= 1))
            return error_set(err, ERROR_RANGE, "material %s: weight fraction %g of %s, 0 to 1 expected", material->word,
                             material->weight[i], symbols[i]);
        sum += material->weight[i];
    }
    bool is_boron_alone = sum <= 0 && material->boron_ppm > 0;
    return is_boron_alone || (sum >= .98 && sum <= 1.02) ||
           error_set(err, ERROR_RANGE, "material %s: weight fractions add up to %g, 0.98 to 1.02 expected",
                     material->word, sum);
}
