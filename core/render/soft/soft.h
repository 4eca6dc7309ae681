#pragma once
/* The implementation of render.h in plain C, for render.c alone. Draws what core/render/gl draws, by the same rules; knows no GL. */
#include "core/render/render.h"

struct soft_renderer;

struct soft_renderer *soft_renderer_create(void);
void soft_renderer_destroy(struct soft_renderer *renderer);
const struct render_facts *soft_renderer_facts(const struct soft_renderer *renderer);
/* camera: the snapshot's, resolved; timing: zeroed. Equal bytes for any number of threads.
 * errors ERROR_RANGE, ERROR_LIMIT, ERROR_MEMORY, ERROR_UNSUPPORTED */
NODISCARD struct image *soft_renderer_snapshot(struct soft_renderer *renderer, const struct snapshot *snapshot,
                                               const struct render_options *options, const struct camera *camera,
                                               struct render_timing *timing, struct error *err);
void soft_renderer_forget(struct soft_renderer *renderer, const struct plan *plan);

/* For tests and benches: how many threads draw (1..64), and whether what only newer processors have is used. */
void soft_renderer_tune(struct soft_renderer *renderer, int n_threads, bool is_portable);
