/* Checks changes of items, writes their rows, and tells members and the room's owner. */
#include "server/room/items/items.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "server/auth/digest.h"
#include "server/room/items/acceptance.h"
#include "server/room/items/bookmark_body.h"
#include "server/room/items/item_list.h"
#include "server/room/items/item_row.h"
#include "server/room/items/record_body.h"
#include "server/room/items/room_items.h"
#include "server/room/out/audit.h"

#include "server/room/out/send.h"
#include "server/room/state/event.h"
#include "server/room/state/roles.h"
#include "server/room/state/who.h"
#include "server/wire/random.h"

/* ---- rows ------------------------------------------------------------------------------------------------------- */

enum { ID_BYTES = 5 };

/* 40 random bits: an id is not used again, so that what a page says late about a deleted item reaches no other one. */
static void make_id(const struct room *room, char id[16])
{
    do {
        char digits[2 * ID_BYTES + 1];
        random_hex(digits, ID_BYTES);
        (void)snprintf(id, 16, "i-%s", digits);
    } while (items_find(room, id));
}

/* Makes an id that depends on room, caller and key alone: a call that is sent again finds what it has made, also after
 * a restart. */
static void make_id_of_key(const struct room *room, const struct member *member, const char *key, char id[16])
{
    char text[600], hex[DIGEST_TEXT];
    (void)snprintf(text, sizeof text, "%s\n%s\n%s\n%s", room->id, member->id, member->id[0] ? "" : member->name, key);
    digest_text(text, hex);
    (void)snprintf(id, 16, "i-%.*s", 2 * ID_BYTES, hex);
}

static void copy_name(char to[161], const char *from)
{
    (void)snprintf(to, 161, "%s", from);
}

/* ---- changes ---------------------------------------------------------------------------------------------------- */

/* Tells all members; row NULL: the item is deleted. by: a member's id; input: the number of it that this member gave.
 */
static void tell_members(struct room *room, const char *id, const char *row, const char *by, uint32_t input)
{
    struct message message = { .type = MESSAGE_ITEM, .item = { .item = row ? cJSON_CreateRaw(row) : NULL } };
    (void)snprintf(message.item.id, sizeof message.item.id, "%s", id);
    (void)snprintf(message.item.by, sizeof message.item.by, "%s", by);
    room_event(room, ROOM_ITEMS, id);
    send_to_listeners(room, &message);
    for (int i = 0; i < room->members.n; i++) {
        const bool is_own = strcmp(room->members.list[i]->id, by) == 0;
        message.item.input = is_own ? input : 0; /* the input number is only for its sender */
        send_to_member(room, room->members.list[i], &message);
    }
    message_finish(&message);
}

/* Tells the room's owner and all members. */
static void tell(struct room *room, const char *id, const char *row, const struct member *by, uint32_t input)
{
    if (room->callbacks.item_changed)
        room->callbacks.item_changed(room->callbacks.context, room, row, id);
    tell_members(room, id, row, by->id, input);
}

/* Whether the member may change or delete what this author has written. With sign-in a note is its writer's alone. */
static bool author_may(const struct room *room, const struct member *member, const struct item *item,
                       struct problem *problem)
{
    const bool is_machine = who_is_machine(who_acts(room, member));
    const bool is_own = item->author_user[0] ? who_is_same_user(item->author_user, member->user)
                                             : member->id[0] && strcmp(item->author, member->id) ==
                                                                    0; /* without a seat: not known again */
    const bool is_free = item->kind == WIRE_ITEM_KIND_CHECK || item->kind == WIRE_ITEM_KIND_ACCEPTANCE;
    if (is_free || is_own)
        return true;
    if (!is_machine && item->kind == WIRE_ITEM_KIND_NOTE)
        return problem_set(problem, PROBLEM_FORBIDDEN, "/item", "", "this note is by %.40s, who alone changes it",
                           item->author_name);
    return role_rank(member->role) >= role_rank(WIRE_MEMBER_ROLE_PRESENTER) ||
           problem_set(problem, PROBLEM_FORBIDDEN, "/item", "",
                       "this %s is by %.40s: only its author or a member of role presenter changes or deletes it",
                       item_word(item->kind), item->author_name);
}

/* Another change of the item is under way; then with problem. */
static bool is_being_kept(const struct room *room, const struct item *item, struct problem *problem)
{
    for (const struct keeping *keeping = room->items->keeping; keeping; keeping = keeping->next)
        if (strcmp(keeping->item.id, item->id) == 0) {
            problem_set(problem, PROBLEM_CONFLICT, "/item", "",
                        "another change of this %s by %.40s is just being kept: try again", item_word(item->kind),
                        keeping->item.changed_name);
            return true;
        }
    return false;
}

/* The item that a member may change or delete, which knows it in this version (0: whatever it is). NULL with problem.
 */
static struct item *find_to_change(const struct room *room, const struct member *member, const char *id,
                                   int64_t version, struct problem *problem)
{
    struct item *item = items_find(room, id);
    if (!item) {
        problem_set(problem, PROBLEM_NOT_FOUND, "/item", "", "there is no item \"%.63s\", or not any more", id);
        return NULL;
    }
    if (!record_may_change(room, member, item, problem) || !acceptance_may(room, member, item->kind, problem))
        return NULL;
    if (!author_may(room, member, item, problem) || is_being_kept(room, item, problem))
        return NULL;
    if (version && version != item->version) {
        problem_set(problem, PROBLEM_CONFLICT, "/version", "",
                    "this %s was changed by %.40s meanwhile: it is at version %u, the change was made for %lld",
                    item_word(item->kind), item->changed_name, item->version, (long long)version);
        return NULL;
    }
    return item;
}

/* The item in the list becomes next with this row (taken); before NULL: it is new. */
static struct item *take(struct room *room, struct item *before, const struct item *next, char *row)
{
    struct item *item = before ? before : mem_new(sizeof *item);
    char *old_row = before ? before->row : NULL;
    *item = *next;
    item->next = before ? next->next : NULL;
    item->row = old_row;
    items_keep(room, item, row);
    return item;
}

static bool write_first(struct room *room, const struct keeping *keeping, const struct member *member,
                        struct problem *problem)
{
    const struct item *item = &keeping->item;
    struct audit_apart apart = { 0 };
    char *record = record_of(room, item, problem);
    const bool has_record = record || !record_is_wanted(item->kind);
    audit_set_apart(room, &apart);
    record_audit(room, item, member, record);
    acceptance_audit(room, item, member, false);
    audit_set_apart(room, NULL);
    const struct room_item_write write = { .id = item->id,
                                           .kind = item_word(item->kind),
                                           .row = item->row,
                                           .author = item->author,
                                           .author_name = item->author_name,
                                           .time_ms = item->changed_ms,
                                           .record = record,
                                           .audit = &apart.row };
    const bool is_begun =
        has_record && room->callbacks.item_first(room->callbacks.context, room, keeping->number, &write, problem);
    audit_apart_finish(&apart);
    free(record);
    return is_begun;
}

/* Has the item written, and only then lets it count. next->row is taken. */
static bool keep_first(struct room *room, const struct item *next, bool is_change, const struct member *member,
                       uint32_t input, struct problem *problem)
{
    struct keeping *keeping = mem_new(sizeof *keeping), **last = &room->items->keeping;
    *keeping =
        (struct keeping){ .number = ++room->items->n_kept, .item = *next, .is_change = is_change, .input = input };
    (void)snprintf(keeping->member, sizeof keeping->member, "%s", member->id);
    if (room->call.act) {
        keeping->done = room->call.act->done;
        keeping->context = room->call.act->context;
    }
    if (!write_first(room, keeping, member, problem)) {
        free(keeping->item.row);
        free(keeping);
        return false;
    }
    while (*last)
        last = &(*last)->next;
    *last = keeping;
    room->call.waits = keeping->done != NULL;
    return true;
}

void items_forget_keeping(struct room *room)
{
    struct problem problem;
    problem_set(&problem, PROBLEM_BUSY, "", "",
                "the room was closed while this was being kept: look whether it is there");
    problem.retry_after_ms = 1000;
    while (room->items->keeping) {
        struct keeping *keeping = room->items->keeping;
        room->items->keeping = keeping->next;
        if (keeping->done)
            keeping->done(keeping->context, NULL, false, &problem);
        free(keeping->item.row);
        free(keeping);
    }
}

size_t room_n_items_written(const struct room *room)
{
    size_t n = 0;
    for (const struct keeping *keeping = room->items->keeping; keeping; keeping = keeping->next)
        n++;
    return n;
}

void items_written(struct room *room, uint64_t number, const struct problem *problem)
{
    struct keeping **at = &room->items->keeping, *keeping;
    while (*at && (*at)->number != number)
        at = &(*at)->next;
    if (!(keeping = *at))
        return;
    *at = keeping->next;
    if (problem) {
        for (int i = 0; i < room->members.n; i++)
            if (!keeping->done && strcmp(room->members.list[i]->id, keeping->member) == 0 &&
                room->members.list[i]->connection)
                (void)send_problem(room, room->members.list[i]->connection, "item.put", 0, keeping->input, problem);
        if (keeping->done)
            keeping->done(keeping->context, NULL, false, problem);
        free(keeping->item.row);
    } else {
        struct item *before = keeping->is_change ? items_find(room, keeping->item.id) : NULL;
        const struct item *item = take(room, before, &keeping->item, keeping->item.row);
        tell_members(room, item->id, item->row, keeping->member, keeping->input);
        if (keeping->done)
            keeping->done(keeping->context, item->row, false, NULL);
        if (item->kind == WIRE_ITEM_KIND_ACCEPTANCE)
            acceptances_settle(room);
    }
    free(keeping);
}

/* Whether the body is the one that the item was made with, as far as that can be told. */
static bool was_made_with(struct room *room, const struct item *made, const struct member *member, const cJSON *body)
{
    struct problem ignored = { 0 };
    if (made->version > 1) /* it was changed since */
        return true;
    if (made->kind == WIRE_ITEM_KIND_BOOKMARK) { /* what it shows may be of that moment */
        cJSON *kept = bookmark_body_of(made);
        const char *was = json_text(kept, "name"), *is = json_text(body, "name");
        const bool is_same = was && is && strcmp(was, is) == 0;
        cJSON_Delete(kept);
        return is_same;
    }
    room->items->writer = member;
    char *text = item_body_text(room, made->kind, body, made, false, &ignored);
    room->items->writer = NULL;
    char *row = text ? item_row_text(made, text) : NULL;
    const bool is_same = row && strcmp(row, made->row) == 0;
    free(row);
    free(text);
    return is_same;
}

/* Gives a new item its id, and is true; or it was made when the same call was sent before (room->call.was_sent_before),
 * or is just being kept: then false, with problem if that is not the answer. */
static bool give_id(struct room *room, const struct member *member, const struct message_item_put *put, char id[16],
                    struct problem *problem)
{
    if (!room->call.act || !room->call.act->key) {
        make_id(room, id);
        return true;
    }
    make_id_of_key(room, member, room->call.act->key, id);
    for (const struct keeping *keeping = room->items->keeping; keeping; keeping = keeping->next)
        if (strcmp(keeping->item.id, id) == 0) {
            problem_set(problem, PROBLEM_BUSY, "", "", "this call was sent before, and is just being kept: try again");
            problem->retry_after_ms = 200;
            return false;
        }
    const struct item *made = items_find(room, id);
    if (!made)
        return true;
    if (made->kind != put->kind || strcmp(made->author, member->id) != 0 ||
        !was_made_with(room, made, member, put->body))
        return problem_set(problem, PROBLEM_CONFLICT, "", "key",
                           "another call had this Idempotency-Key: it has written %s, which is something else", id);
    (void)snprintf(room->call.item, sizeof room->call.item, "%s", id);
    room->call.was_sent_before = true;
    return false;
}

/* The item becomes next with this row, which is taken; row NULL: with problem. before NULL: it is new. */
static bool write_item(struct room *room, struct item *before, struct item *next, char *row,
                       const struct member *member, uint32_t input, struct problem *problem)
{
    if (!row || !items_have_place(room, before, strlen(row), problem)) {
        free(row);
        return false;
    }
    if (room->callbacks.item_first) {
        next->row = row;
        return keep_first(room, next, before != NULL, member, input, problem);
    }
    struct item *item = take(room, before, next, row);
    record_audit(room, item, member, NULL);
    acceptance_audit(room, item, member, false);
    tell(room, item->id, item->row, member, input);
    (void)snprintf(room->call.item, sizeof room->call.item, "%s", item->id);
    if (item->kind == WIRE_ITEM_KIND_ACCEPTANCE)
        acceptances_settle(room);
    return true;
}

bool items_put(struct room *room, struct member *member, const struct message *message, struct problem *problem)
{
    const struct message_item_put *put = &message->item_put;
    struct item *before = NULL, next = { .kind = put->kind };
    if (!record_may_write(room, member, put->kind, problem))
        return false;
    if (put->item[0]) {
        if (put->version == 0)
            return problem_set(problem, PROBLEM_VALIDATION, "/version", "required",
                               "a change needs the version that it was made for");
        before = find_to_change(room, member, put->item, put->version, problem);
        if (!before)
            return false;
        if (before->kind != put->kind)
            return problem_set(problem, PROBLEM_VALIDATION, "/kind", "enum", "this item is a %s and stays one",
                               item_word(before->kind));
        if (!acceptance_may_write(room, member, put->kind, before, problem))
            return false;
        next = *before;
    } else {
        if (!acceptance_may_write(room, member, put->kind, NULL, problem))
            return false;
        if (!give_id(room, member, put, next.id, problem))
            return room->call.was_sent_before;
        (void)snprintf(next.author, sizeof next.author, "%s", member->id);
        copy_name(next.author_name, member->name);
        (void)snprintf(next.author_user, sizeof next.author_user, "%s", member->user);
        next.is_guest = member->is_guest;
        (void)snprintf(next.author_color, sizeof next.author_color, "#%06x", color_rgb(member->color) & 0xffffffU);
        next.created_ms = clock_wall_ms(); /* only to be displayed */
        const char *parent = json_text(put->body, "parent");
        (void)snprintf(next.parent, sizeof next.parent, "%s", put->kind == WIRE_ITEM_KIND_NOTE && parent ? parent : "");
    }
    next.version++;
    next.changed_ms = before ? clock_wall_ms() : next.created_ms;
    copy_name(next.changed_name, member->name);
    room->items->writer = member;
    char *body = item_body_text(room, put->kind, put->body, before, false, problem);
    room->items->writer = NULL;
    char *row = body ? item_row_text(&next, body) : NULL;
    if (body && !row)
        json_no_memory(problem, "an item");
    free(body);
    return write_item(room, before, &next, row, member, (uint32_t)put->input, problem);
}

bool items_hide(struct room *room, struct member *member, const struct message *message, struct problem *problem)
{
    const struct message_item_hide *asked = &message->item_hide;
    const enum wire_member_role least =
        who_is_machine(who_acts(room, member)) ? WIRE_MEMBER_ROLE_PRESENTER : WIRE_MEMBER_ROLE_PLANNER;
    struct item *item = items_find(room, asked->item);
    if (!item || item->kind != WIRE_ITEM_KIND_NOTE)
        return problem_set(problem, PROBLEM_NOT_FOUND, "/item", "", "there is no note \"%.63s\", or not any more",
                           asked->item);
    if (role_rank(member->role) < role_rank(least))
        return problem_set(problem, PROBLEM_FORBIDDEN, "/item", "role", "a note is hidden by a member of role %s",
                           wire_member_role_words.words[least]);
    if (is_being_kept(room, item, problem))
        return false;
    struct item next = *item;
    next.version++;
    copy_name(next.hidden_by, asked->hidden ? member->name : "");
    cJSON *before = json_read(item->row, strlen(item->row), problem);
    char *body = before ? json_print(cJSON_GetObjectItemCaseSensitive(before, "body")) : NULL;
    char *row = body ? item_row_text(&next, body) : NULL;
    if (!row)
        json_no_memory(problem, "an item");
    cJSON_Delete(before);
    free(body);
    return write_item(room, item, &next, row, member, (uint32_t)asked->input, problem);
}

bool items_delete(struct room *room, struct member *member, const struct message *message, struct problem *problem)
{
    const struct message_item_delete *asked = &message->item_delete;
    struct item *item = find_to_change(room, member, asked->item, asked->version, problem);
    if (!item || (room->callbacks.can_write && !room->callbacks.can_write(room->callbacks.context, problem)))
        return false;
    for (struct item *reply = room->items->first, *after; reply; reply = after) {
        after = reply->next;
        if (strcmp(reply->parent, item->id) != 0)
            continue;
        char id[sizeof reply->id];
        memcpy(id, reply->id, sizeof id);
        record_audit_deleted(room, reply, member);
        items_drop(room, reply);
        tell(room, id, NULL, member, 0);
    }
    const bool was_accepted = item->kind == WIRE_ITEM_KIND_ACCEPTANCE;
    if (was_accepted)
        acceptance_audit(room, item, member, true);
    else
        record_audit_deleted(room, item, member);
    items_drop(room, item);
    tell(room, asked->item, NULL, member, (uint32_t)asked->input);
    if (was_accepted)
        acceptances_settle(room);
    return true;
}
