#pragma once
/* Reads SERA's beam source, .source: the currents of neutrons and photons through a disk by energy group, and equally
 * probable cosines for each group. One source and one spectrum. Works on text in memory. */
#include "core/base/error.h"
#include "core/beam/beam_source.h"

#include <stdint.h>

#define SERA_SOURCE_MAX_BYTES ((uint64_t)1 << 20)

/* Fills the source but for its delimiter, which the file does not have; its name is the file's title.
 *   errors  ERROR_FORMAT, ERROR_RANGE with the line; ERROR_LIMIT; source is then undefined */
NODISCARD bool sera_source_parse(const uint8_t *data, size_t size, const char *name, struct beam_source *source,
                                 struct error *err);
