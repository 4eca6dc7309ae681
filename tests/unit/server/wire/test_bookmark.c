/* Bookmarks: their form, opening those of other versions and of plans that have changed, the smallest patch, tokens.
 * The examples in tests/data/bookmarks are those that some version has written, or will have. */
#include "server/wire/bookmark.h"
#include "server/wire/document.h"
#include "server/wire/json_merge.h"
#include "server/wire/prune.h"
#include "tests/check.h"

static cJSON *parse(const char *text)
{
    struct problem problem = { 0 };
    cJSON *json = json_read(text, strlen(text), &problem);
    if (!json)
        fail_msg("%s: %s", text, problem.detail);
    return json;
}

static cJSON *example(const char *name)
{
    static char text[16384];
    char path[128];
    (void)snprintf(path, sizeof path, "tests/data/bookmarks/%s.json", name);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    size_t n = fread(text, 1, sizeof text - 1, file);
    (void)fclose(file);
    text[n] = 0;
    return parse(text);
}

/* The regions and images of the demo plan, with its scene as a new room has it. */
static const char *const regions[] = { "scalp", "cranium", "brain", "target", "tumour" };

static cJSON *demo_plan(size_t n_regions)
{
    cJSON *plan = parse("{\"id\":\"phantom\",\"images\":[{\"id\":\"ct\"}],\"doses\":[],\"beams\":[]}");
    cJSON *list = cJSON_AddArrayToObject(plan, "regions");
    for (size_t i = 0; i < n_regions; i++) {
        cJSON *region = cJSON_CreateObject();
        cJSON_AddStringToObject(region, "id", regions[i]);
        json_append(list, region);
    }
    return plan;
}

static cJSON *demo_scene(size_t n_regions)
{
    struct scene scene = scene_default;
    struct scene_region_style_entry entries[5];
    for (size_t i = 0; i < n_regions; i++) {
        entries[i] = (struct scene_region_style_entry){ .value = scene_region_style_default };
        (void)snprintf(entries[i].id, sizeof entries[i].id, "%s", regions[i]);
    }
    scene.regions = entries;
    scene.n_regions = n_regions;
    memcpy(scene.image.id, "ct", 3);
    return scene_write(&scene);
}

static cJSON *opened(const cJSON *body, size_t n_regions)
{
    struct problem problem = { 0 };
    assert_true(bookmark_check(body, &problem));
    cJSON *plan = demo_plan(n_regions), *defaults = demo_scene(n_regions);
    cJSON *result = bookmark_open(body, plan, defaults, &problem);
    if (!result)
        fail_msg("not opened: %s", problem.detail);
    cJSON_Delete(plan);
    cJSON_Delete(defaults);
    return result;
}

static const cJSON *at(const cJSON *json, const char *path) /* "views.0.document" */
{
    char name[64];
    while (json && *path) {
        size_t n = strcspn(path, ".");
        memcpy(name, path, n);
        name[n] = 0;
        json = cJSON_IsArray(json) ? cJSON_GetArrayItem(json, (int)strtol(name, NULL, 10))
                                   : cJSON_GetObjectItemCaseSensitive(json, name);
        path += n + (path[n] == '.');
    }
    return json;
}

static double number_at(const cJSON *json, const char *path)
{
    const cJSON *value = at(json, path);
    if (!cJSON_IsNumber(value))
        fail_msg("%s is no number", path);
    return value->valuedouble;
}

static const char *text_at(const cJSON *json, const char *path)
{
    const char *text = cJSON_GetStringValue(at(json, path));
    return text ? text : "";
}

/* "pointer code" of each line of the report must be these, in order. */
static void assert_report(const cJSON *json, const char *const *lines, size_t n)
{
    const cJSON *report = at(json, "report");
    char line[256];
    for (size_t i = 0; i < n; i++) {
        const cJSON *item = cJSON_GetArrayItem(report, (int)i);
        (void)snprintf(line, sizeof line, "%s %s", text_at(item, "pointer"), text_at(item, "code"));
        assert_string_equal(line, lines[i]);
        assert_true(strlen(text_at(item, "detail")) > 10);
    }
    assert_int_equal(cJSON_GetArraySize(report), n);
    assert_int_equal(number_at(json, "n_report"), n);
}

static void a_bookmark_of_version_1_opens_whole(void **state)
{
    (void)state;
    cJSON *body = example("version-1"), *result = opened(body, 5);
    assert_report(result, NULL, 0);
    assert_string_equal(text_at(result, "name"), "Tumour behind the beam");
    assert_true(cJSON_IsFalse(at(result, "scene.regions.scalp.visible")));
    assert_close(number_at(result, "scene.regions.brain.opacity"), 0.25, 1e-12);
    assert_true(cJSON_IsTrue(at(result, "scene.regions.tumour.visible"))); /* the plan's own */
    assert_close(number_at(result, "scene.image.slices.axial.position_mm"), 21.5, 1e-12);
    assert_int_equal(cJSON_GetArraySize(at(result, "scene.measures.m1.points")), 2);
    assert_int_equal(number_at(result, "views.1.view"), 2);
    assert_string_equal(text_at(result, "views.1.document.kind"), "axial");
    assert_close(number_at(result, "views.1.document.camera.height_mm"), 150, 1e-12);
    assert_null(at(result, "views.1.document.size_px"));
    assert_null(at(result, "views.1.document.override"));
    assert_string_equal(text_at(result, "layout.layout"), "2x1");
    cJSON_Delete(result);
    cJSON_Delete(body);
}

static void what_this_version_does_not_know_is_named_and_the_rest_is_shown(void **state)
{
    static const char *const lines[] = { "/version version",
                                         "/mood unknown-field",
                                         "/scene/regions/brain/glow unknown-field",
                                         "/scene/regions/liver unknown-id",
                                         "/scene/weather unknown-field",
                                         "/scene/image/window/curve unknown-field",
                                         "/scene/image/id unknown-id",
                                         "/scene/axes/visible type",
                                         "/views/0/document/camera/lens unknown-field",
                                         "/views/1/document/kind enum",
                                         "/views/1/document type" };
    (void)state;
    cJSON *body = example("version-2"), *result = opened(body, 5);
    assert_report(result, lines, sizeof lines / sizeof lines[0]);
    assert_close(number_at(result, "scene.regions.brain.opacity"), 0.5, 1e-12);
    assert_close(number_at(result, "scene.image.window.width"), 90, 1e-12);
    assert_string_equal(text_at(result, "scene.image.id"), "ct");
    assert_true(cJSON_IsBool(at(result, "scene.axes.visible")));
    assert_int_equal(cJSON_GetArraySize(at(result, "views")), 1);
    assert_close(number_at(result, "views.0.document.camera.fov_deg"), 40, 1e-12);
    cJSON_Delete(result);
    cJSON_Delete(body);
}

static void what_the_plan_has_lost_is_named(void **state)
{
    static const char *const lines[] = { "/scene/regions/scalp unknown-id", "/scene/regions/brain unknown-id" };
    (void)state;
    cJSON *body = example("version-1"), *result = opened(body, 0);
    assert_report(result, lines, 2);
    assert_close(number_at(result, "scene.image.window.width"), 120, 1e-12);
    cJSON_Delete(result);
    cJSON_Delete(body);
}

static void a_report_has_a_bound_and_counts_what_it_does_not_name(void **state)
{
    (void)state;
    cJSON *body = example("version-1"), *scene = cJSON_GetObjectItem(body, "scene");
    for (int i = 0; i < 500; i++) {
        char name[16];
        (void)snprintf(name, sizeof name, "later%d", i);
        cJSON_AddBoolToObject(scene, name, true);
    }
    cJSON *result = opened(body, 5);
    assert_int_equal(cJSON_GetArraySize(at(result, "report")), BOOKMARK_MAX_REPORT);
    assert_int_equal(number_at(result, "n_report"), 500);
    cJSON_Delete(result);
    cJSON_Delete(body);
}

/* 40 values that are not valid: after MAX_TRIES the plan's own scene is shown, and it is said. */
static void a_scene_of_nonsense_gives_the_plans_own_and_says_so(void **state)
{
    (void)state;
    cJSON *body = example("version-1"), *measures = cJSON_CreateObject();
    for (int i = 0; i < 40; i++) {
        char name[16];
        (void)snprintf(name, sizeof name, "m%d", i);
        json_add(measures, name, parse("{\"visible\":7}"));
    }
    cJSON *scene = cJSON_GetObjectItem(body, "scene");
    cJSON_ReplaceItemInObject(scene, "measures", measures);
    cJSON *result = opened(body, 5), *defaults = demo_scene(5);
    assert_true(json_equal(at(result, "scene"), defaults));
    const cJSON *report = at(result, "report");
    assert_string_equal(text_at(cJSON_GetArrayItem(report, cJSON_GetArraySize(report) - 1), "detail"),
                        "the scene cannot be shown: the plan's own is shown instead");
    cJSON_Delete(defaults);
    cJSON_Delete(result);
    cJSON_Delete(body);
}

static void the_smallest_patch_makes_the_scene_again(void **state)
{
    static const char *const patches[] = {
        "{}",
        "{\"regions\":{\"brain\":{\"opacity\":0.3}},\"axes\":{\"visible\":true}}",
        "{\"image\":{\"slices\":{\"axial\":{\"position_mm\":12}},\"obliques\":{\"a\":{\"normal\":[0,1,1]}}}}",
        "{\"measures\":{\"m1\":{\"kind\":\"angle\",\"points\":[{\"at_mm\":[1,2,3]}]}}}",
    };
    (void)state;
    cJSON *plan = demo_plan(5), *defaults = demo_scene(5);
    struct problem problem = { 0 };
    for (size_t i = 0; i < sizeof patches / sizeof patches[0]; i++) {
        cJSON *given = parse(patches[i]);
        cJSON *scene = scene_document_patch(plan, defaults, defaults, given, &problem);
        cJSON *patch = bookmark_difference(defaults, scene);
        cJSON *again = scene_document_patch(plan, defaults, defaults, patch, &problem);
        assert_true(json_equal(again, scene));
        if (i < 2)
            assert_true(json_equal(patch, given)); /* these name nothing but what differs */
        cJSON_Delete(again);
        cJSON_Delete(patch);
        cJSON_Delete(scene);
        cJSON_Delete(given);
    }
    /* an entry of the plan's own scene that was taken away stays away */
    cJSON *level = parse("{\"dose\":{\"levels\":{\"95\":{\"value\":95}}}}"),
          *none = parse("{\"dose\":{\"levels\":{\"95\":null}}}");
    cJSON *with = scene_document_patch(plan, defaults, defaults, level, &problem);
    cJSON *patch = bookmark_difference(with, defaults);
    assert_true(json_equal(patch, none));
    cJSON *again = scene_document_patch(plan, with, with, patch, &problem);
    assert_true(json_equal(again, defaults));
    cJSON_Delete(again);
    cJSON_Delete(patch);
    cJSON_Delete(with);
    cJSON_Delete(none);
    cJSON_Delete(level);
    cJSON_Delete(defaults);
    cJSON_Delete(plan);
}

static void a_body_of_another_form_is_refused_with_its_place(void **state)
{
    static const struct {
        const char *patch, *pointer, *code;
    } cases[] = {
        { "{\"format\":null}", "/format", "required" },
        { "{\"format\":\"beamroom-plan\"}", "/format", "enum" },
        { "{\"version\":null}", "/version", "range" },
        { "{\"version\":0}", "/version", "range" },
        { "{\"version\":1.5}", "/version", "range" },
        { "{\"name\":\"\"}", "/name", "required" },
        { "{\"name\":7}", "/name", "required" },
        { "{\"name\":\"a\\nb\"}", "/name", "length" },
        { "{\"plan\":\"../x\"}", "/plan", "pattern" },
        { "{\"order\":\"first\"}", "/order", "range" },
        { "{\"order\":2e9}", "/order", "range" },
        { "{\"scene\":[1]}", "/scene", "type" },
        { "{\"token\":7}", "/token", "pattern" },
        { "{\"views\":null}", "/views", "required" },
        { "{\"views\":{}}", "/views", "type" },
        { "{\"views\":[{\"view\":1}]}", "/views/0", "type" },
        { "{\"views\":[{\"view\":9,\"document\":{}}]}", "/views/0", "range" },
        { "{\"views\":[{\"view\":1,\"document\":{}},{\"view\":1,\"document\":{}}]}", "/views/1", "duplicate" },
        { "{\"layout\":[]}", "/layout", "type" },
        { "{\"layout\":{\"cells\":[1,2,3,4,5,6,7,8,9]}}", "/layout", "count" },
        { "{\"layout\":{\"cells\":[[1]]}}", "/layout", "type" },
        { "{\"layout\":{\"layout\":{\"deep\":1}}}", "/layout", "type" },
    };
    (void)state;
    cJSON *good = example("version-1");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct problem problem = { 0 };
        cJSON *patch = parse(cases[i].patch), *body = json_merge(good, patch);
        if (bookmark_check(body, &problem))
            fail_msg("%s was accepted", cases[i].patch);
        assert_string_equal(problem.pointer, cases[i].pointer);
        assert_string_equal(problem.code, cases[i].code);
        cJSON_Delete(body);
        cJSON_Delete(patch);
    }
    struct problem problem = { 0 };
    assert_false(bookmark_check(NULL, &problem));
    cJSON *list = parse("[]");
    assert_false(bookmark_check(list, &problem));
    cJSON_Delete(list);
    cJSON_Delete(good);
}

static void name_and_size_have_limits(void **state)
{
    static char text[BOOKMARK_MAX_BYTES + 1];
    (void)state;
    struct problem problem = { 0 };
    cJSON *body = example("version-1");
    char name[2 * BOOKMARK_MAX_NAME + 2] = "";
    for (size_t i = 0; i < 2 * BOOKMARK_MAX_NAME; i += 2)
        memcpy(name + i, "\xc3\xa4", 2); /* one character */
    cJSON_ReplaceItemInObject(body, "name", cJSON_CreateString(name));
    assert_true(bookmark_check(body, &problem));
    name[2 * BOOKMARK_MAX_NAME] = 'x';
    cJSON_ReplaceItemInObject(body, "name", cJSON_CreateString(name));
    assert_false(bookmark_check(body, &problem));
    assert_string_equal(problem.pointer, "/name");
    cJSON_Delete(body);

    body = example("version-1");
    memset(text, 'x', sizeof text - 1);
    cJSON_AddStringToObject(body, "later", text);
    assert_false(bookmark_check(body, &problem));
    assert_int_equal(problem.type, PROBLEM_TOO_LARGE);
    cJSON_Delete(body);
}

static void tokens_are_ids_and_differ(void **state)
{
    char one[BOOKMARK_TOKEN_CHARS + 1], two[BOOKMARK_TOKEN_CHARS + 1];
    (void)state;
    assert_true(bookmark_make_token(one) && bookmark_make_token(two));
    assert_int_equal(strlen(one), BOOKMARK_TOKEN_CHARS);
    assert_true(id_is_valid(one));
    assert_string_not_equal(one, two);
    cJSON *body = example("version-1");
    assert_true(bookmark_has_token(body, "qwe2rty3u4p5asd6fgh7"));
    assert_false(bookmark_has_token(body, "qwe2rty3u4p5asd6fgh8"));
    assert_false(bookmark_has_token(body, "qwe2rty3u4p5asd6fgh"));
    assert_false(bookmark_has_token(body, ""));
    cJSON_DeleteItemFromObject(body, "token");
    assert_false(bookmark_has_token(body, ""));
    cJSON_Delete(body);
}

static void a_pointer_takes_out_the_value_or_what_holds_it(void **state)
{
    (void)state;
    cJSON *json = parse("{\"a\":{\"b/c\":1,\"d\":{\"e\":2}},\"f\":[1,2]}"), *left = parse("{\"a\":{}}");
    assert_true(prune_at(json, "/a/b~1c"));
    assert_true(prune_at(json, "/a/d/missing"));
    assert_true(prune_at(json, "/f/1"));
    assert_true(json_equal(json, left));
    assert_false(prune_at(json, ""));
    assert_false(prune_at(json, "/nothing"));
    cJSON_Delete(left);
    cJSON_Delete(json);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_bookmark_of_version_1_opens_whole),
        cmocka_unit_test(what_this_version_does_not_know_is_named_and_the_rest_is_shown),
        cmocka_unit_test(what_the_plan_has_lost_is_named),
        cmocka_unit_test(a_report_has_a_bound_and_counts_what_it_does_not_name),
        cmocka_unit_test(a_scene_of_nonsense_gives_the_plans_own_and_says_so),
        cmocka_unit_test(the_smallest_patch_makes_the_scene_again),
        cmocka_unit_test(a_body_of_another_form_is_refused_with_its_place),
        cmocka_unit_test(name_and_size_have_limits),
        cmocka_unit_test(tokens_are_ids_and_differ),
        cmocka_unit_test(a_pointer_takes_out_the_value_or_what_holds_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
