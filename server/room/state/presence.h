#pragma once
/* Stays of members: names and times of those who were in the room. Internal to server/room. */
#include "server/room/state/room_state.h"

void presence_init(struct room *room); /* with the room */
void presence_free(struct room *room);

void presence_entered(struct room *room, const struct member *member);
void presence_left(struct room *room, const struct member *member);
/* Stays that are counted only: they were more than ROOM_MAX_PRESENCE. */
unsigned presence_n_dropped(const struct room *room);
/* [{member, name, role, entered_ms, left_ms, here}], the first first; left_ms null: still here, or the server ended. */
NODISCARD cJSON *presence_list(const struct room *room);
/* The text that is kept, for free(); NULL: no memory. Reading takes the rows that are whole. */
NODISCARD char *presence_write(const struct room *room);
void presence_read(struct room *room, const char *text);
