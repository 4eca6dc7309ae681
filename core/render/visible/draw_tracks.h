#pragma once
/* The particle tracks of a scene as a draw: which segments, how wide and how dark. Knows no pixels. */
#include "core/render/visible/draw.h"

/* Appends the tracks of a view into space; none if the scene shows none. errors ERROR_MEMORY */
NODISCARD bool draw_tracks(struct draw_list *list, const struct draw_scope *scope, struct error *err);
