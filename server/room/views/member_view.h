#pragma once
/* The views of a member: opening, changing and closing them; following the presenter and leaving. The handlers of view
 * messages, of follow and of frame.shown. Internal to server/room. */
#include "server/room/state/room_state.h"
#include "server/wire/message.h"

/* Handlers; each returns false with a problem when it applied nothing. */
bool member_view_open(struct room *room, struct member *member, const struct message *message, struct problem *problem);
bool member_view_patch(struct room *room, struct member *member, const struct message *message,
                       struct problem *problem);
bool member_view_active(struct room *room, struct member *member, const struct message *message,
                        struct problem *problem);
bool member_view_close(struct room *room, struct member *member, const struct message *message,
                       struct problem *problem);
bool member_follow(struct room *room, struct member *member, const struct message *message, struct problem *problem);
bool member_frame_shown(struct room *room, struct member *member, const struct message *message,
                        struct problem *problem);

/* All open views of the member show the shared views, in place of its own ones; the member is sent each view. Returns
 * false when there was no memory: all is as it was. */
NODISCARD bool views_follow(struct room *room, struct member *member, uint32_t input, struct problem *problem);
/* The open views of the presenter become the shared views of their kinds and numbers, with their documents and in the
 * presenter's sizes; of two of one kind and number (and plane), the first. keep_override false: their overrides are
 * dropped. Sends each view that was the presenter's own. Returns false when there was no memory: all is as it was. */
NODISCARD bool views_share(struct room *room, struct member *presenter, bool keep_override, uint32_t input,
                           struct problem *problem);
/* Closes all views of a connection that has ended: a page that comes back opens its own again. */
void views_close(struct room *room, struct member *member);
/* Notes an input that the stream's present version holds: it is reported with the first picture that shows it. */
void view_add_input(struct member_view *view, uint32_t input);
