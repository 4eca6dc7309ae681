#pragma once
/* Walls: displays that are members (role wall). Each pane of a wall is a view of its own, drawn in the size that the
 * wall asks for, which follows the shared view of its kind: walls of one size are served by one stream. Also what walls
 * show: the layout that the presenter chooses, and the view that they work in.
 *   - A picture for a wall never comes before one for a person: its requests are the renderer's last, at most one a
 * stream is under way, and moving ones leave WALL_EVERY_US between them.
 *   - What of a shared picture is seen, is seen on the wall as well: where its shape is another one, more is.
 * Internal to server/room. */
#include "server/room/state/room_state.h"
#include "server/wire/message.h"

enum {
    WALL_EVERY_US = 50000,       /* between two requests of moving pictures for one stream */
    WALL_STILL_LATER_US = 200000 /* after the stills of people */
};

/* True of a member that is a wall: it has no views but those that follow. */
bool member_is_wall(const struct member *member);
/* The stream for a wall's view with this document, of which kind, number, plane, size, pixel_ratio and foot_px count.
 * Takes document; NULL with problem: no memory. */
NODISCARD struct stream *wall_stream(struct room *room, cJSON *document, struct problem *problem);
/* When a moving picture of the stream may be requested next. */
int64_t wall_due_us(const struct stream *stream);
/* After whatever may have changed a shared view, what the presenter has open or works in: walls go along, and are told.
 */
int64_t walls_follow(struct room *room);
/* Tells a newcomer what walls show. */
void walls_show(struct room *room, struct member *member);
/* The handler of wall.layout. */
bool wall_layout_set(struct room *room, struct member *member, const struct message *message, struct problem *problem);
