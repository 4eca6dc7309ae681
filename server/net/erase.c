/* The steps of erasing a plan, one plan at a time. */
#include "server/net/erase.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "server/net/keep_audit.h"
#include "server/net/meeting_list.h"
#include "server/net/statements.h"
#include "server/wire/random.h"

enum erase_step { ERASE_NOTED, ERASE_REMOVING, ERASE_FINISHING };

struct erasing {
    enum erase_step step; /* that is under way */
    uint64_t ticket;
    struct store_erase what;
    char address[46];
    net_erased *done;
    void *context;
};

static void end(struct net *net, const struct store_erased *erased, const struct problem *problem)
{
    struct erasing *erasing = net->erasing;
    net->erasing = NULL;
    erasing->done(erasing->context, erased->n_rooms + erasing->what.n_rooms, erased->n_records, problem);
    free(erasing);
}

/* The row, but for the numbers, which the store knows. */
static bool make_row(struct store_erase *what, const struct identity *who, const char *address, const char *reason)
{
    char *detail_text, *text;
    cJSON *detail = cJSON_CreateObject();
    cJSON_AddStringToObject(detail, "erase", what->id);
    cJSON_AddStringToObject(detail, "reason", reason);
    cJSON_AddBoolToObject(detail, "folder", what->folder[0] != 0);
    detail_text = json_print(detail);
    const struct room_audit row = { .time_ms = clock_wall_ms(),
                                    .action = "erase",
                                    .member = "",
                                    .name = who->name,
                                    .role = "",
                                    .address = address,
                                    .user = who->user,
                                    .source = identity_source_word(who->source),
                                    .session = who->session,
                                    .detail = detail_text ? detail_text : "{}",
                                    .result = "done",
                                    .before = -1,
                                    .after = -1 };
    cJSON *json = keep_audit_describe("", what->plan, &row);
    text = json_print(json);
    const bool ok = text && strlen(text) < sizeof what->row;
    (void)snprintf(what->row, sizeof what->row, "%s", ok ? text : "");
    cJSON_Delete(json);
    cJSON_Delete(detail);
    free(text);
    free(detail_text);
    return ok;
}

bool net_erase_plan(struct net *net, const char *plan_id, const struct identity *who, const char *address,
                    const char *reason, net_erased *done, void *context, struct problem *problem)
{
    if (!net->store)
        return problem_set(problem, PROBLEM_NOT_FOUND, "", "", "this server keeps no records");
    if (net->erasing) {
        problem_set(problem, PROBLEM_BUSY, "", "", "another plan is being erased");
        problem->retry_after_ms = 2000;
        return false;
    }
    struct fleet_erase of;
    struct erasing *erasing = mem_new(sizeof *erasing);
    struct store_erase *what = &erasing->what;
    *erasing = (struct erasing){ .ticket = net->n_tickets + 1, .done = done, .context = context };
    random_hex(what->id, 16);
    fleet_erase_of(net->fleet, plan_id, &of);
    mem_put_text(what->plan, sizeof what->plan, of.id);
    mem_put_text(what->other, sizeof what->other, of.other_id);
    mem_put_text(what->folder, sizeof what->folder, of.folder);
    mem_put_text(what->cache, sizeof what->cache, of.cache);
    mem_put_text(what->other_cache, sizeof what->other_cache, of.other_cache);
    (void)snprintf(erasing->address, sizeof erasing->address, "%s", address);
    if (!make_row(what, who, address, reason) || !store_erase(net->store, what, true, erasing->ticket)) {
        free(erasing);
        problem_set(problem, PROBLEM_BUSY, "", "", "the disk has too much to do to erase a plan now");
        problem->retry_after_ms = 1000;
        return false;
    }
    net->n_tickets++;
    net->erasing = erasing;
    return true;
}

/* It is noted: from here on it will be erased, whatever happens. */
static void remove_all(struct net *net)
{
    struct erasing *erasing = net->erasing;
    struct problem problem;
    const char *plan = erasing->what.plan, *other = erasing->what.other;
    const size_t n_before = net->n_rooms + net->n_asleep;
    net_rooms_delete_of_plan(net, plan, erasing->address, "its plan was erased");
    if (other[0])
        net_rooms_delete_of_plan(net, other, erasing->address, "its plan was erased");
    meetings_erase(net, plan, other);
    net_statement_forget(net, plan, other);
    erasing->what.n_rooms = (int64_t)(n_before - net->n_rooms - net->n_asleep);
    erasing->step = ERASE_REMOVING;
    if (!fleet_erase_plan(net->fleet, plan, &problem) && problem.type != PROBLEM_NOT_FOUND)
        end(net, &(struct store_erased){ 0 }, &problem);
}

void erase_tick(struct net *net)
{
    struct erasing *erasing = net->erasing;
    if (!erasing || erasing->step != ERASE_REMOVING || fleet_is_removing(net->fleet) || net->n_undeleted)
        return;
    if (!store_erase(net->store, &erasing->what, false, net->n_tickets + 1))
        return;
    erasing->ticket = ++net->n_tickets;
    erasing->step = ERASE_FINISHING;
}

void erase_answered(struct net *net, const struct store_answer *answer)
{
    struct problem problem;
    if (!net->erasing || net->erasing->ticket != answer->ticket)
        return;
    if (answer->error.code != ERROR_NONE) {
        problem_set(&problem, PROBLEM_STORAGE, "", "", "%s", answer->error.text);
        end(net, &answer->erased, &problem);
    } else if (net->erasing->step == ERASE_NOTED) {
        remove_all(net);
    } else {
        end(net, &answer->erased, NULL);
    }
}

bool net_is_erasing(const struct net *net, const char *plan_id)
{
    const struct store_erase *what = net->erasing ? &net->erasing->what : NULL;
    return what && (strcmp(what->plan, plan_id) == 0 || strcmp(what->other, plan_id) == 0);
}

void erase_end(struct net *net)
{
    struct problem problem;
    problem_set(&problem, PROBLEM_BUSY, "", "", "the server is stopping");
    if (net->erasing)
        end(net, &(struct store_erased){ 0 }, &problem);
}
