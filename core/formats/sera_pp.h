#pragma once
/* seraMC's particle tracks .pp: a line a segment, x0 y0 z0 x1 y1 z1 type energy, in (RL, PA, IS). Works on bytes in
 * memory. seraMC writes millimetres for a header in cm and centimetres for one in mm, and says neither: the patient's
 * size decides. */
#include "core/report/report.h"
#include "core/track/track.h"

enum { PP_MAX_BYTES = 256 << 20 };
#define PP_MAX_PLACE_MM 1e6 /* segments that end further out are no particles of a treatment room */

/* Segments in the file's own unit, already turned to LPS; appended to set.
 *   errors  ERROR_FORMAT not one line is a segment, ERROR_LIMIT more than TRACK_MAX_SEGMENTS, ERROR_MEMORY */
NODISCARD bool pp_parse(const uint8_t *data, size_t size, const char *name, struct track_set *set,
                        struct report *report, struct error *err);

/* Millimetres in the unit of segments from first on: given_mm when the plan says it (0: it does not), else 1 or 10,
 * whichever makes their spread the more like the patient's. An empty box gives 1. */
double pp_unit_mm(const struct track_set *set, size_t first, double given_mm, const struct box3 *patient_lps_mm,
                  const char *name, struct report *report);
/* Into millimetres; segments beyond PP_MAX_PLACE_MM are left out. */
void pp_scale(struct track_set *set, size_t first, double mm, const char *name, struct report *report);
