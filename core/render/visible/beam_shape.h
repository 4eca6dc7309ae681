#pragma once
/* Shapes of a drawn beam: its line, arrow head and cross, and the wall of its opening. Knows no scene and no pixels.
 * Any thread. */
#include "core/render/visible/cut.h"
#include "core/scene/beams_drawn.h"
#include "core/surface/shape.h"

/* Which parts. */
struct beam_parts {
    bool has_line;
    const struct beam_opening *opening; /* NULL: not drawn */
};

/* Adds in patient space: the line, an arrow head of four barbs whose tip is the mark, a cross at the target; the
 * opening's edges where it begins and ends, and of an outline of few corners the edges between. Of a draft, line and
 * edges are dashed. errors ERROR_MEMORY */
NODISCARD bool beam_add_lines(const struct beam_drawn *beam, const struct beam_parts *parts, struct cut_lines *lines,
                              struct error *err);
/* Lines as a shape to draw. One reference, the caller's; NULL on failure. errors ERROR_MEMORY, ERROR_LIMIT */
NODISCARD struct shape *beam_lines_shape(const struct cut_lines *lines, struct error *err);
/* The wall of the opening as triangles, open at both ends, from first to last; flat between corners that are not of a
 * circle. One reference, the caller's; NULL on failure. errors those of mesh_create */
NODISCARD struct shape *beam_wall_shape(const struct beam_drawn *beam, const struct beam_opening *opening,
                                        struct error *err);

/* Adds where a plane cuts the wall; dashed of a draft. errors ERROR_MEMORY */
NODISCARD bool beam_add_section(const struct beam_drawn *beam, const struct beam_opening *opening,
                                const struct plane *plane, struct cut_lines *lines, struct error *err);
/* Projects segments on a plane and divides them: within reach_mm of the plane to near, the others to far. Adds to near
 * a ring of this radius where the beam's line crosses the plane, unless it runs along it (within BEAM_ALONG).
 * errors ERROR_MEMORY */
#define BEAM_ALONG 0.02 /* sine of the angle */
NODISCARD bool beam_project(const struct cut_lines *lines, const struct plane *plane, double reach_mm,
                            struct cut_lines *near, struct cut_lines *far, struct error *err);
NODISCARD bool beam_add_crossing(const struct beam_drawn *beam, const struct plane *plane, double radius_mm,
                                 struct cut_lines *lines, struct error *err);
