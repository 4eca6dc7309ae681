#pragma once
/* Reads seraMC's particle tracks, .pp: one segment per line, x0 y0 z0 x1 y1 z1 type energy, in (RL, PA, IS). Works on
 * bytes in memory. The file does not give its unit: seraMC writes millimetres when the univel header is in cm and
 * centimetres when it is in mm. So the patient's size decides. */
#include "core/report/report.h"
#include "core/track/track.h"

enum { PP_MAX_BYTES = 256 << 20 };
#define PP_MAX_PLACE_MM 1e6 /* farthest end point of a segment inside a treatment room */

/* Appends the segments to set, in LPS, in the file's own unit.
 *   errors  ERROR_FORMAT not one line is a segment, ERROR_LIMIT more than TRACK_MAX_SEGMENTS, ERROR_MEMORY */
NODISCARD bool pp_parse(const uint8_t *data, size_t size, const char *name, struct track_set *set,
                        struct report *report, struct error *err);

/* Length of one unit of the segments from first on, in mm: given_mm when the plan gives it (0: it does not), else 1 or
 * 10, whichever brings their spread closer to the patient's size. An empty box gives 1. 0: no memory. */
double pp_unit_mm(const struct track_set *set, size_t first, double given_mm, const struct box3 *patient_lps_mm,
                  const char *name, struct report *report);
/* Scales the segments from first on to millimetres; drops and reports those beyond PP_MAX_PLACE_MM. */
void pp_scale(struct track_set *set, size_t first, double mm, const char *name, struct report *report);
