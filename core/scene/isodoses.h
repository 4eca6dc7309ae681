#pragma once
/* The isodose surfaces that a snapshot shows, as recipes of results. Any thread. */
#include "core/derive/isodose_shape.h"
#include "core/scene/dose_scale.h"

enum { ISODOSES_MAX = 32 };

struct isodose {
    struct subject subject; /* SUBJECT_ISODOSE; index: of the level in scene.dose.levels */
    struct isodose_choice choice;
    uint32_t color_rgb;
    double opacity; /* above 0 */
};

/* The isodose of a level, shown or not. scale: of the snapshot, with a field. False with a sentence: the level is in
 * percent of an unknown reference. */
NODISCARD bool isodose_of_level(const struct snapshot *snapshot, const struct dose_scale *scale, size_t level,
                                struct isodose *isodose, struct error *why);
/* True if the scene shows any isodose surface in this view, as far as that can be told without the dose. */
bool isodoses_are_shown(const struct snapshot *snapshot);
/* Those that the scene shows in this view; returns how many. */
size_t isodoses_shown(const struct snapshot *snapshot, const struct dose_scale *scale,
                      struct isodose isodoses[ISODOSES_MAX]);
/* How many of them may be translucent. */
size_t isodoses_n_translucent(const struct snapshot *snapshot);
