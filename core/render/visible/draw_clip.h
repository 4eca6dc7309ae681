#pragma once
/* Which clip planes cut a draw. Knows no pixels. */
#include "core/render/visible/draw.h"

/* All clip planes of the snapshot; none for what the scene exempts, and none in a slice pane. */
struct clip_set draw_clip_set(const struct snapshot *snapshot, bool is_clipped);
/* Leaves out the planes that cut nothing of a box off. False: one of them cuts all of it off. */
bool draw_clip_box(struct clip_set *set, const struct box3 *box);
/* Like draw_clip_box, for the part of a plane within a grid's outer faces. False also if there is no such part. */
bool draw_clip_slice(struct clip_set *set, const struct plane *plane, const struct grid *grid);
/* True if some plane of the set cuts. */
bool draw_clip_cuts(const struct clip_set *set);
/* True if some plane of the set cuts and has no cap: the inside of what it cuts is seen. */
bool draw_clip_opens(const struct clip_set *set);
