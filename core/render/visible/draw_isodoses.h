#pragma once
/* Isodose surfaces, and the surface of a region's coverage by the dose, as draws. */
#include "core/render/visible/draw.h"

/* Appends the opaque surfaces, and that of the coverage if its region is shown. Nothing on a slice pane; nothing that
 * is not asked for. errors ERROR_MEMORY, those of draw_cache_computed_shape */
NODISCARD bool draw_opaque_isodoses(struct draw_list *list, const struct draw_scope *scope, struct error *err);
/* Inserts the translucent surfaces among the translucent regions, which end the list: by distance, as regions whose
 * order is 0. */
NODISCARD bool draw_translucent_isodoses(struct draw_list *list, const struct draw_scope *scope, struct error *err);

/* Builds the surfaces that a picture needs, one after the other, on all cores. Calls go_on before each one and stops
 * when it returns false. Failures are met again when the picture is drawn. thread any */
void draw_isodoses_build(const struct snapshot *snapshot, enum surface_detail detail, bool (*go_on)(void *context),
                         void *context);
/* True if the picture needs any. */
bool draw_isodoses_are_wanted(const struct snapshot *snapshot);
