#pragma once
/* Help shared by the tests of tracks: a plan with a ball of 28 mm and no tracks yet, and pictures of its tracks. */
#include "tests/render/shots.h"

#define TRACKS_PX_PER_MM 4.0
extern const struct vec3 tracks_middle, tracks_up; /* (0, 0, 0), (0, 0, 1) */

struct plan *tracks_plan(void);
/* Without an energy. The segment stays where it is until the next one is added. */
struct track_segment *tracks_add(struct plan *plan, enum track_class class, struct vec3 from, struct vec3 to);
/* Tracks alone, 1 px wide, without depth cue; scene_finish frees it. */
struct scene tracks_scene(const struct plan *plan);
/* Parallel, seen from the front: right is +L, down is -S; TRACKS_PX_PER_MM. */
struct view tracks_front_view(void);
struct image *tracks_take(struct plan *plan, const struct scene *scene, struct view view, bool is_still);
struct image *tracks_take_alone(struct plan *plan, struct view view, bool is_still);
/* False: the pixel has the background's colour. */
bool tracks_is_lit(const struct image *image, int x, int y);

static inline uint32_t color_of(enum track_class class)
{
    return track_class_look(class).color_rgb;
}

/* Numbers -1 .. 1; the same after each tracks_random_begin, so that all back ends get the same tracks. */
void tracks_random_begin(void);
double tracks_random(void);
struct vec3 tracks_random_in_ball(double radius);
