#pragma once
/* The members of a room: finding one, who presents and who follows, and the list of members as JSON (room_members).
 * Internal to server/room. */
#include "server/room/state/room_state.h"

/* The member that uses this connection; NULL: it has not said hello. */
struct member *member_of_connection(const struct room *room, const void *connection);
/* Like member_of_connection, quicker where members speak in about the same order each time, as with acknowledgements.
 */
struct member *member_who_speaks(struct room *room, const void *connection);
bool member_presents(const struct room *room, const struct member *member);
/* True if one of its views shows a shared view, and the member does not present. */
bool member_follows(const struct room *room, const struct member *member);
/* Adds to the row of a member what tells it from others of its name: user and is_guest, where there are any. */
void member_say_who(const struct member *member, cJSON *row);
/* Fills problem: only the presenter may do `what` ("change the scene"). Returns false. */
bool refuse_not_presenter(const struct room *room, struct problem *problem, const char *what);
