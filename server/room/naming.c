/* Whom the plan is of, in a room: which walls name the patient, and which members have read it. The names themselves
 * are never here. */
#include <string.h>

#include "server/room/entry.h"
#include "server/room/out/audit.h"
#include "server/room/out/send.h"
#include "server/room/state/who.h"

static struct member *find_wall(const struct room *room, const char *id)
{
    for (int i = 0; i < room->members.n; i++) {
        struct member *member = room->members.list[i];
        if (member->role == WIRE_MEMBER_ROLE_WALL && member->connection && strcmp(member->id, id) == 0)
            return member;
    }
    return NULL;
}

bool room_wall_name(struct room *room, const char *wall, bool is_named, const struct identity *who, const char *caller,
                    const char *address, int64_t now_us, struct problem *problem)
{
    struct member *member = find_wall(room, wall);
    if (!member)
        return problem_set(problem, PROBLEM_NOT_FOUND, "", "", "there is no wall \"%.40s\" in this room", wall);
    const struct audit_act act = { .by = room_caller(room, caller),
                                   .action = "identity-on-wall",
                                   .address = address,
                                   .who = who,
                                   .detail = cJSON_CreateObject(),
                                   .before = -1,
                                   .after = room->shared.revision };
    cJSON_AddStringToObject(act.detail, "wall", member->name);
    cJSON_AddBoolToObject(act.detail, "is_shown", is_named);
    room_enter(room, now_us);
    member->is_naming = is_named;
    audit_tell(room, &act);
    send_members(room);
    room_leave(room);
    return true;
}

bool room_wall_is_naming(const struct room *room, const char *caller)
{
    const struct member *member = room_caller(room, caller);
    return member && member->is_naming && member->connection;
}

void room_identity_read(struct room *room, const char *caller, int64_t now_us)
{
    struct member *member = room_caller(room, caller);
    if (member)
        member->read_identity_us = now_us;
}
