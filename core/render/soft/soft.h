#pragma once
/* The software back end: executes draw lists on the processor. For render.c alone. Knows no GL. */
#include "core/render/visible/back_end.h"
#include "core/render/visible/draw.h"

struct soft_renderer;
struct soft_frame;

struct soft_renderer *soft_renderer_create(void);
void soft_renderer_destroy(struct soft_renderer *renderer);
const struct render_facts *soft_renderer_facts(const struct soft_renderer *renderer);
/* The maker for the cache of its drawables. */
struct drawable_maker soft_renderer_maker(void);
/* Its parts of render_begin, render_go_on and render_end. scope and its list are borrowed until the end. Adds to
 * timing. The picture has equal bytes for any number of threads and pauses. errors  ERROR_RANGE, ERROR_LIMIT,
 * ERROR_MEMORY */
struct soft_frame *soft_picture_begin(struct soft_renderer *renderer, const struct draw_scope *scope,
                                      const struct draw_list *list, const struct render_options *options);
NODISCARD enum render_state soft_picture_go_on(struct soft_frame *frame, const struct render_pause *pause,
                                               struct render_timing *timing, struct error *err);
NODISCARD struct image *soft_picture_end(struct soft_frame *frame); /* NULL: not done */
/* Frees the buffers that grew with a plan. No picture is begun. */
void soft_renderer_forget(struct soft_renderer *renderer);

/* renderer_tune. */
void soft_renderer_tune(struct soft_renderer *renderer, int n_threads, bool is_portable);
