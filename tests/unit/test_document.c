#include "server/wire/document.h"
#include "tests/check.h"

static const char *const images[] = { "ct", "mr", NULL };

static cJSON *parse(const char *text)
{
    cJSON *json = cJSON_Parse(text);
    assert_non_null(json);
    return json;
}

/* A plan with a brain and a tumor, as its renderer would give it. */
static cJSON *plan_defaults(void)
{
    struct scene scene = scene_default;
    struct scene_region_style_entry entries[2] = { { "brain", { .visible = true, .color_rgb = 0xd696a0, .opacity = 0.45 } },
                                                    { "tumor", { .visible = true, .color_rgb = 0x46be50, .opacity = 1 } } };
    scene.regions = entries;
    scene.n_regions = 2;
    memcpy(scene.image.id, "ct", 3);
    return scene_write(&scene);
}

static const cJSON *at(const cJSON *json, const char *path) /* "regions.brain.opacity" */
{
    char name[64];
    while (json && *path) {
        size_t n = strcspn(path, ".");
        memcpy(name, path, n);
        name[n] = 0;
        json = cJSON_GetObjectItemCaseSensitive(json, name);
        path += n + (path[n] == '.');
    }
    return json;
}

static cJSON *patched(const cJSON *defaults, const cJSON *current, const char *patch)
{
    struct problem problem = { 0 };
    cJSON *json = parse(patch);
    cJSON *next = scene_document_patch(defaults, images, current, json, &problem);
    if (!next)
        fail_msg("%s was refused: %s", patch, problem.detail);
    cJSON_Delete(json);
    return next;
}

static void a_patch_changes_what_it_names_and_null_gives_the_plans_value_back(void **state)
{
    (void)state;
    cJSON *defaults = plan_defaults();
    cJSON *one = patched(defaults, defaults, "{\"regions\":{\"brain\":{\"opacity\":0.2}},\"image\":{\"window\":{\"width\":80}}}");
    assert_close(at(one, "regions.brain.opacity")->valuedouble, 0.2, 0);
    assert_string_equal(at(one, "regions.brain.color")->valuestring, "#d696a0");
    assert_close(at(one, "regions.tumor.opacity")->valuedouble, 1, 0);
    assert_close(at(one, "image.window.width")->valuedouble, 80, 0);
    assert_close(at(one, "image.window.center")->valuedouble, 40, 0);
    cJSON *two = patched(defaults, one, "{\"regions\":{\"brain\":null},\"image\":{\"window\":{\"width\":null}}}");
    assert_true(cJSON_Compare(two, defaults, true));
    cJSON_Delete(defaults);
    cJSON_Delete(one);
    cJSON_Delete(two);
}

static void who_keeps_a_copy_is_told_what_null_became(void **state)
{
    (void)state;
    cJSON *defaults = plan_defaults();
    cJSON *one = patched(defaults, defaults, "{\"regions\":{\"brain\":{\"opacity\":0.2}},\"image\":{\"window\":{\"width\":80}}}");
    cJSON *patch = parse("{\"regions\":{\"brain\":null,\"tumor\":{\"opacity\":0.5}},\"image\":{\"window\":{\"width\":null}}}");
    cJSON *two = scene_document_patch(defaults, images, one, patch, NULL);
    cJSON *told = document_told_patch(two, patch);
    cJSON *copy = json_merge(one, told); /* by RFC 7396 alone, as the page does it: null would take the field away */
    assert_true(cJSON_Compare(copy, two, true));
    assert_true(cJSON_Compare(at(told, "regions.brain"), at(defaults, "regions.brain"), true));
    assert_close(at(told, "image.window.width")->valuedouble, at(defaults, "image.window.width")->valuedouble, 0);
    assert_null(cJSON_GetObjectItem(told, "surface")); /* no more than was said */
    cJSON *all[] = { defaults, one, patch, two, told, copy };
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        cJSON_Delete(all[i]);
}

static void expect_refused(const char *patch, enum problem_type type, const char *pointer)
{
    cJSON *defaults = plan_defaults(), *before = plan_defaults(), *json = parse(patch);
    struct problem problem = { 0 };
    cJSON *next = scene_document_patch(defaults, images, before, json, &problem);
    if (next)
        fail_msg("%s was accepted", patch);
    assert_int_equal(problem.type, type);
    assert_string_equal(problem.pointer, pointer);
    assert_true(cJSON_Compare(before, defaults, true)); /* nothing half-applied */
    cJSON_Delete(defaults);
    cJSON_Delete(before);
    cJSON_Delete(json);
}

static void a_patch_with_any_wrong_field_is_refused_whole(void **state)
{
    (void)state;
    expect_refused("{\"regions\":{\"tumor\":{\"opacity\":0.5},\"brain\":{\"opacity\":1.5}}}", PROBLEM_VALIDATION, "/regions/brain/opacity");
    expect_refused("{\"regions\":{\"liver\":{\"visible\":true}}}", PROBLEM_NOT_FOUND, "/regions/liver");
    expect_refused("{\"regions\":{\"a/b\":{\"visible\":true}}}", PROBLEM_VALIDATION, "/regions/a~1b");
    expect_refused("{\"regions\":{\"brain\":{\"color\":\"red\"}}}", PROBLEM_VALIDATION, "/regions/brain/color");
    expect_refused("{\"image\":{\"id\":\"pet\"}}", PROBLEM_NOT_FOUND, "/image/id");
    expect_refused("{\"image\":{\"window\":{\"width\":0}}}", PROBLEM_VALIDATION, "/image/window/width");
    expect_refused("{\"surface\":{\"normals\":\"flat\"}}", PROBLEM_VALIDATION, "/surface/normals");
    expect_refused("{\"surface\":{\"algorithm\":\"magic\"}}", PROBLEM_VALIDATION, "/surface/algorithm");
    expect_refused("{\"beam\":{}}", PROBLEM_VALIDATION, "/beam");
    expect_refused("{\"image\":{\"slices\":{\"axial\":{\"position_mm\":1e300}}}}", PROBLEM_VALIDATION, "/image/slices/axial/position_mm");
    expect_refused("[1]", PROBLEM_VALIDATION, "");
}

static void a_view_gets_defaults_and_keeps_its_override(void **state)
{
    (void)state;
    struct problem problem = { 0 };
    cJSON *patch = parse("{\"kind\":\"axial\",\"override\":{\"regions\":{\"brain\":{\"visible\":false}}}}");
    cJSON *view = view_document_patch(NULL, patch, &problem);
    assert_non_null(view);
    assert_string_equal(at(view, "kind")->valuestring, "axial");
    assert_int_equal(at(view, "size_px")->child->valueint, 1024);
    assert_true(cJSON_IsNull(at(view, "camera.position_mm")));
    cJSON *defaults = plan_defaults();
    cJSON *shown = scene_document_for_view(defaults, images, defaults, view, &problem);
    assert_non_null(shown);
    assert_true(cJSON_IsFalse(at(shown, "regions.brain.visible")));
    assert_true(cJSON_IsTrue(at(shown, "regions.tumor.visible")));
    struct view decoded;
    assert_true(view_read(view, &decoded, &problem));
    assert_int_equal(decoded.kind, SCENE_KIND_AXIAL);
    assert_false(decoded.camera.has_position_mm);
    view_finish(&decoded);
    cJSON_Delete(shown);
    cJSON_Delete(patch);
    patch = parse("{\"override\":{\"regions\":{\"liver\":{}}}}");
    cJSON *other = view_document_patch(view, patch, &problem);
    assert_non_null(other); /* the view's own fields are right; what it overrides is checked against the plan */
    assert_null(scene_document_for_view(defaults, images, defaults, other, &problem));
    assert_string_equal(problem.pointer, "/override/regions/liver");
    cJSON_Delete(other);
    cJSON_Delete(patch);
    patch = parse("{\"size_px\":[100000,768]}");
    assert_null(view_document_patch(view, patch, &problem));
    assert_string_equal(problem.pointer, "/size_px/0");
    cJSON_Delete(patch);
    cJSON_Delete(view);
    cJSON_Delete(defaults);
}

/* The examples of RFC 7396, appendix A. */
static void merge_patches_follow_the_examples_of_the_standard(void **state)
{
    (void)state;
    static const char *const cases[][3] = {
        { "{\"a\":\"b\"}", "{\"a\":\"c\"}", "{\"a\":\"c\"}" },
        { "{\"a\":\"b\"}", "{\"b\":\"c\"}", "{\"a\":\"b\",\"b\":\"c\"}" },
        { "{\"a\":\"b\"}", "{\"a\":null}", "{}" },
        { "{\"a\":\"b\",\"b\":\"c\"}", "{\"a\":null}", "{\"b\":\"c\"}" },
        { "{\"a\":[\"b\"]}", "{\"a\":\"c\"}", "{\"a\":\"c\"}" },
        { "{\"a\":\"c\"}", "{\"a\":[\"b\"]}", "{\"a\":[\"b\"]}" },
        { "{\"a\":{\"b\":\"c\"}}", "{\"a\":{\"b\":\"d\",\"c\":null}}", "{\"a\":{\"b\":\"d\"}}" },
        { "{\"a\":[{\"b\":\"c\"}]}", "{\"a\":[1]}", "{\"a\":[1]}" },
        { "[\"a\",\"b\"]", "[\"c\",\"d\"]", "[\"c\",\"d\"]" },
        { "{\"a\":\"b\"}", "[\"c\"]", "[\"c\"]" },
        { "{\"a\":\"foo\"}", "null", "null" },
        { "{\"a\":\"foo\"}", "\"bar\"", "\"bar\"" },
        { "{\"e\":null}", "{\"a\":1}", "{\"e\":null,\"a\":1}" },
        { "[1,2]", "{\"a\":\"b\",\"c\":null}", "{\"a\":\"b\"}" },
        { "{}", "{\"a\":{\"bb\":{\"ccc\":null}}}", "{\"a\":{\"bb\":{}}}" },
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        cJSON *target = parse(cases[i][0]), *patch = parse(cases[i][1]), *expected = parse(cases[i][2]);
        cJSON *merged = json_merge(target, patch);
        char *text = json_write(merged);
        if (!cJSON_Compare(merged, expected, true))
            fail_msg("example %zu gave %s, expected %s", i + 1, text, cases[i][2]);
        free(text);
        cJSON_Delete(target);
        cJSON_Delete(patch);
        cJSON_Delete(expected);
        cJSON_Delete(merged);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_patch_changes_what_it_names_and_null_gives_the_plans_value_back),
        cmocka_unit_test(who_keeps_a_copy_is_told_what_null_became),
        cmocka_unit_test(a_patch_with_any_wrong_field_is_refused_whole),
        cmocka_unit_test(a_view_gets_defaults_and_keeps_its_override),
        cmocka_unit_test(merge_patches_follow_the_examples_of_the_standard),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
