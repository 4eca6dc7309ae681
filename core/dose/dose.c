#include "core/dose/dose.h"

#include <string.h>

static const char *const words[DOSE_N_QUANTITIES] = { "total", "boron", "nitrogen", "fast", "gamma" };

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

void dose_finish(struct dose *dose)
{
    for (size_t i = 0; i < dose->n_components; i++)
        volume_unref(dose->components[i].values);
    volume_unref(dose->mask);
    dose->n_components = 0;
    dose->mask = NULL;
}
