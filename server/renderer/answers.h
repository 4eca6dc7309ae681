#pragma once
/* Answers to questions about a plan and a scene, as JSON bodies of the web API; the caller frees them. Any thread. */
#include "core/derive/subject.h"
#include "core/load/summary.h"
#include "core/render/render.h"
#include "server/wire/shape_query.h"

/* {region, representation, what else decides the shape, triangles, vertices, lines, points, area_mm2, volume_mm3,
 * univel_volume_mm3, n_univels, distance_mean_mm, distance_max_mm, n_bytes, ms}; null where a shape has no such figure.
 * When the query wants a file also its bytes, at most PACKET_MAX_BLOB, to free(). NULL with problem */
NODISCARD cJSON *answer_shape(struct derive *derived, struct subject subject, const struct shape_query *query,
                              uint8_t **file, size_t *n_file, struct problem *problem);
/* {point_lps_mm, regions: [id], images: [{id, value, unit}], doses: [{id, quantity, per_ppm, boron_ppm, value,
 * unit, per, frame_of_reference}]}; innermost region first; boron_ppm and frame_of_reference as in the plan document */
NODISCARD cJSON *answer_probe(const struct plan *plan, struct vec3 point_lps_mm);
/* {hits: [{point_lps_mm, region: id | null, distance_mm}]}, front to back */
NODISCARD cJSON *answer_pick(const struct snapshot *snapshot, double px, double py);
/* {name, note, phantom, readable, reason, parts, n_bytes} */
NODISCARD cJSON *answer_summary(const struct plan_summary *summary);
/* {back_end, vendor, renderer, version, is_software} */
NODISCARD cJSON *answer_gl(const struct render_facts *facts, bool is_stub);
