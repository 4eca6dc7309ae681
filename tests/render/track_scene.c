/* The plan, the scene and the pictures of the tests of tracks. */
#include "tests/render/track_scene.h"

const struct vec3 tracks_middle = { 0, 0, 0 }, tracks_up = { 0, 0, 1 };
static const struct vec3 front = { 0, -1, 0 }; /* seen from there right is +L, down is -S */
enum { SIDE = 64 };

static double ball_label(struct vec3 p)
{
    return vec3_length(p) <= 28 ? 1 : 0;
}
static double grey_value(struct vec3 p)
{
    return vec3_length(p) < 1000 ? 100 : 0;
}
static const struct made_region ball[] = { { "ball", -1, 0xffffff } };

struct plan *tracks_plan(void)
{
    struct grid grid = made_cube_grid(SIDE);
    struct plan *plan = made_plan(&grid, ball_label, ball, 1);
    made_plan_add_image(plan, &grid, VOXEL_I16, grey_value);
    return plan;
}

struct track_segment *tracks_add(struct plan *plan, enum track_class class, struct vec3 from, struct vec3 to)
{
    struct track_set *set = &plan->tracks;
    set->segments = realloc(set->segments, (set->n_segments + 1) * sizeof *set->segments);
    set->segments[set->n_segments] = (struct track_segment){
        .from_lps_mm = { (float)from.x, (float)from.y, (float)from.z },
        .to_lps_mm = { (float)to.x, (float)to.y, (float)to.z },
        .class = (uint8_t) class,
        .energy_mev = NAN,
    };
    set->n_of_class[class]++;
    return &set->segments[set->n_segments++];
}

struct scene tracks_scene(const struct plan *plan)
{
    struct scene scene = shots_scene(plan);
    shots_style(&scene, "ball")->visible = false;
    scene.tracks.visible = true;
    scene.tracks.width_px = 1;
    scene.tracks.depth_cue = false;
    return scene;
}

struct view tracks_front_view(void)
{
    return shots_view_from(tracks_middle, front, tracks_up, TRACKS_PX_PER_MM);
}

struct image *tracks_take(struct plan *plan, const struct scene *scene, struct view view, bool is_still)
{
    struct render_options options = { view.size_px[0], view.size_px[1], SURFACE_FULL, is_still };
    struct scene copy;
    scene_copy(&copy, scene);
    return shots_take(plan, copy, view, &options, NULL);
}

struct image *tracks_take_alone(struct plan *plan, struct view view, bool is_still)
{
    struct scene scene = tracks_scene(plan);
    struct image *image = tracks_take(plan, &scene, view, is_still);
    scene_finish(&scene);
    return image;
}

bool tracks_is_lit(const struct image *image, int x, int y)
{
    const uint8_t *p = shots_pixel(image, x, y);
    return p[0] != shots_background[0] || p[1] != shots_background[1] || p[2] != shots_background[2];
}

static uint64_t state; /* of tracks_random */

void tracks_random_begin(void)
{
    state = 88172645463325252u;
}

double tracks_random(void)
{
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return (double)(state >> 11) * 0x1p-52 - 1;
}

struct vec3 tracks_random_in_ball(double radius)
{
    for (;;) {
        struct vec3 p = vec3(tracks_random(), tracks_random(), tracks_random());
        if (vec3_dot(p, p) <= 1)
            return vec3_scale(p, radius);
    }
}
