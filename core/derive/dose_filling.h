#pragma once
/* Inside core/derive: the sum of a dose's components in each row of a field, combined brick by brick where and when it
 * is read. Any thread may ask for any part at any time; a brick is combined once. */
#include "core/derive/dose_bricks.h"

struct dose_filling;

/* errors those of dose_field_get */
NODISCARD struct dose_filling *dose_filling_create(const struct plan *plan, const struct dose_choice *choice,
                                                   struct error *err);
void dose_filling_destroy(struct dose_filling *filling);
/* The grid of the sums; is_resampled as in dose_field. */
const struct grid *dose_filling_grid(const struct dose_filling *filling, bool *is_resampled);
/* Takes references to rows, on the grid, whose voxels are not set; takes over near, which is NULL if rows[0] holds
 * everywhere. errors ERROR_MEMORY */
NODISCARD bool dose_filling_start(struct dose_filling *filling, struct volume *const *rows, size_t n_rows,
                                  struct dose_bricks *near, struct error *err);

/* Returns when every row is there that a univel within the part reads. */
void dose_filling_need(struct dose_filling *filling, const struct dose_part *part);
/* Returns when all is there, also rows where no univel reads them; measures the volumes. */
void dose_filling_complete(struct dose_filling *filling);
bool dose_filling_is_complete(const struct dose_filling *filling);
