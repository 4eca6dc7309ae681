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
    { "lung", 1.05, { .103, .105, .031, .749, .002, 0, .002, .003, .003, .002, 0 }, 0 },
    { "water", 1.00, { .1119, 0, 0, .8881, 0, 0, 0, 0, 0, 0, 0 }, 0 },
};
enum { N_TISSUES = sizeof tissues / sizeof *tissues };

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
    static const char *const symbols[N_ELEMENTS] = { "H", "C", "N", "O", "Na", "Mg", "P", "S", "Cl", "K", "Ca" };
    for (int i = 0; i < N_ELEMENTS; i++)
        if (strcasecmp(symbol, symbols[i]) == 0) {
            material->weight[i] = fraction;
            return true;
        }
    return error_set(err, ERROR_NOT_FOUND,
                     "'%.3s' is no element that is known; there are H, C, N, O, Na, Mg, P, S, Cl, K, Ca", symbol);
}

/* Parts of names, in the order in which they are looked for: "maxillary sinus" is air though a maxilla is bone. */
static const struct {
    const char *part, *word;
} suggestions[] = {
    { "air", "air" },          { "sinus", "air" },        { "buffer", "air" },
    { "void", "air" },         { "outside", "air" },      { "lens", "eye-lens" },
    { "scalp", "skin" },       { "skin", "skin" },        { "skull", "cranium" },
    { "crani", "cranium" },    { "bone", "cranium" },     { "mandib", "cranium" },
    { "maxilla", "cranium" },  { "brain", "brain" },      { "tumo", "brain" },
    { "gtv", "brain" },        { "ptv", "brain" },        { "ctv", "brain" },
    { "edema", "brain" },      { "oedema", "brain" },     { "target", "brain" },
    { "nerve", "brain" },      { "chiasm", "brain" },     { "cerebe", "brain" },
    { "muscle", "muscle" },    { "tongue", "muscle" },    { "fat", "adipose" },
    { "blood", "blood" },      { "lung", "lung" },        { "water", "water" },
    { "phantom", "water" },    { "eye", "soft-tissue" },  { "parotid", "soft-tissue" },
    { "body", "soft-tissue" }, { "head", "soft-tissue" },
};

const char *material_word_of_region(const char *region_name)
{
    for (size_t i = 0; i < sizeof suggestions / sizeof *suggestions; i++)
        for (const char *at = region_name; *at; at++)
            if (strncasecmp(at, suggestions[i].part, strlen(suggestions[i].part)) == 0)
                return suggestions[i].word;
    return NULL;
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
            return error_set(err, ERROR_RANGE, "material %s: weight fraction %g, 0 to 1 expected", material->word,
                             material->weight[i]);
        sum += material->weight[i];
    }
    if (!(sum <= 1.02) || sum + material->boron_ppm <= 0)
        return error_set(err, ERROR_RANGE,
                         "material %s: weight fractions add up to %g, at most 1.02 and not 0 expected", material->word,
                         sum);
    return true;
}
