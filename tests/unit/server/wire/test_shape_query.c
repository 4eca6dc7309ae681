/* Queries for shapes: what is read, and what is refused with the field it names. */
#include "server/wire/document.h"
#include "server/wire/shape_query.h"
#include "tests/check.h"
#include "wire_gen.h"

static struct shape_query good(const char *text)
{
    cJSON *json = cJSON_Parse(text);
    struct shape_query query;
    struct problem problem = { 0 };
    assert_non_null(json);
    if (!shape_query_read(json, &query, &problem))
        fail_msg("%s was refused: %s", text, problem.detail);
    cJSON_Delete(json);
    return query;
}

static void the_words_of_the_scene_are_those_of_the_shapes_in_the_same_order(void **state)
{
    (void)state;
    assert_int_equal(scene_representation_words.n, REPRESENTATION_N);
    for (int i = 0; i < REPRESENTATION_N; i++)
        assert_string_equal(scene_representation_words.words[i],
                            region_representation_word((enum region_representation)i));
    assert_int_equal(scene_algorithm_words.n, SURFACE_N_ALGORITHMS);
    for (int i = 0; i < SURFACE_N_ALGORITHMS; i++)
        assert_string_equal(scene_algorithm_words.words[i], surface_algorithm_word((enum surface_algorithm)i));
    assert_string_equal(scene_outline_method_words.words[OUTLINE_MARCHING_SQUARES], "marching-squares");
    assert_string_equal(scene_nurbs_sampling_words.words[NURBS_DEGREE_BINS], "degree-bins");
    assert_string_equal(scene_normals_words.words[1], "face");
}

static void what_is_left_out_is_the_scenes_default(void **state)
{
    (void)state;
    struct shape_query query = good("{}");
    assert_int_equal(query.key.representation, REPRESENTATION_SURFACE);
    assert_string_equal(surface_algorithm_word(query.key.algorithm),
                        scene_algorithm_words.words[scene_default.surface.algorithm]);
    assert_false(query.is_faceted || query.is_file || query.n_frames);
    query = good("{\"representation\":\"nurbs\"}");
    assert_int_equal(query.key.nurbs_order, scene_default.nurbs.order);
    assert_int_equal(query.key.nurbs_bins, scene_default.nurbs.bins);
}

static void each_word_decides_what_it_names_and_nothing_else(void **state)
{
    (void)state;
    struct shape_query query = good(
        "{\"representation\":\"nurbs\",\"order\":\"3\",\"sampling\":\"degree-bins\",\"bins\":\"72\",\"algorithm\":\"eight-cell\"}");
    struct shape_key key = {
        .representation = REPRESENTATION_NURBS, .nurbs_order = 3, .nurbs_sampling = NURBS_DEGREE_BINS, .nurbs_bins = 72
    };
    shape_key_normalise(&key);
    assert_true(shape_key_equal(&query.key, &key)); /* the algorithm is not a spline's */
    query = good("{\"representation\":\"points\",\"inner_boundary\":\"true\"}");
    assert_true(query.key.has_inner_boundary);
    query = good("{\"representation\":\"outline\",\"outline\":\"marching-squares\",\"frames\":\"50\"}");
    assert_int_equal(query.key.outline, OUTLINE_MARCHING_SQUARES);
    assert_int_equal(query.n_frames, 50);
    query = good("{\"algorithm\":\"eight-cell\",\"normals\":\"face\",\"format\":\"glb\"}");
    assert_true(query.is_faceted && query.is_file);
    assert_int_equal(query.format, MESH_GLB);
}

static void what_cannot_be_is_refused_by_name(void **state)
{
    (void)state;
    static const struct {
        const char *text, *pointer;
    } bad[] = {
        { "{\"representation\":\"hologram\"}", "/representation" },
        { "{\"algorithm\":\"magic\"}", "/algorithm" },
        { "{\"normals\":\"both\"}", "/normals" },
        { "{\"outline\":\"\"}", "/outline" },
        { "{\"outline\":\"surface\"}", "/outline" }, /* no method of tracing univels */
        { "{\"inner_boundary\":\"yes\"}", "/inner_boundary" },
        { "{\"order\":\"1\"}", "/order" },
        { "{\"order\":\"5\"}", "/order" },
        { "{\"order\":\"3.5\"}", "/order" },
        { "{\"order\":\" 3\"}", "/order" },
        { "{\"bins\":\"7\"}", "/bins" },
        { "{\"bins\":\"99999999999999999999\"}", "/bins" },
        { "{\"sampling\":\"dice\"}", "/sampling" },
        { "{\"frames\":\"51\"}", "/frames" },
        { "{\"format\":\"obj\"}", "/format" },
        { "{\"representation\":\"points\",\"format\":\"stl\"}", "/format" },
        { "{\"representation\":\"outline\",\"format\":\"ply\"}", "/format" },
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        cJSON *json = cJSON_Parse(bad[i].text);
        struct shape_query query;
        struct problem problem = { 0 };
        if (shape_query_read(json, &query, &problem))
            fail_msg("%s was taken", bad[i].text);
        assert_int_equal(problem.type, PROBLEM_VALIDATION);
        assert_string_equal(problem.pointer, bad[i].pointer);
        cJSON_Delete(json);
    }
}

static void the_scene_of_a_shape_shows_it_alone(void **state)
{
    (void)state;
    struct scene scene = scene_default;
    struct scene_region_style_entry entries[2] = { { "brain", { .visible = true, .opacity = 0.4 } },
                                                   { "tumor", { .visible = true, .opacity = 1 } } };
    scene.regions = entries;
    scene.n_regions = 2;
    scene.image.slices.coronal.visible = true;
    cJSON *plan = cJSON_Parse("{\"regions\":[{\"id\":\"brain\"},{\"id\":\"tumor\"}],\"images\":[],\"doses\":[]}");
    struct problem problem = { 0 };
    struct shape_query query = good("{\"representation\":\"nurbs\",\"order\":\"2\",\"bins\":\"12\"}");
    cJSON *document = scene_write(&scene), *patch = shape_query_scene(&query, "brain", document);
    cJSON *patched = scene_document_patch(plan, document, document, patch, &problem);
    struct scene shown;
    assert_non_null(patched);
    assert_true(scene_read(patched, &shown, &problem));
    assert_true(shown.regions[0].value.visible);
    assert_int_equal(shown.regions[0].value.representation, SCENE_REPRESENTATION_NURBS);
    assert_close(shown.regions[0].value.opacity, 1, 0);
    assert_false(shown.regions[1].value.visible || shown.image.slices.coronal.visible);
    assert_int_equal(shown.nurbs.order, 2);
    assert_int_equal(shown.nurbs.bins, 12);
    scene_finish(&shown);
    cJSON_Delete(plan);
    cJSON_Delete(document);
    cJSON_Delete(patch);
    cJSON_Delete(patched);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_words_of_the_scene_are_those_of_the_shapes_in_the_same_order),
        cmocka_unit_test(what_is_left_out_is_the_scenes_default),
        cmocka_unit_test(each_word_decides_what_it_names_and_nothing_else),
        cmocka_unit_test(what_cannot_be_is_refused_by_name),
        cmocka_unit_test(the_scene_of_a_shape_shows_it_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
