#pragma once
/* The OpenGL back end: executes draw lists. For render.c alone. */
#include "core/render/visible/back_end.h"
#include "core/render/visible/draw.h"

struct gl_renderer;

/* back_end is one of OpenGL's; is_hardware_wanted leaves out the software devices of RENDER_EGL_DEVICE.
 *   errors  ERROR_GL
 *   thread  the context is current on the calling thread, which makes every other call */
NODISCARD struct gl_renderer *gl_renderer_create(enum render_back_end back_end, bool is_hardware_wanted,
                                                 struct error *err);
void gl_renderer_destroy(struct gl_renderer *renderer);
const struct render_facts *gl_renderer_facts(const struct gl_renderer *renderer);
/* The maker for the cache of its drawables, which is destroyed before the renderer. */
struct drawable_maker gl_renderer_maker(struct gl_renderer *renderer);
/* Its parts of render_begin, render_go_on and render_end. scope and its list are borrowed until the end. Adds to
 * timing. errors  ERROR_GL, ERROR_MEMORY, ERROR_LIMIT, ERROR_RANGE the size of the picture */
struct gl_picture;
struct gl_picture *gl_picture_begin(struct gl_renderer *renderer, const struct draw_scope *scope,
                                    const struct draw_list *list, const struct render_options *options);
NODISCARD enum render_state gl_picture_go_on(struct gl_picture *picture, const struct render_pause *pause,
                                             struct render_timing *timing, struct error *err);
NODISCARD struct image *gl_picture_end(struct gl_picture *picture); /* NULL: not done */
