/* Every representation of a region with spikes, single univels, holes and separate pieces, on an oblique grid of
 * unequal spacings: where it is drawn, against rays through its univels. */
#include "core/pick/pick.h"
#include "tests/render/shots.h"

static const struct vec3 origin = { 0, 0, 0 };
static const struct vec3 up = { 0, 0, 1 };
static const struct made_region spiky[] = { { "spiky", -1, 0xf0c080 } };
enum { NI = 44, NJ = 36, NK = 20 };

/* In index space: a body with a hole through it, spikes one univel thick, two lone univels, a pair touching at a
 * corner, and a piece of its own with a hollow inside. */
static bool is_spiky(int i, int j, int k)
{
    double x = i - 15, y = j - 16, z = 1.5 * (k - 9);
    bool is_body = x * x + y * y + z * z < 100, is_hole = x * x + y * y < 9;
    bool is_spike = (j == 16 && k == 9 && i >= 2 && i <= 28) || (i == 15 && k == 12 && j >= 2 && j <= 30);
    bool is_lone = (i == 4 && j == 4 && k == 4) || (i == 40 && j == 3 && k == 16);
    bool is_pair = (i == 38 && j == 31 && k == 3) || (i == 39 && j == 32 && k == 3);
    int u = abs(i - 36), v = abs(j - 18), w = abs(k - 9), most = u > v ? (u > w ? u : w) : v > w ? v : w;
    return (is_body && !is_hole) || is_spike || is_lone || is_pair || most == 4;
}

static struct grid make_grid(void)
{
    const uint32_t size[3] = { NI, NJ, NK };
    double c = cos(0.35), s = sin(0.35);
    return made_grid(NI, NJ, NK,
                     made_affine(vec3(1.1 * c, 1.1 * s, 0), vec3(-1.4 * s, 1.4 * c, 0), vec3(0, 0, 2.5), size, origin));
}

static double spiky_label(struct vec3 p)
{
    struct grid grid = make_grid();
    struct vec3 ijk = affine_point(&grid.ijk_from_lps_mm, p);
    return is_spiky((int)lround(ijk.x), (int)lround(ijk.y), (int)lround(ijk.z));
}

static struct plan *make_plan(void)
{
    struct grid grid = make_grid();
    return made_plan(&grid, spiky_label, spiky, 1);
}

/* ---- the truth: which pixels' rays meet a univel ---------------------------------------------------------------- */

enum { N_VIEWS = 4 };
static struct view make_view(int i)
{
    static const struct vec3 from[N_VIEWS] = {
        { 0.3, -1, 0.4 }, { -0.8, 0.5, -0.3 }, { 0.2, -1, 0.9 }, { 0, -1, 0.02 }
    };
    struct view view = shots_view_from(origin, from[i], up, 5);
    if (i >= 2) {
        view.camera.projection = SCENE_PROJECTION_PERSPECTIVE;
        view.camera.has_height_mm = false;
        view.camera.fov_deg = i == 2 ? 30 : 70;
        view.camera.position_mm =
            vec3_scale(vec3_normalize(from[i]), i == 2 ? 120 : 38); /* the last: voxels of 30 pixels and more */
    }
    return view;
}

/* Fills truth: the pixels whose ray meets a univel; and their mean position. */
static void find_truth(struct plan *plan, int view_number, bool truth[SHOTS_HEIGHT][SHOTS_WIDTH], double middle_px[2])
{
    struct scene scene = shots_scene(plan);
    struct view view = make_view(view_number);
    struct error err = { 0 };
    char field[128];
    struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
    double n = 0;
    middle_px[0] = middle_px[1] = 0;
    for (int y = 0; y < SHOTS_HEIGHT; y++)
        for (int x = 0; x < SHOTS_WIDTH; x++) {
            struct pick_hit hits[PICK_MAX_HITS];
            truth[y][x] = snapshot_pick(snapshot, x + 0.5, y + 0.5, hits) > 0;
            n += truth[y][x];
            middle_px[0] += truth[y][x] ? x : 0;
            middle_px[1] += truth[y][x] ? y : 0;
        }
    middle_px[0] /= n;
    middle_px[1] /= n;
    assert_true(n > 3000);
    snapshot_unref(snapshot);
}

static bool is_near_truth(bool truth[SHOTS_HEIGHT][SHOTS_WIDTH], bool value, int x, int y, int reach)
{
    for (int v = y - reach; v <= y + reach; v++)
        for (int u = x - reach; u <= x + reach; u++)
            if (u >= 0 && v >= 0 && u < SHOTS_WIDTH && v < SHOTS_HEIGHT && truth[v][u] == value)
                return true;
    return false;
}

/* How each representation may differ from the univels' silhouette. */
static const struct way {
    const char *name;
    enum scene_representation representation;
    enum scene_algorithm algorithm;
    bool is_exact;    /* except for pixels on its edge */
    bool is_covering; /* every pixel of it, and none a voxel away */
    bool is_thin;     /* lines and points: some of it */
    bool is_partial;  /* leaves out what is thin, or cannot show pieces */
} ways[] = {
    { "univels", SCENE_REPRESENTATION_UNIVELS, SCENE_ALGORITHM_MARCHING_CUBES, true, false, false, false },
    { "solid", SCENE_REPRESENTATION_SOLID, SCENE_ALGORITHM_MARCHING_CUBES, false, true, false, false },
    { "points", SCENE_REPRESENTATION_POINTS, SCENE_ALGORITHM_MARCHING_CUBES, false, false, true, false },
    { "outline", SCENE_REPRESENTATION_OUTLINE, SCENE_ALGORITHM_MARCHING_CUBES, false, false, true, false },
    { "marching cubes", SCENE_REPRESENTATION_SURFACE, SCENE_ALGORITHM_MARCHING_CUBES, false, false, false, false },
    { "eight-cell", SCENE_REPRESENTATION_SURFACE, SCENE_ALGORITHM_EIGHT_CELL, false, false, false, true },
    { "smooth", SCENE_REPRESENTATION_SURFACE, SCENE_ALGORITHM_SMOOTH, false, false, false, false },
    { "nurbs", SCENE_REPRESENTATION_NURBS, SCENE_ALGORITHM_MARCHING_CUBES, false, false, false, true },
    { "fan", SCENE_REPRESENTATION_FAN, SCENE_ALGORITHM_MARCHING_CUBES, false, false, false, true },
};
enum { N_WAYS = sizeof ways / sizeof ways[0] };

static struct scene make_scene(const struct plan *plan, const struct way *way)
{
    struct scene scene = shots_scene(plan);
    shots_style(&scene, "spiky")->representation = way->representation;
    scene.surface.algorithm = way->algorithm;
    return scene;
}

static bool is_drawn(const struct image *image, int x, int y)
{
    return memcmp(shots_pixel(image, x, y), shots_background, 3) != 0;
}

static void expect_way(const struct way *way, int view_number, const struct image *image,
                       bool truth[SHOTS_HEIGHT][SHOTS_WIDTH], const double middle_px[2])
{
    /* a voxel's half diagonal of 1.5 mm at 5 pixels a mm; in the last view voxels are near */
    int reach = view_number < 3 ? 10 : 60;
    double n = 0, n_truth = 0, n_wrong = 0, sum[2] = { 0, 0 };
    for (int y = 0; y < SHOTS_HEIGHT; y++)
        for (int x = 0; x < SHOTS_WIDTH; x++) {
            bool is = is_drawn(image, x, y);
            n += is;
            n_truth += truth[y][x];
            sum[0] += is ? x : 0;
            sum[1] += is ? y : 0;
            if (is == truth[y][x])
                continue;
            bool is_wrong = way->is_exact      ? !is_near_truth(truth, is, x, y, 1)
                            : way->is_covering ? !is || !is_near_truth(truth, true, x, y, reach)
                            : is               ? !is_near_truth(truth, true, x, y, reach)
                                 : !way->is_thin && !way->is_partial && !is_near_truth(truth, false, x, y, reach);
            n_wrong += is_wrong;
        }
    if (n_wrong > 0 || hypot(sum[0] / n - middle_px[0], sum[1] / n - middle_px[1]) > (way->is_partial ? 25 : 12))
        printf("  %s, view %d: %.0f drawn, %.0f univels, %.0f wrong; middle off by %.1f, %.1f pixels\n", way->name,
               view_number, n, n_truth, n_wrong, sum[0] / n - middle_px[0], sum[1] / n - middle_px[1]);
    /* surfaces narrow a spike from both sides, so that where two cross the truth's edge may be farther off; splines
     * round all off */
    bool is_strict = way->is_exact || way->is_covering || way->is_thin;
    assert_true(n_wrong <= (is_strict ? 0 : way->representation == SCENE_REPRESENTATION_NURBS ? 0.05 : 0.01) * n_truth);
    assert_true(n > (way->is_thin ? 0.05 : 0.5) * n_truth);
    assert_true(hypot(sum[0] / n - middle_px[0], sum[1] / n - middle_px[1]) < (way->is_partial ? 25 : 12));
}

static void every_way_draws_the_region_where_its_univels_are(void **state)
{
    (void)state;
    static bool truth[SHOTS_HEIGHT][SHOTS_WIDTH];
    struct plan *plan = make_plan();
    for (int v = 0; v < N_VIEWS; v++) {
        double middle_px[2];
        find_truth(plan, v, truth, middle_px);
        for (size_t w = 0; w < N_WAYS; w++)
            for (int opacity = 0; opacity < 2; opacity++) {
                struct scene scene = make_scene(plan, &ways[w]);
                shots_style(&scene, "spiky")->opacity = opacity ? 1 : 0.6;
                struct image *image = shots_plain(plan, scene, make_view(v));
                expect_way(&ways[w], v, image, truth, middle_px);
                image_destroy(image);
            }
    }
    shots_forget(plan);
}

static void every_back_end_draws_every_way_the_same(void **state)
{
    (void)state;
    struct error err = { 0 };
    struct renderer *soft = renderer_create(RENDER_SOFT, &err), *tested = shots_renderer;
    struct plan *plan = make_plan();
    for (int v = 0; v < N_VIEWS; v++)
        for (size_t w = 0; w < N_WAYS; w++) {
            struct image *images[2];
            struct render_options options = { SHOTS_WIDTH, SHOTS_HEIGHT, SURFACE_FULL, v % 2 == 0 };
            for (int i = 0; i < 2; i++) {
                struct scene scene = make_scene(plan, &ways[w]);
                shots_style(&scene, "spiky")->opacity = v < 2 ? 0.7 : 1;
                shots_renderer = i ? soft : tested;
                images[i] = shots_take(plan, scene, make_view(v), &options, NULL);
            }
            shots_renderer = tested;
            size_t n = (size_t)SHOTS_WIDTH * SHOTS_HEIGHT, n_far = 0;
            for (size_t i = 0; i < n; i++) {
                int most = 0;
                for (size_t c = 0; c < 3; c++) {
                    int apart = abs(images[0]->rgba[4 * i + c] - images[1]->rgba[4 * i + c]);
                    most = apart > most ? apart : most;
                }
                n_far += most > 8;
            }
            if (n_far > n / 250)
                printf("  %s, view %d: %zu pixels differ\n", ways[w].name, v, n_far);
            assert_true(n_far <= n / 250); /* back ends round vertices differently, so some edge pixels differ */
            image_destroy(images[0]);
            image_destroy(images[1]);
        }
    renderer_forget(soft, plan);
    renderer_destroy(soft);
    shots_forget(plan);
}

/* ---- solid points at any zoom ----------------------------------------------------------------------------------- */

/* Inside the body no pixel may show the background, at scales from a third of a pixel to a hundred pixels a voxel. */
static void solid_points_leave_no_gap_at_any_zoom(void **state)
{
    (void)state;
    static const double zooms[] = { 0.2, 1.7, 9, 35 };
    static bool truth[SHOTS_HEIGHT][SHOTS_WIDTH];
    struct plan *plan = make_plan();
    struct grid grid = make_grid();
    struct vec3 body = affine_point(&grid.lps_mm_from_ijk, vec3(20, 12, 9));
    for (size_t z = 0; z < sizeof zooms / sizeof zooms[0]; z++)
        for (int is_still = 0; is_still < 2; is_still++) {
            struct view view = shots_view_from(body, vec3(0.4, -1, 0.3), up, zooms[z]);
            struct scene scene = make_scene(plan, &ways[1]);
            struct render_options options = { SHOTS_WIDTH, SHOTS_HEIGHT, SURFACE_FULL, is_still };
            struct image *image = shots_take(plan, scene, view, &options, NULL);
            struct scene picked = shots_scene(plan);
            struct error err = { 0 };
            char field[128];
            struct snapshot *snapshot = snapshot_create(derived_of(plan), &picked, &view, 1, field, &err);
            size_t n = 0;
            memset(truth, 0, sizeof truth);
            for (int y = 0; y < SHOTS_HEIGHT; y++)
                for (int x = 0; x < SHOTS_WIDTH; x++) {
                    struct pick_hit hits[PICK_MAX_HITS];
                    truth[y][x] = snapshot_pick(snapshot, x + 0.5, y + 0.5, hits) > 0;
                }
            for (int y = 0; y < SHOTS_HEIGHT; y++)
                for (int x = 0; x < SHOTS_WIDTH; x++)
                    if (truth[y][x]) {
                        n++;
                        assert_true(is_drawn(image, x, y));
                    }
            assert_true(n > 20);
            snapshot_unref(snapshot);
            image_destroy(image);
        }
    shots_forget(plan);
}

/* ---- light ------------------------------------------------------------------------------------------------------ */

/* A univel's face that faces the viewer has one colour, that of its plane. Baked shading does not depend on the eye,
 * live shading does. */
static double block_label(struct vec3 p)
{
    return fabs(p.x) < 10 && fabs(p.y) < 10 && fabs(p.z) < 10 ? 1 : 0;
}

static void light_is_of_faces_or_baked_or_live(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(30);
    struct plan *plan = made_plan(&grid, block_label, spiky, 1);
    static const double color[3] = { 0xf0 / 255.0, 0xc0 / 255.0, 0x80 / 255.0 };
    struct image *image;
    for (int side = 0; side < 2; side++) {
        struct vec3 from = vec3(side ? 1 : 0, side ? 0 : -1, 0);
        struct scene scene = make_scene(plan, &ways[0]);
        scene.surface.normals = SCENE_NORMALS_FACE;
        image = shots_plain(plan, scene, shots_view_from(origin, from, up, 8));
        for (int x = 200 - 70; x <= 200 + 70; x += 7)
            for (int c = 0; c < 3; c++)
                assert_close(shots_pixel(image, x, 150 - 60)[c], 255 * shots_facing_light(color[c], true), 2);
        image_destroy(image);
    }
    int baked[2], live[2];
    for (int side = 0; side < 2; side++)
        for (int is_live = 0; is_live < 2;
             is_live++) { /* the same voxels, in the middle of a face, seen from the front and from above */
            struct scene scene = make_scene(plan, &ways[1]);
            scene.points.solid = is_live ? SCENE_SOLID_LIGHTING_LIVE : SCENE_SOLID_LIGHTING_BAKED;
            image = shots_plain(plan, scene, shots_view_from(origin, side ? vec3(0, -1, 0.9) : vec3(0, -1, 0), up, 8));
            *(is_live ? &live[side] : &baked[side]) = shots_pixel(image, 200, side ? 150 + 20 : 150)[0];
            image_destroy(image);
        }
    assert_int_equal(baked[0], baked[1]);
    assert_true(abs(live[0] - live[1]) > 5);
    shots_forget(plan);
}

static double ball_label(struct vec3 p)
{
    return vec3_length(p) < 12 ? 1 : 0;
}

/* Seen along an axis, all visible faces of univels are parallel. Shaded by face normals alone, a ball would look like a
 * disk. */
static void univels_that_face_the_same_way_are_told_apart_unless_light_is_to_be_of_faces(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(30);
    struct plan *plan = made_plan(&grid, ball_label, spiky, 1);
    int spread[2];
    for (int is_rounded = 0; is_rounded < 2; is_rounded++) {
        struct scene scene = make_scene(plan, &ways[0]);
        scene.surface.normals = is_rounded ? SCENE_NORMALS_VERTEX : SCENE_NORMALS_FACE;
        struct image *image = shots_plain(plan, scene, shots_view_from(origin, vec3(0, -1, 0), up, 8));
        int low = 255, high = 0;
        for (int y = 150 - 60; y <= 150 + 60; y++)
            for (int x = 200 - 60; x <= 200 + 60; x++) {
                int value = shots_pixel(image, x, y)[0];
                low = value < low ? value : low;
                high = value > high ? value : high;
            }
        spread[is_rounded] = high - low;
        image_destroy(image);
    }
    assert_true(spread[0] <= 2);
    assert_true(spread[1] >= 15);
    shots_forget(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_way_draws_the_region_where_its_univels_are),
        cmocka_unit_test(every_back_end_draws_every_way_the_same),
        cmocka_unit_test(solid_points_leave_no_gap_at_any_zoom),
        cmocka_unit_test(light_is_of_faces_or_baked_or_live),
        cmocka_unit_test(univels_that_face_the_same_way_are_told_apart_unless_light_is_to_be_of_faces),
    };
    return shots_run("representations", tests, sizeof tests / sizeof tests[0]);
}
