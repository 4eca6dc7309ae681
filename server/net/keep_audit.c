/* Rows for the audit, from rooms and calls to the store. */
#include "server/net/keep_audit.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/auth/digest.h"
#include "server/net/schedule.h"
#include "server/wire/json.h"

struct net_room *keep_find(const struct net *net, const struct room *room)
{
    for (size_t i = 0; net->store && i < net->n_rooms; i++)
        if (net->rooms[i]->room == room)
            return net->rooms[i];
    return NULL;
}

void keep_audit_add(struct net *net, char ***rows, size_t *n, char *row)
{
    if (*n % 16 == 0) {
        void *more = realloc(*rows, (*n + 16) * sizeof **rows);
        if (!more) {
            log_error("a row of the audit is lost: no memory");
            net->n_audit_waiting--;
            net->n_audit_lost++;
            free(row);
            return;
        }
        *rows = more;
    }
    (*rows)[(*n)++] = row;
}

void net_audit_plan_key(const char *plan, char key[NET_AUDIT_PLAN_KEY])
{
    char hex[DIGEST_TEXT];
    digest_text(plan, hex);
    (void)snprintf(key, NET_AUDIT_PLAN_KEY, "%s%.*s", plan[0] ? "plan-" : "", plan[0] ? 16 : 0, hex);
}

cJSON *keep_audit_describe(const char *room, const char *plan_id, const struct room_audit *row)
{
    char plan[NET_AUDIT_PLAN_KEY];
    net_audit_plan_key(plan_id, plan);
    cJSON *json = cJSON_CreateObject();
    cJSON_AddNumberToObject(json, "time_ms", (double)row->time_ms);
    cJSON_AddStringToObject(json, "room", room);
    cJSON_AddStringToObject(json, "plan", plan);
    cJSON_AddStringToObject(json, "member", row->member);
    cJSON_AddStringToObject(json, "name", row->name);
    cJSON_AddStringToObject(json, "role", row->role);
    cJSON_AddStringToObject(json, "address", row->address);
    cJSON_AddStringToObject(json, "user", row->user ? row->user : "");
    cJSON_AddStringToObject(json, "source", row->source ? row->source : "");
    cJSON_AddStringToObject(json, "session", row->session ? row->session : "");
    cJSON_AddStringToObject(json, "action", row->action);
    json_add(json, "detail", cJSON_CreateRaw(row->detail));
    json_add(json, "revision_before", row->before < 0 ? cJSON_CreateNull() : cJSON_CreateNumber((double)row->before));
    json_add(json, "revision_after", row->after < 0 ? cJSON_CreateNull() : cJSON_CreateNumber((double)row->after));
    cJSON_AddStringToObject(json, "result", row->result);
    return json;
}

static void keep_row(struct net *net, char ***rows, size_t *n, cJSON *json)
{
    char *text = net->n_audit_waiting < 2 * (size_t)NET_MAX_AUDIT ? json_print(json) : NULL;
    cJSON_Delete(json);
    if (!text) {
        if (net->n_audit_lost++ == 0)
            log_error("a row of the audit is lost: %zu wait for the disk", net->n_audit_waiting);
        return;
    }
    net->n_audit_waiting++;
    keep_audit_add(net, rows, n, text);
    schedule_at(net, 0);
}

/* Says first how many rows were lost before this one. */
static void keep_row_and_loss(struct net *net, char ***rows, size_t *n, cJSON *json)
{
    char detail[64];
    const struct room_audit lost = { .time_ms = clock_wall_ms(),
                                     .action = "lost",
                                     .member = "",
                                     .name = "",
                                     .role = "",
                                     .address = "",
                                     .detail = detail,
                                     .result = "done",
                                     .before = -1,
                                     .after = -1 };
    if (net->n_audit_lost && net->n_audit_waiting < NET_MAX_AUDIT) {
        (void)snprintf(detail, sizeof detail, "{\"rows\":%llu}", (unsigned long long)net->n_audit_lost);
        net->n_audit_lost = 0;
        keep_row(net, rows, n, keep_audit_describe("", "", &lost));
    }
    keep_row(net, rows, n, json);
}

void keep_audited(void *context, struct room *room, const struct room_audit *row)
{
    struct net_room *entry = keep_find(context, room);
    if (entry)
        keep_row_and_loss(context, &entry->keep.audit, &entry->keep.n_audit,
                          keep_audit_describe(room_id(room), room_plan_id(room), row));
}

bool keep_audit_has_place(void *context)
{
    return net_audit_has_place(context);
}

bool net_audit_has_place(const struct net *net)
{
    return !net->store || net->n_audit_waiting < NET_MAX_AUDIT;
}

static void audit_what(struct net *net, const struct identity *who, const char *address, const char *room,
                       const char *plan, const char *action, cJSON *detail, const char *result)
{
    char *text = json_print(detail);
    const struct room_audit row = { .time_ms = clock_wall_ms(),
                                    .action = action,
                                    .member = "",
                                    .name = who ? who->name : "",
                                    .role = "",
                                    .address = address,
                                    .user = who ? who->user : "",
                                    .source = who ? identity_source_word(who->source) : "",
                                    .session = who ? who->session : "",
                                    .detail = text ? text : "{}",
                                    .result = result,
                                    .before = -1,
                                    .after = -1 };
    if (net->store)
        keep_row_and_loss(net, &net->audit, &net->n_audit, keep_audit_describe(room, plan, &row));
    cJSON_Delete(detail);
    free(text);
}

void net_audit(struct net *net, const char *address, const char *room, const char *plan, const char *action,
               cJSON *detail)
{
    audit_what(net, NULL, address, room, plan, action, detail, "done");
}

void net_audit_by(struct net *net, const struct identity *who, const char *address, const char *room, const char *plan,
                  const char *action, cJSON *detail)
{
    audit_what(net, who, address, room, plan, action, detail, "done");
}

void net_audit_refused(struct net *net, const struct identity *who, const char *address, const char *room,
                       const char *plan, const char *action, cJSON *detail)
{
    audit_what(net, who, address, room, plan, action, detail, "refused");
}

void net_set_caller(struct net *net, const struct identity *who)
{
    net->has_caller = who != NULL;
    if (who)
        net->caller = *who;
}

const struct identity *keep_caller(void *context)
{
    const struct net *net = context;
    return net->has_caller ? &net->caller : NULL;
}

struct net_audit_head net_audit_head(const struct net *net)
{
    struct net_audit_head head = net->audit_head;
    head.n_waiting = net->n_audit_waiting;
    return head;
}

void keep_audit_write(struct net *net)
{
    struct store_room *row = mem_new(sizeof *row);
    *row = (struct store_room){ .audit = net->audit, .n_audit = net->n_audit };
    if (store_write(net->store, row, 0)) {
        net->audit = NULL;
        net->n_audit = 0;
        return;
    }
    row->audit = NULL;
    row->n_audit = 0;
    store_room_free(row);
}

void keep_audit_written(struct net *net, const struct store_answer *answer)
{
    net->n_audit_waiting -= answer->n_audit;
    if (answer->error.code != ERROR_NONE && !answer->audit_n)
        return;
    net->audit_head.n = answer->audit_n;
    memcpy(net->audit_head.hash, answer->audit_hash, sizeof net->audit_head.hash);
}
