/* Pauses of whole networks, and how many of their passwords wait. The clock is the test's. */
#include "server/auth/throttle.h"

#include "server/auth/auth.h"
#include "tests/check.h"
#include "tests/unit/auth_world.h"

#define HERE "192.0.2.7" /* the address of auth_world_sign_in */
#define ELSEWHERE "198.51.100.9"

static struct auth_answer wrong_of_fresh_name(void)
{
    static int n;
    char user[24];
    (void)snprintf(user, sizeof user, "stranger%d", n++);
    return auth_world_sign_in(user, "any horse");
}

static struct auth_answer sign_in_from(const char *address)
{
    struct problem problem = { 0 };
    if (!auth_sign_in(auth_world.auth, "ann", "correct horse", address, true, auth_world_done, NULL, &problem))
        return (struct auth_answer){ .problem = problem };
    return auth_world_await();
}

/* A name of its own for each password does not help: the twentieth that fails begins a pause, and a right one between
 * them forgets nothing. */
static void a_network_pauses_over_all_its_names(void **state)
{
    (void)state;
    auth_world_add_user("ann", "");
    for (int i = 1; i < 20; i++) {
        const struct auth_answer answer = wrong_of_fresh_name();
        assert_string_equal(answer.problem.code, "password");
        assert_int_equal(answer.tries_left, 20 - i < 4 ? 20 - i : 4);
        assert_int_equal(answer.pause_s, 60);
    }
    assert_string_equal(sign_in_from(HERE).problem.detail, "");
    const struct auth_answer last = wrong_of_fresh_name();
    assert_string_equal(last.problem.code, "password");
    assert_int_equal(last.tries_left, 0);
    assert_int_equal(last.pause_s, 60);
    auth_world.now_ms += 60 * 1000 - 1;
    assert_string_equal(wrong_of_fresh_name().problem.code, "pause");
    assert_string_equal(sign_in_from(HERE).problem.code, "pause");
    assert_int_equal(sign_in_from(HERE).problem.retry_after_ms, 1);
    assert_string_equal(sign_in_from(ELSEWHERE).problem.detail, "");
    auth_world.now_ms++;
    assert_int_equal(wrong_of_fresh_name().pause_s, 120);
    auth_world.now_ms += 60 * AUTH_MINUTE_MS;
    assert_string_equal(sign_in_from(HERE).problem.detail, "");
}

/* Strangers in the network of somebody who is in a meeting do not keep them from signing. */
static void a_pause_of_the_network_keeps_nobody_from_confirming(void **state)
{
    (void)state;
    struct problem problem = { 0 };
    auth_world_add_user("ann", "");
    const struct auth_answer in = sign_in_from(HERE);
    for (int i = 0; i < 20; i++)
        (void)wrong_of_fresh_name();
    assert_string_equal(sign_in_from(HERE).problem.code, "pause");
    assert_true(auth_confirm(auth_world.auth, &in.identity, "correct horse", auth_world_done, NULL, &problem));
    assert_string_equal(auth_world_await().problem.detail, "");
    for (int i = 0; i < THROTTLE_TRIES; i++) {
        assert_true(auth_confirm(auth_world.auth, &in.identity, "wrong horse", auth_world_done, NULL, &problem));
        assert_string_equal(auth_world_await().problem.code, "password");
    }
    assert_false(auth_confirm(auth_world.auth, &in.identity, "correct horse", auth_world_done, NULL, &problem));
    assert_string_equal(problem.code, "pause");
}

/* Twenty an hour are forgotten, so a house of many people who mistype one every three minutes is never kept out. */
static void failures_of_a_network_are_forgotten_with_time(void **state)
{
    (void)state;
    struct throttle *throttle = throttle_create();
    int64_t now_ms = AUTH_START_MS;
    for (int i = 0; i < 200; i++, now_ms += 3 * AUTH_MINUTE_MS)
        assert_int_equal(throttle_fail(throttle, NULL, HERE, now_ms).waits_ms, 0);
    for (int i = 0; i < 20; i++)
        (void)throttle_fail(throttle, NULL, HERE, now_ms);
    assert_true(throttle_look(throttle, NULL, HERE, now_ms).waits_ms > 0);
    now_ms += 55 * AUTH_MINUTE_MS;
    assert_true(throttle_look(throttle, NULL, HERE, now_ms).tries_left < THROTTLE_NETWORK_TRIES);
    assert_int_equal(throttle_look(throttle, NULL, HERE, now_ms + 120 * AUTH_MINUTE_MS).tries_left,
                     THROTTLE_NETWORK_TRIES);
    throttle_destroy(throttle);
}

/* Behind loopback may stand a proxy that is not trusted, with everybody behind it. */
static void loopback_and_an_unknown_address_pause_after_a_hundred(void **state)
{
    (void)state;
    static const char *const shared[] = { "", "127.0.0.1", "127.9.9.9", "::1" };
    struct throttle *throttle = throttle_create();
    for (size_t k = 0; k < sizeof shared / sizeof shared[0]; k++) {
        for (int i = 1; i < 100; i++)
            assert_int_equal(throttle_fail(throttle, NULL, shared[k], AUTH_START_MS).tries_left, 100 - i);
        assert_int_equal(throttle_fail(throttle, NULL, shared[k], AUTH_START_MS).waits_ms, 60 * 1000);
    }
    for (int i = 1; i < 20; i++) /* and of IPv6, 64 bits are one */
        (void)throttle_fail(throttle, NULL, i % 2 ? "2001:db8::1" : "2001:db8::2:3", AUTH_START_MS);
    assert_int_equal(throttle_look(throttle, NULL, "2001:db8::4", AUTH_START_MS).tries_left, 1);
    assert_int_equal(throttle_look(throttle, NULL, "2001:db8:0:1::1", AUTH_START_MS).tries_left, 20);
    assert_int_equal(throttle_look(throttle, "", "2001:db8::1", AUTH_START_MS).tries_left, THROTTLE_TRIES);
    throttle_destroy(throttle);
}

/* A crowd behind one address that knows its passwords is not slowed down: four wait only of a network that has just
 * failed five times, of others as many as the queue takes. */
static void of_a_network_that_fails_four_wait(void **state)
{
    (void)state;
    struct throttle *throttle = throttle_create();
    for (int i = 0; i < AUTH_QUEUE; i++)
        assert_true(throttle_enter(throttle, HERE, AUTH_START_MS));
    for (int i = 0; i < AUTH_QUEUE; i++)
        throttle_leave(throttle, HERE);
    for (int i = 0; i < THROTTLE_TRIES; i++)
        (void)throttle_fail(throttle, NULL, HERE, AUTH_START_MS);
    for (int i = 0; i < 4; i++)
        assert_true(throttle_enter(throttle, HERE, AUTH_START_MS));
    assert_false(throttle_enter(throttle, HERE, AUTH_START_MS));
    assert_true(throttle_enter(throttle, ELSEWHERE, AUTH_START_MS));
    throttle_leave(throttle, ELSEWHERE);
    assert_false(throttle_enter(throttle, HERE, AUTH_START_MS));
    throttle_leave(throttle, HERE);
    assert_true(throttle_enter(throttle, HERE, AUTH_START_MS));
    assert_false(throttle_enter(throttle, HERE, AUTH_START_MS));
    assert_true(throttle_enter(throttle, HERE, AUTH_START_MS + AUTH_MINUTE_MS + 1));
    for (int i = 0; i < THROTTLE_TRIES; i++)
        (void)throttle_fail(throttle, NULL, "127.0.0.1", AUTH_START_MS);
    for (int i = 0; i < AUTH_QUEUE; i++)
        assert_true(throttle_enter(throttle, "127.0.0.1", AUTH_START_MS));
    throttle_destroy(throttle);
}

/* With passwords as slow as they are: a stranger's names leave room in the queue for others. */
static void a_stranger_does_not_fill_the_queue(void **state)
{
    (void)state;
    struct problem problem = { 0 };
    int n_taken = 0;
    char user[16];
    auth_world_open(true, false, false);
    auth_world_add_user("ann", "");
    for (int i = 0; i < THROTTLE_TRIES; i++)
        (void)wrong_of_fresh_name();
    for (int i = 0; i < 3 * AUTH_QUEUE; i++) {
        (void)snprintf(user, sizeof user, "u%d", i);
        if (auth_sign_in(auth_world.auth, user, "any horse", HERE, true, auth_world_done, NULL, &problem))
            n_taken++;
        else
            assert_int_equal(problem.retry_after_ms, AUTH_RETRY_MS);
    }
    assert_in_range(n_taken, 4, AUTH_QUEUE - 2); /* some were checked meanwhile */
    assert_true(
        auth_sign_in(auth_world.auth, "ann", "correct horse", ELSEWHERE, true, auth_world_done, NULL, &problem));
    for (int i = 0; i < n_taken; i++)
        assert_string_equal(auth_world_await().problem.code, "password");
    assert_string_equal(auth_world_await().problem.detail, "");
}

/* Not even twice as many failures as there are places push a pause out of the table. */
static void a_pause_outlasts_failures_of_others(void **state)
{
    (void)state;
    struct throttle *throttle = throttle_create();
    char user[24];
    for (int i = 0; i < THROTTLE_TRIES; i++)
        (void)throttle_fail(throttle, "ann", HERE, AUTH_START_MS);
    for (int i = 1; i <= 2 * THROTTLE_PLACES; i++) {
        (void)snprintf(user, sizeof user, "stranger%d", i);
        (void)throttle_fail(throttle, user, ELSEWHERE, AUTH_START_MS + i);
    }
    assert_true(throttle_look(throttle, "ann", HERE, AUTH_START_MS + 2 * THROTTLE_PLACES).waits_ms > 0);
    throttle_destroy(throttle);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, auth_world_set_up, auth_world_tear_down)
    const struct CMUnitTest tests[] = {
        TEST(a_network_pauses_over_all_its_names),
        TEST(a_pause_of_the_network_keeps_nobody_from_confirming),
        cmocka_unit_test(failures_of_a_network_are_forgotten_with_time),
        cmocka_unit_test(loopback_and_an_unknown_address_pause_after_a_hundred),
        cmocka_unit_test(of_a_network_that_fails_four_wait),
        TEST(a_stranger_does_not_fill_the_queue),
        cmocka_unit_test(a_pause_outlasts_failures_of_others),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
