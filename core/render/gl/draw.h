#pragma once
/* The draws of a list by OpenGL, into the bound framebuffer. Every function leaves blending and culling off. */
#include "core/render/gl/polygon.h"
#include "core/render/gl/program.h"
#include "core/render/gl/target.h"
#include "core/render/gl/upload.h"
#include "core/render/visible/draw.h"
#include "core/render/visible/lights.h"

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
    struct visible_lights lights;
    uint8_t ground[3];       /* what the picture is cleared to */
    double view_line_width;  /* snapshot_line_width: widths of lines and sizes of points are in its unit */
    int first_row, n_rows;   /* of the band's samples in the picture, and of the whole picture */
    float clip_from_lps[16]; /* from patient points to the clip space of the band, upside down */
};

/* Draws a polygon with the program in use, which has the vertex shader slice.vert: at is 0..1 over the grid's outer
 * faces. */
void gl_draw_polygon(const struct gl_frame *frame, const struct grid *grid, const struct gl_polygon *polygon);

/* errors of all: ERROR_GL, those of draw_cache_grid */
NODISCARD bool gl_draw_shapes(const struct gl_frame *frame, const struct draw *draws, size_t n, struct error *err);
NODISCARD bool gl_draw_image(const struct gl_frame *frame, const struct draw *draw, struct error *err);
/* Like gl_draw_image, without the image's wash. Stencil and depth rules are the caller's. */
NODISCARD bool gl_draw_bare_image(const struct gl_frame *frame, const struct draw *draw, struct error *err);
NODISCARD bool gl_draw_labels(const struct gl_frame *frame, const struct draw *draw, struct error *err);
/* DRAW_WASH. */
NODISCARD bool gl_draw_wash(const struct gl_frame *frame, const struct draw *draw, struct error *err);
/* Draws a wash over a plane, by the stencil and depth rules that are set. */
NODISCARD bool gl_paint_wash(const struct gl_frame *frame, const struct draw_wash *wash, const struct plane *plane,
                             const struct clip_set *clip, struct error *err);
/* Sets the wash's uniforms and textures of a program with wash.glsl, which is in use. lps_from_place: of its places.
 * wash NULL: only what a program needs that does not call it. */
NODISCARD bool gl_set_wash(const struct gl_frame *frame, const struct gl_program *program, const struct draw_wash *wash,
                           const struct affine *lps_from_place, struct error *err);
/* Sets the uniforms and textures of a shape's texture; the program is in use. */
NODISCARD bool gl_set_texture(const struct gl_frame *frame, const struct gl_program *program, const struct draw *draw,
                              struct error *err);
/* The uniforms of an image's window. */
struct gl_window {
    GLint grey, ends, tone;
};
/* Sets them; of the image low, width, gamma and is_low_white count. */
void gl_set_window(const struct gl *gl, struct gl_window at, const struct gl_grid *texels,
                   const struct draw_image *image);
/* Sets the lights of the program in use; eye space is the camera's. */
void gl_set_lights(const struct gl_frame *frame, const struct gl_program *program);
/* Binds a table of one or two rows of colours by level to the unit; NULL: greys. */
void gl_bind_colors(const struct gl_frame *frame, int unit, const uint32_t *first, const uint32_t *second);
/* Maps 0..1 over a grid's outer faces to patient points. */
struct affine gl_lps_from_faces(const struct grid *grid);
/* errors also ERROR_MEMORY */
NODISCARD bool gl_draw_tracks(const struct gl_frame *frame, const struct draw *draw, struct error *err);
NODISCARD bool gl_draw_marks(const struct gl_frame *frame, const struct draw *draw, struct error *err);
/* Leaves the stencil test off and the depth test on. errors also ERROR_MEMORY */
NODISCARD bool gl_draw_cap(const struct gl_frame *frame, const struct draw *draw, struct error *err);
/* errors also ERROR_MEMORY */
NODISCARD bool gl_draw_isolines(const struct gl_frame *frame, const struct draw *draw, struct error *err);
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
