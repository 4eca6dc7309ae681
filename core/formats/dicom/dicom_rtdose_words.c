/* Finds the component of a BNCT dose, and the ppm of boron-10, in the description of an RT Dose object. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/formats/dicom/dicom_rtdose.h"
#include "core/formats/dose_words.h"
#include "core/formats/text.h"

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
        struct dose_words words;
        dose_words_read(text, &words);
        if (!words.has_quantity || words.is_error)
            return false;
        found = words.quantity;
        found_ppm = words.is_per_ppm && !(words.ppm > 0) ? 1 : words.ppm;
    }
    *quantity = found;
    *ppm = found_ppm;
    return true;
}
