#pragma once
/* A snapshot to an image. Leaks no GL: OpenGL and a software rasteriser of our own stand behind it, with the same
 * tests. */
#include "core/render/visible/back_end.h"

const char *render_back_end_word(
    enum render_back_end back_end); /* "auto", "egl-device", "egl-surfaceless", "osmesa", "soft" */
bool render_back_end_from_word(const char *word, enum render_back_end *back_end);

struct renderer;

/* Starts the back end. RENDER_AUTO: OpenGL where a graphics card draws a correct test pixel, else our own software
 * rasteriser, which is always there and several times faster than OpenGL in software. Asked for by name, OpenGL may
 * also be a software one. The calling thread becomes the render thread: every other call must come from it (asserted).
 *   errors ERROR_GL with what each back end said */
NODISCARD struct renderer *renderer_create(enum render_back_end back_end, struct error *err);
void renderer_destroy(struct renderer *renderer);
const struct render_facts *renderer_facts(const struct renderer *renderer);
/* For tests and benches of the software rasteriser: how many threads draw (1..64), and whether instructions of newer
 * processors are left out. Other back ends ignore it. */
void renderer_tune(struct renderer *renderer, int n_threads, bool is_portable);

/* The picture, RGBA, opaque, row 0 at the top. Uploads meshes and images on first use and keeps them until
 * renderer_forget. errors ERROR_GL, ERROR_MEMORY, ERROR_RANGE */
NODISCARD struct image *render_snapshot(struct renderer *renderer, const struct snapshot *snapshot,
                                        const struct render_options *options, struct camera *camera,
                                        struct render_timing *timing, struct error *err);

/* The same in pieces, so that a picture that takes long can wait while others are drawn: begin, go on until it is done
 * or has failed, end. Several pictures may be begun. However often one is paused, its bytes are the same. */
struct render_picture;
NODISCARD struct render_picture *render_begin(struct renderer *renderer, const struct snapshot *snapshot,
                                              const struct render_options *options);
/* Draws at least one part of it, and on until a pause is due (NULL: never). Not to be called again once it is done or
 * has failed. errors as render_snapshot */
NODISCARD enum render_state render_go_on(struct render_picture *picture, const struct render_pause *pause,
                                         struct error *err);
/* Frees picture, done or not. The image, or NULL when it is not done; camera and timing (times of its own parts only)
 * are always filled. */
NODISCARD struct image *render_end(struct render_picture *picture, struct camera *camera, struct render_timing *timing);

/* Drops everything kept for a plan; before the plan is destroyed, and while no picture is begun. */
void renderer_forget(struct renderer *renderer, const struct plan *plan);
