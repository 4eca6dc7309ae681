#pragma once
/* The patient's body, as far as the regions of a plan describe it. Knows no dose and no scene. */
#include "core/region/population.h"

struct body {
    uint32_t layer;
    int region; /* the body is this region with those inside it; -1: all regions of the layer */
};

/* Finds the largest region, with those inside it, of the layer whose regions fill the largest volume. Where it holds
 * less than half of what they fill (organs side by side, without an outline around them), all of them are the body.
 * Returns false: no region has a univel. */
bool body_find(const struct region_set *set, struct body *body);
/* "scalp with the regions inside", "all regions of the label layer" */
void body_words(const struct region_set *set, const struct body *body, char words[REGION_NAME_SIZE + 32]);
/* 1 at the univels of the body, else 0; U8 on the layer's grid. One reference, the caller's. errors ERROR_MEMORY */
NODISCARD struct volume *body_labels(const struct region_set *set, const struct body *body, struct error *err);
