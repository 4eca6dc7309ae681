#pragma once
/* Reads and writes plan.json and the lists of label names. Opens no file. */
#include "core/formats/plan_file.h"
#include "core/report/report.h"

/* Reads plan.json. Unknown keys are reported, not refused.
 *   errors  ERROR_FORMAT not JSON (with the line), not a plan, a value of the wrong type; ERROR_RANGE a path that
 *           leaves the folder, a value out of range; ERROR_LIMIT too many entries; ERROR_UNSUPPORTED another version;
 *           the text names the place, "doses[1].components[0].path" */
NODISCARD struct plan_file *plan_file_parse(const uint8_t *data, size_t size, struct report *report, struct error *err);

/* Reads a list of label names: {"file": "tumour.nii.gz", "labels": [{"value": 1, "name": "scalp", "color": "#e0c0a0",
 * "parent": "...", "id": "scalp", "place": 1, "tissue": {"cbe_boron": 1.3}}]}; "file" may be left out; a colour may
 * also be three numbers of 0 to 1 or 0 to 255. errors ERROR_FORMAT, ERROR_RANGE, ERROR_LIMIT */
NODISCARD bool label_names_parse(const uint8_t *data, size_t size, const char *file, struct label_names *names,
                                 struct error *err);

/* Write the documents that the two readers above read back to equal structs; "" and not-a-number are left out. The
 * caller frees the text. errors ERROR_MEMORY */
NODISCARD char *plan_file_text(const struct plan_file *file, struct error *err);
NODISCARD char *label_names_text(const struct label_names *names, struct error *err);
