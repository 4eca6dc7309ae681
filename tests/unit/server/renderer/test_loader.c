/* The loader keeps a plan in the cache as its files are, without what a person has stated. */
#include "server/renderer/loader.h"

#include <poll.h>

#include "core/load/load.h"
#include "server/renderer/digest.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/nifti_bytes.h"

static struct inbox_event *wait_for(struct inbox *inbox, enum inbox_event_type type)
{
    for (;;) {
        struct inbox_event *event = inbox_take(inbox);
        struct pollfd wake = { inbox_wake_fd(inbox), POLLIN, 0 };
        if (!event) {
            assert_int_equal(poll(&wake, 1, 60000), 1);
            continue;
        }
        assert_int_not_equal(event->type, INBOX_LOAD_FAILED);
        if (event->type == type)
            return event;
        inbox_event_destroy(event);
    }
}

/* A statement on a folder of files that name nobody. */
static struct packet_statement stated_of(const char *folder)
{
    struct packet_statement statement = { .time_ms = 1 };
    cJSON *digest = digest_folder(folder, NULL, NULL);
    packet_put_text(statement.revision, sizeof statement.revision, json_text(digest, "revision"));
    packet_put_text(statement.key, sizeof statement.key, json_text(digest, "key"));
    cJSON_Delete(digest);
    patients_seen(NULL, 0, statement.patients);
    packet_put_text(statement.by, sizeof statement.by, "Anna Weiss");
    packet_put_text(statement.name, sizeof statement.name, "Morgen^Ottilie");
    packet_put_text(statement.patient_id, sizeof statement.patient_id, "88-50327");
    return statement;
}

static void a_stated_patient_is_of_the_plan_and_not_of_what_is_kept_of_it(void **state)
{
    char folder[256], cache[256];
    struct error err = { 0 };
    struct nifti_bytes image = nifti_bytes_make(8, 8, 8, 4, 16, 1024, false); /* int16: 8^3 of 2 bytes */
    (void)state;
    folder_make(folder);
    folder_make(cache);
    folder_put(folder, "ct.nii", image.data, image.size);
    nifti_bytes_free(&image);
    const struct packet_statement statement = stated_of(folder);
    struct inbox *inbox = inbox_create();
    struct loader *loader = loader_create(&(struct loader_options){ .folder = folder,
                                                                    .plan_id = "p",
                                                                    .cache_folder = cache,
                                                                    .statement = &statement,
                                                                    .worth_keeping_us = -1 },
                                          inbox, &err);
    assert_non_null(loader);
    struct inbox_event *loaded = wait_for(inbox, INBOX_LOADED);
    assert_int_equal(loaded->plan->statement.state, STATEMENT_USED);
    assert_int_equal(loaded->plan->n_patients, 1);
    assert_string_equal(loaded->plan->patients[0].id, "88-50327");
    loader_destroy(loader);
    derive_destroy(loaded->derived);
    plan_destroy(loaded->plan);
    loaded->derived = NULL;
    loaded->plan = NULL;
    inbox_event_destroy(loaded);
    inbox_destroy(inbox);

    size_t n_kept;
    char path[300];
    snprintf(path, sizeof path, "%s/" PLAN_CACHE_NAME, cache);
    uint8_t *kept = file_bytes(path, &n_kept); /* there is one */
    for (size_t i = 0; i + 7 <= n_kept; i++)
        assert_int_not_equal(memcmp(kept + i, "Ottilie", 7), 0);
    free(kept);
    struct plan *again = plan_load(folder, "p", &(struct plan_load_options){ .cache_folder = cache }, &err);
    assert_non_null(again);
    assert_int_equal(again->n_patients, 0);
    assert_int_equal(again->statement.kind, STATEMENT_NONE);
    plan_destroy(again);
    folder_remove(folder);
    folder_remove(cache);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_stated_patient_is_of_the_plan_and_not_of_what_is_kept_of_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
