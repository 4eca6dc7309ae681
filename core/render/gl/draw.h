#pragma once
/* The passes that make up a picture. Every one leaves blending and culling off. */
#include "core/render/gl/cache.h"
#include "core/render/gl/program.h"
#include "core/render/gl/target.h"
#include "core/render/visible/back_end.h"
#include "core/render/visible/visible.h"

struct gl_frame {
    const struct gl *gl;
    const struct gl_programs *programs;
    struct gl_cache *cache;
    const struct gl_target *target;
    struct gl_layers *layers;
    GLuint no_vertices;            /* vertex array of passes without vertices */
    GLuint polygon_array, polygon; /* vertex array and buffer of slices */
    GLuint palette;                /* texture, label to colour */
    uint8_t (*colors)[4];          /* [VISIBLE_N_LABELS], what is uploaded to it */
    const struct snapshot *snapshot;
    const struct camera *camera;
    enum surface_detail detail;
    float clip_from_lps[16]; /* of the part of the picture being drawn, upside down */
    struct render_timing *timing;
};

/* The regions' shapes: opaque ones front to back, */
NODISCARD bool gl_draw_opaque_shapes(const struct gl_frame *frame, struct error *err);
/* translucent ones, each with its nearest sheet only: each sample in its own order or whole regions, as the scene says.
 * More than GL_LAYERS_MAX of them are taken in groups of as many, in the order of visible_shapes. */
NODISCARD bool gl_draw_translucent_shapes(const struct gl_frame *frame, struct error *err);

/* The image on the slices that are visible in space. */
NODISCARD bool gl_draw_slices_in_space(const struct gl_frame *frame, struct error *err);
/* A slice pane: the image; without one the regions' cross-sections in flat colour. */
NODISCARD bool gl_draw_pane(const struct gl_frame *frame, struct error *err);
