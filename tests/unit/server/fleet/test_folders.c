/* Which folders are listed as plans, and the ids made from their names. */
#include <sys/stat.h>
#include <unistd.h>

#include "server/fleet/folders.h"
#include "tests/check.h"
#include "tests/unit/fleet_world.h"

static void an_id_is_safe_in_an_address_and_never_empty(void **state)
{
    (void)state;
    static const struct {
        const char *name, *id;
    } cases[] = {
        { "head-3", "head-3" }, { "Head of  Mr. X", "head-of-mr-x" }, { "..", "plan" },    { "", "plan" },
        { "__a__b__", "a-b" },  { "\xc3\x84rger", "rger" },           { "a/../b", "a-b" }, { "%2e%2e", "2e-2e" },
    };
    char id[64], longest[300];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        folder_make_id(cases[i].name, id);
        assert_string_equal(id, cases[i].id);
    }
    memset(longest, 'x', sizeof longest);
    longest[sizeof longest - 1] = 0;
    folder_make_id(longest, id);
    assert_true(strlen(id) < 63);
}

static void make(const char *folder, const char *path, bool is_folder)
{
    char full[512];
    snprintf(full, sizeof full, "%s/%s", folder, path);
    if (is_folder) {
        assert_int_equal(mkdir(full, 0700), 0);
        return;
    }
    FILE *file = fopen(full, "w");
    assert_non_null(file);
    fclose(file);
}

static void plans_are_found_where_they_lie(void **state)
{
    (void)state;
    char folder[] = "/tmp/beamroom-folders-XXXXXX", alone[80], nowhere[80];
    assert_non_null(mkdtemp(folder));
    static const char *const folders[] = {
        "b", "a", ".hidden", "set", "set/one", "set/two", "set/other", "c", "c/inner"
    };
    static const char *const files[] = {
        "readme",      "a/plan.json",       "b/x.nii",          "set/one/plan.json", "set/two/plan.json",
        "c/plan.json", "c/inner/plan.json", ".hidden/plan.json"
    };
    for (size_t i = 0; i < sizeof folders / sizeof *folders; i++)
        make(folder, folders[i], true);
    for (size_t i = 0; i < sizeof files / sizeof *files; i++)
        make(folder, files[i], false);
    snprintf(alone, sizeof alone, "%s/a", folder);
    snprintf(nowhere, sizeof nowhere, "%s/nowhere", folder);

    struct folder_list list;
    folders_list((const char *const[]){ folder, alone, nowhere }, 3, &list); /* the second is in the first */
    static const char *const expected[] = { "a", "b", "c", "set one", "set two" };
    assert_int_equal(list.n_folders, 5);
    for (size_t i = 0; i < 5; i++)
        assert_string_equal(list.folders[i].name, expected[i]);
    assert_non_null(strstr(list.problem, "nowhere"));
    uint64_t before = list.folders[1].fingerprint;
    folder_list_finish(&list);

    make(folder, "b/y.nii", false);
    folders_list((const char *const[]){ folder }, 1, &list);
    assert_true(list.folders[1].fingerprint != before);
    folder_list_finish(&list);
    folders_list((const char *const[]){ alone }, 1, &list);
    assert_int_equal(list.n_folders, 1);
    assert_string_equal(list.folders[0].name, "a");
    folder_list_finish(&list);
    world_remove_folder(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_id_is_safe_in_an_address_and_never_empty),
        cmocka_unit_test(plans_are_found_where_they_lie),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
