#pragma once
/* Numbers about a plan as JSON bodies of the web API. Pure functions; any thread. */
#include "core/render/render.h"
#include "core/surface/mesh_export.h"
#include "server/wire/json.h"

/* {region, algorithm, normals, triangles, vertices, area_mm2, volume_mm3, univel_volume_mm3, n_univels, ms}; NULL with problem */
NODISCARD cJSON *answer_surface(struct plan *plan, size_t region, enum surface_algorithm algorithm, bool is_faceted, struct problem *problem);
/* The same surface as a file of at most PACKET_MAX_BLOB bytes; free(). NULL with problem */
NODISCARD uint8_t *answer_surface_file(struct plan *plan, size_t region, enum surface_algorithm algorithm, bool is_faceted,
                                       enum mesh_format format, size_t *n_bytes, struct problem *problem);
/* {point_lps_mm, regions: [id], images: [{id, value, unit}], doses: [{id, quantity, per_ppm, value, unit, per}]}; innermost region first */
NODISCARD cJSON *answer_probe(const struct plan *plan, struct vec3 point_lps_mm);
/* {hits: [{point_lps_mm, region: id | null, distance_mm}]}, front to back */
NODISCARD cJSON *answer_pick(const struct snapshot *snapshot, double px, double py);
/* {name, note, phantom, readable, reason, parts, n_bytes} */
NODISCARD cJSON *answer_summary(const struct plan_summary *summary);
/* {back_end, vendor, renderer, version, is_software} */
NODISCARD cJSON *answer_gl(const struct render_facts *facts, bool is_stub);
/* The cameras a view starts from, by kind. */
NODISCARD cJSON *answer_home(const struct plan *plan);
