#pragma once
/* Inside core/formats/dicom: malformed or out-of-range values, as lines of the report. */
#include "core/formats/dicom/dicom_file.h"
#include "core/report/report.h"

/* A line for each DS or IS value of a file that is no number, up to some; the others are counted. Values of the tag
 * but_not are the caller's to look at (0: none). A single one counts as absent for whoever reads it. */
void dicom_numbers_report(const struct dicom_file *file, uint32_t but_not, const char *where, struct report *report);

enum { DICOM_DOUBTS_PLACES = 8, DICOM_DOUBTS_OTHERS = 3 };

/* What was found wrong with one thing (a beam) while it was read: how much, and what is named. Doubts about where it
 * lies are kept apart, so that others cannot take their room. */
struct dicom_doubts {
    size_t n, n_places, n_others; /* all; those named */
    struct {
        uint32_t tag;
        char text[200];
    } places[DICOM_DOUBTS_PLACES];
    char others[DICOM_DOUBTS_OTHERS][200];
};
void dicom_doubt(struct dicom_doubts *doubts, const char *format, ...) PRINTF_LIKE(2, 3);
/* Of an element that says where the thing lies; of each tag the first is named. */
void dicom_doubt_place(struct dicom_doubts *doubts, uint32_t tag, const char *format, ...) PRINTF_LIKE(3, 4);
/* A warning for each that is named, first those about the place, then one with the count of the rest:
 * "Beam "Front": gantry angle (300A,011E) is 400, expected -360 to 360; 40 was taken." */
void dicom_doubts_report(const struct dicom_doubts *doubts, const char *code, const char *who, const char *where,
                         struct report *report);
/* The number of an element, if it is there: in a range, else a doubt that names tag, found and expected, and false. */
bool dicom_number_within(const struct dicom_item *item, uint32_t tag, const char *name, double low, double high,
                         double *value, struct dicom_doubts *doubts);
