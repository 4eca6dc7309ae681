#pragma once
/* The beams of a scene as draws: lines and openings in space, and where they lie on a slice pane. Clip planes do not
 * cut them: a beam says where it runs, also through what is cut off. */
#include "core/render/visible/draw.h"

/* Appends lines, and openings whose opacity is 1; nothing on a slice pane, and nothing that is not asked for. errors
 * ERROR_MEMORY, those of draw_cache_computed_shape */
NODISCARD bool draw_opaque_beams(struct draw_list *list, const struct draw_scope *scope, struct error *err);
/* Inserts the translucent openings among the translucent shapes, which end the list. */
NODISCARD bool draw_translucent_beams(struct draw_list *list, const struct draw_scope *scope, struct error *err);

/* Appends, on a slice pane: each line projected on the plane, faint, and strong where it lies within half an image's
 * slice of it, with a ring where it crosses the plane; the section of its opening. errors ERROR_MEMORY */
NODISCARD bool draw_beams_on_pane(struct draw_list *list, const struct draw_scope *scope, struct error *err);
/* Frees the lines of DRAW_STROKES. */
void draw_beams_release(struct draw_list *list);

#define DRAW_BEAM_WIDTH_PX 2.0  /* of lines, on the full picture */
#define DRAW_BEAM_FAINT 0.45    /* opacity of a projected line away from the plane */
#define DRAW_BEAM_CROSSING_PX 5 /* radius of the ring where a line crosses the plane, on the full picture */
