/* Owners of uploaded plans. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/auth/auth_state.h"

static struct owner **find_owner(struct auth *auth, const char *plan)
{
    struct owner **at = &auth->owners[auth_bucket(plan)];
    while (*at && strcmp((*at)->row.plan, plan) != 0)
        at = &(*at)->next;
    return at;
}

void auth_owner(struct auth *auth, const char *plan, char user[IDENTITY_MAX_USER + 1])
{
    lock_hold(auth->lock);
    const struct owner *owner = *find_owner(auth, plan);
    (void)snprintf(user, IDENTITY_MAX_USER + 1, "%s", owner ? owner->row.user : "");
    lock_release(auth->lock);
}

void auth_set_owner(struct auth *auth, const char *plan, const char *user)
{
    struct store_owner row = { .is_deleted = !user[0] };
    mem_put_text(row.plan, sizeof row.plan, plan);
    mem_put_text(row.user, sizeof row.user, user);
    lock_hold(auth->lock);
    struct owner **at = find_owner(auth, row.plan), *old = *at;
    if (old) {
        *at = old->next;
        free(old);
    }
    if (!row.is_deleted)
        auth_owner_put(auth, &row);
    if (old || !row.is_deleted)
        auth_write_owner(auth, &row);
    lock_release(auth->lock);
}
