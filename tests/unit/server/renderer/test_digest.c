/* The revision of a plan's files: when they are read, and who may stop that. */
#include "server/renderer/digest.h"

#include <string.h>

#include "core/plan/origin.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"

struct watched {
    int n;
    bool stops;
    double percent;
};

static bool go_on(void *context, double percent)
{
    struct watched *watched = context;
    watched->n++;
    assert_true(percent >= watched->percent && percent <= 100);
    watched->percent = percent;
    return !watched->stops;
}

static void files_are_read_while_somebody_watches_who_may_stop_that(void **state)
{
    char folder[256];
    (void)state;
    folder_make(folder);
    folder_put_text(folder, "a.dcm", "abc");
    folder_put_text(folder, "b.dcm", "defg");
    struct watched watched = { 0 };
    const struct digest_watch watch = { go_on, &watched };
    cJSON *read = digest_folder(folder, NULL, &watch);
    /* (cd folder; sha256sum a.dcm b.dcm) | sha256sum */
    assert_string_equal(json_text(read, "revision"),
                        "20b6cb0013868749d8b4de48b546e4a813b343bc70571c797b1e0893f9af5e09");
    assert_int_equal(watched.n, 2);
    assert_close(watched.percent, 100, 1e-9);

    cJSON *again = digest_folder(folder, json_text(read, "key"), &watch);
    assert_int_equal(watched.n, 2); /* the files are as they were: not one is read */
    assert_null(json_text(again, "revision"));
    assert_string_equal(json_text(again, "key"), json_text(read, "key"));

    watched = (struct watched){ .stops = true };
    cJSON *stopped = digest_folder(folder, NULL, &watch);
    assert_int_equal(watched.n, 1);
    assert_null(json_text(stopped, "key"));
    assert_non_null(json_text(stopped, "reason"));
    cJSON_Delete(read);
    cJSON_Delete(again);
    cJSON_Delete(stopped);
    folder_remove(folder);
}

static void whom_files_name_is_told_apart_by_each_part_of_an_identity_and_by_the_order(void **state)
{
    struct plan_patient pair[2] = { { .id = "1", .name = "A^B", .birth_date = "19500101" }, { .id = "2" } };
    char first[65], other[65];
    (void)state;
    patients_seen(pair, 2, first);
    assert_int_equal(strlen(first), 64);
    patients_seen(pair, 2, other);
    assert_string_equal(first, other);
    patients_seen(pair, 1, other);
    assert_string_not_equal(first, other);
    const struct plan_patient turned[2] = { pair[1], pair[0] };
    patients_seen(turned, 2, other);
    assert_string_not_equal(first, other);
    char *const texts[] = { pair[0].id, pair[0].issuer, pair[0].name, pair[0].birth_date };
    for (size_t i = 0; i < 4; i++) {
        const char kept = texts[i][0];
        texts[i][0] = '9';
        patients_seen(pair, 2, other);
        assert_string_not_equal(first, other);
        texts[i][0] = kept;
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(files_are_read_while_somebody_watches_who_may_stop_that),
        cmocka_unit_test(whom_files_name_is_told_apart_by_each_part_of_an_identity_and_by_the_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
