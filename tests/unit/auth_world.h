#pragma once
/* Sign-in with a clock of the test's, and what it answered. */
#include "core/base/mem.h"
#include "core/base/queue.h"
#include "server/auth/auth.h"

enum { AUTH_MINUTE_MS = 60000 };
#define AUTH_START_MS INT64_C(1767225600000)

struct auth_world {
    struct auth *auth;
    struct queue *answers;
    int64_t now_ms;
};
extern struct auth_world auth_world;

int auth_world_set_up(void **state); /* both ways to sign in; passwords cost nothing */
int auth_world_tear_down(void **state);
void auth_world_open(bool is_local, bool is_proxied, bool is_cheap); /* anew */
void auth_world_fresh(void);                                         /* likewise, before anything was loaded */
void auth_world_done(void *context, const struct auth_answer *answer);
struct auth_answer auth_world_await(void);
void auth_world_add_user(const char *user, const char *groups); /* Ann Example, with the password "correct horse" */
struct auth_answer auth_world_sign_in(const char *user, const char *password);
struct identity auth_world_with_cookie(const char *name, const char *secret);
struct identity auth_world_with_token(const char *token, bool is_right);
