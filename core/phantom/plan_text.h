#pragma once
/* The words of the phantom's folder: plan.json, labels.json and a README for people. Each is NUL-terminated and the
 * caller's to free(); NULL and ERROR_MEMORY on failure. */
#include <stdint.h>

#include "core/base/error.h"

NODISCARD char *phantom_plan_json(uint64_t seed, struct error *err);
NODISCARD char *phantom_labels_json(struct error *err);
NODISCARD char *phantom_readme(const uint32_t size[3], uint64_t seed, struct error *err);
