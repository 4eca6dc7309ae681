/* Lists of plan folders and the requests that they answer, with a listing that waits for the test. */
#include <semaphore.h>

#include "server/fleet/lister.h"
#include "tests/check.h"

static sem_t began, may_end, ended;

static void list_on_command(const char *const *given, size_t n_given, struct folder_list *list)
{
    (void)given, (void)n_given, (void)list;
    sem_post(&began);
    sem_wait(&may_end);
}

static void note_end(void *context)
{
    (void)context;
    sem_post(&ended);
}

static struct lister *start(void)
{
    struct error err = { 0 };
    assert_int_equal(sem_init(&began, 0, 0) | sem_init(&may_end, 0, 0) | sem_init(&ended, 0, 0), 0);
    struct lister *lister = lister_create(NULL, 0, list_on_command, note_end, NULL, &err);
    assert_non_null(lister);
    return lister;
}

/* A caller may wait for the later request: its list replaces the earlier one, and no other comes. */
static void a_list_that_replaces_one_that_was_not_taken_answers_both_requests(void **state)
{
    (void)state;
    struct lister *lister = start();
    struct folder_list list;
    uint64_t number = 0;
    assert_int_equal(lister_request(lister), 1);
    sem_wait(&began);
    assert_int_equal(lister_request(lister), 2); /* while the first is being listed */
    for (int i = 0; i < 2; i++) {
        sem_post(&may_end);
        sem_wait(&ended);
    }
    assert_true(lister_take(lister, &list, &number));
    assert_int_equal(number, 2);
    folder_list_finish(&list);
    assert_false(lister_take(lister, &list, &number));
    lister_destroy(lister);
}

static void a_list_answers_no_request_that_was_made_after_it_was_begun(void **state)
{
    (void)state;
    struct lister *lister = start();
    struct folder_list list;
    uint64_t number = 0;
    (void)lister_request(lister);
    sem_wait(&began);
    for (uint64_t i = 2; i <= 4; i++)
        assert_int_equal(lister_request(lister), i);
    sem_post(&may_end);
    sem_wait(&ended);
    assert_true(lister_take(lister, &list, &number));
    assert_int_equal(number, 1);
    folder_list_finish(&list);
    sem_post(&may_end); /* one more listing for the three */
    sem_wait(&ended);
    assert_true(lister_take(lister, &list, &number));
    assert_int_equal(number, 4);
    folder_list_finish(&list);
    lister_destroy(lister);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_list_that_replaces_one_that_was_not_taken_answers_both_requests),
        cmocka_unit_test(a_list_answers_no_request_that_was_made_after_it_was_begun),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
