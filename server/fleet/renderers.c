/* Starts a plan's renderer process with its arguments; closes and fails a plan. */
#include "server/fleet/renderers.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "server/fleet/cache_quota.h"
#include "server/fleet/requests.h"
#include "server/fleet/watch.h"

static const cJSON *statement_on(const struct fleet *fleet, const struct plan_entry *plan)
{
    return fleet->options.statement ? fleet->options.statement(fleet->options.context, plan->id) : NULL;
}

static void put(char *out, size_t size, const cJSON *json, const char *name)
{
    const char *text = json_text(json, name);
    packet_put_text(out, size, text ? text : "");
}

/* Encoded before the process is started: it waits for it. NULL: no memory. */
static uint8_t *statement_packet(const struct plan_entry *plan, const cJSON *said, size_t *n_bytes)
{
    struct packet packet;
    struct problem problem;
    const char *kind = json_text(said, "kind");
    packet_init(&packet, PACKET_STATEMENT);
    struct packet_statement *statement = &packet.statement;
    statement->one_person = kind && strcmp(kind, "one-person") == 0;
    statement->withdrawn = json_number(said, "withdrawn_ms", 0) > 0;
    statement->time_ms = (int64_t)json_number(said, "time_ms", 0);
    put(statement->revision, sizeof statement->revision, said, "revision");
    put(statement->key, sizeof statement->key, said, "key");
    put(statement->patients, sizeof statement->patients, said, "patients");
    if (plan->revision.digest[0] && strcmp(plan->revision.digest, statement->revision) == 0)
        packet_put_text(statement->key, sizeof statement->key, plan->revision.key);
    put(statement->by, sizeof statement->by, said, "by");
    put(statement->words, sizeof statement->words, said, "words");
    put(statement->name, sizeof statement->name, said, "name");
    put(statement->patient_id, sizeof statement->patient_id, said, "id");
    put(statement->birth_date, sizeof statement->birth_date, said, "birth_date");
    return packet_encode(&packet, NULL, 0, n_bytes, &problem);
}

bool renderer_start(struct fleet *fleet, struct plan_entry *plan)
{
    char cache[PATH_MAX], limit[32], file_limit[32];
    (void)snprintf(cache, sizeof cache, "%s/cache/%s", fleet->data_folder, plan->id);
    (void)snprintf(limit, sizeof limit, "%llu", (unsigned long long)fleet->options.max_renderer_bytes);
    (void)mkdir(cache, 0700); /* without the folder the renderer works without a cache */
    (void)snprintf(file_limit, sizeof file_limit, "%llu", (unsigned long long)cache_quota_max_file(fleet->cache_quota));
    const char *words[20] = { fleet->renderer_path, "--socket-fd", "3",           "--plan-folder", plan->folder,
                              "--plan-id",          plan->id,      "--cache",     cache,           "--max-file-bytes",
                              file_limit,           "--gl",        fleet->gl_word };
    size_t n = 13;
    if (fleet->options.max_renderer_bytes > 0) {
        words[n++] = "--max-bytes";
        words[n++] = limit;
    }
    if (fleet->options.hides_folders)
        words[n++] = "--hide-folder";
    if (fleet->options.stub_renderer)
        words[n++] = "--stub";
    const cJSON *said = statement_on(fleet, plan);
    size_t n_statement = 0;
    uint8_t *statement = said ? statement_packet(plan, said, &n_statement) : NULL;
    if (said && !statement)
        return false; /* tried again: without it the plan would be another's */
    if (statement)
        words[n++] = "--statement";
    plan->process = fleet_next_number(fleet);
    plan->restart_at_us = 0;
    plan->problem = (struct problem){ 0 };
    plan->is_killed = false;
    plan->generation++;
    plan->percent = 0;
    plan->has_drawn = plan->is_awaited = false;
    plan->ready_us = 0;
    plan->started_us = clock_now_us();
    plan->progressed_us = fleet_now_us(fleet);
    cache_quota_begin(fleet->cache_quota, plan->id, plan->process);
    if (watch_start_renderer(fleet->watch, plan->process, fleet_arguments(words))) {
        if (statement && !watch_send(fleet->watch, plan->process, statement, n_statement))
            watch_stop(fleet->watch, plan->process, true, "could not be told what was stated of its plan");
        return true;
    }
    free(statement);
    cache_quota_end(fleet->cache_quota, plan->process);
    plan->process = 0;
    return false;
}

static void stop_process(struct fleet *fleet, struct plan_entry *plan)
{
    if (plan->process)
        watch_stop(fleet->watch, plan->process, false, "is no longer wanted");
    plan_entry_lose(plan);
    plan->restart_at_us = 0;
}

void renderer_close(struct fleet *fleet, struct plan_entry *plan, const char *why)
{
    struct problem problem;
    problem_set(&problem, PROBLEM_CANCELLED, "", "", "the plan was closed: %s", why);
    requests_fail(fleet, plan, false, &problem);
    stop_process(fleet, plan);
    plan->waits_for_slot = false;
    plan->was_ready = false;
    plan->phase[0] = 0;
    plan->percent = 0;
    plan_entry_forget_documents(plan);
    plan_entry_change(fleet, plan, FLEET_CLOSED);
    log_info("plan %s: closed: %s", plan->id, why);
}

void renderer_fail(struct fleet *fleet, struct plan_entry *plan, const struct problem *problem)
{
    stop_process(fleet, plan);
    plan->failed_number = fleet->last_number;
    plan->failed_opening = plan->opening;
    plan->problem = plan->failure = *problem;
    requests_fail(fleet, plan, false, problem);
    plan_entry_change(fleet, plan, FLEET_FAILED);
    log_warn("plan %s: %s", plan->id, problem->detail);
}
