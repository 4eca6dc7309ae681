/* Scene and view documents: patches, defaults, references to the plan, merge patches (RFC 7396). */
#include "server/wire/document.h"
#include "server/wire/json_merge.h"
#include "server/wire/patch.h"
#include "tests/check.h"

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
    struct scene_region_style_entry entries[2] = {
        { "brain", { .visible = true, .color_rgb = 0xd696a0, .opacity = 0.45 } },
        { "tumor", { .visible = true, .color_rgb = 0x46be50, .opacity = 1 } }
    };
    scene.regions = entries;
    scene.n_regions = 2;
    memcpy(scene.image.id, "ct", 3);
    return scene_write(&scene);
}

/* Its plan document, as far as scenes name something of it. */
static cJSON *plan_of_scenes(void)
{
    return parse(
        "{\"id\":\"head\",\"images\":[{\"id\":\"ct\"},{\"id\":\"mr\"}],\"regions\":[{\"id\":\"brain\"},{\"id\":\"tumor\"}],"
        "\"doses\":[{\"id\":\"plan\"}],\"beams\":[]}");
}

static cJSON *patch_scene(const cJSON *defaults, const cJSON *current, const cJSON *patch, struct problem *problem)
{
    cJSON *plan = plan_of_scenes();
    cJSON *next = scene_document_patch(plan, defaults, current, patch, problem);
    cJSON_Delete(plan);
    return next;
}

static cJSON *scene_for_view(const cJSON *defaults, const cJSON *view, struct problem *problem)
{
    cJSON *plan = plan_of_scenes();
    cJSON *shown = scene_document_for_view(plan, defaults, defaults, view, problem);
    cJSON_Delete(plan);
    return shown;
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
    cJSON *next = patch_scene(defaults, current, json, &problem);
    if (!next)
        fail_msg("%s was refused: %s", patch, problem.detail);
    cJSON_Delete(json);
    return next;
}

static void a_patch_changes_what_it_names_and_null_gives_the_plans_value_back(void **state)
{
    (void)state;
    cJSON *defaults = plan_defaults();
    cJSON *one = patched(defaults, defaults,
                         "{\"regions\":{\"brain\":{\"opacity\":0.2}},\"image\":{\"window\":{\"width\":80}}}");
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
    cJSON *one = patched(defaults, defaults,
                         "{\"regions\":{\"brain\":{\"opacity\":0.2}},\"image\":{\"window\":{\"width\":80}}}");
    cJSON *patch =
        parse("{\"regions\":{\"brain\":null,\"tumor\":{\"opacity\":0.5}},\"image\":{\"window\":{\"width\":null}}}");
    cJSON *two = patch_scene(defaults, one, patch, NULL);
    cJSON *told = patch_told(one, two, patch);
    cJSON *copy = json_merge(one, told); /* by RFC 7396 alone, as the page does it: null would take the field away */
    assert_true(cJSON_Compare(copy, two, true));
    assert_true(cJSON_Compare(at(told, "regions.brain"), at(defaults, "regions.brain"), true));
    assert_close(at(told, "image.window.width")->valuedouble, at(defaults, "image.window.width")->valuedouble, 0);
    assert_null(cJSON_GetObjectItem(told, "surface")); /* no more than was said */
    cJSON *all[] = { defaults, one, patch, two, told, copy };
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        cJSON_Delete(all[i]);
}

static void expect_refused_as(const char *patch, enum problem_type type, const char *pointer, const char *code)
{
    cJSON *defaults = plan_defaults(), *before = plan_defaults(), *json = parse(patch);
    struct problem problem = { 0 };
    cJSON *next = patch_scene(defaults, before, json, &problem);
    if (next)
        fail_msg("%s was accepted", patch);
    assert_int_equal(problem.type, type);
    assert_string_equal(problem.pointer, pointer);
    if (code)
        assert_string_equal(problem.code, code);
    assert_true(cJSON_Compare(before, defaults, true)); /* nothing half-applied */
    cJSON_Delete(defaults);
    cJSON_Delete(before);
    cJSON_Delete(json);
}

static void expect_refused(const char *patch, enum problem_type type, const char *pointer)
{
    expect_refused_as(patch, type, pointer, NULL);
}

static void a_patch_with_any_wrong_field_is_refused_whole(void **state)
{
    (void)state;
    expect_refused("{\"regions\":{\"tumor\":{\"opacity\":0.5},\"brain\":{\"opacity\":1.5}}}", PROBLEM_VALIDATION,
                   "/regions/brain/opacity");
    expect_refused("{\"regions\":{\"liver\":{\"visible\":true}}}", PROBLEM_VALIDATION, "/regions/liver");
    expect_refused("{\"regions\":{\"a/b\":{\"visible\":true}}}", PROBLEM_VALIDATION, "/regions/a~1b");
    expect_refused("{\"regions\":{\"brain\":{\"color\":\"red\"}}}", PROBLEM_VALIDATION, "/regions/brain/color");
    expect_refused("{\"image\":{\"id\":\"pet\"}}", PROBLEM_VALIDATION, "/image/id");
    expect_refused("{\"image\":{\"window\":{\"width\":0}}}", PROBLEM_VALIDATION, "/image/window/width");
    expect_refused("{\"surface\":{\"normals\":\"flat\"}}", PROBLEM_VALIDATION, "/surface/normals");
    expect_refused("{\"surface\":{\"algorithm\":\"magic\"}}", PROBLEM_VALIDATION, "/surface/algorithm");
    expect_refused("{\"beams\":{}}", PROBLEM_VALIDATION, "/beams");
    expect_refused("{\"image\":{\"slices\":{\"axial\":{\"position_mm\":1e300}}}}", PROBLEM_VALIDATION,
                   "/image/slices/axial/position_mm");
    expect_refused("[1]", PROBLEM_VALIDATION, "");
}

/* Puts an id that the plan does not have into each field of the table that names something of the plan, one patch each,
 * and expects it to be refused at that field. before and behind: the JSON around the object. Returns how many fields.
 */
static size_t expect_references(const struct field_object *object, const char *before, const char *behind,
                                const char *pointer)
{
    size_t n = 0;
    char opened[256], closed[64], at_field[128];
    for (size_t i = 0; i < object->n_fields; i++) {
        const struct field *field = &object->fields[i];
        (void)snprintf(opened, sizeof opened, "%s\"%s\":", before, field->name);
        (void)snprintf(at_field, sizeof at_field, "%s/%s", pointer, field->name);
        if (field->type == FIELD_OBJECT) {
            (void)snprintf(closed, sizeof closed, "}%s", behind);
            (void)snprintf(opened + strlen(opened), sizeof opened - strlen(opened), "{");
            n += expect_references(field->object, opened, closed, at_field);
        } else if (field->names) {
            char patch[512];
            (void)snprintf(patch, sizeof patch, "%s%s%s", opened,
                           field->type == FIELD_ID ? "\"nowhere\"" : "{\"nowhere\":{}}", behind);
            if (field->type == FIELD_MAP)
                (void)snprintf(at_field + strlen(at_field), sizeof at_field - strlen(at_field), "/nowhere");
            expect_refused_as(patch, PROBLEM_VALIDATION, at_field, "unknown-id");
            n++;
        } else if (field->type == FIELD_ID) {
            fail_msg("%s holds an id and proto/scene.json does not say what it names", at_field);
        }
    }
    return n;
}

static void every_field_that_names_something_of_the_plan_is_refused_when_the_plan_has_no_such_thing(void **state)
{
    (void)state;
    /* regions, check.region, image.id, image.looks, image.blend.id, beam.id, beam.looks, clip.beam.id, and of a dose:
     * id, sum, tissue, weights, reference.region, coverage.region, coverage.tissue, compare.id, and irradiation.fields
     */
    assert_int_equal(expect_references(&scene_object, "{", "}", ""), 17);
    cJSON *defaults = plan_defaults();
    cJSON *scene = patched(defaults, defaults,
                           "{\"image\":{\"id\":\"mr\"},\"dose\":{\"id\":\"plan\"},\"check\":{\"region\":\"tumor\"}}");
    assert_string_equal(at(scene, "dose.id")->valuestring, "plan");
    cJSON *none =
        patched(defaults, scene, "{\"image\":{\"id\":\"\"},\"dose\":{\"id\":\"\"},\"check\":{\"region\":\"\"}}");
    assert_string_equal(at(none, "check.region")->valuestring, ""); /* empty names nothing */
    cJSON_Delete(defaults);
    cJSON_Delete(scene);
    cJSON_Delete(none);
}

/* Keys may come in any order, and a plan has up to 1024 regions: each is found, and the one it does not have is named.
 */
static void regions_are_found_whatever_order_a_patch_names_them_in(void **state)
{
    (void)state;
    enum { N = 1024 };
    struct problem problem = { 0 };
    cJSON *plan = cJSON_CreateObject(), *regions = cJSON_AddArrayToObject(plan, "regions");
    cJSON *forward = cJSON_CreateObject(), *backward = cJSON_CreateObject();
    cJSON *up = cJSON_AddObjectToObject(forward, "regions"), *down = cJSON_AddObjectToObject(backward, "regions");
    for (int i = 0; i < N; i++) {
        char id[16];
        cJSON *region = cJSON_CreateObject();
        (void)snprintf(id, sizeof id, "r%d", i);
        cJSON_AddStringToObject(region, "id", id);
        cJSON_AddItemToArray(regions, region);
        (void)cJSON_AddObjectToObject(up, id);
        (void)snprintf(id, sizeof id, "r%d", N - 1 - i);
        (void)cJSON_AddObjectToObject(down, id);
    }
    cJSON *nothing = cJSON_CreateObject();
    cJSON *one = scene_document_patch(plan, nothing, nothing, forward, &problem),
          *two = scene_document_patch(plan, nothing, nothing, backward, &problem);
    assert_non_null(one);
    assert_non_null(two);
    assert_int_equal(cJSON_GetArraySize(at(two, "regions")), N);
    cJSON_DeleteItemFromArray(regions, 700);
    assert_null(scene_document_patch(plan, nothing, nothing, backward, &problem));
    assert_string_equal(problem.pointer, "/regions/r700");
    cJSON *all[] = { plan, forward, backward, nothing, one, two };
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        cJSON_Delete(all[i]);
}

static void a_scene_for_a_plan_that_changed_keeps_what_the_plan_still_has(void **state)
{
    (void)state;
    cJSON *defaults = plan_defaults();
    cJSON *scene =
        patched(defaults, defaults,
                "{\"regions\":{\"brain\":{\"opacity\":0.2},\"tumor\":{\"opacity\":0.3}},\"image\":{\"id\":\"mr\"},"
                "\"dose\":{\"id\":\"plan\"},\"check\":{\"region\":\"tumor\",\"visible\":true}}");
    cJSON *plan =
        parse("{\"images\":[{\"id\":\"ct\"}],\"regions\":[{\"id\":\"skin\"},{\"id\":\"brain\"}],\"doses\":[]}");
    cJSON *others = parse(
        "{\"regions\":{\"skin\":{\"visible\":true},\"brain\":{\"opacity\":0.9}},\"image\":{\"id\":\"ct\"},\"dose\":{\"id\":\"\"},"
        "\"check\":{\"region\":\"\",\"visible\":false}}");
    cJSON *renewed = scene_document_renew(plan, others, scene);
    assert_close(at(renewed, "regions.brain.opacity")->valuedouble, 0.2, 0);
    assert_non_null(at(renewed, "regions.skin"));
    assert_null(at(renewed, "regions.tumor"));
    assert_string_equal(at(renewed, "image.id")->valuestring, "ct");
    assert_string_equal(at(renewed, "dose.id")->valuestring, "");
    assert_string_equal(at(renewed, "check.region")->valuestring, "");
    assert_true(cJSON_IsTrue(at(renewed, "check.visible")));
    cJSON *all[] = { defaults, scene, plan, others, renewed };
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        cJSON_Delete(all[i]);
}

/* A plan of n regions and its scene. */
static void make_regions(int n, cJSON **plan, cJSON **scene)
{
    *plan = cJSON_CreateObject();
    *scene = cJSON_CreateObject();
    cJSON *list = cJSON_AddArrayToObject(*plan, "regions"), *styles = cJSON_AddObjectToObject(*scene, "regions");
    for (int i = 0; i < n; i++) {
        char id[16];
        (void)snprintf(id, sizeof id, "r%d", i);
        cJSON *region = cJSON_CreateObject();
        cJSON_AddStringToObject(region, "id", id);
        cJSON_AddItemToArray(list, region);
        (void)cJSON_AddObjectToObject(styles, id);
    }
    cJSON *nothing = cJSON_CreateObject();
    cJSON *complete = scene_document_patch(*plan, nothing, *scene, nothing, NULL);
    assert_non_null(complete);
    cJSON_Delete(*scene);
    cJSON_Delete(nothing);
    *scene = complete;
}

/* Processor seconds, the least of several tries, of what a room does with a patch that names the regions from first to
 * last, in this order. */
static double patch_s(int n_regions, int first, int last)
{
    cJSON *plan, *scene, *patch = cJSON_CreateObject(), *styles = cJSON_AddObjectToObject(patch, "regions");
    double least_s = 1e9;
    int step = first <= last ? 1 : -1;
    make_regions(n_regions, &plan, &scene);
    for (int i = first; i != last + step; i += step) {
        char id[16];
        (void)snprintf(id, sizeof id, "r%d", i);
        cJSON_AddNumberToObject(cJSON_AddObjectToObject(styles, id), "opacity", 0.5);
    }
    for (int repeat = 0; repeat < 9; repeat++) {
        double began_s = cpu_s();
        for (int i = 0; i < 4; i++) {
            cJSON *next = scene_document_patch(plan, scene, scene, patch, NULL);
            assert_false(json_equal(next, scene));
            cJSON *told = patch_told(scene, next, patch);
            assert_non_null(told);
            cJSON_Delete(told);
            cJSON_Delete(next);
        }
        double s = cpu_s() - began_s;
        least_s = s < least_s ? s : least_s;
    }
    cJSON_Delete(plan);
    cJSON_Delete(scene);
    cJSON_Delete(patch);
    return least_s;
}

/* Eight times the regions: eight times the work, or ten with sorting; 64 times if each name were looked for among all.
 */
static void the_work_of_a_patch_grows_with_the_scene_and_not_with_its_square(void **state)
{
    (void)state;
    enum { FEW = 128, MANY = 1024 };
    assert_true(patch_s(MANY, 0, MANY - 1) < 24 * patch_s(FEW, 0, FEW - 1));
    assert_true(patch_s(MANY, MANY - 1, 0) < 24 * patch_s(FEW, FEW - 1, 0));
    assert_true(patch_s(MANY, MANY / 2, MANY / 2) < 24 * patch_s(FEW, FEW / 2, FEW / 2));
}

/* RFC 8259 leaves open what equal names in one object mean. */
static void of_equal_names_in_a_patch_each_is_applied_after_the_one_before(void **state)
{
    (void)state;
    cJSON *defaults = plan_defaults();
    cJSON *scene =
        patched(defaults, defaults,
                "{\"regions\":{\"brain\":{\"opacity\":0.2},\"brain\":{\"visible\":false},\"tumor\":{\"order\":3},"
                "\"tumor\":null,\"tumor\":{\"opacity\":0.5}}}");
    assert_close(at(scene, "regions.brain.opacity")->valuedouble, 0.2, 0);
    assert_true(cJSON_IsFalse(at(scene, "regions.brain.visible")));
    assert_close(at(scene, "regions.tumor.opacity")->valuedouble, 0.5, 0);
    assert_close(at(scene, "regions.tumor.order")->valuedouble, 0, 0);
    assert_int_equal(cJSON_GetArraySize(at(scene, "regions")), 2);
    cJSON_Delete(scene);
    cJSON_Delete(defaults);
}

/* A patch as read by a reader of JSON that keeps the last of equal names (JSON.parse). */
static cJSON *as_read_by_a_page(const cJSON *patch)
{
    if (!cJSON_IsObject(patch))
        return cJSON_Duplicate(patch, true);
    cJSON *read = cJSON_CreateObject();
    for (const cJSON *item = patch->child; item; item = item->next) {
        cJSON_DeleteItemFromObjectCaseSensitive(read, item->string);
        cJSON_AddItemToObject(read, item->string, as_read_by_a_page(item));
    }
    return read;
}

/* A merge patch takes null for a member to drop: who merges has no member where the document has null. */
static void drop_nulls(cJSON *json)
{
    cJSON *next;
    for (cJSON *item = json->child; item; item = next) {
        next = item->next;
        if (cJSON_IsNull(item) && cJSON_IsObject(json))
            cJSON_Delete(cJSON_DetachItemViaPointer(json, item));
        else
            drop_nulls(item);
    }
}

static void equal_names_in_a_patch_reach_members_as_what_was_applied(void **state)
{
    (void)state;
    static const char *const patches[] = {
        "{\"surface\":{\"normals\":\"face\",\"algorithm\":\"smooth\",\"normals\":\"vertex\",\"translucency\":\"rim\"}}",
        "{\"surface\":{\"algorithm\":\"eight-cell\"},\"surface\":{\"normals\":\"face\"}}",
        "{\"regions\":null,\"surface\":{\"normals\":\"face\"},\"regions\":{\"brain\":{\"opacity\":0.1}}}",
        "{\"regions\":{\"brain\":{\"opacity\":0.3},\"brain\":null,\"tumor\":{\"visible\":false}}}",
    };
    for (size_t i = 0; i < sizeof patches / sizeof patches[0]; i++) {
        cJSON *before = plan_defaults(), *patch = parse(patches[i]);
        cJSON *after = patched(before, before, patches[i]);
        assert_non_null(after);
        cJSON *told = patch_told(before, after, patch), *read = as_read_by_a_page(told);
        cJSON *copy = json_merge(before, read);
        drop_nulls(copy);
        drop_nulls(after);
        assert_true(json_equal(copy, after));
        cJSON_Delete(copy);
        cJSON_Delete(read);
        cJSON_Delete(told);
        cJSON_Delete(after);
        cJSON_Delete(patch);
        cJSON_Delete(before);
    }
}

/* 2,000 times the same name: the answer grows with the document, not with the patch. */
static void a_name_repeated_in_a_patch_does_not_multiply_the_document(void **state)
{
    (void)state;
    enum { N = 2000 };
    static const char name[] = "\"regions\":null,";
    char *text = malloc(N * (sizeof name - 1) + 3);
    size_t n = 1;
    text[0] = '{';
    for (int i = 0; i < N; i++, n += sizeof name - 1)
        memcpy(text + n, name, sizeof name - 1);
    memcpy(text + n - 1, "}", 2);
    cJSON *before = plan_defaults(), *patch = parse(text), *after = patched(before, before, text);
    cJSON *told = patch_told(before, after, patch);
    char *words = json_write(told), *whole = json_write(after);
    assert_true(strlen(words) <= 2 * strlen(whole));
    free(words);
    free(whole);
    free(text);
    cJSON_Delete(told);
    cJSON_Delete(after);
    cJSON_Delete(patch);
    cJSON_Delete(before);
}

static void documents_are_equal_whatever_the_order_of_their_members(void **state)
{
    (void)state;
    static const char *const cases[][2] = {
        { "{\"a\":1,\"b\":{\"c\":[1,2],\"d\":null}}", "{\"b\":{\"d\":null,\"c\":[1,2]},\"a\":1}" },
        { "{}", "{}" },
        { "[true,\"x\"]", "[true,\"x\"]" },
    };
    static const char *const others[][2] = {
        { "{\"a\":1}", "{\"a\":2}" },
        { "{\"a\":1}", "{\"a\":1,\"b\":2}" },
        { "{\"a\":1,\"b\":2}", "{\"a\":1}" },
        { "[1,2]", "[2,1]" },
        { "[1,2]", "[1]" },
        { "{\"a\":null}", "{}" },
        { "true", "false" },
        { "{}", "[]" },
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        cJSON *a = parse(cases[i][0]), *b = parse(cases[i][1]);
        assert_true(json_equal(a, b));
        cJSON_Delete(a);
        cJSON_Delete(b);
    }
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        cJSON *a = parse(others[i][0]), *b = parse(others[i][1]);
        assert_false(json_equal(a, b));
        cJSON_Delete(a);
        cJSON_Delete(b);
    }
    assert_false(json_equal(NULL, NULL));
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
    cJSON *shown = scene_for_view(defaults, view, &problem);
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
    assert_null(scene_for_view(defaults, other, &problem));
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
        cmocka_unit_test(every_field_that_names_something_of_the_plan_is_refused_when_the_plan_has_no_such_thing),
        cmocka_unit_test(regions_are_found_whatever_order_a_patch_names_them_in),
        cmocka_unit_test(the_work_of_a_patch_grows_with_the_scene_and_not_with_its_square),
        cmocka_unit_test(of_equal_names_in_a_patch_each_is_applied_after_the_one_before),
        cmocka_unit_test(equal_names_in_a_patch_reach_members_as_what_was_applied),
        cmocka_unit_test(a_name_repeated_in_a_patch_does_not_multiply_the_document),
        cmocka_unit_test(documents_are_equal_whatever_the_order_of_their_members),
        cmocka_unit_test(a_scene_for_a_plan_that_changed_keeps_what_the_plan_still_has),
        cmocka_unit_test(a_view_gets_defaults_and_keeps_its_override),
        cmocka_unit_test(merge_patches_follow_the_examples_of_the_standard),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
