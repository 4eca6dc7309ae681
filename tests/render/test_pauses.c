/* Pictures that are paused while others are drawn have the same bytes as those drawn in one go. */
#include "tests/render/shots.h"

enum { N_PICTURES = 5 };

static double nested(struct vec3 p)
{
    double r = vec3_length(vec3_sub(p, vec3(2, -1, 1)));
    return r < 5 ? 3 : r < 9 ? 2 : r < 13 ? 1 : 0;
}
static double waves(struct vec3 p)
{
    return 200 * sin(p.x * 0.7) * cos(p.y * 0.5) + 10 * p.z;
}
static const struct made_region regions[] = { { "outer", -1, 0xd8a890 },
                                              { "middle", 0, 0x90b0e0 },
                                              { "inner", 1, 0x50c060 } };

static struct plan *make_plan(void)
{
    struct grid grid = made_cube_grid(32);
    struct plan *plan = made_plan(&grid, nested, regions, 3);
    made_plan_add_image(plan, &grid, VOXEL_I16, waves);
    return plan;
}

struct wish {
    struct snapshot *snapshot;
    struct render_options options;
};

/* Pictures of several sizes, moving and still, in space and on panes with outlines. The first is large enough to have
 * several parts on every back end. */
static void make_wishes(struct plan *plan, struct wish wishes[N_PICTURES])
{
    static const struct {
        enum scene_kind kind;
        int width_px, height_px;
        bool is_still;
    } pictures[N_PICTURES] = { { SCENE_KIND_3D, 2100, 2050, true },
                               { SCENE_KIND_3D, 401, 300, false },
                               { SCENE_KIND_AXIAL, 333, 400, true },
                               { SCENE_KIND_3D, 640, 480, true },
                               { SCENE_KIND_CORONAL, 500, 200, false } };
    for (int i = 0; i < N_PICTURES; i++) {
        int shrunk = SHOTS_SANITIZED && i == 0 ? 3 : 1;
        struct scene scene;
        struct view view = view_default;
        struct error err = { 0 };
        char field[128];
        scene_for_plan(plan, &scene);
        for (size_t r = 0; r < scene.n_regions; r++)
            scene.regions[r].value.opacity = r == 2 ? 1 : 0.3 + 0.1 * i;
        scene.image.slices.coronal.visible = i != 3;
        view.kind = pictures[i].kind;
        view.size_px[0] = pictures[i].width_px / shrunk;
        view.size_px[1] = pictures[i].height_px / shrunk;
        wishes[i].options =
            (struct render_options){ view.size_px[0], view.size_px[1], SURFACE_FULL, pictures[i].is_still };
        wishes[i].snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
        assert_string_equal(err.text, "");
    }
}

static struct image *draw_in_one_go(const struct wish *wish, struct render_timing *timing)
{
    struct camera camera;
    struct error err = { 0 };
    struct image *image = render_snapshot(shots_renderer, wish->snapshot, &wish->options, &camera, timing, &err);
    assert_string_equal(err.text, "");
    return image;
}

static bool always(void *context)
{
    (void)context;
    return true;
}

static void expect_same(const struct image *a, const struct image *b)
{
    assert_non_null(a);
    assert_int_equal(a->width_px, b->width_px);
    assert_int_equal(a->height_px, b->height_px);
    assert_memory_equal(a->rgba, b->rgba, (size_t)a->width_px * (size_t)a->height_px * 4);
}

static void pictures_drawn_in_turns_are_the_same_as_in_one_go(void **state)
{
    (void)state;
    const struct render_pause pause = { always, NULL };
    struct plan *plan = make_plan();
    struct wish wishes[N_PICTURES];
    struct image *expected[N_PICTURES];
    struct render_timing timings[N_PICTURES];
    struct render_picture *pictures[N_PICTURES];
    int n_parts[N_PICTURES] = { 0 }, n_done = 0;
    make_wishes(plan, wishes);
    for (int i = 0; i < N_PICTURES; i++) {
        expected[i] = draw_in_one_go(&wishes[i], &timings[i]);
        pictures[i] = render_begin(shots_renderer, wishes[i].snapshot, &wishes[i].options);
    }
    for (int turn = 0; n_done < N_PICTURES; turn++) { /* each goes on in its turn, so there are more begun pictures than
                                                         the back end keeps sorted triangles of */
        int i = turn % N_PICTURES;
        struct error err = { 0 };
        if (!pictures[i])
            continue;
        enum render_state drawn = render_go_on(pictures[i], &pause, &err);
        n_parts[i]++;
        assert_string_equal(err.text, "");
        assert_int_not_equal(drawn, RENDER_FAILED);
        if (drawn == RENDER_PAUSED)
            continue;
        struct camera camera;
        struct render_timing timing;
        struct image *image = render_end(pictures[i], &camera, &timing);
        expect_same(image, expected[i]);
        assert_int_equal(timing.n_triangles, timings[i].n_triangles);
        image_destroy(image);
        pictures[i] = NULL;
        n_done++;
    }
    /* the same shapes, whether a picture has one band or several */
    assert_int_equal(timings[0].n_triangles, timings[3].n_triangles);
    assert_true(n_parts[0] > 2); /* it was paused between its parts, not only before the overlay */
    for (int i = 0; i < N_PICTURES; i++) {
        image_destroy(expected[i]);
        snapshot_unref(wishes[i].snapshot);
    }
    shots_forget(plan);
}

static void a_picture_that_is_given_up_leaves_nothing_behind(void **state)
{
    (void)state;
    const struct render_pause pause = { always, NULL };
    struct plan *plan = make_plan();
    struct wish wishes[N_PICTURES];
    struct camera camera;
    struct render_timing timing;
    make_wishes(plan, wishes);
    struct image *expected = draw_in_one_go(&wishes[1], &timing);
    for (int n_parts = 0; n_parts < 3; n_parts++) {
        struct render_picture *picture = render_begin(shots_renderer, wishes[0].snapshot, &wishes[0].options);
        for (int part = 0; part < n_parts; part++) {
            struct error err = { 0 };
            assert_int_equal(render_go_on(picture, &pause, &err), RENDER_PAUSED);
        }
        assert_null(render_end(picture, &camera, &timing));
        struct image *image = draw_in_one_go(&wishes[1], &timing);
        expect_same(image, expected);
        image_destroy(image);
    }
    image_destroy(expected);
    for (int i = 0; i < N_PICTURES; i++)
        snapshot_unref(wishes[i].snapshot);
    shots_forget(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_drawn_in_turns_are_the_same_as_in_one_go),
        cmocka_unit_test(a_picture_that_is_given_up_leaves_nothing_behind),
    };
    return shots_run("pauses", tests, sizeof tests / sizeof tests[0]);
}
