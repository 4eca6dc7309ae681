/* Users who are kept here, and whom an administrator has disabled. */
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/auth/auth_state.h"
#include "server/auth/words.h"

/* Keeps out a person whom only the proxy knows. */
static struct user *add_barred(struct auth *auth, const char *id)
{
    struct store_user row = { .created_ms = auth_now_ms(auth) };
    mem_put_text(row.id, sizeof row.id, id);
    mem_put_text(row.name, sizeof row.name, id);
    auth_user_put(auth, &row);
    return auth_find_user(auth, id);
}

bool auth_user_disable(struct auth *auth, const char *id, bool is_disabled, struct problem *problem)
{
    lock_hold(auth->lock);
    struct user *user = auth_find_user(auth, id);
    if (!user && is_disabled && auth->options.is_proxied && words_are_id(id) && auth->n_users < AUTH_MAX_USERS)
        user = add_barred(auth, id);
    if (user) {
        user->row.is_disabled = is_disabled;
        auth_write_user(auth, user);
        if (is_disabled)
            auth_sessions_end_of(auth, id);
    }
    lock_release(auth->lock);
    return user || problem_set(problem, PROBLEM_NOT_FOUND, "", "", "there is no user \"%.64s\"", id);
}

bool auth_has_user(struct auth *auth, const char *user)
{
    lock_hold(auth->lock);
    const bool has = auth_find_user(auth, user) != NULL;
    lock_release(auth->lock);
    return has;
}

static int by_id(const void *a, const void *b)
{
    const struct store_user *one = a, *other = b;
    return strcmp(one->id, other->id);
}

struct store_user *auth_users(struct auth *auth, size_t *n)
{
    *n = 0;
    lock_hold(auth->lock);
    struct store_user *list = mem_array(auth->n_users + 1, sizeof *list, 16 << 20, NULL);
    for (size_t i = 0; list && i < AUTH_BUCKETS; i++)
        for (const struct user *user = auth->users[i]; user; user = user->next) {
            list[*n] = user->row;
            memset(list[*n].password, 0, sizeof list[*n].password);
            ++*n;
        }
    lock_release(auth->lock);
    if (list)
        qsort(list, *n, sizeof *list, by_id);
    return list;
}
