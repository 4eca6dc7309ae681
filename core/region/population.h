#pragma once
/* Which univels a region's figures are of: its own without those of the regions inside it, or all that it holds. Knows
 * no dose and no scene. */
#include "core/region/region.h"

enum region_population {
    POPULATION_OWN,  /* own univels, without regions inside */
    POPULATION_WHOLE /* whole region: its own univels and those of the regions inside it */
};

/* "own univels, without regions inside", "whole region" */
const char *population_words(enum region_population population);
/* The usual population of a set's regions: POPULATION_OWN where all share one layer, so that each univel has one label;
 * POPULATION_WHOLE where they lie over each other. */
enum region_population population_usual(const struct region_set *set);

/* True if the population is the univels with the region's label, no more and no fewer. */
bool population_is_label(const struct region_set *set, size_t region, enum region_population population);

/* 1 at the univels of a region's population, else 0; U8 on the grid of its layer.
 *
 *   whole    adds the regions inside on the same layer; a region inside on another layer only if the region's own
 *            univels hold less than half of it: elsewhere the region was drawn over it, and its own univels are whole
 *   own      takes away the univels of regions inside on other layers; on another grid those whose centre lies in one
 *   returns  one reference, the caller's
 *   errors   ERROR_RANGE no such region; ERROR_MEMORY
 *   thread   any; the set is frozen */
NODISCARD struct volume *population_labels(const struct region_set *set, size_t region,
                                           enum region_population population, struct error *err);
