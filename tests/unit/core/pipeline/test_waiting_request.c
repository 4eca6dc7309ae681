/* Which shapes a request waits for, and that they are built when it no longer waits. */
#include "core/pipeline/waiting_request.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"

static double nested_label(struct vec3 p)
{
    double r = vec3_length(p);
    return r < 4 ? 3 : r < 7 ? 2 : r < 10 ? 1 : 0;
}
static const struct made_region nested[] = { { "outer", -1, 0xff0000 },
                                             { "middle", 0, 0x00ff00 },
                                             { "inner", 1, 0x0000ff } };

static struct plan *make_plan(void)
{
    struct grid grid = made_cube_grid(24);
    return made_plan(&grid, nested_label, nested, 3);
}

struct picture {
    enum scene_kind kind;
    enum scene_representation representation;
    double opacity;      /* of the outer one */
    const char *checked; /* NULL: no check */
    enum surface_detail detail;
};

static struct waiting_request *request_of(struct plan *plan, const struct picture *picture)
{
    struct scene scene;
    struct view view = view_default;
    struct error err = { 0 };
    char field[128];
    scene_for_plan(plan, &scene);
    view.kind = picture->kind;
    for (size_t i = 0; i < scene.n_regions; i++) {
        scene.regions[i].value.representation = picture->representation;
        scene.regions[i].value.opacity = i == 0 ? picture->opacity : 1;
    }
    scene.check.visible = picture->checked != NULL;
    snprintf(scene.check.region, sizeof scene.check.region, "%s", picture->checked ? picture->checked : "");
    struct pipeline_request request = { .snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err),
                                        .render = { 64, 64, picture->detail, false } };
    assert_string_equal(err.text, "");
    return waiting_request_create(&request);
}

static void a_picture_wants_the_shapes_that_can_be_seen(void **state)
{
    (void)state;
    static const struct {
        struct picture picture;
        size_t n;
        size_t first;
        enum region_representation representation;
        enum surface_detail detail;
    } cases[] = {
        { { SCENE_KIND_3D, SCENE_REPRESENTATION_SURFACE, 1, NULL, SURFACE_COARSE },
          1,
          0,
          REPRESENTATION_SURFACE,
          SURFACE_COARSE }, /* hides all */
        { { SCENE_KIND_3D, SCENE_REPRESENTATION_SURFACE, 0.5, NULL, SURFACE_FULL },
          2,
          0,
          REPRESENTATION_SURFACE,
          SURFACE_FULL },
        { { SCENE_KIND_3D, SCENE_REPRESENTATION_SURFACE, 0, NULL, SURFACE_FULL },
          1,
          1,
          REPRESENTATION_SURFACE,
          SURFACE_FULL },
        { { SCENE_KIND_3D, SCENE_REPRESENTATION_POINTS, 1, NULL, SURFACE_COARSE },
          3,
          0,
          REPRESENTATION_POINTS,
          SURFACE_FULL }, /* one sees through */
        { { SCENE_KIND_AXIAL, SCENE_REPRESENTATION_UNIVELS, 1, NULL, SURFACE_COARSE },
          0,
          0,
          REPRESENTATION_SURFACE,
          SURFACE_FULL },
        { { SCENE_KIND_AXIAL, SCENE_REPRESENTATION_UNIVELS, 1, "", SURFACE_COARSE },
          3,
          0,
          REPRESENTATION_UNIVELS,
          SURFACE_FULL },
        { { SCENE_KIND_CORONAL, SCENE_REPRESENTATION_OUTLINE, 1, "middle", SURFACE_COARSE },
          1,
          1,
          REPRESENTATION_SURFACE,
          SURFACE_FULL },
    };
    struct plan *plan = make_plan();
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct waiting_request *waiting = request_of(plan, &cases[i].picture);
        assert_int_equal(waiting->n_wants, cases[i].n);
        if (cases[i].n > 0) {
            assert_int_equal(waiting->wants[0].subject.index, cases[i].first);
            assert_int_equal(waiting->wants[0].key.representation, cases[i].representation);
            assert_int_equal(waiting->wants[0].detail, cases[i].detail);
        }
        waiting_request_destroy(waiting);
    }
    plan_and_derived_destroy(plan);
}

static void what_was_built_once_is_not_waited_for_again(void **state)
{
    (void)state;
    static const struct picture solid = { SCENE_KIND_3D, SCENE_REPRESENTATION_SOLID, 0.5, NULL, SURFACE_FULL },
                                points = { SCENE_KIND_3D, SCENE_REPRESENTATION_POINTS, 0.5, NULL, SURFACE_FULL };
    struct plan *plan = make_plan();
    struct built_shapes *built_shapes = built_shapes_create();
    struct waiting_request *first = request_of(plan, &solid), *again = request_of(plan, &solid),
                           *other = request_of(plan, &points);
    struct once_cache_usage usage;
    assert_false(built_shapes_has_all(built_shapes, first));
    atomic_bool cancel = false;
    waiting_request_build_shapes(first, &cancel);
    assert_true(first->is_built);
    derive_usage(derived_of(plan), &usage);
    assert_int_equal(usage.n_results, 3);
    built_shapes_add(built_shapes, first);
    assert_true(built_shapes_has_all(built_shapes, again));
    assert_false(built_shapes_has_all(built_shapes, other));
    waiting_request_destroy(first);
    waiting_request_destroy(again);
    waiting_request_destroy(other);
    built_shapes_destroy(built_shapes);
    plan_and_derived_destroy(plan);
}

static void what_is_not_wanted_any_more_is_not_built(void **state)
{
    (void)state;
    static const struct picture solid = { SCENE_KIND_3D, SCENE_REPRESENTATION_SOLID, 0.5, NULL, SURFACE_FULL };
    struct plan *plan = make_plan();
    struct once_cache_usage usage;
    for (int way = 0; way < 3; way++) {
        _Atomic uint64_t wanted = way == 0 ? 77 : 5; /* its slot serves another picture now */
        atomic_bool cancel = way == 1;
        struct waiting_request *waiting = request_of(plan, &solid);
        waiting->request.id = 5;
        waiting->wanted = &wanted;
        waiting_request_build_shapes(waiting, &cancel);
        derive_usage(derived_of(plan), &usage);
        assert_int_equal(usage.n_results, way == 2 ? 3 : 0);
        assert_int_equal(waiting->is_built, way == 2);
        waiting_request_destroy(waiting);
    }
    plan_and_derived_destroy(plan);
}

static void the_set_of_built_shapes_tells_any_number_of_shapes_apart(void **state)
{
    (void)state;
    struct built_shapes *built = built_shapes_create();
    for (int bins = 0; bins < 3000; bins++) { /* 6000 shapes: more than the set holds */
        struct shape_want wants[2];
        for (size_t region = 0; region < 2; region++)
            wants[region] = (struct shape_want){ subject_region(region),
                                                 { .representation = REPRESENTATION_NURBS, .nurbs_bins = bins },
                                                 SURFACE_FULL };
        const struct waiting_request waiting = { .wants = wants, .n_wants = 2 },
                                     first = { .wants = wants, .n_wants = 1 };
        assert_false(built_shapes_has_all(built, &first));
        built_shapes_add(built, &first);
        assert_true(built_shapes_has_all(built, &first));
        assert_false(built_shapes_has_all(built, &waiting)); /* only one of two */
        built_shapes_add(built, &waiting);
        assert_true(built_shapes_has_all(built, &waiting));
    }
    built_shapes_destroy(built);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_picture_wants_the_shapes_that_can_be_seen),
        cmocka_unit_test(what_was_built_once_is_not_waited_for_again),
        cmocka_unit_test(what_is_not_wanted_any_more_is_not_built),
        cmocka_unit_test(the_set_of_built_shapes_tells_any_number_of_shapes_apart),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
