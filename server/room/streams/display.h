#pragma once
/* Displays: screens that show a shared view and are no members. A display is a viewer of the stream without credit: it
 * is sent the pictures that the members who look are sent, and nothing is drawn for it beside them. Only where nobody
 * else looks, or none of those who look takes pictures, are pictures requested for displays. Internal to server/room.
 */
#include "server/room/state/room_state.h"
#include "server/room/streams/room_displays.h"

struct room_display {
    struct room_display *next; /* of the same stream */
    struct room *room;
    struct stream *stream;
    struct room_display_callbacks callbacks;
    bool is_late; /* as the display was told */
    bool is_main; /* it shows the room's main view */
};

/* Like room_display_add. */
NODISCARD struct room_display *display_add(struct room *room, const char *view,
                                           const struct room_display_callbacks *callbacks, struct problem *problem);
struct room *display_remove(struct room_display *display); /* returns its room */

/* How soon to look again whether a display has taken its picture: it makes no event. */
enum { DISPLAY_AGAIN_US = 50000 };
/* A picture is late when for so long it has not shown the newest state, and no newer one came. */
enum { DISPLAY_LATE_US = 1000000 };

/* True if a picture may be requested for the stream's displays: one of them has taken its picture, and no member who
 * looks was sent one in the last DISPLAY_ALONE_US. n_coming: requests of the stream outstanding. */
bool displays_have_credit(const struct stream *stream, uint32_t n_coming, int64_t now_us);
/* When all members who look will have stalled, if they take no more pictures; INT64_MIN: nobody looks. */
int64_t display_alone_us(const struct stream *stream);
/* Gives the stream's latest picture to its displays. Of a scene with a draft they are given pictures with words for it
 * alone: nothing else says so on a screen. */
void displays_send(const struct room *room, const struct stream *stream);
/* Tells displays whether their picture is late; when the next may be. */
int64_t displays_settle(struct room *room);
/* The room's main view is another one: the displays that show it go over. Returns INT64_MAX. */
int64_t displays_follow(struct room *room);
