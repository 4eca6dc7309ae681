#pragma once
/* The dose of an annotated picture in words: what is shown and in which unit, what 100 % is, with which weights, what
 * is missing, its levels; and the labels on its lines. */
#include "core/annotate/annotate.h"
#include "core/scene/snapshot.h"

enum { DESCRIBE_DOSE_MAX_ITEMS = 104 };
/* Adds items of the rows ANNOTATION_DOSE and ANNOTATION_LEVELS, at most DESCRIBE_DOSE_MAX_ITEMS; none if the scene
 * shows nothing of a dose. */
void dose_describe(struct annotations *annotations, const struct snapshot *snapshot);
/* True if the scene wants something of a dose to be seen, which then has items. */
bool dose_is_described(const struct snapshot *snapshot);
/* Adds the labels of the isodose lines of a picture that is as wide. errors ERROR_MEMORY */
NODISCARD bool dose_label(struct annotations *annotations, const struct snapshot *snapshot, int width_px,
                          struct error *err);
