/* The draw list of a picture and the cache of what back ends make, with a back end that only counts. */
#include "core/render/soft/soft.h"
#include "core/render/visible/beam_shape.h"
#include "core/render/visible/draw_list.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"

/* ---- a back end that counts ------------------------------------------------------------------------------------- */

struct counting {
    size_t n_made, n_shapes; /* made in all, there now */
    uint64_t bytes_each;
    size_t n_left;  /* before make_shape fails; SIZE_MAX: never */
    size_t n_grids; /* there now */
};

static struct drawable *make_shape(void *context, const struct shape *shape, int n_passes, struct error *err)
{
    struct counting *counting = context;
    (void)shape, (void)n_passes;
    if (counting->n_left == 0) {
        error_set(err, ERROR_MEMORY, "no memory");
        return NULL;
    }
    counting->n_left -= counting->n_left != SIZE_MAX;
    counting->n_made++;
    counting->n_shapes++;
    struct drawable *made = mem_new(sizeof *made);
    made->n_bytes = counting->bytes_each;
    return made;
}

static void destroy_shape(void *context, struct drawable *drawable)
{
    ((struct counting *)context)->n_shapes--;
    free(drawable);
}

static struct drawable *make_grid(void *context, const struct volume *const *volumes, size_t n, bool is_labels,
                                  struct error *err)
{
    (void)volumes, (void)n, (void)is_labels, (void)err;
    ((struct counting *)context)->n_grids++;
    return mem_new(sizeof(struct drawable));
}

static void destroy_grid(void *context, struct drawable *drawable)
{
    ((struct counting *)context)->n_grids--;
    free(drawable);
}

static struct draw_cache *counting_cache(struct counting *counting)
{
    counting->n_left = SIZE_MAX;
    return draw_cache_create(&(struct drawable_maker){ .make_shape = make_shape,
                                                       .destroy_shape = destroy_shape,
                                                       .make_grid = make_grid,
                                                       .destroy_grid = destroy_grid,
                                                       .context = counting });
}

/* ---- a plan ----------------------------------------------------------------------------------------------------- */

/* Three balls along the line of sight from the front, -y to +y, and one around the last. */
static double balls(struct vec3 p)
{
    static const double at[3] = { -12, 0, 12 };
    for (int i = 0; i < 3; i++)
        if (vec3_length(vec3_sub(p, vec3(0, at[i], 0))) < 3)
            return i + 1;
    return vec3_length(vec3_sub(p, vec3(0, 12, 0))) < 5 ? 4 : 0;
}
static const struct made_region regions[] = {
    { "front", -1, 0xff0000 }, { "middle", -1, 0x00ff00 }, { "back", 3, 0x0000ff }, { "around", -1, 0xffff00 }
};
static double value(struct vec3 p)
{
    return p.x + 40;
}

static struct plan *make_plan(void)
{
    struct grid grid = made_cube_grid(40);
    struct plan *plan = made_plan(&grid, balls, regions, 4);
    made_plan_add_image(plan, &grid, VOXEL_U8, value);
    return plan;
}

struct picture {
    struct snapshot *snapshot;
    struct camera camera;
    struct draw_list *list;
};

/* Takes scene. */
static struct picture picture_of(struct plan *plan, struct scene scene, enum scene_kind kind, struct draw_cache *cache)
{
    struct picture picture;
    struct view view = view_default;
    struct error err = { 0 };
    char field[128];
    const struct render_options options = { 64, 48, SURFACE_FULL, false };
    view.kind = kind;
    picture.snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
    assert_string_equal(err.text, "");
    camera_resolve(picture.snapshot, &picture.camera);
    const struct draw_scope scope = { picture.snapshot, &picture.camera, SURFACE_FULL, cache, true, NULL, NULL, false };
    picture.list = draw_list_create(&scope, &options, &err);
    assert_string_equal(err.text, "");
    return picture;
}

static void picture_finish(struct picture *picture)
{
    draw_list_destroy(picture->list);
    snapshot_unref(picture->snapshot);
}

static struct scene plain_scene(const struct plan *plan)
{
    struct scene scene;
    scene_for_plan(plan, &scene);
    for (size_t i = 0; i < scene.n_regions; i++)
        scene.regions[i].value.opacity = 1;
    return scene;
}

static void expect_draws(const struct draw_list *list, const enum draw_kind *kinds, const size_t *indices, size_t n)
{
    assert_int_equal(list->n, n);
    for (size_t i = 0; i < n; i++) {
        assert_int_equal(list->draws[i].kind, kinds[i]);
        assert_int_equal(list->draws[i].subject.index, indices[i]);
        assert_int_equal(list->draws[i].clip.n_planes, 0);
        if (i > 0)
            assert_true(list->draws[i - 1].pass <= list->draws[i].pass);
    }
}

/* ---- order ------------------------------------------------------------------------------------------------------ */

/* Order of draws seen from the front: opaque ones nearest first, planes, translucent ones farthest first; "back" lies
 * inside the opaque "around" in the second picture and cannot be seen. */
static void draws_are_ordered_by_pass_and_distance(void **state)
{
    (void)state;
    struct counting counting = { .bytes_each = 1000 };
    struct draw_cache *cache = counting_cache(&counting);
    struct plan *plan = make_plan();
    struct scene scene = plain_scene(plan);
    scene.image.slices.axial.visible = scene.image.slices.sagittal.visible = true;
    scene.regions[1].value.opacity = scene.regions[3].value.opacity = 0.5;
    struct picture picture = picture_of(plan, scene, SCENE_KIND_3D, cache);
    expect_draws(picture.list,
                 (enum draw_kind[]){ DRAW_SHAPE, DRAW_SHAPE, DRAW_IMAGE, DRAW_IMAGE, DRAW_SHAPE, DRAW_SHAPE },
                 (size_t[]){ 0, 2, 0, 0, 3, 1 }, 6);
    assert_int_equal(draw_list_n_layers(picture.list, 4), 2);
    assert_int_equal(picture.list->draws[0].depth, DRAW_DEPTH_TESTED);
    assert_int_equal(picture.list->draws[2].depth, DRAW_DEPTH_TESTED);
    assert_close(picture.list->draws[2].plane.normal.z, 1, 0); /* axial before sagittal */
    assert_close(picture.list->draws[3].plane.normal.x, 1, 0);
    picture_finish(&picture);

    scene = plain_scene(plan);
    scene.image.slices.axial.visible = false;
    picture = picture_of(plan, scene, SCENE_KIND_3D, cache);
    expect_draws(picture.list, (enum draw_kind[]){ DRAW_SHAPE, DRAW_SHAPE, DRAW_SHAPE }, (size_t[]){ 0, 1, 3 }, 3);
    picture_finish(&picture);
    draw_cache_destroy(cache);
    plan_and_derived_destroy(plan);
}

/* The image, then outlines: the outer before the inner, the larger before the smaller; "front" is checked. */
static void a_pane_has_the_image_and_the_overlay(void **state)
{
    (void)state;
    struct counting counting = { .bytes_each = 1000 };
    struct draw_cache *cache = counting_cache(&counting);
    struct plan *plan = make_plan();
    struct scene scene = plain_scene(plan);
    scene.check.visible = true;
    snprintf(scene.check.region, sizeof scene.check.region, "front");
    scene.regions[0].value.order = 1;
    scene.regions[1].value.visible = false;
    struct picture picture = picture_of(plan, scene, SCENE_KIND_AXIAL, cache);
    expect_draws(picture.list, (enum draw_kind[]){ DRAW_IMAGE, DRAW_OUTLINE, DRAW_OUTLINE, DRAW_CHECK },
                 (size_t[]){ 0, 3, 2, 0 }, 4);
    assert_int_equal(picture.list->n_in_image, 1);
    assert_int_equal(picture.list->draws[0].depth, DRAW_DEPTH_NONE);
    assert_int_equal(counting.n_made, 0); /* no shape is needed */
    picture_finish(&picture);
    draw_cache_destroy(cache);
    plan_and_derived_destroy(plan);
}

/* ---- what is kept ----------------------------------------------------------------------------------------------- */

static struct scene scene_of_one(const struct plan *plan, size_t region)
{
    struct scene scene = plain_scene(plan);
    scene.image.slices.axial.visible = false;
    for (size_t i = 0; i < scene.n_regions; i++)
        scene.regions[i].value.visible = i == region;
    return scene;
}

/* A third of the budget each and a little: the fourth picture finds four shapes, and the one that was not used for
 * longest goes, unless a begun picture uses it. */
static void the_least_recently_used_goes_and_nothing_that_is_in_use(void **state)
{
    (void)state;
    struct plan *plan = make_plan();
    for (int is_begun = 0; is_begun < 2; is_begun++) {
        struct counting counting = { .bytes_each = DRAW_CACHE_BYTES / 3 };
        struct draw_cache *cache = counting_cache(&counting);
        struct picture first = picture_of(plan, scene_of_one(plan, 0), SCENE_KIND_3D, cache);
        if (!is_begun)
            picture_finish(&first);
        for (size_t region = 1; region < 4; region++) {
            struct picture picture = picture_of(plan, scene_of_one(plan, region), SCENE_KIND_3D, cache);
            picture_finish(&picture);
        }
        assert_int_equal(counting.n_made, 4);
        /* 0 was dropped before 3 was made, or, while it is in use, nothing was: the others are younger than its picture
         */
        assert_int_equal(counting.n_shapes, is_begun ? 4 : 3);
        struct picture again = picture_of(plan, scene_of_one(plan, 0), SCENE_KIND_3D, cache);
        assert_int_equal(counting.n_made, is_begun ? 4 : 5);
        picture_finish(&again);
        if (is_begun)
            picture_finish(&first);
        draw_cache_forget(cache, plan);
        assert_int_equal(counting.n_shapes, 0);
        draw_cache_destroy(cache);
    }
    plan_and_derived_destroy(plan);
}

static void what_is_requested_again_is_not_made_again(void **state)
{
    (void)state;
    struct counting counting = { .bytes_each = 1000 };
    struct draw_cache *cache = counting_cache(&counting);
    struct plan *plan = make_plan(), *other = make_plan();
    for (int i = 0; i < 3; i++) {
        struct picture picture = picture_of(plan, plain_scene(plan), SCENE_KIND_3D, cache);
        picture_finish(&picture);
    }
    assert_int_equal(counting.n_made, 3); /* "back" is hidden */
    struct picture picture = picture_of(other, plain_scene(other), SCENE_KIND_3D, cache);
    picture_finish(&picture);
    assert_int_equal(counting.n_made, 6);
    draw_cache_forget(cache, other);
    assert_int_equal(counting.n_shapes, 3);
    draw_cache_destroy(cache);
    plan_and_derived_destroy(plan);
    plan_and_derived_destroy(other);
}

/* A computed volume is made once; when nobody else holds it, it goes with the next picture, but not from a begun one.
 */
static void a_computed_volume_goes_when_nobody_else_holds_it(void **state)
{
    (void)state;
    struct counting counting = { .bytes_each = 1000 };
    struct draw_cache *cache = counting_cache(&counting);
    struct plan *plan = make_plan();
    struct draw_cache_use first, second, third;
    struct error err = { 0 };
    struct volume *volume = volume_create(&plan->images[0].volume->grid, VOXEL_F32, &err);
    const struct volume *volumes[1] = { volume };
    draw_cache_begin(cache, &first);
    const struct drawable *made = draw_cache_volumes(cache, plan, volumes, 1, false, &err);
    assert_non_null(made);
    assert_ptr_equal(draw_cache_volumes(cache, plan, volumes, 1, false, &err), made);
    assert_int_equal(counting.n_grids, 1);
    draw_cache_begin(cache, &second);
    draw_cache_end(&second);
    volume_unref(volume);
    draw_cache_begin(cache, &second);
    assert_int_equal(counting.n_grids, 1); /* the first picture draws on */
    draw_cache_end(&first);
    draw_cache_begin(cache, &third);
    assert_int_equal(counting.n_grids, 0);
    draw_cache_end(&second);
    draw_cache_end(&third);
    volumes[0] = volume = volume_create(&plan->images[0].volume->grid, VOXEL_F32, &err);
    draw_cache_begin(cache, &first);
    assert_non_null(draw_cache_volumes(cache, plan, volumes, 1, false, &err));
    draw_cache_end(&first);
    draw_cache_begin(cache, &first);
    assert_int_equal(counting.n_grids, 1); /* held by the test */
    draw_cache_end(&first);
    draw_cache_forget(cache, plan);
    assert_int_equal(counting.n_grids, 0);
    volume_unref(volume);
    draw_cache_destroy(cache);
    plan_and_derived_destroy(plan);
}

/* ---- the software back end, whose shapes hold what they were made of ---------------------------------------------- */

static struct drawable *make_soft_shape(void *context, const struct shape *shape, int n_passes, struct error *err)
{
    const struct drawable_maker soft = soft_renderer_maker();
    ((struct counting *)context)->n_shapes++;
    return soft.make_shape(soft.context, shape, n_passes, err);
}

static void destroy_soft_shape(void *context, struct drawable *drawable)
{
    const struct drawable_maker soft = soft_renderer_maker();
    ((struct counting *)context)->n_shapes--;
    soft.destroy_shape(soft.context, drawable);
}

static struct shape *beam_of(double length_mm)
{
    struct cut_lines lines = { 0 };
    struct error err = { 0 };
    assert_true(cut_lines_add(&lines, vec3(0, 0, 0), vec3(0, 0, length_mm), &err));
    struct shape *shape = beam_lines_shape(&lines, &err);
    assert_non_null(shape);
    cut_lines_finish(&lines);
    return shape;
}

/* A beam has a new shape in each picture: those of earlier pictures are gone, with back ends that hold them and with
 * others; one that the test holds stays. */
static void a_computed_shape_goes_when_nobody_else_holds_it(void **state)
{
    (void)state;
    struct plan *plan = make_plan();
    for (int is_soft = 0; is_soft < 2; is_soft++) {
        struct counting counting = { .bytes_each = 1000 };
        const struct drawable_maker soft = { .make_shape = make_soft_shape,
                                             .destroy_shape = destroy_soft_shape,
                                             .context = &counting };
        struct draw_cache *cache = is_soft ? draw_cache_create(&soft) : counting_cache(&counting);
        struct shape *held = beam_of(1);
        struct draw_cache_use use;
        struct error err = { 0 };
        for (int picture = 0; picture < 5; picture++) {
            struct shape *shape = beam_of(picture + 2);
            draw_cache_begin(cache, &use);
            assert_int_equal(counting.n_shapes, picture > 0); /* the held one */
            assert_non_null(draw_cache_computed_shape(cache, plan, held, 0, 1, &err));
            assert_non_null(draw_cache_computed_shape(cache, plan, shape, 0, 1, &err));
            assert_int_equal(counting.n_shapes, 2);
            shape_unref(shape);
            draw_cache_end(&use);
        }
        shape_unref(held);
        draw_cache_begin(cache, &use);
        assert_int_equal(counting.n_shapes, 0);
        draw_cache_end(&use);
        draw_cache_destroy(cache);
    }
    plan_and_derived_destroy(plan);
}

/* The error names the region, and nothing that began stays begun. */
static void a_list_fails_when_a_shape_cannot_be_made(void **state)
{
    (void)state;
    struct counting counting = { .bytes_each = 1000 };
    struct draw_cache *cache = counting_cache(&counting);
    struct plan *plan = make_plan();
    struct scene scene = plain_scene(plan);
    struct view view = view_default;
    struct error err = { 0 };
    char field[128];
    struct camera camera;
    struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
    camera_resolve(snapshot, &camera);
    const struct draw_scope scope = { snapshot, &camera, SURFACE_FULL, cache, true, NULL, NULL, false };
    const struct render_options options = { 64, 48, SURFACE_FULL, false };
    counting.n_left = 1;
    assert_null(draw_list_create(&scope, &options, &err));
    assert_int_equal(err.code, ERROR_MEMORY);
    assert_string_equal(err.text, "region middle: no memory");
    counting.n_left = SIZE_MAX;
    struct draw_list *list = draw_list_create(&scope, &options, &err);
    assert_non_null(list);
    draw_list_destroy(list);
    draw_cache_destroy(cache); /* asserts that no picture is begun */
    snapshot_unref(snapshot);
    plan_and_derived_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(draws_are_ordered_by_pass_and_distance),
        cmocka_unit_test(a_pane_has_the_image_and_the_overlay),
        cmocka_unit_test(the_least_recently_used_goes_and_nothing_that_is_in_use),
        cmocka_unit_test(what_is_requested_again_is_not_made_again),
        cmocka_unit_test(a_computed_volume_goes_when_nobody_else_holds_it),
        cmocka_unit_test(a_computed_shape_goes_when_nobody_else_holds_it),
        cmocka_unit_test(a_list_fails_when_a_shape_cannot_be_made),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
