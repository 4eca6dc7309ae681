#pragma once
/* The draws of a list by OpenGL, into the bound framebuffer. Every function leaves blending and culling off. */
#include "core/render/gl/program.h"
#include "core/render/gl/target.h"
#include "core/render/gl/upload.h"
#include "core/render/visible/draw.h"

/* State for drawing one band of a picture. */
struct gl_frame {
    const struct gl *gl;
    const struct gl_programs *programs;
    struct draw_cache *cache;
    const struct gl_target *target;
    struct gl_layers *layers;
    GLuint no_vertices;             /* vertex array of programs that read no vertices */
    GLuint polygon_array, polygon;  /* vertex array and buffer of slices */
    GLuint segment_array, segments; /* vertex array and buffer of outlines: an instance is a segment, two points */
    GLuint palette;                 /* texture, label to colour */
    GLuint transfer;                /* texture, value to colour and absorption */
    const struct plan *plan;
    const struct draw_list *list;
    const struct camera *camera;
    int view_width_px;       /* of the full picture: widths of lines and sizes of points are in its pixels */
    int first_row, n_rows;   /* of the band's samples in the picture, and of the whole picture */
    float clip_from_lps[16]; /* from patient points to the clip space of the band, upside down */
};

/* errors of all: ERROR_GL, those of draw_cache_grid */
NODISCARD bool gl_draw_shapes(const struct gl_frame *frame, const struct draw *draws, size_t n, struct error *err);
NODISCARD bool gl_draw_image(const struct gl_frame *frame, const struct draw *draw, struct error *err);
NODISCARD bool gl_draw_labels(const struct gl_frame *frame, const struct draw *draw, struct error *err);
/* Leaves the stencil test off and the depth test on. errors also ERROR_MEMORY */
NODISCARD bool gl_draw_cap(const struct gl_frame *frame, const struct draw *draw, struct error *err);
/* Sets a program of the volume's rays, which is in use, and binds the textures of the volume. */
NODISCARD bool gl_set_volume(const struct gl_frame *frame, const struct gl_program *program, const struct draw *draw,
                             struct error *err);
void gl_unset_volume(const struct gl_frame *frame);
/* Shapes whose depth rule is DRAW_DEPTH_LAYER, and perhaps a volume among them. More than GL_LAYERS_MAX are composed in
 * groups of GL_LAYERS_MAX. Leaves the target's framebuffer bound. errors also ERROR_MEMORY */
NODISCARD bool gl_draw_layers(const struct gl_frame *frame, const struct draw *draws, size_t n, struct error *err);
/* Draws where a volume of the method ray has absorbed half of the light, into the depths of the first layer, and leaves
 * its framebuffer bound. Of a depth d that is d / 2, on a cut face (1 + d) / 2, and 1 where it absorbs less. */
NODISCARD bool gl_draw_volume_depth(const struct gl_frame *frame, const struct draw *draw, struct error *err);
