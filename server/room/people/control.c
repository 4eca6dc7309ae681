/* Tells who has control. */
#include "server/room/people/control.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/room/out/audit.h"
#include "server/room/out/send.h"
#include "server/wire/message.h"

void control_init(struct room *room)
{
    room->control = mem_new(sizeof *room->control);
}

void control_free(struct room *room)
{
    free(room->control);
}

/* The ids of those who request control, the oldest request first. */
static cJSON *requests_list(const struct room *room)
{
    cJSON *list = cJSON_CreateArray();
    for (uint64_t after = 0;;) {
        const struct member *next = NULL;
        for (int i = 0; i < room->members.n; i++) {
            const struct member *member = room->members.list[i];
            if (member->request > after && (!next || member->request < next->request))
                next = member;
        }
        if (!next)
            return list;
        json_append(list, cJSON_CreateString(next->id));
        after = next->request;
    }
}

static void fill(const struct room *room, struct message *message)
{
    *message = (struct message){ .type = MESSAGE_CONTROL };
    message->control.locked = room->control->is_locked;
    message->control.requests = requests_list(room);
    (void)snprintf(message->control.presenter, sizeof message->control.presenter, "%s",
                   room->presenter ? room->presenter->id : "");
}

cJSON *control_document(const struct room *room)
{
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "presenter", room->presenter ? room->presenter->id : "");
    cJSON_AddBoolToObject(json, "locked", room->control->is_locked);
    json_add(json, "requests", requests_list(room));
    return json;
}

void control_send(struct room *room, struct member *member)
{
    struct message message;
    fill(room, &message);
    send_to_member(room, member, &message);
    message_finish(&message);
}

static const struct member *find(const struct room *room, const char *id)
{
    for (int i = 0; i < room->members.n; i++)
        if (strcmp(room->members.list[i]->id, id) == 0)
            return room->members.list[i];
    return NULL;
}

static void audit_control(struct room *room)
{
    const char *act = wire_control_act_words.words[room->control->act];
    const struct audit_act row = { .by = find(room, room->control->by),
                                   .action = "control",
                                   .detail = cJSON_CreateObject(),
                                   .before = -1,
                                   .after = -1 };
    cJSON_AddStringToObject(row.detail, "act", act);
    cJSON_AddStringToObject(row.detail, "member", room->control->member);
    audit_tell(room, &row);
}

int64_t control_settle(struct room *room)
{
    struct message message;
    if (!room->control->is_new)
        return INT64_MAX;
    fill(room, &message);
    message.control.act = room->control->act;
    (void)snprintf(message.control.member, sizeof message.control.member, "%s", room->control->member);
    (void)snprintf(message.control.by, sizeof message.control.by, "%s", room->control->by);
    room->control->is_new = false;
    if (room->control->act != WIRE_CONTROL_ACT_NONE)
        audit_control(room);
    send_to_all(room, &message);
    message_finish(&message);
    return INT64_MAX;
}

void control_note(struct room *room, enum wire_control_act act, const struct member *member, const struct member *by)
{
    room->control->is_new = true;
    room->control->act = act;
    (void)snprintf(room->control->member, sizeof room->control->member, "%s", member ? member->id : "");
    (void)snprintf(room->control->by, sizeof room->control->by, "%s", by ? by->id : "");
}

void control_pass(struct room *room, struct member *member)
{
    if (room->presenter == member)
        return;
    room->presenter = member;
    room->control->is_locked = false;
    for (int i = 0; i < room->members.n; i++)
        if (!member || room->members.list[i] == member)
            room->members.list[i]->request = 0;
    control_note(room, member ? WIRE_CONTROL_ACT_TAKEN : WIRE_CONTROL_ACT_LEFT, member, member);
}

void control_left(struct room *room, struct member *member)
{
    if (member->request)
        control_note(room, WIRE_CONTROL_ACT_WITHDRAWN, member, member);
    member->request = 0;
}
