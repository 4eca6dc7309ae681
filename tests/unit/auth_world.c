/* Signs in for tests. */
#include "tests/unit/auth_world.h"

#include "tests/check.h"

struct auth_world auth_world;

static int64_t clock_of_test(void)
{
    return auth_world.now_ms;
}

static void create(bool is_local, bool is_proxied, bool is_cheap)
{
    struct error err = { 0 };
    auth_destroy(auth_world.auth);
    const struct auth_options options = {
        .is_local = is_local, .is_proxied = is_proxied, .now_ms = clock_of_test, .is_cheap = is_cheap
    };
    auth_world.auth = auth_create(&options, &err);
    assert_string_equal(err.text, "");
}

void auth_world_open(bool is_local, bool is_proxied, bool is_cheap)
{
    create(is_local, is_proxied, is_cheap);
    auth_load(auth_world.auth, NULL, false);
}

void auth_world_fresh(void)
{
    create(true, true, true);
}

int auth_world_set_up(void **state)
{
    (void)state;
    auth_world.now_ms = AUTH_START_MS;
    auth_world.answers = queue_create(64, free);
    auth_world_open(true, true, true);
    return 0;
}

int auth_world_tear_down(void **state)
{
    (void)state;
    auth_destroy(auth_world.auth);
    auth_world.auth = NULL;
    queue_destroy(auth_world.answers);
    return 0;
}

void auth_world_done(void *context, const struct auth_answer *answer)
{
    struct auth_answer *copy = mem_new(sizeof *copy);
    (void)context;
    *copy = *answer;
    assert_true(queue_try_put(auth_world.answers, copy));
}

struct auth_answer auth_world_await(void)
{
    struct auth_answer *answer = queue_take(auth_world.answers, 60000), copy;
    assert_non_null(answer);
    copy = *answer;
    free(answer);
    return copy;
}

void auth_world_add_user(const char *user, const char *groups)
{
    struct problem problem = { 0 };
    assert_true(
        auth_user_add(auth_world.auth, user, "Ann Example", groups, "correct horse", auth_world_done, NULL, &problem));
    assert_string_equal(auth_world_await().problem.detail, "");
}

struct auth_answer auth_world_sign_in(const char *user, const char *password)
{
    struct problem problem = { 0 };
    if (!auth_sign_in(auth_world.auth, user, password, "192.0.2.7", true, auth_world_done, NULL, &problem))
        return (struct auth_answer){ .problem = problem };
    return auth_world_await();
}

struct identity auth_world_with_cookie(const char *name, const char *secret)
{
    char cookie[200];
    struct identity identity;
    struct problem problem = { 0 };
    (void)snprintf(cookie, sizeof cookie, "a=b; %s=%s; c=d", name, secret);
    assert_true(auth_identify(auth_world.auth, &(struct credentials){ .cookie = cookie, .address = "192.0.2.7" },
                              &identity, &problem));
    return identity;
}

struct identity auth_world_with_token(const char *token, bool is_right)
{
    char header[200];
    struct identity identity;
    struct problem problem = { 0 };
    (void)snprintf(header, sizeof header, "Bearer %s", token);
    assert_int_equal(auth_identify(auth_world.auth, &(struct credentials){ .authorization = header }, &identity,
                                   &problem),
                     is_right);
    if (!is_right)
        assert_int_equal(problem.type, PROBLEM_SIGN_IN);
    return identity;
}
