#pragma once
/* Words of a caption for parts of a plan that are used though they do not fit, by a person's word. Any thread. */
#include "core/annotate/annotate.h"
#include "core/scene/snapshot.h"

enum { DESCRIBE_FITS_MAX_ITEMS = 64 };
/* Adds at most DESCRIBE_FITS_MAX_ITEMS items. */
void fits_describe(struct annotations *annotations, const struct snapshot *snapshot);
