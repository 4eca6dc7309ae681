/* Turns rooms into rows and back. */
#include "server/net/keep.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/net/can_write.h"
#include "server/net/keep_audit.h"
#include "server/net/keep_figures.h"
#include "server/net/keep_recordings.h"
#include "server/net/meeting_list.h"
#include "server/net/schedule.h"
#include "server/net/statements.h"
#include "server/wire/json.h"

void keep_changed(void *context, struct room *room, unsigned parts)
{
    struct net_room *entry = keep_find(context, room);
    if (!entry)
        return;
    entry->keep.changed |= parts;
    if (parts & ROOM_PRESENCE)
        meetings_room_changed(entry->net, room_id(room));
    schedule_at(entry->net, 0);
}

static bool is_changed(const struct net_room *room)
{
    return room->keep.changed || room->keep.n_recordings || room->keep.n_items || room->keep.n_audit;
}

bool keep_is_written(const struct net_room *room)
{
    return !is_changed(room) && room->keep.ticket == 0 && !room->keep.prompts;
}

void keep_is_saved(void *context, const struct room *room, struct room_saved *saved)
{
    const struct net *net = context;
    const struct net_room *entry = keep_find(net, room);
    if (!entry || room_replays(room))
        return;
    const bool fails = net->store_fails || entry->keep.is_refused;
    *saved = (struct room_saved){ .revision = entry->keep.written, .is_full = net->store_is_full };
    saved->state = fails                    ? WIRE_SAVED_STATE_FAILING
                   : keep_is_written(entry) ? WIRE_SAVED_STATE_SAVED
                                            : WIRE_SAVED_STATE_SAVING;
}

/* ---- items ------------------------------------------------------------------------------------------------------ */

/* Copies the fields that the database searches for into columns beside the whole row. */
static void read_columns(const char *row, struct store_item *item)
{
    cJSON *json = json_read(row, strlen(row), NULL);
    json_put_text(item->kind, sizeof item->kind, json, "kind");
    json_put_text(item->author, sizeof item->author, json, "author");
    json_put_text(item->author_name, sizeof item->author_name, json, "author_name");
    item->version = (int64_t)json_number(json, "version", 0);
    item->created_ms = (int64_t)json_number(json, "created_ms", 0);
    item->changed_ms = (int64_t)json_number(json, "changed_ms", 0);
    cJSON_Delete(json);
}

/* The place for an item that is to be written; NULL: no memory. */
static struct store_item *item_place(struct net_room *room, const char *id)
{
    for (size_t i = 0; i < room->keep.n_items; i++)
        if (strcmp(room->keep.items[i].id, id) == 0)
            return &room->keep.items[i];
    void *more = realloc(room->keep.items, (room->keep.n_items + 1) * sizeof room->keep.items[0]);
    if (!more)
        return NULL;
    room->keep.items = more;
    struct store_item *item = &room->keep.items[room->keep.n_items++];
    schedule_at(room->net, 0);
    *item = (struct store_item){ 0 };
    return item;
}

static void item_changed(struct net_room *room, const char *row, const char *id)
{
    struct store_item *item = item_place(room, id);
    if (!item) {
        log_error("room %s: an item cannot be kept: no memory", room_id(room->room));
        return;
    }
    free(item->body);
    *item = (struct store_item){ 0 };
    mem_put_text(item->id, sizeof item->id, id);
    if (row) {
        item->body = mem_copy_text(row);
        read_columns(row, item);
    }
}

void keep_item_changed(void *context, struct room *room, const char *row, const char *id)
{
    struct net_room *entry = keep_find(context, room);
    if (entry)
        item_changed(entry, row, id);
}

static struct store_room *make_row(const struct net_room *room, unsigned parts);

/* Fills the write with the item, its record and its row for the audit. */
static bool fill_prompt(struct store_room *row, const struct room_item_write *write, char *audit)
{
    row->is_prompt = true;
    row->items = mem_array(1, sizeof row->items[0], 1 << 20, NULL);
    row->records = write->record ? mem_array(1, sizeof row->records[0], 1 << 20, NULL) : NULL;
    row->audit = mem_array(1, sizeof row->audit[0], 1 << 20, NULL);
    if (!row->items || !row->audit || (write->record && !row->records)) {
        free(audit);
        return false;
    }
    row->audit[row->n_audit++] = audit;
    struct store_item *item = &row->items[row->n_items++];
    *item = (struct store_item){ .body = mem_copy_text(write->row) };
    mem_put_text(item->id, sizeof item->id, write->id);
    read_columns(write->row, item);
    if (!write->record)
        return true;
    struct store_record *record = &row->records[row->n_records++];
    *record = (struct store_record){ .time_ms = write->time_ms,
                                     .item = mem_copy_text(write->row),
                                     .body = mem_copy_text(write->record) };
    mem_put_text(record->id, sizeof record->id, write->id);
    mem_put_text(record->room, sizeof record->room, row->id);
    mem_put_text(record->plan, sizeof record->plan, row->plan);
    mem_put_text(record->kind, sizeof record->kind, write->kind);
    mem_put_text(record->author, sizeof record->author, write->author);
    mem_put_text(record->author_name, sizeof record->author_name, write->author_name);
    return true;
}

bool keep_item_first(void *context, struct room *room, uint64_t number, const struct room_item_write *write,
                     struct problem *problem)
{
    struct net *net = context;
    struct net_room *entry = keep_find(net, room);
    if (!entry)
        return problem_set(problem, PROBLEM_STORAGE, "", "write",
                           "this room is not kept, and nothing can be added to it");
    if (!keep_can_write(net, problem))
        return false;
    cJSON *json = keep_audit_describe(room_id(room), room_plan_id(room), write->audit);
    char *audit = json_print(json);
    cJSON_Delete(json);
    struct store_room *row = audit ? make_row(entry, 0) : NULL;
    if (!row)
        free(audit);
    struct prompt_write *prompt = mem_new(sizeof *prompt);
    *prompt = (struct prompt_write){ .next = entry->keep.prompts, .ticket = ++net->n_tickets, .number = number };
    if (!row || !fill_prompt(row, write, audit) || (!write->record && !store_write(net->store, row, prompt->ticket))) {
        store_room_free(row);
        free(prompt);
        return keep_refuse(false, problem);
    }
    net->n_audit_waiting++;
    entry->keep.prompts = prompt;
    if (write->record) { /* what is decided about must be what is shown */
        prompt->row = row;
        fleet_look_at_files(net->fleet, room_plan_id(room));
    }
    return true;
}

/* The next item that waits for a look at the plan's files, out of the list; NULL: none does. */
static struct prompt_write *take_waiting(struct net_room *entry)
{
    for (struct prompt_write **at = &entry->keep.prompts; *at; at = &(*at)->next)
        if ((*at)->row && !(*at)->gathering) {
            struct prompt_write *prompt = *at;
            *at = prompt->next;
            return prompt;
        }
    return NULL;
}

/* Hands what has waited to the store, or says why it is not kept. prompt is out of the list; taken. */
static void write_waiting(struct net_room *entry, struct prompt_write *prompt, struct problem *problem)
{
    struct net *net = entry->net;
    struct store_room *row = prompt->row;
    prompt->row = NULL;
    if (problem->type == PROBLEM_NONE && !store_write(net->store, row, prompt->ticket))
        (void)keep_refuse(false, problem);
    if (problem->type == PROBLEM_NONE) {
        prompt->next = entry->keep.prompts;
        entry->keep.prompts = prompt;
        return;
    }
    net->n_audit_waiting--;
    store_room_free(row);
    room_item_written(entry->room, prompt->number, problem, clock_now_us());
    free(prompt);
}

/* All that a decision is kept with is there, as far as it can be had. */
static void gathered(struct net_room *entry, struct prompt_write *prompt)
{
    struct problem problem = { 0 };
    struct prompt_write **at = &entry->keep.prompts;
    while (*at != prompt)
        at = &(*at)->next;
    *at = prompt->next;
    if (!keep_can_write(entry->net, &problem))
        log_warn("room %s: a decision is not kept: the disk cannot be written", room_id(entry->room));
    write_waiting(entry, prompt, &problem);
    schedule_room(entry);
}

void keep_files_looked(struct net_room *entry, const struct fleet_plan *plan)
{
    struct prompt_write *prompt;
    while (!plan->files_are_looked_at && (prompt = take_waiting(entry))) {
        struct problem problem = { 0 };
        if (plan->files_changed_ms || !plan->revision[0])
            problem_set(&problem, PROBLEM_CONFLICT, "", "files",
                        "the plan's files %s: this was not kept and does not count; have them read anew",
                        plan->files_changed_ms ? "have changed on the disk since they were read"
                                               : "cannot be read now");
        if (problem.type == PROBLEM_NONE && keep_figures_begin(entry, prompt, gathered)) {
            prompt->next = entry->keep.prompts;
            entry->keep.prompts = prompt;
            continue;
        }
        write_waiting(entry, prompt, &problem);
    }
}

/* The answer to keep_item_first. True: it was one. */
static bool prompt_written(struct net *net, const struct store_answer *answer)
{
    for (size_t i = 0; i < net->n_rooms; i++)
        for (struct prompt_write **at = &net->rooms[i]->keep.prompts; *at; at = &(*at)->next) {
            struct prompt_write *prompt = *at;
            struct problem problem;
            if (prompt->ticket != answer->ticket)
                continue;
            const bool is_refused = answer->error.code != ERROR_NONE;
            const uint64_t number = prompt->number;
            *at = prompt->next;
            free(prompt);
            if (is_refused)
                (void)keep_refuse(answer->error.code == ERROR_LIMIT, &problem);
            room_item_written(net->rooms[i]->room, number, is_refused ? &problem : NULL, clock_now_us());
            meetings_room_changed(net, room_id(net->rooms[i]->room)); /* it may have been decided */
            schedule_room(net->rooms[i]);
            return true;
        }
    return false;
}

static void all_items_again(struct net_room *room)
{
    for (size_t kind = 0; kind < wire_item_kind_words.n; kind++) {
        cJSON *rows = room_items(room->room, (enum wire_item_kind)kind);
        const cJSON *row;
        cJSON_ArrayForEach(row, rows)
        {
            char *text = json_print(row);
            const char *id = json_text(row, "id");
            if (text && id)
                item_changed(room, text, id);
            free(text);
        }
        cJSON_Delete(rows);
    }
}

static void restore_items(struct room *room, const struct store_room *row)
{
    for (size_t i = 0; i < row->n_items; i++) {
        struct problem problem = { 0 };
        const char *text = row->items[i].body;
        if (!room_restore_item(room, text, strlen(text), &problem))
            log_error("room %s: item %s is left out: %s", room_id(room), row->items[i].id, problem.detail);
    }
}

void keep_room_finish(struct net_room *room)
{
    keep_recordings_finish(room);
    while (room->keep.prompts) {
        struct prompt_write *prompt = room->keep.prompts;
        room->keep.prompts = prompt->next;
        keep_figures_forget(room, prompt);
        if (prompt->row)
            room->net->n_audit_waiting--;
        store_room_free(prompt->row);
        free(prompt);
    }
    for (size_t i = 0; i < room->keep.n_items; i++)
        free(room->keep.items[i].body);
    free(room->keep.items);
    room->keep.items = NULL;
    room->keep.n_items = 0;
    for (size_t i = 0; i < room->keep.n_audit; i++)
        keep_audit_add(room->net, &room->net->audit, &room->net->n_audit, room->keep.audit[i]);
    free(room->keep.audit);
    room->keep.audit = NULL;
    room->keep.n_audit = 0;
}

/* ---- to the store ----------------------------------------------------------------------------------------------- */

/* The row with these parts; NULL: no memory. */
static struct store_room *make_row(const struct net_room *room, unsigned parts)
{
    struct store_room *row = mem_new(sizeof *row);
    if (!room_keep(room->room, parts, row)) {
        free(row);
        return NULL;
    }
    row->used_ms = clock_wall_ms();
    return row;
}

static void write_room(struct net *net, struct net_room *room)
{
    struct store_room *row = make_row(room, room->keep.changed);
    uint64_t ticket = net->n_tickets + 1;
    if (row) {
        row->items = room->keep.items;
        row->n_items = room->keep.n_items;
        row->audit = room->keep.audit;
        row->n_audit = room->keep.n_audit;
        row->recordings = room->keep.recordings;
        row->n_recordings = room->keep.n_recordings;
    }
    if (!row || !store_write(net->store, row, ticket)) { /* tried again */
        if (row) {
            row->items = NULL;
            row->audit = NULL;
            row->recordings = NULL;
            row->n_items = row->n_audit = row->n_recordings = 0;
        }
        store_room_free(row);
        return;
    }
    room->keep.items = NULL;
    room->keep.audit = NULL;
    room->keep.recordings = NULL;
    room->keep.n_items = room->keep.n_audit = room->keep.n_recordings = 0;
    net->n_tickets = ticket;
    room->keep.ticket = ticket;
    room->keep.changed = 0;
    (void)room_scene(room->room, &room->keep.writing);
}

/* True if of all that is to be written only shared views have changed. */
static bool only_views(const struct net_room *room)
{
    return room->keep.changed == ROOM_VIEWS && !room->keep.n_items && !room->keep.n_audit && !room->keep.n_recordings;
}

void keep_write_due(struct net *net, bool is_last)
{
    const int64_t longer_us = (KEEP_VIEWS_PAUSE_MS - KEEP_PAUSE_MS) * INT64_C(1000);
    const int64_t now_us = clock_now_us(), again_us = now_us + KEEP_PAUSE_MS * INT64_C(1000);
    keep_figures_due(net);
    while (net->store && net->n_undeleted && store_delete(net->store, net->undeleted[net->n_undeleted - 1], 0))
        net->n_undeleted--;
    if (net->store && net->n_audit)
        keep_audit_write(net);
    if (net->store) {
        meetings_write_due(net, is_last);
        statements_write_due(net);
    }
    for (size_t i = 0; net->store && i < net->n_rooms; i++) {
        struct net_room *room = net->rooms[i];
        if (!is_changed(room) || (!is_last && room->keep.ticket))
            continue;
        const int64_t due_us = room->keep.due_us + (only_views(room) ? longer_us : 0);
        if (is_last || now_us >= due_us) {
            room->keep.due_us = again_us;
            write_room(net, room);
        }
        if (is_changed(room)) /* too early, or the store takes nothing now */
            schedule_room_at(room, due_us > now_us ? due_us : again_us);
    }
    if (net->store && (net->n_undeleted || net->n_audit))
        schedule_at(net, again_us);
}

void keep_delete(struct net *net, const char *id)
{
    if (net->store && net->n_audit)
        keep_audit_write(net); /* the row that says so is on disk before */
    if (!net->store || store_delete(net->store, id, 0))
        return;
    void *more = realloc(net->undeleted, (net->n_undeleted + 1) * sizeof net->undeleted[0]);
    if (!more) {
        log_error("room %s stays on the disk: no memory", id);
        return;
    }
    net->undeleted = more;
    (void)snprintf(net->undeleted[net->n_undeleted++], sizeof net->undeleted[0], "%s", id);
}

/* ---- from the store --------------------------------------------------------------------------------------------- */

void keep_written(struct net *net, const struct store_answer *answer)
{
    keep_audit_written(net, answer);
    if (answer->ticket &&
        (prompt_written(net, answer) || meetings_written(net, answer) || statements_written(net, answer)))
        return;
    for (size_t i = 0; answer->ticket && i < net->n_rooms; i++) {
        struct net_room *room = net->rooms[i];
        if (room->keep.ticket != answer->ticket)
            continue;
        room->keep.ticket = 0;
        room->keep.is_refused = answer->error.code != ERROR_NONE;
        if (!room->keep.is_refused) {
            room->keep.written = room->keep.writing;
            continue;
        }
        room->keep.changed = ROOM_ALL_PARTS;
        room->keep.due_us = clock_now_us() + KEEP_REFUSED_PAUSE_MS * INT64_C(1000);
        all_items_again(room);
    }
}

void keep_all_again(struct net *net)
{
    for (size_t i = 0; i < net->n_rooms; i++)
        net->rooms[i]->keep.changed = ROOM_ALL_PARTS;
    schedule_at(net, 0);
    for (size_t i = 0; i < net->n_rooms; i++) {
        all_items_again(net->rooms[i]);
        room_recording_restart(net->rooms[i]->room);
    }
}

void keep_restore(struct net_room *room, const struct store_room *row)
{
    keep_recordings_restore(room->room, row);
    restore_items(room->room, row); /* before members */
    room_restore(room->room, row, clock_now_us());
    room->keep.changed = 0; /* it is what was read */
    room->keep.written = row->revision;
}
