#pragma once
/* The words by which people and programs name the components of a BNCT dose: in descriptions of RT Dose objects and in
 * names of files; English and Japanese, some Chinese. The one table of such words. */
#include <stdbool.h>
#include <stddef.h>

#include "core/dose/dose.h"

enum { DOSE_WORDS_REST_SIZE = 128 };

/* Meaning of a text. */
struct dose_words {
    bool has_quantity;           /* exactly one component, or the total, is named */
    enum dose_quantity quantity; /* valid with has_quantity */
    bool is_letter;   /* named by a single letter at the end, "n" or "g", which means something beside B10 alone */
    bool says_dose;   /* "dose" or its like is in it */
    bool is_error;    /* the statistical error of the component: sigma, uncertainty, ... */
    bool is_relative; /* with is_error: relative to the value */
    bool is_per_ppm;  /* "per ppm" */
    double ppm;       /* the number before "ppm"; NaN if there is none */
    char rest[DOSE_WORDS_REST_SIZE]; /* the words that say none of this, in lower case, a blank between them */
};

/* Reads UTF-8 free text, a description: "B-10 dose (15.5 ppm)". */
void dose_words_read(const char *text, struct dose_words *words);
/* Reads a file's name without its endings: "head_B10", "dose_fast_sigma". B and 10 must touch, and a last "n" or "g" is
 * a component. */
void dose_words_read_name(const char *name, struct dose_words *words);
