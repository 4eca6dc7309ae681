/* Reads the DVH Sequence of an RT Dose object. */
#include "core/formats/dicom/dicom_rtdose_dvh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

enum {
    DVH_SEQUENCE = DICOM_TAG(0x3004, 0x0050),
    DVH_TYPE = DICOM_TAG(0x3004, 0x0001),
    DOSE_UNITS = DICOM_TAG(0x3004, 0x0002),
    DOSE_SCALING = DICOM_TAG(0x3004, 0x0052),
    VOLUME_UNITS = DICOM_TAG(0x3004, 0x0054),
    DVH_DATA = DICOM_TAG(0x3004, 0x0058),
    ROI_SEQUENCE = DICOM_TAG(0x3004, 0x0060),
    CONTRIBUTION = DICOM_TAG(0x3004, 0x0062),
    LOW_DOSE = DICOM_TAG(0x3004, 0x0070),
    HIGH_DOSE = DICOM_TAG(0x3004, 0x0072),
    MEAN_DOSE = DICOM_TAG(0x3004, 0x0074),
    ROI_NUMBER = DICOM_TAG(0x3006, 0x0084),
    MOST_NUMBERS = 1 << 20 /* of a curve; a longer one gives no mean */
};

/* The mean and the volume of a curve: pairs of a bin's width and its volume, or of a cumulative one the volume with at
 * least the dose at the bin's lower edge. False: there is no such curve. */
static bool read_curve(const struct dicom_item *item, double scaling, double *mean, double *volume, struct error *err)
{
    char type[17];
    double *numbers = NULL, sum = 0, all = 0, from = 0;
    size_t n = dicom_numbers(item, DVH_DATA, NULL, 0);
    dicom_text(item, DVH_TYPE, type, sizeof type);
    bool is_cumulative = strcmp(type, "CUMULATIVE") == 0;
    if (n < 2 || n % 2 || n > MOST_NUMBERS || (!is_cumulative && strcmp(type, "DIFFERENTIAL") != 0) ||
        !(numbers = mem_array(n, sizeof *numbers, UINT64_MAX, err)))
        return false;
    (void)dicom_numbers(item, DVH_DATA, numbers, n);
    bool is_good = true;
    for (size_t i = 0; i < n; i += 2) {
        double width = numbers[i] * scaling, next = is_cumulative && i + 2 < n ? numbers[i + 3] : 0,
               part = numbers[i + 1] - next;
        is_good = is_good && isfinite(width) && width >= 0 && isfinite(part) && part >= 0;
        sum += part * (from + width / 2);
        all += part;
        from += width;
    }
    free(numbers);
    *mean = sum / all;
    *volume = all;
    return is_good && all > 0;
}

static double number_or_nan(const struct dicom_item *item, uint32_t tag)
{
    double value;
    return dicom_number(item, tag, &value) ? value : NAN;
}

static bool read_item(const struct dicom_item *item, const char *units, struct dose_stated *stated, struct error *err)
{
    char text[17];
    double scaling = 1, mean, volume;
    memset(stated, 0, sizeof *stated);
    const struct dicom_item *roi = dicom_n_items(item, ROI_SEQUENCE) == 1 ? dicom_item_at(item, ROI_SEQUENCE, 0) : NULL;
    if (!roi || !dicom_integer(roi, ROI_NUMBER, &stated->number))
        return false;
    if (dicom_text(roi, CONTRIBUTION, text, sizeof text) && strcmp(text, "INCLUDED") != 0)
        return false;
    if (!dicom_text(item, DOSE_UNITS, text, sizeof text) || strcmp(text, units) != 0)
        return false;
    stated->low = number_or_nan(item, LOW_DOSE);
    stated->mean = number_or_nan(item, MEAN_DOSE);
    stated->high = number_or_nan(item, HIGH_DOSE);
    stated->volume_cm3 = NAN;
    (void)dicom_number(item, DOSE_SCALING, &scaling);
    if (read_curve(item, scaling, &mean, &volume, err)) {
        stated->mean = isnan(stated->mean) ? mean : stated->mean;
        if (dicom_text(item, VOLUME_UNITS, text, sizeof text) && strcmp(text, "CM3") == 0)
            stated->volume_cm3 = volume;
    }
    return isfinite(stated->low) || isfinite(stated->mean) || isfinite(stated->high);
}

bool rtdose_read_dvhs(struct rtdose *dose, const struct dicom_item *root, const char *where, struct report *report,
                      struct error *err)
{
    size_t n = dicom_n_items(root, DVH_SEQUENCE), most = n < DOSE_MAX_STATED ? n : DOSE_MAX_STATED, n_left_out = 0;
    struct error lack = { 0 };
    if (n == 0)
        return true;
    dose->stated = mem_array(most, sizeof *dose->stated, UINT64_MAX, err);
    if (!dose->stated)
        return false;
    for (size_t i = 0; i < n && !lack.code; i++) {
        if (dose->n_stated < most &&
            read_item(dicom_item_at(root, DVH_SEQUENCE, i), dose->units, &dose->stated[dose->n_stated], &lack))
            dose->n_stated++;
        else
            n_left_out++;
    }
    if (lack.code)
        return error_set(err, lack.code, "%s", lack.text);
    if (n_left_out > 0)
        report_add(
            report, REPORT_NOTE, "dose.histograms-left-out", where,
            "%zu of %zu stored histograms are not read: of several regions, in other units than the dose, without figures, or beyond %d.",
            n_left_out, n, DOSE_MAX_STATED);
    return true;
}
