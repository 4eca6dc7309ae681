/* core/base: errors, checked sizes, mailbox, queue, gate, parallel work. */
#include <pthread.h>
#include <stdatomic.h>

#include "core/base/error.h"
#include "core/base/gate.h"
#include "core/base/image.h"
#include "core/base/mailbox.h"
#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/base/queue.h"
#include "tests/check.h"

static void an_error_gains_context_in_front_and_keeps_its_code(void **state)
{
    (void)state;
    struct error err = { 0 };
    assert_false(error_set(&err, ERROR_RANGE, "label %d is not in the volume", 300));
    error_prefix(&err, "region %d", 7);
    assert_int_equal(err.code, ERROR_RANGE);
    assert_string_equal(err.text, "region 7: label 300 is not in the volume");
    char longer[600];
    memset(longer, 'x', sizeof longer - 1);
    longer[sizeof longer - 1] = 0;
    error_prefix(&err, "%s", longer);
    assert_int_equal(strlen(err.text), sizeof err.text - 1);
    error_prefix(NULL, "nobody listens");
}

static void sizes_from_outside_are_checked_before_memory_is_asked_for(void **state)
{
    (void)state;
    struct error err = { 0 };
    assert_null(mem_array(SIZE_MAX / 2, 4, UINT64_MAX, &err)); /* the product overflows 64 bits */
    assert_int_equal(err.code, ERROR_LIMIT);
    assert_null(mem_array(1001, 1, 1000, &err));
    assert_int_equal(err.code, ERROR_LIMIT);
    void *fits = mem_array(1000, 1, 1000, &err);
    assert_non_null(fits);
    free(fits);
    assert_null(image_create(IMAGE_MAX_SIDE_PX + 1, 10, &err));
    assert_int_equal(err.code, ERROR_RANGE);
}

static int n_dropped;
static void drop(void *letter)
{
    (void)letter;
    n_dropped++;
}

static void a_mailbox_keeps_only_the_newest_letter(void **state)
{
    (void)state;
    int first = 1, second = 2;
    n_dropped = 0;
    struct mailbox *box = mailbox_create(drop);
    mailbox_put(box, &first);
    mailbox_put(box, &second);
    assert_int_equal(n_dropped, 1);
    assert_ptr_equal(mailbox_take(box), &second);
    assert_null(mailbox_take(box));
    mailbox_put(box, &first);
    mailbox_destroy(box);
    assert_int_equal(n_dropped, 2);
}

static void a_queue_keeps_order_refuses_when_full_and_drains_when_closed(void **state)
{
    (void)state;
    int a = 1, b = 2, c = 3;
    struct queue *queue = queue_create(2, NULL);
    assert_true(queue_try_put(queue, &a));
    assert_true(queue_try_put(queue, &b));
    assert_false(queue_try_put(queue, &c));
    assert_ptr_equal(queue_take(queue, 0), &a);
    queue_close(queue);
    assert_false(queue_try_put(queue, &c));
    assert_ptr_equal(queue_take(queue, -1), &b);
    assert_null(queue_take(queue, -1));
    queue_destroy(queue);
}

struct closing {
    struct gate *gate;
    atomic_bool is_done;
};

static void *close_gate(void *context)
{
    struct closing *closing = context;
    gate_close(closing->gate);
    atomic_store(&closing->is_done, true);
    return NULL;
}

static void closing_a_gate_waits_for_those_inside_and_lets_nobody_in(void **state)
{
    (void)state;
    struct closing closing = { .gate = gate_create() };
    pthread_t thread;
    assert_true(gate_enter(closing.gate));
    assert_int_equal(pthread_create(&thread, NULL, close_gate, &closing), 0);
    while (gate_enter(closing.gate)) /* until the thread has closed it */
        gate_leave(closing.gate);
    assert_false(atomic_load(&closing.is_done));
    gate_leave(closing.gate);
    pthread_join(thread, NULL);
    assert_true(atomic_load(&closing.is_done));
    assert_false(gate_enter(closing.gate));
    gate_destroy(closing.gate);
}

static void count_part(void *context, int part, int n_parts)
{
    int *seen = context;
    seen[part] += n_parts;
}

static void parallel_work_runs_each_part_once(void **state)
{
    (void)state;
    int seen[5] = { 0 };
    parallel_run(5, count_part, seen);
    for (int i = 0; i < 5; i++)
        assert_int_equal(seen[i], 5);
    assert_true(parallel_cores() >= 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_error_gains_context_in_front_and_keeps_its_code),
        cmocka_unit_test(sizes_from_outside_are_checked_before_memory_is_asked_for),
        cmocka_unit_test(a_mailbox_keeps_only_the_newest_letter),
        cmocka_unit_test(a_queue_keeps_order_refuses_when_full_and_drains_when_closed),
        cmocka_unit_test(closing_a_gate_waits_for_those_inside_and_lets_nobody_in),
        cmocka_unit_test(parallel_work_runs_each_part_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
