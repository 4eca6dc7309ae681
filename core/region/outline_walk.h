#pragma once
/* Inside of outline.c, for splines: the two choices that a method makes, each on its own. */
#include "core/region/outline.h"

struct outline_rule {
    bool is_joined;  /* pixels that touch at a corner belong together */
    bool is_between; /* points are the middles of sides, not the centres of pixels */
};

/* As outline_stack. */
NODISCARD struct outline_set *outline_walk(const struct mask *mask, int axis, struct outline_rule rule, int n_threads,
                                           struct error *err);
