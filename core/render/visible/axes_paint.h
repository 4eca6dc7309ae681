#pragma once
/* Paints the patient axes over a finished picture into space, in the form that the scene has. */
#include "core/render/visible/space_pen.h"

void axes_paint(const struct space_pen *pen, uint32_t rgb, double width_px);
