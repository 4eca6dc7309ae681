#pragma once
/* The renderer: a snapshot to an image, by OpenGL or by our own software rasteriser. Leaks no GL. */
#include "core/render/visible/back_end.h"
#include "core/scene/camera.h"

/* "auto", "egl-device", "egl-surfaceless", "osmesa", "soft" */
const char *render_back_end_word(enum render_back_end back_end);
bool render_back_end_from_word(const char *word, enum render_back_end *back_end);

struct renderer;

/* Starts the back end. RENDER_AUTO takes OpenGL if a graphics card draws a correct test pixel, else our own software
 * rasteriser, which is several times faster than OpenGL in software. A back end of OpenGL that is asked for by name may
 * be a software one.
 *   errors  ERROR_GL with the message of each back end that was tried
 *   thread  the calling thread becomes the render thread, which makes every other call (asserted) */
NODISCARD struct renderer *renderer_create(enum render_back_end back_end, struct error *err);
void renderer_destroy(struct renderer *renderer);
const struct render_facts *renderer_facts(const struct renderer *renderer);
/* For tests and benches of the software rasteriser: how many threads draw (1..64), and whether instructions of newer
 * processors are left out. Other back ends ignore it. */
void renderer_tune(struct renderer *renderer, int n_threads, bool is_portable);

/* The picture, RGBA, opaque, row 0 at the top; the caller's. Uploads shapes and images on first use and keeps them, at
 * most until renderer_forget. errors ERROR_GL, ERROR_MEMORY, ERROR_LIMIT, ERROR_RANGE, ERROR_UNSUPPORTED, and those of
 * derive_shape */
NODISCARD struct image *render_snapshot(struct renderer *renderer, const struct snapshot *snapshot,
                                        const struct render_options *options, struct camera *camera,
                                        struct render_timing *timing, struct error *err);

/* Draws a picture in parts, so that a long one can be paused while others are drawn: begin, go on until it is done or
 * has failed, end. Several pictures may be begun at a time. Pauses do not change the picture. */
struct render_picture;
NODISCARD struct render_picture *render_begin(struct renderer *renderer, const struct snapshot *snapshot,
                                              const struct render_options *options);
/* Draws at least one part of the picture, and more until a pause is due (NULL: never). Not called again once the
 * picture is done or has failed. errors as render_snapshot */
NODISCARD enum render_state render_go_on(struct render_picture *picture, const struct render_pause *pause,
                                         struct error *err);
/* Frees the picture, done or not. Returns the image; NULL if it is not done. Always fills camera and timing, which
 * counts the time spent on this picture alone. */
NODISCARD struct image *render_end(struct render_picture *picture, struct camera *camera, struct render_timing *timing);

/* Drops everything that is kept of a plan. Called before the plan is destroyed, while no picture is begun. */
void renderer_forget(struct renderer *renderer, const struct plan *plan);
