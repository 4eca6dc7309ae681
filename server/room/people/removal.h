#pragma once
/* Members that are removed from the room by others. Internal to server/room. */
#include "server/room/state/room_state.h"

/* Handler of member.remove; false with a problem when it applied nothing. */
bool member_remove(struct room *room, struct member *by, const struct message *message, struct problem *problem);
/* Removes all who came in by this link, which was ended. by NULL: nobody of the room. */
void members_remove_of_link(struct room *room, const char *digits, const struct member *by);
