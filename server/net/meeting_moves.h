#pragma once
/* People go on to a meeting's next case. Internal to server/net; net thread. */
#include "server/net/meetings.h"
#include "server/net/net_state.h"

/* The role with which this member of another room may be in the room of the case. False: it is not open to them. */
bool meeting_moves_may(const struct net *net, const struct meeting *meeting, const struct meeting_case *to,
                       const struct identity *who, const struct room_present *present, enum wire_member_role *role);
/* Tells the member at this connection in `from` to go on to the case of now, with a seat there; asks: where they look
 * on their own, they are asked first. */
void meeting_moves_send(struct net *net, const struct meeting *meeting, struct room *from, void *connection, bool asks,
                        const char *by);
/* Tells the member at this connection how the meeting stands; of those who present the first one also that the case
 * opens. */
void meeting_moves_tell(struct net *net, const struct meeting *meeting, const struct meeting_case *here,
                        struct room *room, void *connection);
