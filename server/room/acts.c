/* Does what a call over HTTP asks for, as if a member had sent the message. */
#include <stdio.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "server/room/entry.h"
#include "server/room/items/item_list.h"
#include "server/room/people/links.h"

enum { COLOR_OF_NOBODY = 10 }; /* the light grey of roles.c */

static bool is_about_item(const struct message *message)
{
    return message->type == MESSAGE_ITEM_PUT || message->type == MESSAGE_ITEM_DELETE ||
           message->type == MESSAGE_ITEM_HIDE;
}

/* Whether who is no member may write or delete it. */
static bool is_of_anybody(const struct room *room, const struct message *message)
{
    if (message->type == MESSAGE_MEMBER_REMOVE)
        return true;
    if (!is_about_item(message))
        return false;
    const bool is_put = message->type == MESSAGE_ITEM_PUT;
    const bool is_hidden = message->type == MESSAGE_ITEM_HIDE;
    const struct item *item =
        is_put ? NULL : items_find(room, is_hidden ? message->item_hide.item : message->item_delete.item);
    if (!is_put && !item) /* that there is none is said later */
        return true;
    const enum wire_item_kind kind = is_put ? message->item_put.kind : item->kind;
    return kind == WIRE_ITEM_KIND_NOTE || kind == WIRE_ITEM_KIND_BOOKMARK;
}

/* A caller who is no member of the room: has the name that the call gives, and no id. */
static struct member *make_stranger(const struct room *room, const struct room_act *act)
{
    static const struct identity machine = { .source = IDENTITY_MACHINE };
    const struct identity *who = act->identity ? act->identity : &machine;
    struct member *stranger = mem_new(sizeof *stranger);
    const char *name = who->name[0] ? who->name : who->user[0] ? who->user : act->name;
    stranger->role = room_caller_of(room, who, NULL).role;
    stranger->color = COLOR_OF_NOBODY;
    (void)snprintf(stranger->name, sizeof stranger->name, "%s", name ? name : "");
    (void)snprintf(stranger->user, sizeof stranger->user, "%s", who->user);
    (void)snprintf(stranger->address, sizeof stranger->address, "%s", act->address);
    return stranger;
}

/* Whether this caller may act so; member NULL: nobody of the room. */
static bool check_caller(const struct room *room, const struct member *member, const struct room_act *act,
                         struct problem *problem)
{
    const struct message *message = act->message;
    if (member && (is_about_item(message) || member->connection))
        return true;
    if (member)
        return problem_set(problem, PROBLEM_CONFLICT, "", "away",
                           "%s is not connected, and takes no part in what the room does now", member->id);
    if (!is_of_anybody(room, message))
        return problem_set(problem, PROBLEM_FORBIDDEN, "", "seat",
                           "this is done by a member of the room: send Beamroom-Member");
    const bool has_name = (act->identity && act->identity->user[0]) || (act->name && act->name[0]);
    if (message->type == MESSAGE_ITEM_PUT && !has_name)
        return problem_set(problem, PROBLEM_VALIDATION, "/name", "required",
                           "who writes this? give a name, or send Beamroom-Member");
    return true;
}

void room_act(struct room *room, const struct room_act *act, int64_t now_us)
{
    struct problem problem = { 0 };
    room_enter(room, now_us);
    struct member *member = room_caller(room, act->member), *stranger = NULL;
    bool is_done = check_caller(room, member, act, &problem);
    if (!member)
        member = stranger = make_stranger(room, act);
    room->call = (struct room_call){ .address = act->address, .act = act };
    is_done = is_done && room_apply(room, member, act->message, &problem);
    if (!is_done)
        room_audit_refused(room, member, message_descriptions[act->message->type].name, &problem);
    const struct room_call call = room->call;
    room->call = (struct room_call){ 0 };
    const struct item *item = call.item[0] ? items_find(room, call.item) : NULL;
    if (!call.waits)
        act->done(act->context, item ? item->row : NULL, call.was_sent_before, is_done ? NULL : &problem);
    room_leave(room);
    free(stranger);
}
