/* Asks the room's owner for identities, and compares them. */
#include "server/room/state/who.h"

#include <stdio.h>
#include <string.h>

#include "server/room/state/roles.h"

static const struct identity machine = { .source = IDENTITY_MACHINE, .scopes = IDENTITY_SCOPE_ALL }, nobody;

const struct identity *who_connects(const struct room *room, void *connection)
{
    if (!room->callbacks.identity)
        return &machine;
    return connection ? room->callbacks.identity(room->callbacks.context, connection) : &nobody;
}

const struct identity *who_acts(const struct room *room, const struct member *member)
{
    const struct room_act *act = room->call.act;
    if (act)
        return act->identity ? act->identity : &machine;
    return who_connects(room, member->connection);
}

void who_key_of_user(const char *user, char key[WHO_KEY])
{
    (void)snprintf(key, WHO_KEY, "%s%s", user[0] ? "user:" : "", user);
}

void who_key(const struct identity *who, const char *person, char key[WHO_KEY])
{
    if (who_is_user(who))
        who_key_of_user(who->user, key);
    else
        (void)snprintf(key, WHO_KEY, "%s%s", who_is_machine(who) || !person[0] ? "" : "guest:", person);
}

enum wire_member_role who_holds(const struct identity *who, enum wire_member_role role)
{
    const bool only_reads = who->source == IDENTITY_TOKEN && !(who->scopes & IDENTITY_SCOPE_PLAN);
    return only_reads ? role_lower(role, WIRE_MEMBER_ROLE_OBSERVER) : role;
}

bool who_has_seat(const struct identity *who, const char *user, bool is_guest, enum wire_member_role role)
{
    if (who_is_machine(who))
        return true;
    return who_is_user(who) ? strcmp(who->user, user) == 0 : is_guest || (!user[0] && role == WIRE_MEMBER_ROLE_WALL);
}

bool who_is_same_user(const char *user, const char *other)
{
    return user[0] && strcmp(user, other) == 0;
}
