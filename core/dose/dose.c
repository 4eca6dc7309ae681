/* Words and units of dose quantities. */
#include "core/dose/dose.h"

#include <stdio.h>
#include <string.h>

static const char *const words[DOSE_N_QUANTITIES] = {
    [DOSE_TOTAL] = "total",
    [DOSE_BORON] = "boron",
    [DOSE_NITROGEN] = "nitrogen",
    [DOSE_FAST] = "fast",
    [DOSE_GAMMA] = "gamma",
    [DOSE_OTHER] = "other",
    [DOSE_FAST_FLUENCE] = "fast-fluence",
    [DOSE_EPITHERMAL_FLUENCE] = "epithermal-fluence",
    [DOSE_THERMAL_FLUENCE] = "thermal-fluence",
    [DOSE_BLOOD_BORON] = "blood-boron",
    [DOSE_WEIGHTED_TOTAL] = "weighted-total",
};

const char *dose_quantity_word(enum dose_quantity quantity)
{
    return words[quantity];
}

bool dose_quantity_from_word(const char *word, enum dose_quantity *quantity)
{
    for (int i = 0; i < DOSE_N_QUANTITIES; i++)
        if (strcmp(word, words[i]) == 0) {
            *quantity = (enum dose_quantity)i;
            return true;
        }
    return false;
}

static const char *const frame_words[DOSE_N_FRAMES] = {
    [DOSE_FRAME_SAME] = "same", [DOSE_FRAME_UNKNOWN] = "unknown", [DOSE_FRAME_DIFFERS] = "differs"
};

const char *dose_frame_word(enum dose_frame frame)
{
    return frame_words[frame];
}

bool dose_frame_from_word(const char *word, enum dose_frame *frame)
{
    for (int i = 0; i < DOSE_N_FRAMES; i++)
        if (strcmp(word, frame_words[i]) == 0) {
            *frame = (enum dose_frame)i;
            return true;
        }
    return false;
}

bool dose_quantity_is_fluence(enum dose_quantity quantity)
{
    return quantity == DOSE_FAST_FLUENCE || quantity == DOSE_EPITHERMAL_FLUENCE || quantity == DOSE_THERMAL_FLUENCE;
}

void dose_quantity_unit(const char *dose_unit, enum dose_quantity quantity, char unit[DOSE_UNIT_SIZE])
{
    if (dose_quantity_is_fluence(quantity))
        snprintf(unit, DOSE_UNIT_SIZE, "1/cm2");
    else
        snprintf(unit, DOSE_UNIT_SIZE, "%.16s%s", dose_unit,
                 quantity == DOSE_WEIGHTED_TOTAL && dose_unit[0] ? "(w)" : "");
}

void dose_unit_of(const struct dose *dose, enum dose_quantity quantity, char unit[DOSE_UNIT_SIZE])
{
    dose_quantity_unit(dose->unit, quantity, unit);
}

void dose_finish(struct dose *dose)
{
    for (size_t i = 0; i < dose->n_components; i++) {
        volume_unref(dose->components[i].values);
        volume_unref(dose->components[i].error);
    }
    volume_unref(dose->mask);
    dose->n_components = 0;
    dose->mask = NULL;
}
