#pragma once
/* Tables of tones: the colours of the image shown, and of the one blended over it, by grey, with the window's gamma. */
#include "core/render/visible/draw.h"

/* Fills tones[DRAW_TONES], the lowest grey first. colors: as in draw_image. */
void draw_tones_fill(const uint32_t *colors, double gamma, uint32_t tones[DRAW_TONES]);
/* Makes the list's tables where gamma is not 1. errors ERROR_MEMORY */
NODISCARD bool draw_tones(struct draw_list *list, const struct draw_scope *scope, struct error *err);
