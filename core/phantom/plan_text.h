#pragma once
/* The text files of the phantom's folder: plan.json, labels.json and a README for people. Each function returns a
 * NUL-terminated text, freed by the caller; NULL and ERROR_MEMORY on failure. Any thread. */
#include "core/base/error.h"
#include "core/phantom/phantom_options.h"

NODISCARD char *phantom_plan_json(const struct phantom_options *options, struct error *err);
NODISCARD char *phantom_labels_json(struct error *err);
NODISCARD char *phantom_readme(const struct phantom_options *options, struct error *err);
