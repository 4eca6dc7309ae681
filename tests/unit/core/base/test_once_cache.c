/* The cache of results that are built once: one thread builds, others wait; failures, refusals, the budget. */
#include "core/base/once_cache.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/base/queue.h"
#include "tests/check.h"

struct number {
    _Atomic int references;
    int value;
    uint64_t n_bytes;
};

static atomic_int n_alive;

static bool is_equal(const void *a, const void *b)
{
    return *(const int *)a == *(const int *)b;
}
static void ref(void *result)
{
    atomic_fetch_add(&((struct number *)result)->references, 1);
}
static void unref(void *result)
{
    if (atomic_fetch_sub(&((struct number *)result)->references, 1) != 1)
        return;
    atomic_fetch_sub(&n_alive, 1);
    free(result);
}
static uint64_t n_bytes(const void *result)
{
    return ((const struct number *)result)->n_bytes;
}
static bool is_limit(enum error_code code)
{
    return code == ERROR_LIMIT;
}
static const struct once_cache_type type = { is_equal, ref, unref, n_bytes, is_limit };

struct building {
    struct once_cache *cache;
    int value;
    uint64_t n_bytes;
    enum error_code fails_with;
    atomic_int n_builds, n_failures_left;
    struct queue *begun, *go_on; /* NULL: does not stop on the way */
};

/* All keys have one hash: they are told apart by is_equal alone. */
static struct once_key key_of(const int *value)
{
    return (struct once_key){ value, sizeof *value, 7 };
}

static struct number *make_number(int value, uint64_t size)
{
    struct number *number = mem_new(sizeof *number);
    atomic_init(&number->references, 1);
    number->value = value;
    number->n_bytes = size;
    atomic_fetch_add(&n_alive, 1);
    return number;
}

static void *build(void *context, struct error *err)
{
    struct building *building = context;
    atomic_fetch_add(&building->n_builds, 1);
    if (building->begun) {
        assert_true(queue_try_put(building->begun, building));
        assert_non_null(queue_take(building->go_on, -1));
    }
    if (atomic_load(&building->n_failures_left) > 0) {
        atomic_fetch_sub(&building->n_failures_left, 1);
        error_set(err, building->fails_with, "build %d", atomic_load(&building->n_builds));
        return NULL;
    }
    return make_number(building->value, building->n_bytes);
}

static void *get(struct building *building, struct error *err)
{
    struct once_key key = key_of(&building->value);
    return once_cache_get(building->cache, &key, build, building, err);
}

/* Returns the value, with no reference left to the caller. */
static int get_value(struct building *building)
{
    struct error err = { 0 };
    struct number *number = get(building, &err);
    assert_non_null(number);
    int value = number->value;
    unref(number);
    return value;
}

static struct once_cache_usage usage_of(struct once_cache *cache)
{
    struct once_cache_usage usage;
    once_cache_usage(cache, &usage);
    return usage;
}

enum { N_THREADS = 8 };

struct batch {
    struct building *building;
    struct number *got[N_THREADS];
    struct error errors[N_THREADS];
};

static void ask(void *context, int part, int n_parts)
{
    (void)n_parts;
    struct batch *batch = context;
    batch->got[part] = get(batch->building, &batch->errors[part]);
}

static void one_thread_builds_and_all_get_the_same_result(void **state)
{
    (void)state;
    struct building building = { .cache = once_cache_create(&type, 1000), .value = 5, .n_bytes = 10 };
    struct batch batch = { .building = &building };
    parallel_run(N_THREADS, ask, &batch);
    assert_int_equal(building.n_builds, 1);
    for (int i = 0; i < N_THREADS; i++) {
        assert_ptr_equal(batch.got[i], batch.got[0]);
        assert_int_equal(batch.got[i]->value, 5);
        unref(batch.got[i]);
    }
    assert_int_equal(usage_of(building.cache).n_results, 1);
    assert_int_equal(usage_of(building.cache).n_bytes, 10);
    once_cache_destroy(building.cache);
    assert_int_equal(n_alive, 0);
}

static void *ask_main(void *argument)
{
    return get(argument, NULL);
}

/* The builder stands still until it is told to go on, so what is seen meanwhile does not depend on speed. */
static void while_one_key_is_built_another_key_can_be_asked_for(void **state)
{
    (void)state;
    struct once_cache *cache = once_cache_create(&type, 1000);
    struct building slow = { .cache = cache,
                             .value = 1,
                             .n_bytes = 10,
                             .begun = queue_create(1, NULL),
                             .go_on = queue_create(1, NULL) },
                    other = { .cache = cache, .value = 2, .n_bytes = 10 };
    pthread_t thread;
    void *result;
    assert_int_equal(pthread_create(&thread, NULL, ask_main, &slow), 0);
    assert_ptr_equal(queue_take(slow.begun, -1), &slow);
    struct once_key key = key_of(&slow.value);
    assert_true(once_cache_has(cache, &key)); /* is being built */
    assert_false(once_cache_is_ready(cache, &key));
    assert_int_equal(usage_of(cache).n_results, 0);
    assert_int_equal(get_value(&other), 2);
    once_cache_set_budget(cache, 0); /* drops nothing that is being built */
    struct number *offered = make_number(9, 10);
    once_cache_offer(cache, &key, offered); /* too late: the key is being built */
    unref(offered);
    assert_true(queue_try_put(slow.go_on, &slow));
    pthread_join(thread, &result);
    assert_int_equal(((struct number *)result)->value, 1);
    unref(result);
    queue_destroy(slow.begun);
    queue_destroy(slow.go_on);
    once_cache_destroy(cache);
    assert_int_equal(n_alive, 0);
}

static void a_failure_is_not_kept_and_each_that_waited_builds_in_turn(void **state)
{
    (void)state;
    struct building building = {
        .cache = once_cache_create(&type, 1000), .value = 5, .fails_with = ERROR_MEMORY, .n_failures_left = 3
    };
    struct batch batch = { .building = &building };
    struct error why;
    struct once_key key = key_of(&building.value);
    parallel_run(N_THREADS, ask, &batch);
    assert_int_equal(building.n_builds, 4); /* the first three fail, the fourth serves all others */
    int n_failed = 0;
    for (int i = 0; i < N_THREADS; i++) {
        n_failed += batch.got[i] == NULL;
        assert_int_equal(batch.errors[i].code, batch.got[i] ? ERROR_NONE : ERROR_MEMORY);
        if (batch.got[i])
            unref(batch.got[i]);
    }
    assert_int_equal(n_failed, 3);
    assert_false(once_cache_is_refused(building.cache, &key, &why));
    assert_false(once_cache_has_refusals(building.cache));
    once_cache_destroy(building.cache);
}

static void a_refusal_is_kept_and_given_again_without_a_build(void **state)
{
    (void)state;
    struct building building = {
        .cache = once_cache_create(&type, 1000), .value = 5, .fails_with = ERROR_LIMIT, .n_failures_left = 1
    };
    struct once_key key = key_of(&building.value);
    struct error first = { 0 }, again = { 0 }, why = { 0 };
    assert_false(once_cache_has(building.cache, &key));
    assert_null(get(&building, &first));
    assert_null(get(&building, &again)); /* it would succeed now, if it were tried */
    assert_null(get(&building, NULL));
    assert_int_equal(building.n_builds, 1);
    assert_int_equal(again.code, ERROR_LIMIT);
    assert_string_equal(again.text, "build 1");
    assert_true(once_cache_is_refused(building.cache, &key, &why));
    assert_string_equal(why.text, "build 1");
    assert_true(once_cache_has_refusals(building.cache));
    assert_true(once_cache_has(building.cache, &key));
    assert_true(once_cache_is_ready(building.cache, &key)); /* refused */
    /* one more than are remembered forgets the others */
    struct building more = { .cache = building.cache, .fails_with = ERROR_LIMIT };
    for (int i = 0; i < ONCE_CACHE_MAX_REFUSALS; i++) {
        more.value = 100 + i;
        atomic_store(&more.n_failures_left, 1);
        assert_null(get(&more, NULL));
    }
    assert_false(once_cache_is_refused(building.cache, &key, &why));
    assert_int_equal(get_value(&building), 5);
    once_cache_destroy(building.cache);
    assert_int_equal(n_alive, 0);
}

static void the_least_recently_used_is_dropped_and_lives_on_with_its_holder(void **state)
{
    (void)state;
    struct once_cache *cache = once_cache_create(&type, 30);
    struct building buildings[4] = { 0 };
    struct once_key keys[4];
    struct error err = { 0 };
    for (int i = 0; i < 4; i++) {
        buildings[i].cache = cache;
        buildings[i].value = i;
        buildings[i].n_bytes = 10;
        keys[i] = key_of(&buildings[i].value);
    }
    struct number *held = get(&buildings[1], &err);
    assert_non_null(held);
    get_value(&buildings[0]);
    get_value(&buildings[2]);
    get_value(&buildings[0]);
    get_value(&buildings[3]); /* 40 bytes of 30: number 1 goes */
    assert_false(once_cache_has(cache, &keys[1]));
    assert_int_equal(held->value, 1);
    assert_true(once_cache_has(cache, &keys[0]));
    assert_true(once_cache_is_ready(cache, &keys[0]));
    assert_int_equal(usage_of(cache).n_results, 3);
    assert_int_equal(usage_of(cache).n_bytes, 30);
    once_cache_set_budget(cache, 15);
    assert_int_equal(usage_of(cache).n_results, 1);
    assert_true(once_cache_has(cache, &keys[3]));
    buildings[2].n_bytes = 100; /* alone more than the budget: kept as the newest */
    get_value(&buildings[2]);
    assert_true(once_cache_has(cache, &keys[2]));
    assert_int_equal(usage_of(cache).n_bytes, 100);
    unref(held);
    once_cache_destroy(cache);
    assert_int_equal(n_alive, 0);
}

static void a_result_of_no_bytes_is_never_dropped_for_the_budget(void **state)
{
    (void)state;
    struct once_cache *cache = once_cache_create(&type, 0);
    struct building none = { .cache = cache, .value = 1 }, some = { .cache = cache, .value = 2, .n_bytes = 10 },
                    more = { .cache = cache, .value = 3, .n_bytes = 10 };
    get_value(&none);
    get_value(&some);
    get_value(&more);
    assert_int_equal(usage_of(cache).n_results, 2); /* `some` went: the newest is kept, and the one of no bytes */
    get_value(&none);
    assert_int_equal(none.n_builds, 1);
    once_cache_destroy(cache);
}

static void what_is_offered_is_kept_unless_there_is_one(void **state)
{
    (void)state;
    struct building building = { .cache = once_cache_create(&type, 1000), .value = 5, .n_bytes = 10 };
    struct once_key key = key_of(&building.value);
    struct number *offered = make_number(50, 10), *second = make_number(51, 10);
    once_cache_offer(building.cache, &key, offered);
    once_cache_offer(building.cache, &key, second);
    unref(offered);
    unref(second);
    assert_int_equal(n_alive, 1);
    assert_int_equal(get_value(&building), 50);
    assert_int_equal(building.n_builds, 0);
    once_cache_destroy(building.cache);
    assert_int_equal(n_alive, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_thread_builds_and_all_get_the_same_result),
        cmocka_unit_test(while_one_key_is_built_another_key_can_be_asked_for),
        cmocka_unit_test(a_failure_is_not_kept_and_each_that_waited_builds_in_turn),
        cmocka_unit_test(a_refusal_is_kept_and_given_again_without_a_build),
        cmocka_unit_test(the_least_recently_used_is_dropped_and_lives_on_with_its_holder),
        cmocka_unit_test(a_result_of_no_bytes_is_never_dropped_for_the_budget),
        cmocka_unit_test(what_is_offered_is_kept_unless_there_is_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
