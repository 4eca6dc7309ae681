/* Convex solids under clip planes, drawn and computed. */
#include "tests/render/cut_scene.h"

static const struct solid *made_of; /* for label_of: the solid that is being voxelised */

static bool holds(const struct solid *solid, struct vec3 p)
{
    struct vec3 d = vec3_sub(p, solid->centre_mm);
    return solid->is_box ? fabs(d.x) < solid->half_mm.x && fabs(d.y) < solid->half_mm.y && fabs(d.z) < solid->half_mm.z
                         : vec3_length(d) < solid->radius_mm;
}

static double label_of(struct vec3 p)
{
    return holds(made_of, p);
}

static double one(struct vec3 p)
{
    (void)p;
    return 1;
}

struct cut_scene cut_scene_create(const struct solid *solids, size_t n, enum scene_representation representation,
                                  enum scene_algorithm algorithm)
{
    struct grid grid = made_cube_grid(56);
    return cut_scene_create_on(&grid, solids, n, representation, algorithm);
}

struct cut_scene cut_scene_create_on(const struct grid *grid, const struct solid *solids, size_t n,
                                     enum scene_representation representation, enum scene_algorithm algorithm)
{
    struct made_region regions[CUT_MAX_SOLIDS];
    static const char *const ids[CUT_MAX_SOLIDS] = { "a", "b", "c", "d", "e" };
    struct cut_scene cut = { .solids = solids, .n_solids = n };
    for (size_t i = 0; i < n; i++)
        regions[i] = (struct made_region){ ids[i], -1, solids[i].rgb };
    made_of = &solids[0];
    cut.plan = made_plan(grid, label_of, regions, n);
    for (size_t i = 0; i < n; i++) {
        made_of = &solids[i];
        if (i > 0)
            cut.plan->regions.layers[i] = made_volume(grid, VOXEL_U8, label_of);
        cut.plan->regions.regions[i].layer = (uint32_t)i;
        cut.plan->regions.regions[i].label = 1;
    }
    cut.plan->regions.n_layers = n;
    region_set_measure(&cut.plan->regions);
    made_plan_add_image(cut.plan, grid, VOXEL_U8, one);
    cut.scene = shots_scene(cut.plan);
    cut.scene.surface.algorithm = algorithm;
    cut.scene.image.window.center = 1;
    cut.scene.image.window.width = 1;
    for (size_t i = 0; i < n; i++) {
        cut.scene.regions[i].value.representation = representation;
        cut.scene.regions[i].value.clipped = !solids[i].is_exempt;
    }
    return cut;
}

void cut_scene_destroy(struct cut_scene *cut)
{
    scene_finish(&cut->scene);
    shots_forget(cut->plan);
}

/* ---- geometry --------------------------------------------------------------------------------------------------- */

struct ray {
    struct vec3 from, along; /* from the near plane, to the far plane at t = 1 */
};

/* The part of a ray within a solid. False: it misses it. */
static bool cross_solid(const struct solid *solid, const struct ray *ray, double *in, double *out)
{
    struct vec3 o = vec3_sub(ray->from, solid->centre_mm), d = ray->along;
    if (!solid->is_box) {
        double a = vec3_dot(d, d), b = vec3_dot(o, d), c = vec3_dot(o, o) - solid->radius_mm * solid->radius_mm;
        double root = b * b - a * c;
        if (root <= 0)
            return false;
        *in = (-b - sqrt(root)) / a;
        *out = (-b + sqrt(root)) / a;
        return true;
    }
    const double o3[3] = { o.x, o.y, o.z }, d3[3] = { d.x, d.y, d.z },
                 half[3] = { solid->half_mm.x, solid->half_mm.y, solid->half_mm.z };
    *in = -INFINITY;
    *out = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        double a = (-half[axis] - o3[axis]) / d3[axis], b = (half[axis] - o3[axis]) / d3[axis];
        *in = fmax(*in, fmin(a, b));
        *out = fmin(*out, fmax(a, b));
    }
    return *in < *out;
}

static bool is_kept(const struct snapshot *snapshot, size_t but, struct vec3 p)
{
    for (size_t i = 0; i < snapshot->n_clips; i++)
        if (i != but && plane_height_mm(&snapshot->clips[i].plane, p) > 0)
            return false;
    return true;
}

static struct vec3 at(const struct ray *ray, double t)
{
    return vec3_add(ray->from, vec3_scale(ray->along, t));
}

/* Returns the first thing that a ray meets: a solid's surface from outside, from inside where a cut opens it, or a cap.
 */
static int meets(const struct cut_scene *cut, const struct snapshot *snapshot, const struct ray *ray)
{
    double nearest = 1, in[CUT_MAX_SOLIDS], out[CUT_MAX_SOLIDS];
    bool is_crossed[CUT_MAX_SOLIDS];
    int seen = SEEN_BACKGROUND;
    for (size_t i = 0; i < cut->n_solids; i++) {
        is_crossed[i] = cross_solid(&cut->solids[i], ray, &in[i], &out[i]);
        for (int side = 0; is_crossed[i] && side < 2; side++) {
            double t = side ? out[i] : in[i];
            if (t <= 0 || t >= nearest || (!cut->solids[i].is_exempt && !is_kept(snapshot, SIZE_MAX, at(ray, t))) ||
                (side && in[i] <= 0))
                continue;
            nearest = t;
            seen = (int)i;
        }
    }
    for (size_t p = 0; p < snapshot->n_clips; p++) {
        const struct plane *plane = &snapshot->clips[p].plane;
        double t = -plane_height_mm(plane, ray->from) / vec3_dot(ray->along, plane->normal);
        if (!snapshot->clips[p].is_capped || !(t > 0 && t < nearest) || !is_kept(snapshot, p, at(ray, t)))
            continue;
        for (size_t i = 0; i < cut->n_solids; i++)
            if (is_crossed[i] && !cut->solids[i].is_exempt && in[i] < t && t < out[i]) {
                nearest = t;
                seen = SEEN_CAP;
            }
    }
    return seen;
}

static struct ray ray_at(const struct mat4 *lps_from_clip, double x, double y, int width_px, int height_px)
{
    double u = 2 * x / width_px - 1, v = 1 - 2 * y / height_px;
    struct vec3 near = mat4_project(lps_from_clip, vec3(u, v, -1)), far = mat4_project(lps_from_clip, vec3(u, v, 1));
    return (struct ray){ near, vec3_sub(far, near) };
}

/* ---- pictures --------------------------------------------------------------------------------------------------- */

static int seen_in(const struct cut_scene *cut, const uint8_t *pixel)
{
    if (memcmp(pixel, shots_background, 3) == 0)
        return SEEN_BACKGROUND;
    if (abs(pixel[0] - CUT_GREY) <= 1 && abs(pixel[1] - CUT_GREY) <= 1 && abs(pixel[2] - CUT_GREY) <= 1)
        return SEEN_CAP;
    if (pixel[0] == 0x14 && pixel[1] == 0x12 && pixel[2] == 0x0f)
        return SEEN_DARK_CAP;
    int best = SEEN_OTHER;
    double most = 0;
    struct vec3 p = vec3_normalize(vec3(pixel[0], pixel[1], pixel[2]));
    for (size_t i = 0; i < cut->n_solids; i++) {
        uint32_t rgb = cut->solids[i].rgb;
        double likeness = vec3_dot(p, vec3_normalize(vec3(rgb >> 16, rgb >> 8 & 255, rgb & 255)));
        if (likeness > most) {
            most = likeness;
            best = (int)i;
        }
    }
    return best;
}

struct cut_counts cut_scene_compare(const struct cut_scene *cut, struct view view, double margin_px, bool is_still)
{
    struct cut_counts counts = { 0 };
    struct error err = { 0 };
    struct camera camera;
    struct render_timing timing;
    char field[128];
    struct scene scene;
    scene_copy(&scene, &cut->scene);
    struct snapshot *snapshot = snapshot_create(derived_of(cut->plan), &scene, &view, 1, field, &err);
    assert_string_equal(err.text, "");
    const struct render_options options = { SHOTS_WIDTH, SHOTS_HEIGHT, SURFACE_FULL, is_still };
    struct image *image = render_snapshot(shots_renderer, snapshot, &options, &camera, &timing, &err);
    assert_string_equal(err.text, "");
    struct mat4 lps_from_clip;
    assert_true(mat4_invert(&camera.clip_from_lps_mm, &lps_from_clip));
    size_t n_cap = 0;
    for (int y = 0; y < SHOTS_HEIGHT; y++)
        for (int x = 0; x < SHOTS_WIDTH; x++) {
            static const double around[5][2] = { { 0, 0 }, { 1, 1 }, { -1, 1 }, { 1, -1 }, { -1, -1 } };
            bool is_one = true, is_something = true;
            int expected = 0;
            for (int i = 0; i < 5; i++) {
                struct ray ray = ray_at(&lps_from_clip, x + 0.5 + margin_px * around[i][0],
                                        y + 0.5 + margin_px * around[i][1], SHOTS_WIDTH, SHOTS_HEIGHT);
                int there = meets(cut, snapshot, &ray);
                expected = i == 0 ? there : expected;
                is_one &= there == expected;
                is_something &= there != SEEN_BACKGROUND;
            }
            int seen = seen_in(cut, shots_pixel(image, x, y));
            counts.n_cracks += is_something && seen == SEEN_BACKGROUND;
            counts.n_cap += seen == SEEN_CAP;
            n_cap += expected == SEEN_CAP;
            counts.n_compared += is_one;
            counts.n_wrong += is_one && seen != expected;
        }
    counts.cap_share = (double)n_cap / (SHOTS_WIDTH * SHOTS_HEIGHT);
    image_destroy(image);
    snapshot_unref(snapshot);
    return counts;
}

/* ---- random scenes ---------------------------------------------------------------------------------------------- */

double cut_random(void)
{
    static uint64_t state = 88172645463325252u; /* xorshift64, Marsaglia 2003 */
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return (double)(state >> 11) * 0x1p-53;
}

struct vec3 cut_random_direction(void)
{
    double z = 2 * cut_random() - 1, turn = 2 * MATH_PI * cut_random(), r = sqrt(1 - z * z);
    return vec3(r * cos(turn), r * sin(turn), z);
}

struct view cut_view(struct vec3 from, bool is_parallel)
{
    struct vec3 up = fabs(from.z) < 0.9 ? vec3(0, 0, 1) : vec3(0, 1, 0);
    struct view view = shots_view_from(vec3(0, 0, 0), from, up, 4.5);
    if (!is_parallel) {
        view.camera.projection = SCENE_PROJECTION_PERSPECTIVE;
        view.camera.has_height_mm = false;
        view.camera.fov_deg = 26;
        view.camera.position_mm = vec3_scale(vec3_normalize(from), 160);
    }
    return view;
}

void cut_free(struct scene *scene, struct vec3 normal, double distance_mm, bool is_capped)
{
    scene->clip.free = (struct scene_clip_free){ .enabled = true,
                                                 .origin_mm = vec3_scale(vec3_normalize(normal), distance_mm),
                                                 .normal = normal,
                                                 .cap = is_capped };
}
