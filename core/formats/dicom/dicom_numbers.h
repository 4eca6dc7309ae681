#pragma once
/* Inside core/formats/dicom: reports malformed numbers and numbers out of range. Any thread; report and doubts are the
 * caller's alone. */
#include "core/formats/dicom/dicom_file.h"
#include "core/report/report.h"

/* Adds a report line for each malformed DS or IS value of the file, up to a maximum; the rest are counted in one line.
 * Skips elements of tag but_not (0: none), which the caller checks itself. Readers treat a malformed single value as
 * absent. */
void dicom_numbers_report(const struct dicom_file *file, uint32_t but_not, const char *where, struct report *report);

enum { DICOM_DOUBTS_PLACES = 8, DICOM_DOUBTS_OTHERS = 3 };

/* The doubtful values of one thing (a beam), collected while it is read. Doubts about its position are kept in a list
 * of their own, so that other doubts cannot displace them. */
struct dicom_doubts {
    size_t n, n_places, n_others; /* n: all doubts; n_places and n_others: those kept with their text */
    struct {
        uint32_t tag;
        char text[200];
    } places[DICOM_DOUBTS_PLACES];
    char others[DICOM_DOUBTS_OTHERS][200];
};
void dicom_doubt(struct dicom_doubts *doubts, const char *format, ...) PRINTF_LIKE(2, 3);
/* A doubt about an element that gives a position. Only the first doubt about each tag is kept. */
void dicom_doubt_place(struct dicom_doubts *doubts, uint32_t tag, const char *format, ...) PRINTF_LIKE(3, 4);
/* Reports one warning per doubt kept, positions first, and one with the number of the others. Example: Beam "Front":
 * gantry angle (300A,011E) is 400, expected -360 to 360; 40 was taken. */
void dicom_doubts_report(const struct dicom_doubts *doubts, const char *code, const char *who, const char *where,
                         struct report *report);
/* Reads the number of an element. Returns false if it is absent, or outside low..high; in the second case adds a doubt
 * that names tag, value found and range expected. */
bool dicom_number_within(const struct dicom_item *item, uint32_t tag, const char *name, double low, double high,
                         double *value, struct dicom_doubts *doubts);
