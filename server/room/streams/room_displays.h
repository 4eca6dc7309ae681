#pragma once
/* The displays of a room. Included by room.h. */
#include "server/room/state/room_types.h"

/* Displays: screens that show a shared view and are no members. view: its kind; NULL: the room's main view, whichever
 * that is at the time. Of several views of the kind, the presenter's first, else that with the lowest number; one that
 * nobody has shown yet begins as for a member. A display neither keeps a room awake nor counts as its use. NULL with
 * problem: limit, validation, not-found. */
struct room_display;
struct room_display_callbacks {
    /* a newer picture, of a view of this kind (a constant word); keeping it takes frame_ref */
    void (*picture)(void *context, struct frame *picture, const char *kind);
    bool (*has_room)(void *context); /* the screen has taken the last one */
    /* The picture does not show what the room shows now: the newest state is slow to be drawn, or cannot be. False at
     * first, and again when it does. */
    void (*late)(void *context, bool is_late);
    void (*ended)(void *context); /* with the room: the display is gone */
    void *context;
};
const char *room_display_kind(const struct room_display *display); /* a word of the view's field kind */
