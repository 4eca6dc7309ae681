#pragma once
/* The body of a note: {text, anchor: null | {point_mm?, region?}, resolved, mentions: [{member, name}], parent}. A
 * reply is a note with a parent; it has no anchor and is not resolved. Knows the plan's regions, not who may write.
 * Internal to server/room. */
#include "server/room/items/item_list.h"

enum {
    NOTE_MAX_TEXT = 2000, /* characters */
    NOTE_MAX_MENTIONS = 16,
    NOTE_MAX_NAME = 40,     /* characters of a mentioned name */
    NOTE_MAX_MM = 100000,   /* of a coordinate, either way */
    NOTE_MAX_BYTES = 16384, /* of the body as text; what the other limits let through is less */
};

/* The body, checked and complete, as a new document; pointers of problems begin with /body. The region must be one of
 * the plan, and the parent a note of the room. before: the note that is changed, which keeps its parent; NULL: a new
 * one. is_restored: from the store, whose plan and order of notes may be others: neither region nor parent are looked
 * up. NULL with problem. */
NODISCARD cJSON *note_body_read(const struct room *room, const cJSON *body, const struct item *before, bool is_restored,
                                struct problem *problem);
