/* From rooms to rows and back. */
#include "server/net/keep.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/net/keep_recordings.h"
#include "server/net/schedule.h"
#include "server/wire/json.h"

/* The room's entry; NULL: rooms are not kept. */
static struct net_room *find_kept(const struct net *net, const struct room *room)
{
    for (size_t i = 0; net->store && i < net->n_rooms; i++)
        if (net->rooms[i]->room == room)
            return net->rooms[i];
    return NULL;
}

void keep_changed(void *context, struct room *room, unsigned parts)
{
    struct net_room *entry = find_kept(context, room);
    if (!entry)
        return;
    entry->keep.changed |= parts;
    schedule_at(entry->net, 0);
}

static bool is_changed(const struct net_room *room)
{
    return room->keep.changed || room->keep.n_recordings || room->keep.n_items || room->keep.n_audit;
}

bool keep_is_written(const struct net_room *room)
{
    return !is_changed(room) && room->keep.ticket == 0;
}

/* ---- the audit -------------------------------------------------------------------------------------------------- */

/* Adds a row (taken) that waits already. */
static void add_row(struct net *net, char ***rows, size_t *n, char *row)
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

/* The row as JSON, without its number. */
static cJSON *describe(const char *room, const char *plan, const struct room_audit *row)
{
    cJSON *json = cJSON_CreateObject();
    cJSON_AddNumberToObject(json, "time_ms", (double)row->time_ms);
    cJSON_AddStringToObject(json, "room", room);
    cJSON_AddStringToObject(json, "plan", plan);
    cJSON_AddStringToObject(json, "member", row->member);
    cJSON_AddStringToObject(json, "name", row->name);
    cJSON_AddStringToObject(json, "role", row->role);
    cJSON_AddStringToObject(json, "address", row->address);
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
    add_row(net, rows, n, text);
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
        keep_row(net, rows, n, describe("", "", &lost));
    }
    keep_row(net, rows, n, json);
}

void keep_audited(void *context, struct room *room, const struct room_audit *row)
{
    struct net_room *entry = find_kept(context, room);
    if (entry)
        keep_row_and_loss(context, &entry->keep.audit, &entry->keep.n_audit,
                          describe(room_id(room), room_plan_id(room), row));
}

bool keep_audit_has_place(void *context)
{
    return net_audit_has_place(context);
}

bool net_audit_has_place(const struct net *net)
{
    return !net->store || net->n_audit_waiting < NET_MAX_AUDIT;
}

void net_audit(struct net *net, const char *address, const char *room, const char *plan, const char *action,
               cJSON *detail)
{
    char *text = json_print(detail);
    const struct room_audit row = { .time_ms = clock_wall_ms(),
                                    .action = action,
                                    .member = "",
                                    .name = "",
                                    .role = "",
                                    .address = address,
                                    .detail = text ? text : "{}",
                                    .result = "done",
                                    .before = -1,
                                    .after = -1 };
    if (net->store)
        keep_row_and_loss(net, &net->audit, &net->n_audit, describe(room, plan, &row));
    cJSON_Delete(detail);
    free(text);
}

struct net_audit_head net_audit_head(const struct net *net)
{
    struct net_audit_head head = net->audit_head;
    head.n_waiting = net->n_audit_waiting;
    return head;
}

/* Hands over the rows of no room. */
static void write_audit(struct net *net)
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

void keep_is_saved(void *context, const struct room *room, struct room_saved *saved)
{
    const struct net *net = context;
    const struct net_room *entry = find_kept(net, room);
    if (!entry || room_replays(room))
        return;
    const bool fails = net->store_fails || entry->keep.is_refused;
    *saved = (struct room_saved){ .revision = entry->keep.written, .is_full = net->store_is_full };
    saved->state = fails                    ? WIRE_SAVED_STATE_FAILING
                   : keep_is_written(entry) ? WIRE_SAVED_STATE_SAVED
                                            : WIRE_SAVED_STATE_SAVING;
}

/* ---- items ------------------------------------------------------------------------------------------------------ */

static void copy_text(char *to, size_t size, const char *from)
{
    (void)snprintf(to, size, "%s", from ? from : "");
}

/* What is searched for in the database stands in columns beside the whole row. */
static void read_columns(const char *row, struct store_item *item)
{
    cJSON *json = json_read(row, strlen(row), NULL);
    copy_text(item->kind, sizeof item->kind, json_text(json, "kind"));
    copy_text(item->author, sizeof item->author, json_text(json, "author"));
    copy_text(item->author_name, sizeof item->author_name, json_text(json, "author_name"));
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
    copy_text(item->id, sizeof item->id, id);
    if (row) {
        item->body = mem_copy_text(row);
        read_columns(row, item);
    }
}

void keep_item_changed(void *context, struct room *room, const char *row, const char *id)
{
    struct net_room *entry = find_kept(context, room);
    if (entry)
        item_changed(entry, row, id);
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
    for (size_t i = 0; i < room->keep.n_items; i++)
        free(room->keep.items[i].body);
    free(room->keep.items);
    room->keep.items = NULL;
    room->keep.n_items = 0;
    for (size_t i = 0; i < room->keep.n_audit; i++)
        add_row(room->net, &room->net->audit, &room->net->n_audit, room->keep.audit[i]);
    free(room->keep.audit);
    room->keep.audit = NULL;
    room->keep.n_audit = 0;
}

/* ---- to the store ----------------------------------------------------------------------------------------------- */

static void write_member(const struct room_kept_member *from, struct store_member *to)
{
    memcpy(to->id, from->id, sizeof to->id);
    memcpy(to->name, from->name, sizeof to->name);
    memcpy(to->color, from->color, sizeof to->color);
    memcpy(to->role, from->role, sizeof to->role);
    memcpy(to->secret_hash, from->secret_hash, sizeof to->secret_hash);
    to->has_left = from->has_left;
}

static void write_link(const struct room_kept_link *from, struct store_link *to)
{
    memcpy(to->token_hash, from->token_hash, sizeof to->token_hash);
    memcpy(to->role, from->role, sizeof to->role);
    memcpy(to->person, from->person, sizeof to->person);
    to->expires_ms = from->expires_ms;
    to->is_one_use = from->is_one_use;
    to->is_used = from->is_used;
}

/* Members and links, as far as they were asked for. False: no memory. */
static bool make_lists(const struct room_kept *kept, struct store_room *row)
{
    if (kept->members && !(row->members = mem_array(kept->n_members, sizeof row->members[0], 1 << 20, NULL)))
        return false;
    if (kept->links && !(row->links = mem_array(kept->n_links, sizeof row->links[0], 1 << 20, NULL)))
        return false;
    row->n_members = kept->n_members;
    row->n_links = kept->n_links;
    for (size_t i = 0; i < row->n_members; i++)
        write_member(&kept->members[i], &row->members[i]);
    for (size_t i = 0; i < row->n_links; i++)
        write_link(&kept->links[i], &row->links[i]);
    return true;
}

/* The row with these parts; NULL: no memory. */
static struct store_room *make_row(const struct net_room *room, unsigned parts)
{
    struct room_kept kept;
    if (!room_keep(room->room, parts, &kept))
        return NULL;
    struct store_room *row = mem_new(sizeof *row);
    (void)snprintf(row->id, sizeof row->id, "%s", room_id(room->room));
    (void)snprintf(row->plan, sizeof row->plan, "%s", room_plan_id(room->room));
    memcpy(row->presenter, kept.presenter, sizeof row->presenter);
    row->created_ms = kept.created_at_s * 1000;
    row->used_ms = clock_wall_ms();
    row->revision = kept.revision;
    row->n_named = kept.n_named;
    row->has_links = kept.has_links;
    row->scene = kept.scene;
    row->views = kept.views;
    row->presence = kept.presence;
    kept.scene = kept.views = kept.presence = NULL;
    if (!make_lists(&kept, row)) {
        store_room_free(row);
        row = NULL;
    }
    room_kept_finish(&kept);
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

/* Of what is to be written, only shared views have changed. */
static bool only_views(const struct net_room *room)
{
    return room->keep.changed == ROOM_VIEWS && !room->keep.n_items && !room->keep.n_audit && !room->keep.n_recordings;
}

void keep_write_due(struct net *net, bool is_last)
{
    const int64_t longer_us = (KEEP_VIEWS_PAUSE_MS - KEEP_PAUSE_MS) * INT64_C(1000);
    const int64_t now_us = clock_now_us(), again_us = now_us + KEEP_PAUSE_MS * INT64_C(1000);
    while (net->store && net->n_undeleted && store_delete(net->store, net->undeleted[net->n_undeleted - 1], 0))
        net->n_undeleted--;
    if (net->store && net->n_audit)
        write_audit(net);
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

void keep_audit_written(struct net *net, const struct store_answer *answer)
{
    net->n_audit_waiting -= answer->n_audit;
    if (answer->error.code != ERROR_NONE && !answer->audit_n)
        return;
    net->audit_head.n = answer->audit_n;
    memcpy(net->audit_head.hash, answer->audit_hash, sizeof net->audit_head.hash);
}

void keep_written(struct net *net, const struct store_answer *answer)
{
    keep_audit_written(net, answer);
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

static void read_member(const struct store_member *from, struct room_kept_member *to)
{
    memcpy(to->id, from->id, sizeof to->id);
    memcpy(to->name, from->name, sizeof to->name);
    memcpy(to->color, from->color, sizeof to->color);
    memcpy(to->role, from->role, sizeof to->role);
    memcpy(to->secret_hash, from->secret_hash, sizeof to->secret_hash);
    to->has_left = from->has_left;
}

static void read_link(const struct store_link *from, struct room_kept_link *to)
{
    memcpy(to->token_hash, from->token_hash, sizeof to->token_hash);
    memcpy(to->role, from->role, sizeof to->role);
    memcpy(to->person, from->person, sizeof to->person);
    to->expires_ms = from->expires_ms;
    to->is_one_use = from->is_one_use;
    to->is_used = from->is_used;
}

void keep_restore(struct net_room *room, const struct store_room *row)
{
    struct room_kept kept = { .created_at_s = row->created_ms / 1000,
                              .revision = row->revision,
                              .n_named = row->n_named,
                              .has_links = row->has_links,
                              .scene = row->scene,
                              .views = row->views,
                              .presence = row->presence };
    memcpy(kept.presenter, row->presenter, sizeof kept.presenter);
    kept.members = mem_array(row->n_members, sizeof kept.members[0], 1 << 20, NULL);
    kept.n_members = kept.members ? row->n_members : 0;
    for (size_t i = 0; i < kept.n_members; i++)
        read_member(&row->members[i], &kept.members[i]);
    kept.links = mem_array(row->n_links, sizeof kept.links[0], 1 << 20, NULL);
    kept.n_links = kept.links ? row->n_links : 0;
    for (size_t i = 0; i < kept.n_links; i++)
        read_link(&row->links[i], &kept.links[i]);
    keep_recordings_restore(room->room, row);
    restore_items(room->room, row); /* before members */
    room_restore(room->room, &kept, clock_now_us());
    free(kept.members);
    free(kept.links);
    room->keep.changed = 0; /* it is what was read */
    room->keep.written = row->revision;
}
