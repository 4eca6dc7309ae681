/* The C that proto/gen writes, for a description of the tests' own with every kind of field (tests/gen/trial.json): it
 * is held to examples written by hand (tests/gen/cases.json), and so is the JavaScript. */
#include "server/wire/json_merge.h"
#include "server/wire/patch.h"
#include "server/wire/references.h"
#include "tests/check.h"
#include "trial_gen.h"

static cJSON *cases, *plan, *defaults;

static int read_cases(void **state)
{
    (void)state;
    static char text[65536];
    FILE *file = fopen("tests/gen/cases.json", "rb");
    assert_non_null(file);
    size_t n = fread(text, 1, sizeof text, file);
    fclose(file);
    struct problem problem = { 0 };
    cases = json_read(text, n, &problem);
    assert_non_null(cases);
    plan = cJSON_GetObjectItemCaseSensitive(cases, "plan");
    defaults = cJSON_GetObjectItemCaseSensitive(cases, "defaults");
    return 0;
}

static int delete_cases(void **state)
{
    (void)state;
    cJSON_Delete(cases);
    return 0;
}

static const cJSON *part(const cJSON *json, const char *name)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(json, name);
    assert_non_null(item);
    return item;
}

static cJSON *parse(const char *text)
{
    cJSON *json = cJSON_Parse(text);
    assert_non_null(json);
    return json;
}

static void expect_equal(const cJSON *found, const cJSON *expected, const char *about)
{
    if (cJSON_Compare(found, expected, true))
        return;
    char *a = json_write(found), *b = json_write(expected);
    fail_msg("%s: found %s, expected %s", about, a, b);
}

static void read_trial(const cJSON *json, struct trial *trial, const char *about)
{
    struct problem problem = { 0 };
    if (!fields_read(&trial_object, json, NULL, trial, &problem))
        fail_msg("%s was refused: %s", about, problem.detail);
}

/* The document with every field, as the tables write it. */
static cJSON *complete(const cJSON *json, const char *about)
{
    struct trial trial;
    read_trial(json, &trial, about);
    cJSON *written = fields_write(&trial_object, &trial);
    trial_finish(&trial);
    return written;
}

static void what_is_left_out_or_null_has_its_default_at_every_depth(void **state)
{
    (void)state;
    const cJSON *one;
    cJSON_ArrayForEach(one, part(cases, "read"))
    {
        const char *about = json_text(one, "about");
        cJSON *expected = json_merge(part(cases, "empty"), part(one, "more"));
        cJSON *written = complete(part(one, "given"), about), *again = complete(written, about);
        expect_equal(written, expected, about);
        expect_equal(again, expected, about);
        cJSON_Delete(expected);
        cJSON_Delete(written);
        cJSON_Delete(again);
    }
}

static void expect_refused(const cJSON *json, const char *code, const char *pointer)
{
    struct trial trial;
    struct problem problem = { 0 };
    if (fields_read(&trial_object, json, NULL, &trial, &problem))
        fail_msg("%s: accepted", pointer);
    assert_int_equal(problem.type, PROBLEM_VALIDATION);
    assert_string_equal(problem.pointer, pointer);
    assert_string_equal(problem.code, code);
    assert_int_equal(strncmp(problem.detail, pointer, strlen(pointer)), 0);
}

static void what_the_description_does_not_allow_is_refused_at_its_place(void **state)
{
    (void)state;
    const cJSON *one;
    cJSON_ArrayForEach(one, part(cases, "refused"))
        expect_refused(part(one, "given"), json_text(one, "code"), json_text(one, "pointer"));
}

/* JSON files of the project have no name twice in an object: these are text. */
static void an_id_twice_in_a_map_is_refused(void **state)
{
    (void)state;
    cJSON *few = parse("{\"dose\":{\"levels\":{\"a\":{},\"b\":{},\"a\":{}}}}");
    cJSON *many =
        parse("{\"dose\":{\"levels\":{\"a\":{},\"b\":{},\"c\":{},\"d\":{},\"e\":{},\"f\":{},\"g\":{},\"h\":{},\"i\":{},"
              "\"c\":{}}}}");
    cJSON *field = parse("{\"marks\":[{\"region\":\"skin\",\"region\":\"skin\"}]}");
    expect_refused(few, "duplicate", "/dose/levels/a");
    expect_refused(many, "duplicate", "/dose/levels/c");
    expect_refused(field, "duplicate", "/marks/0/region");
    cJSON_Delete(few);
    cJSON_Delete(many);
    cJSON_Delete(field);
}

static void a_number_that_is_not_finite_is_refused(void **state)
{
    (void)state;
    cJSON *json = parse("{\"cut\":{\"normal\":[0,1e999,0]}}"),
          *origin = parse("{\"cut\":{\"origin_mm\":[0,0,-1e999]}}");
    expect_refused(json, "range", "/cut/normal/1");
    expect_refused(origin, "range", "/cut/origin_mm/2");
    cJSON *value = part(part(json, "cut"), "normal")->child->next;
    cJSON_SetNumberValue(value, NAN); /* JSON cannot say it */
    expect_refused(json, "range", "/cut/normal/1");
    cJSON_Delete(json);
    cJSON_Delete(origin);
}

static void a_patch_merges_objects_and_maps_and_replaces_lists(void **state)
{
    (void)state;
    const cJSON *one;
    cJSON *nothing = cJSON_CreateObject();
    cJSON_ArrayForEach(one, part(cases, "patches"))
    {
        const char *about = json_text(one, "about");
        struct problem problem = { 0 };
        cJSON *before = patch_apply(&trial_object, plan, defaults, defaults, part(one, "current"), &problem);
        assert_non_null(before);
        cJSON *kept = cJSON_Duplicate(before, true);
        cJSON *after = patch_apply(&trial_object, plan, defaults, before, part(one, "patch"), &problem);
        if (!after)
            fail_msg("%s: %s", about, problem.detail);
        cJSON *changed = json_merge(defaults, part(one, "changed")), *expected = complete(changed, about);
        expect_equal(after, expected, about);
        expect_equal(before, kept, about); /* untouched */

        cJSON *told = patch_told(before, after, part(one, "patch"));
        expect_equal(told, part(one, "told"), about);
        cJSON *copy = json_merge(before, told), *copy_complete = complete(copy, about);
        expect_equal(copy_complete, expected, about);

        cJSON *same = patch_apply(&trial_object, plan, defaults, after, nothing, &problem);
        expect_equal(same, after, about);
        cJSON *all[] = { before, kept, after, changed, expected, told, copy, copy_complete, same };
        for (size_t i = 0; i < sizeof all / sizeof *all; i++)
            cJSON_Delete(all[i]);
    }
    cJSON_Delete(nothing);
}

static void an_id_that_the_plan_does_not_have_is_refused_at_every_depth(void **state)
{
    (void)state;
    const cJSON *one;
    cJSON_ArrayForEach(one, part(cases, "unknown"))
    {
        struct problem problem = { 0 };
        assert_null(patch_apply(&trial_object, plan, defaults, defaults, part(one, "patch"), &problem));
        assert_string_equal(problem.code, "unknown-id");
        assert_string_equal(problem.pointer, json_text(one, "pointer"));
        assert_string_equal(problem.detail, json_text(one, "detail"));
    }
}

static void what_a_changed_plan_lost_is_left_out_at_every_depth(void **state)
{
    (void)state;
    cJSON *smaller = parse("{\"regions\":[{\"id\":\"skin\"}],\"images\":[],\"doses\":[{\"id\":\"d2\"}],\"beams\":[]}");
    cJSON *current =
        parse("{\"regions\":{\"skin\":{\"opacity\":0.1},\"brain\":{\"opacity\":0.2}},\"image\":{\"id\":\"ct\"},"
              "\"dose\":{\"id\":\"d1\",\"weights\":{\"brain\":{\"cbe\":2},\"skin\":{\"cbe\":3}},"
              "\"levels\":{\"7\":{\"value\":7}}},\"beam\":\"b1\","
              "\"marks\":[{\"region\":\"brain\"},{\"region\":\"skin\",\"size_px\":[1,2]}]}");
    cJSON *fresh = parse("{\"regions\":{\"skin\":{\"opacity\":1}},\"dose\":{\"id\":\"d2\"}}");
    cJSON *expected =
        parse("{\"regions\":{\"skin\":{\"opacity\":0.1}},"
              "\"dose\":{\"id\":\"d2\",\"weights\":{\"skin\":{\"cbe\":3}},\"levels\":{\"7\":{\"value\":7}}},"
              "\"marks\":[{\"region\":\"skin\",\"size_px\":[1,2]}]}"); /* a mark needs its region */
    cJSON *fresh_complete = complete(fresh, "fresh"), *expected_complete = complete(expected, "expected");
    cJSON *renewed = patch_renew(&trial_object, smaller, fresh_complete, current);
    expect_equal(renewed, expected_complete, "renewed");
    cJSON *all[] = { smaller, current, fresh, expected, fresh_complete, expected_complete, renewed };
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        cJSON_Delete(all[i]);
}

/* A document with something in every list and map. */
static void read_full(struct trial *trial)
{
    cJSON *json = parse(
        "{\"regions\":{\"skin\":{}},\"image\":{\"obliques\":{\"a\":{}},\"volume\":{\"points\":[{\"value\":1},"
        "{\"value\":2}]}},\"dose\":{\"levels\":{\"95\":{}},\"weights\":{\"brain\":{}}},\"draft\":{},"
        "\"marks\":[{\"region\":\"skin\",\"at_mm\":[1,2,3],\"tags\":{\"t\":{\"note\":\"n\",\"spots\":[{\"value\":3}]}}}]}");
    read_trial(json, trial, "full");
    cJSON_Delete(json);
}

static void a_copy_is_equal_and_owns_what_it_points_to(void **state)
{
    (void)state;
    struct trial one, two;
    read_full(&one);
    trial_copy(&two, &one);
    assert_true(trial_equal(&one, &two));
    cJSON *a = fields_write(&trial_object, &one), *b = fields_write(&trial_object, &two);
    expect_equal(a, b, "copy");
    assert_ptr_not_equal(one.regions, two.regions);
    assert_ptr_not_equal(one.image.volume.points, two.image.volume.points);
    assert_ptr_not_equal(one.marks[0].tags, two.marks[0].tags);
    assert_ptr_not_equal(one.marks[0].tags[0].value.spots, two.marks[0].tags[0].value.spots);
    trial_finish(&one);
    assert_int_equal(one.n_marks, 0);
    assert_null(one.marks);
    cJSON *c = fields_write(&trial_object, &two);
    expect_equal(c, b, "after the original was freed");
    trial_finish(&two);
    trial_finish(&two); /* what is freed stays freed */
    cJSON_Delete(a);
    cJSON_Delete(b);
    cJSON_Delete(c);
}

static void documents_that_differ_anywhere_are_not_equal(void **state)
{
    (void)state;
    struct trial one, two;
    read_full(&one);
    trial_copy(&two, &one);
#define DIFFERS(member, other) \
    do { \
        __typeof__(two.member) was = two.member; \
        two.member = other; \
        assert_false(trial_equal(&one, &two)); \
        two.member = was; \
        assert_true(trial_equal(&one, &two)); \
    } while (0)
    DIFFERS(regions[0].value.visible, false);
    DIFFERS(regions[0].id[0], 'x');
    DIFFERS(n_regions, 0);
    DIFFERS(image.obliques[0].value.plane.normal.y, 1);
    DIFFERS(image.volume.steps, 7);
    DIFFERS(image.volume.points[1].color_rgb, 0);
    DIFFERS(image.volume.n_points, 1);
    DIFFERS(dose.levels[0].value.unit, TRIAL_UNIT_GRAY);
    DIFFERS(dose.weights[0].value.cbe, 2);
    DIFFERS(beam[0], 'b');
    DIFFERS(has_draft, false);
    DIFFERS(draft.along.x, 0.5);
    DIFFERS(cut.origin_mm.z, 1);
    DIFFERS(marks[0].size_px[1], 9);
    DIFFERS(marks[0].at_mm.x, 9);
    DIFFERS(marks[0].tags[0].value.note[0], 'm');
    DIFFERS(marks[0].tags[0].value.spots[0].value, 4);
#undef DIFFERS
    two.has_draft = one.has_draft = false;
    two.draft.along.x = 9; /* what is null has no value */
    assert_true(trial_equal(&one, &two));
    trial_finish(&one);
    trial_finish(&two);
}

/* Puts value behind n nested objects {"a": {"a": ... }}. Takes value. */
static cJSON *nested(int n, cJSON *value)
{
    for (int i = 0; i < n; i++) {
        cJSON *outer = cJSON_CreateObject();
        cJSON_AddItemToObject(outer, "a", value);
        value = outer;
    }
    return value;
}

static void a_document_nested_deeper_than_the_description_is_refused_where_it_leaves_it(void **state)
{
    (void)state;
    struct problem problem = { 0 };
    cJSON *deep = cJSON_CreateObject();
    cJSON_AddItemToObject(deep, "cut", nested(200, cJSON_CreateNull()));
    expect_refused(deep, "unknown-field", "/cut/a");
    char *text = json_write(deep);
    assert_null(json_read(text, strlen(text), &problem)); /* the parser follows 32 levels at most */
    assert_int_equal(problem.type, PROBLEM_JSON);
    assert_null(patch_apply(&trial_object, plan, defaults, defaults, deep, &problem));
    assert_string_equal(problem.pointer, "/cut/a");
    free(text);
    cJSON_Delete(deep);
}

/* More entries than allowed cost no memory for entries, and a map that is full is refused one more. */
static void the_limit_of_a_map_counts_what_a_patch_makes_of_it(void **state)
{
    (void)state;
    struct problem problem = { 0 };
    cJSON *patch = cJSON_CreateObject(), *dose = cJSON_AddObjectToObject(patch, "dose");
    cJSON *levels = cJSON_AddObjectToObject(dose, "levels");
    for (int i = 0; i < 15; i++) { /* and the one of the defaults: 16 */
        char id[8];
        (void)snprintf(id, sizeof id, "l%d", i);
        (void)cJSON_AddObjectToObject(levels, id);
    }
    cJSON *full = patch_apply(&trial_object, plan, defaults, defaults, patch, &problem);
    assert_non_null(full);
    cJSON *more = parse("{\"dose\":{\"levels\":{\"l15\":{}}}}"),
          *instead = parse("{\"dose\":{\"levels\":{\"l15\":{},\"l3\":null}}}");
    assert_null(patch_apply(&trial_object, plan, defaults, full, more, &problem));
    assert_string_equal(problem.code, "count");
    assert_string_equal(problem.pointer, "/dose/levels");
    cJSON *other = patch_apply(&trial_object, plan, defaults, full, instead, &problem);
    assert_non_null(other);
    assert_int_equal(cJSON_GetArraySize(part(part(other, "dose"), "levels")), 16);
    cJSON *all[] = { patch, full, more, instead, other };
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        cJSON_Delete(all[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_left_out_or_null_has_its_default_at_every_depth),
        cmocka_unit_test(what_the_description_does_not_allow_is_refused_at_its_place),
        cmocka_unit_test(an_id_twice_in_a_map_is_refused),
        cmocka_unit_test(a_number_that_is_not_finite_is_refused),
        cmocka_unit_test(a_patch_merges_objects_and_maps_and_replaces_lists),
        cmocka_unit_test(an_id_that_the_plan_does_not_have_is_refused_at_every_depth),
        cmocka_unit_test(what_a_changed_plan_lost_is_left_out_at_every_depth),
        cmocka_unit_test(a_copy_is_equal_and_owns_what_it_points_to),
        cmocka_unit_test(documents_that_differ_anywhere_are_not_equal),
        cmocka_unit_test(a_document_nested_deeper_than_the_description_is_refused_where_it_leaves_it),
        cmocka_unit_test(the_limit_of_a_map_counts_what_a_patch_makes_of_it),
    };
    return cmocka_run_group_tests(tests, read_cases, delete_cases);
}
