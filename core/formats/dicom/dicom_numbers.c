/* Reports malformed numbers, and collects doubts about the values of one thing. */
#include "core/formats/dicom/dicom_numbers.h"

#include <stdarg.h>
#include <stdio.h>

void dicom_numbers_report(const struct dicom_file *file, uint32_t but_not, const char *where, struct report *report)
{
    enum { MOST = 10 };
    struct dicom_bad_number bad[MOST];
    size_t n = dicom_bad_numbers(dicom_root(file), true, but_not, bad, MOST);
    for (size_t i = 0; i < n && i < MOST; i++)
        report_add(report, REPORT_WARNING, "dicom.bad-number", where,
                   "Element %s: expected a number, found \"%s\"; it is not used.", bad[i].place, bad[i].found);
    if (n > MOST)
        report_add(report, REPORT_WARNING, "dicom.bad-number", where, "%zu more values are no numbers.", n - MOST);
}

void dicom_doubt(struct dicom_doubts *doubts, const char *format, ...)
{
    doubts->n++;
    if (doubts->n_others >= DICOM_DOUBTS_OTHERS)
        return;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(doubts->others[doubts->n_others++], sizeof doubts->others[0], format, arguments);
    va_end(arguments);
}

void dicom_doubt_place(struct dicom_doubts *doubts, uint32_t tag, const char *format, ...)
{
    doubts->n++;
    for (size_t i = 0; i < doubts->n_places; i++)
        if (doubts->places[i].tag == tag)
            return;
    if (doubts->n_places >= DICOM_DOUBTS_PLACES)
        return;
    va_list arguments;
    va_start(arguments, format);
    doubts->places[doubts->n_places].tag = tag;
    vsnprintf(doubts->places[doubts->n_places++].text, sizeof doubts->places[0].text, format, arguments);
    va_end(arguments);
}

bool dicom_number_within(const struct dicom_item *item, uint32_t tag, const char *name, double low, double high,
                         double *value, struct dicom_doubts *doubts)
{
    double found;
    if (!dicom_number(item, tag, &found))
        return false; /* absent, or malformed, which dicom_numbers_report reports */
    if (!(found >= low && found <= high)) {
        dicom_doubt(doubts, "%s (%04X,%04X) is %g, expected %g to %g", name, tag >> 16, tag & 0xFFFF, found, low, high);
        return false;
    }
    *value = found;
    return true;
}

void dicom_doubts_report(const struct dicom_doubts *doubts, const char *code, const char *who, const char *where,
                         struct report *report)
{
    for (size_t i = 0; i < doubts->n_places; i++)
        report_add(report, REPORT_WARNING, code, where, "%s: %s.", who, doubts->places[i].text);
    for (size_t i = 0; i < doubts->n_others; i++)
        report_add(report, REPORT_WARNING, code, where, "%s: %s.", who, doubts->others[i]);
    size_t n_more = doubts->n - doubts->n_places - doubts->n_others;
    if (n_more > 0)
        report_add(report, REPORT_WARNING, code, where, "%s: %zu more such values.", who, n_more);
}
