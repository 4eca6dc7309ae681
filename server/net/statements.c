/* The list of statements: statements.h. */
#include "server/net/statements.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/net/can_write.h"
#include "server/net/keep_change.h"
#include "server/net/schedule.h"

enum { STATEMENTS_PAUSE_MS = 500 };

struct kept_statement {
    char plan[64];
    cJSON *now;      /* as it counts; NULL: it is deleted, or its first write is under way */
    cJSON *pending;  /* as it is being written */
    uint64_t ticket; /* of that write; 0: none */
    net_statement_done *done;
    void *context;
    bool is_changed;   /* now is not on disk */
    bool is_forgotten; /* its plan has gone while the write was under way: pending never counts */
};

struct statements {
    struct kept_statement *list; /* place for NET_MAX_STATEMENTS */
    size_t n;
};

static struct kept_statement *find(const struct net *net, const char *plan_id)
{
    for (size_t i = 0; net->statements && i < net->statements->n; i++)
        if (strcmp(net->statements->list[i].plan, plan_id) == 0)
            return &net->statements->list[i];
    return NULL;
}

static struct kept_statement *append(struct net *net, const char *plan_id)
{
    if (!net->statements) {
        net->statements = mem_new(sizeof *net->statements);
        net->statements->list = mem_array(NET_MAX_STATEMENTS, sizeof net->statements->list[0], 1 << 20, NULL);
    }
    struct statements *all = net->statements;
    if (!all->list || all->n >= NET_MAX_STATEMENTS)
        return NULL;
    struct kept_statement *kept = &all->list[all->n++];
    *kept = (struct kept_statement){ 0 };
    mem_put_text(kept->plan, sizeof kept->plan, plan_id);
    return kept;
}

/* Drops what says nothing and waits for nothing. */
static void drop_if_empty(struct net *net, struct kept_statement *kept)
{
    struct statements *all = net->statements;
    if (kept->now || kept->ticket || kept->is_changed)
        return;
    const size_t i = (size_t)(kept - all->list);
    cJSON_Delete(kept->pending);
    all->n--;
    memmove(kept, kept + 1, (all->n - i) * sizeof *kept);
}

static bool is_full(const struct net *net)
{
    return net->statements && net->statements->n >= NET_MAX_STATEMENTS;
}

/* The other id of the plan, with or without sign-in; "": it has none. */
static void other_id_of(const struct net *net, const char *plan_id, char out[64])
{
    struct fleet_erase of;
    out[0] = 0;
    if (!net->fleet || !net->statements || net->statements->n == 0)
        return;
    fleet_erase_of(net->fleet, plan_id, &of);
    mem_put_text(out, 64, strcmp(of.id, plan_id) == 0 ? of.other_id : of.id);
}

/* The statement of the plan, by whichever of its ids it is kept. */
static struct kept_statement *find_of_plan(const struct net *net, const char *plan_id)
{
    char other[64];
    struct kept_statement *kept = find(net, plan_id);
    if (kept && (kept->now || kept->ticket))
        return kept;
    other_id_of(net, plan_id, other);
    struct kept_statement *by_other = other[0] ? find(net, other) : NULL;
    return by_other ? by_other : kept;
}

const cJSON *net_statement_on(const struct net *net, const char *plan_id)
{
    const struct kept_statement *kept = find_of_plan(net, plan_id);
    return kept ? kept->now : NULL;
}

const cJSON *statements_find(void *context, const char *plan_id)
{
    return net_statement_on(context, plan_id);
}

/* ---- writing ---------------------------------------------------------------------------------------------------- */

/* Without the patient and the words: a row of the audit is never erased. */
static cJSON *audit_detail(const cJSON *statement, const char *what)
{
    cJSON *detail = cJSON_CreateObject();
    const char *kind = json_text(statement, "kind"), *revision = json_text(statement, "revision");
    cJSON_AddStringToObject(detail, "what", what);
    cJSON_AddStringToObject(detail, "kind", kind ? kind : "");
    cJSON_AddStringToObject(detail, "revision", revision ? revision : "");
    return detail;
}

/* statement NULL: it is deleted. audit: NULL, or taken. NULL: no memory. */
static struct store_room *make_write(const char *plan_id, const cJSON *statement, char *audit)
{
    struct store_room *write = mem_new(sizeof *write);
    write->statement = mem_new(sizeof *write->statement);
    mem_put_text(write->statement->plan, sizeof write->statement->plan, plan_id);
    write->statement->body = statement ? json_print(statement) : NULL;
    return keep_change_with(write, !statement || write->statement->body, audit);
}

static void forget(struct net *net, const char *plan_id)
{
    struct kept_statement *kept = find(net, plan_id);
    if (!kept)
        return;
    cJSON_Delete(kept->now);
    kept->now = NULL;
    kept->is_changed = net->store != NULL;
    kept->is_forgotten = kept->ticket != 0;
    drop_if_empty(net, kept);
    schedule_at(net, 0);
}

/* Takes away what was withdrawn first because its plan's files had changed. False: there is none. */
static bool forget_oldest_withdrawn(struct net *net)
{
    const struct kept_statement *oldest = NULL;
    for (size_t i = 0; i < net->statements->n; i++) {
        const struct kept_statement *kept = &net->statements->list[i];
        const double ms = kept->ticket ? 0 : json_number(kept->now, "withdrawn_ms", 0);
        if (ms > 0 && (!oldest || ms < json_number(oldest->now, "withdrawn_ms", 0)))
            oldest = kept;
    }
    if (oldest)
        forget(net, oldest->plan);
    return oldest != NULL;
}

/* A place for the first statement on the plan; NULL with problem. */
static struct kept_statement *make_place(struct net *net, const char *plan_id, struct problem *problem)
{
    const bool is_made = is_full(net) && forget_oldest_withdrawn(net);
    struct kept_statement *kept = append(net, plan_id);
    if (!kept && is_made) { /* once it is gone from the disk */
        problem_set(problem, PROBLEM_BUSY, "", "",
                    "a statement that does not count any more is taken away for this one");
        problem->retry_after_ms = 300;
    } else if (!kept) {
        problem_set(problem, PROBLEM_LIMIT, "", "",
                    "statements on %d plans are kept, more are not allowed: withdraw some", NET_MAX_STATEMENTS);
    }
    return kept;
}

/* The change counts: the plan is read with it. */
static void take_over(struct net *net, struct kept_statement *kept)
{
    char plan[sizeof kept->plan], other[64];
    net_statement_done *done = kept->done;
    void *context = kept->context;
    mem_put_text(plan, sizeof plan, kept->plan);
    kept->ticket = 0;
    kept->is_changed = false; /* what was on disk was replaced */
    cJSON_Delete(kept->now);
    kept->now = kept->pending;
    kept->pending = NULL;
    drop_if_empty(net, kept);
    other_id_of(net, plan, other);
    if (other[0]) /* an earlier one does not come back when this is withdrawn */
        forget(net, other);
    fleet_read_anew(net->fleet, plan);
    if (done)
        done(context, NULL);
}

/* The plan has gone while its statement was written: that is taken from the disk again. */
static void give_up(struct net *net, struct kept_statement *kept)
{
    struct problem problem;
    net_statement_done *done = kept->done;
    void *context = kept->context;
    cJSON_Delete(kept->pending);
    kept->pending = NULL;
    kept->ticket = 0;
    kept->is_forgotten = false;
    kept->is_changed = net->store != NULL;
    schedule_at(net, 0);
    (void)problem_set(&problem, PROBLEM_NOT_FOUND, "", "", "the plan is gone");
    if (done)
        done(context, &problem);
}

bool net_statement_put(struct net *net, const char *plan_id, cJSON *statement, const struct identity *who,
                       const char *by, const char *address, net_statement_done *done, void *context,
                       struct problem *problem)
{
    struct kept_statement *kept = find_of_plan(net, plan_id);
    if (kept && kept->ticket) {
        problem_set(problem, PROBLEM_BUSY, "", "", "another statement on this plan is being written");
        problem->retry_after_ms = 300;
        cJSON_Delete(statement);
        return false;
    }
    if (!net_can_write(net, problem)) {
        cJSON_Delete(statement);
        return false;
    }
    if (!kept && !(kept = make_place(net, plan_id, problem))) {
        cJSON_Delete(statement);
        return false;
    }
    cJSON *detail = audit_detail(statement ? statement : kept->now, statement ? "made" : "withdrawn");
    const struct keep_change_by say = { who, by, address };
    char *audit = keep_change_row("", plan_id, "statement", detail, &say);
    struct store_room *write = audit && net->store ? make_write(kept->plan, statement, audit) : NULL;
    if (net->store && !keep_change_write(net, write, &kept->ticket, problem)) {
        cJSON_Delete(statement);
        drop_if_empty(net, kept);
        return false;
    }
    kept->pending = statement;
    kept->done = done;
    kept->context = context;
    if (!net->store) {
        free(audit);
        take_over(net, kept);
    }
    return true;
}

bool statements_written(struct net *net, const struct store_answer *answer)
{
    struct problem problem;
    for (size_t i = 0; net->statements && i < net->statements->n; i++) {
        struct kept_statement *kept = &net->statements->list[i];
        const enum keep_change change = keep_change_answer(&kept->ticket, answer, &problem);
        if (change == KEEP_CHANGE_OTHER)
            continue;
        net_statement_done *done = kept->done;
        void *context = kept->context;
        if (kept->is_forgotten) {
            give_up(net, kept);
        } else if (change == KEEP_CHANGE_WRITTEN) {
            take_over(net, kept);
        } else {
            cJSON_Delete(kept->pending);
            kept->pending = NULL;
            drop_if_empty(net, kept);
            if (done)
                done(context, &problem);
        }
        return true;
    }
    return false;
}

void statements_write_due(struct net *net)
{
    for (size_t i = net->statements ? net->statements->n : 0; i-- > 0;) {
        struct kept_statement *kept = &net->statements->list[i];
        if (!kept->is_changed || kept->ticket)
            continue;
        struct store_room *write = make_write(kept->plan, kept->now, NULL);
        kept->is_changed = !write || !store_write(net->store, write, 0);
        if (kept->is_changed) { /* tried again */
            store_room_free(write);
            schedule_at(net, clock_now_us() + STATEMENTS_PAUSE_MS * INT64_C(1000));
        }
        drop_if_empty(net, kept);
    }
}

/* ---- what the plan's files say ---------------------------------------------------------------------------------- */

void statements_plan_changed(struct net *net, const char *plan_id)
{
    struct fleet_plan plan;
    struct kept_statement *kept = find_of_plan(net, plan_id);
    if (!kept || !kept->now || json_number(kept->now, "withdrawn_ms", 0) > 0 ||
        !fleet_plan_find(net->fleet, plan_id, &plan) || plan.state != FLEET_READY)
        return;
    const cJSON *read = cJSON_GetObjectItemCaseSensitive(plan.document, "statement");
    const char *state = json_text(read, "state");
    /* that of another statement is of the renderer that is being replaced */
    if (!state || (strcmp(state, "outdated") != 0 && strcmp(state, "contradicted") != 0) ||
        json_number(read, "time_ms", 0) != json_number(kept->now, "time_ms", -1))
        return;
    cJSON_DeleteItemFromObjectCaseSensitive(kept->now, "withdrawn_ms");
    cJSON_AddNumberToObject(kept->now, "withdrawn_ms", (double)clock_wall_ms());
    kept->is_changed = net->store != NULL;
    net_audit(net, "", "", plan_id, "statement", audit_detail(kept->now, state));
    schedule_at(net, 0);
}

/* ---- the disk, the end ------------------------------------------------------------------------------------------ */

void statements_add_all(struct net *net, const struct store_answer *opened)
{
    for (size_t i = 0; i < opened->n_statements; i++) {
        const struct store_statement *row = &opened->statements[i];
        if (find(net, row->plan)) /* what was said since the start replaces it */
            continue;
        cJSON *body = json_read(row->body, strlen(row->body), NULL);
        struct kept_statement *kept = body ? append(net, row->plan) : NULL;
        if (kept) {
            kept->now = body;
            fleet_read_anew(net->fleet, row->plan); /* one that was opened while the disk could not be read */
        } else {
            log_error(body ? "there is no place for a statement on a plan of the database"
                           : "a statement on a plan is not readable in the database");
            cJSON_Delete(body);
        }
    }
    for (size_t i = 0; opened->is_new && net->statements && i < net->statements->n; i++)
        net->statements->list[i].is_changed = true; /* what was on disk was lost */
}

void net_statement_forget(struct net *net, const char *plan_id, const char *other)
{
    forget(net, plan_id);
    if (other[0])
        forget(net, other);
}

void statements_end(struct net *net)
{
    struct problem problem;
    problem_set(&problem, PROBLEM_BUSY, "", "", "the server is stopping");
    for (size_t i = 0; net->statements && i < net->statements->n; i++) {
        struct kept_statement *kept = &net->statements->list[i];
        if (kept->ticket && kept->done)
            kept->done(kept->context, &problem);
        kept->done = NULL;
        kept->ticket = 0;
    }
}

void statements_finish(struct net *net)
{
    struct statements *all = net->statements;
    for (size_t i = 0; all && i < all->n; i++) {
        cJSON_Delete(all->list[i].now);
        cJSON_Delete(all->list[i].pending);
    }
    if (all)
        free(all->list);
    free(all);
    net->statements = NULL;
}
