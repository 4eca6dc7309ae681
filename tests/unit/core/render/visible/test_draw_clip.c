/* The draw list under clip planes: what is cut off is not in it, each draw has the planes that cut it, and a region
 * that is cut open hides nothing. */
#include "core/render/visible/draw_clip.h"
#include "core/render/visible/draw_list.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"

/* A ball of radius 16 mm in the middle, one of 8 mm inside it. */
static const struct made_region regions[] = { { "outer", -1, 0xd0a080 }, { "inner", 0, 0x80d0a0 } };

static double balls(struct vec3 p)
{
    double r = vec3_length(p);
    return r < 8 ? 2 : r < 16 ? 1 : 0;
}

static double value(struct vec3 p)
{
    return p.x + 20;
}

static struct drawable *make_shape(void *context, const struct shape *shape, int n_passes, struct error *err)
{
    (void)context, (void)shape, (void)n_passes, (void)err;
    return mem_new(sizeof(struct drawable));
}

static void destroy_shape(void *context, struct drawable *drawable)
{
    (void)context;
    free(drawable);
}

static struct plan *make_plan(void)
{
    struct grid grid = made_cube_grid(40);
    struct plan *plan = made_plan(&grid, balls, regions, 2);
    made_plan_add_image(plan, &grid, VOXEL_U8, value);
    return plan;
}

struct picture {
    struct plan *plan;
    struct scene scene;
    enum scene_kind kind;
    struct draw_cache *cache;
    struct snapshot *snapshot;
    struct camera camera;
    struct draw_list *list;
};

/* Opaque regions, an axial slice in space at S 4 mm. */
static void begin(struct picture *picture)
{
    const struct drawable_maker maker = { .make_shape = make_shape, .destroy_shape = destroy_shape };
    *picture = (struct picture){ .plan = make_plan(), .cache = draw_cache_create(&maker) };
    scene_for_plan(picture->plan, &picture->scene);
    for (size_t i = 0; i < picture->scene.n_regions; i++)
        picture->scene.regions[i].value.opacity = 1;
    picture->scene.image.slices.axial.visible = true;
    picture->scene.image.slices.axial.position_mm = 4;
}

static const struct draw_list *list_of(struct picture *picture)
{
    struct view view = view_default;
    struct error err = { 0 };
    char field[128];
    draw_list_destroy(picture->list);
    snapshot_unref(picture->snapshot);
    view.kind = picture->kind;
    struct scene scene;
    scene_copy(&scene, &picture->scene);
    picture->snapshot = snapshot_create(derived_of(picture->plan), &scene, &view, 1, field, &err);
    assert_string_equal(err.text, "");
    camera_resolve(picture->snapshot, &picture->camera);
    const struct draw_scope scope = {
        picture->snapshot, &picture->camera, SURFACE_FULL, picture->cache, true, NULL, NULL, false
    };
    const struct render_options options = { 64, 48, SURFACE_FULL, false };
    picture->list = draw_list_create(&scope, &options, &err);
    assert_string_equal(err.text, "");
    return picture->list;
}

static void end(struct picture *picture)
{
    draw_list_destroy(picture->list);
    snapshot_unref(picture->snapshot);
    draw_cache_destroy(picture->cache);
    scene_finish(&picture->scene);
    plan_and_derived_destroy(picture->plan);
}

static size_t count(const struct draw_list *list, enum draw_kind kind)
{
    size_t n = 0;
    for (size_t i = 0; i < list->n; i++)
        n += list->draws[i].kind == kind;
    return n;
}

static const struct draw *find(const struct draw_list *list, enum draw_kind kind, size_t index)
{
    for (size_t i = 0; i < list->n; i++)
        if (list->draws[i].kind == kind && list->draws[i].subject.index == index)
            return &list->draws[i];
    return NULL;
}

static void cut_axial(struct scene *scene, double high_mm)
{
    scene->clip.axial_high.enabled = true;
    scene->clip.axial_high.position_mm = high_mm;
}

static void an_opaque_region_hides_what_is_in_it_only_while_it_is_not_cut(void **state)
{
    (void)state;
    struct picture picture;
    begin(&picture);
    assert_int_equal(count(list_of(&picture), DRAW_SHAPE), 1);
    cut_axial(&picture.scene, 10); /* cuts the outer one alone: the inner one is seen through the cut */
    assert_int_equal(count(list_of(&picture), DRAW_SHAPE), 2);
    assert_true(draw_clip_cuts(&find(picture.list, DRAW_SHAPE, 0)->clip));
    assert_false(draw_clip_cuts(&find(picture.list, DRAW_SHAPE, 1)->clip));
    picture.scene.regions[0].value.clipped = false;
    assert_int_equal(count(list_of(&picture), DRAW_SHAPE), 1);
    picture.scene.regions[0].value.clipped = true;
    picture.scene.clip.axial_high.position_mm = 17; /* beyond it */
    assert_int_equal(count(list_of(&picture), DRAW_SHAPE), 1);
    assert_false(draw_clip_cuts(&find(picture.list, DRAW_SHAPE, 0)->clip));
    end(&picture);
}

static void what_is_wholly_cut_off_is_not_in_the_list(void **state)
{
    (void)state;
    struct picture picture;
    begin(&picture);
    cut_axial(&picture.scene, -9); /* below the inner ball and the slice */
    assert_int_equal(count(list_of(&picture), DRAW_SHAPE), 1);
    assert_non_null(find(picture.list, DRAW_SHAPE, 0));
    assert_int_equal(count(picture.list, DRAW_IMAGE), 0);
    picture.scene.image.clipped = false;
    assert_int_equal(count(list_of(&picture), DRAW_IMAGE), 1);
    picture.scene.clip.axial_high.position_mm = -17;
    assert_int_equal(count(list_of(&picture), DRAW_SHAPE), 0);
    picture.scene.regions[1].value.clipped = false;
    assert_int_equal(count(list_of(&picture), DRAW_SHAPE), 1);
    assert_non_null(find(picture.list, DRAW_SHAPE, 1));
    end(&picture);
}

/* The slack is a micrometre's thousandth: a slice at the very plane is drawn, one a little beyond it is not. */
static void a_slice_in_a_clip_plane_is_drawn_on_it(void **state)
{
    (void)state;
    struct picture picture;
    begin(&picture);
    cut_axial(&picture.scene, 4);
    const struct draw *slice = find(list_of(&picture), DRAW_IMAGE, 0);
    assert_non_null(slice);
    assert_false(draw_clip_cuts(&slice->clip));
    picture.scene.clip.axial_high.position_mm = 4 - 1e-5;
    assert_null(find(list_of(&picture), DRAW_IMAGE, 0));
    picture.scene.clip.axial_high.enabled = false;
    picture.scene.clip.free =
        (struct scene_clip_free){ .enabled = true, .origin_mm = { 3, 3, 4 }, .normal = { 1, 2, 2 }, .cap = true };
    picture.scene.image.slices.axial.visible = false;
    picture.scene.image.obliques = mem_new(sizeof *picture.scene.image.obliques);
    picture.scene.image.n_obliques = 1;
    picture.scene.image.obliques[0].value =
        (struct scene_oblique){ .visible = true, .origin_mm = { 5, 2, 4 }, .normal = { -1, -2, -2 } };
    slice = find(list_of(&picture), DRAW_IMAGE, 0); /* the same plane, by another point and the opposite normal */
    assert_non_null(slice);
    assert_false(draw_clip_cuts(&slice->clip));
    end(&picture);
}

/* A cut shell shows its inside, unless a cap closes it. */
static void a_cut_without_a_cap_shows_both_sides(void **state)
{
    (void)state;
    struct picture picture;
    begin(&picture);
    cut_axial(&picture.scene, 10);
    assert_false(find(list_of(&picture), DRAW_SHAPE, 0)->shape.look.is_two_sided);
    picture.scene.clip.axial_high.cap = false;
    assert_true(find(list_of(&picture), DRAW_SHAPE, 0)->shape.look.is_two_sided);
    assert_false(find(picture.list, DRAW_SHAPE, 1)->shape.look.is_two_sided); /* not cut */
    end(&picture);
}

/* The surface of solid points closes their cut: it is built before the picture is drawn, once a cap needs it. */
static void the_shapes_of_caps_are_wanted_in_advance(void **state)
{
    (void)state;
    struct picture picture;
    struct shape_want wants[4];
    begin(&picture);
    for (size_t i = 0; i < 2; i++)
        picture.scene.regions[i].value.representation = SCENE_REPRESENTATION_SOLID;
    (void)list_of(&picture);
    assert_int_equal(visible_wants(picture.snapshot, SURFACE_COARSE, false, wants), 2);
    cut_axial(&picture.scene, 10);
    picture.scene.regions[1].value.clipped = false;
    (void)list_of(&picture);
    assert_int_equal(visible_wants(picture.snapshot, SURFACE_COARSE, false, wants), 3);
    assert_int_equal(wants[1].subject.index, 0);
    assert_int_equal(wants[1].key.representation, REPRESENTATION_SURFACE);
    picture.scene.clip.axial_high.cap = false;
    (void)list_of(&picture);
    assert_int_equal(visible_wants(picture.snapshot, SURFACE_COARSE, false, wants), 2);
    end(&picture);
}

/* The list cuts it for the cap before the picture can show that the outer one hides all of it. */
static void the_body_of_a_region_is_wanted_for_its_cap_though_an_uncut_one_hides_it(void **state)
{
    (void)state;
    struct picture picture;
    struct shape_want wants[4];
    begin(&picture);
    picture.scene.regions[0].value.clipped = false;
    (void)list_of(&picture);
    assert_int_equal(visible_wants(picture.snapshot, SURFACE_COARSE, false, wants), 1);
    cut_axial(&picture.scene, 0);
    (void)list_of(&picture);
    assert_int_equal(visible_wants(picture.snapshot, SURFACE_COARSE, false, wants), 2);
    assert_int_equal(wants[1].subject.index, 1);
    end(&picture);
}

static void panes_are_never_cut(void **state)
{
    (void)state;
    struct picture picture;
    begin(&picture);
    cut_axial(&picture.scene, 0); /* the pane at S 4 mm lies beyond it */
    picture.kind = SCENE_KIND_AXIAL;
    const struct draw *image = find(list_of(&picture), DRAW_IMAGE, 0);
    assert_non_null(image);
    assert_int_equal(image->clip.n_planes, 0);
    end(&picture);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_opaque_region_hides_what_is_in_it_only_while_it_is_not_cut),
        cmocka_unit_test(what_is_wholly_cut_off_is_not_in_the_list),
        cmocka_unit_test(a_slice_in_a_clip_plane_is_drawn_on_it),
        cmocka_unit_test(a_cut_without_a_cap_shows_both_sides),
        cmocka_unit_test(the_shapes_of_caps_are_wanted_in_advance),
        cmocka_unit_test(the_body_of_a_region_is_wanted_for_its_cap_though_an_uncut_one_hides_it),
        cmocka_unit_test(panes_are_never_cut),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
