#pragma once
/* The presenter: the member whose views are the room's and who may change its scene. The handlers of present and
 * show.everyone. Internal to server/room. */
#include "server/room/state/room_state.h"
#include "server/wire/message.h"

/* Handlers; each returns false with a problem when it applied nothing. */
bool presenter_present(struct room *room, struct member *member, const struct message *message,
                       struct problem *problem);
bool presenter_show_everyone(struct room *room, struct member *member, const struct message *message,
                             struct problem *problem);

/* The member presents a room that has no presenter, with its own views. Returns false with a problem. */
bool presenter_take_over(struct room *room, struct member *member, uint32_t input, struct problem *problem);

/* Takes the role from a presenter who has been away for ROOM_PRESENTER_KEPT_S, and gives it to the only connected
 * member of a room without presenter. To be called whenever somebody came or went, or time passed. Returns true when
 * the presenter changed: the list of members is to be sent. */
bool presenter_settle(struct room *room);
/* When presenter_settle is due without another event; INT64_MAX: not at all. */
int64_t presenter_due_us(struct room *room);
