/* Gathers equal rows. */
#include "server/net/often.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/mem.h"

struct often {
    struct often *next;
    struct identity who;
    char address[46], room[64], plan[64], action[24], what[96];
    bool is_refused;
    int64_t begun_us, since_ms; /* when its row was written; the time of the first that no row was written for */
    unsigned n;                 /* that no row was written for */
};

static void write_row(struct net *net, const struct often *often, unsigned n)
{
    cJSON *detail = cJSON_CreateObject();
    cJSON_AddStringToObject(detail, "what", often->what);
    if (n > 1) {
        cJSON_AddNumberToObject(detail, "times", n);
        cJSON_AddNumberToObject(detail, "since_ms", (double)often->since_ms);
    }
    if (often->is_refused)
        net_audit_refused(net, &often->who, often->address, often->room, often->plan, often->action, detail);
    else
        net_audit_by(net, &often->who, often->address, often->room, often->plan, often->action, detail);
}

static bool is_same(const struct often *a, const struct often *b)
{
    return a->who.source == b->who.source && strcmp(a->who.user, b->who.user) == 0 &&
           strcmp(a->who.session, b->who.session) == 0 && strcmp(a->address, b->address) == 0 &&
           strcmp(a->room, b->room) == 0 && strcmp(a->plan, b->plan) == 0 && strcmp(a->action, b->action) == 0 &&
           strcmp(a->what, b->what) == 0 && a->is_refused == b->is_refused;
}

/* Ends what began before this time. */
static void end_until(struct net *net, int64_t until_us)
{
    for (struct often **at = &net->often; *at;) {
        struct often *often = *at;
        if (often->begun_us > until_us) {
            at = &often->next;
            continue;
        }
        *at = often->next;
        net->n_often--;
        if (often->n > 0)
            write_row(net, often, often->n);
        free(often);
    }
}

void net_audit_often(struct net *net, const struct identity *who, const char *address, const char *room,
                     const char *plan, const char *action, const char *what, bool is_refused)
{
    struct often said = { .who = *who, .is_refused = is_refused, .begun_us = clock_now_us() }, *often = net->often;
    if (!net->store)
        return;
    (void)snprintf(said.address, sizeof said.address, "%s", address);
    (void)snprintf(said.room, sizeof said.room, "%s", room);
    (void)snprintf(said.plan, sizeof said.plan, "%s", plan);
    (void)snprintf(said.action, sizeof said.action, "%s", action);
    (void)snprintf(said.what, sizeof said.what, "%s", what);
    while (often && !is_same(often, &said))
        often = often->next;
    if (often) {
        if (often->n++ == 0)
            often->since_ms = clock_wall_ms();
        return;
    }
    if (net->n_often == OFTEN_MAX)
        end_until(net, INT64_MAX);
    often = mem_new(sizeof *often);
    *often = said;
    often->next = net->often;
    net->often = often;
    net->n_often++;
    write_row(net, often, 1);
}

void often_tick(struct net *net)
{
    if (net->often)
        end_until(net, clock_now_us() - OFTEN_EVERY_MS * INT64_C(1000));
}

void often_finish(struct net *net)
{
    end_until(net, INT64_MAX);
}
