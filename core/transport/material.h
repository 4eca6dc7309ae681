#pragma once
/* Tissue composition: density, weight fractions, boron. Facts by region name, which people may replace. Knows no
 * cross-sections. Any thread. */
#include "core/base/error.h"

enum element {
    ELEMENT_H,
    ELEMENT_C,
    ELEMENT_N,
    ELEMENT_O,
    ELEMENT_NA,
    ELEMENT_MG,
    ELEMENT_P,
    ELEMENT_S,
    ELEMENT_CL,
    ELEMENT_K,
    ELEMENT_CA,
    N_ELEMENTS
};

enum { MATERIAL_MAX = 32, MATERIAL_WORD_SIZE = 24 };
#define MATERIAL_MAX_G_CM3 20.0
#define MATERIAL_MAX_PPM 1e6

struct material {
    char word[MATERIAL_WORD_SIZE]; /* "brain", "skin", ... */
    double g_cm3;
    double weight[N_ELEMENTS]; /* weight fractions; what is missing to 1 is left out, as a thousandth of iron */
    double boron_ppm;          /* boron-10, ug per g of tissue */
};

/* Fills a material of ICRU reports 44 and 46 (water: H2O) by its word, without boron. ERROR_NOT_FOUND names the words.
 */
NODISCARD bool material_of_word(const char *word, struct material *material, struct error *err);
/* Sets an element's weight fraction by its symbol, "Na". ERROR_NOT_FOUND: none of those that are followed. */
NODISCARD bool material_set_element(struct material *material, const char *symbol, double fraction, struct error *err);
/* The word of the material that a region's name suggests: "Scalp" gives "skin", "left maxillary sinus" "air". "": a
 * structure that only shapes a dose, "PTV_avoid", without a material of its own. NULL if the name tells nothing, for
 * the caller to choose one and to say so. */
const char *material_word_of_region(const char *region_name);
/* ERROR_RANGE: density above 0 to MATERIAL_MAX_G_CM3, each fraction 0 to 1, their sum 0.98 to 1.02 (or 0: boron alone),
 * boron 0 to MATERIAL_MAX_PPM; all finite. */
NODISCARD bool material_check(const struct material *material, struct error *err);
