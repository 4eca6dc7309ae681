#pragma once
/* The list of a room's items with its limits; room_items is here. Who may change them and what they
 * hold: items.h. Internal to server/room. */
#include "server/room/state/room_state.h"

struct item { /* a reply is a note */
    struct item *next;
    char id[16];
    enum wire_item_kind kind;
    uint32_t version;
    char author[64], author_name[161], author_color[8]; /* author_color: "#rrggbb" */
    char author_user[STORE_USER];                       /* the author's, where they had signed in; "": none */
    bool is_guest;                                      /* the author is one */
    char changed_name[161];                             /* who changed it last */
    char hidden_by[161];                                /* of a note: who has hidden it; "": nobody */
    int64_t created_ms, changed_ms;                     /* since 1970, UTC */
    char parent[16];                                    /* of a reply: the note's id; "": none */
    char *row;                                          /* all of this with the body, as JSON */
};

struct keeping { /* an item that is being written, and counts afterwards */
    struct keeping *next;
    uint64_t number;
    struct item item; /* what it will be; row: owned */
    bool is_change;   /* of an item in the list */
    char member[64];  /* who gave it */
    uint32_t input;
    void (*done)(void *context, const char *row, bool was_sent_before,
                 const struct problem *problem); /* of struct room_act; NULL: a message gave it */
    void *context;
};

struct items {
    struct item *first;          /* the oldest */
    size_t n, n_bytes;           /* n_bytes: of their rows */
    struct keeping *keeping;     /* the oldest first */
    uint64_t n_kept;             /* numbers of keeping that were given out */
    const struct member *writer; /* while the body of an item is read: who writes it */
};

void items_init(struct room *room); /* with the room */

/* NULL: there is none with this id. */
struct item *items_find(const struct room *room, const char *id);
bool items_has(const struct room *room, enum wire_item_kind kind);
/* Whether the room has the place for a row of n bytes in the stead of `before` (NULL: a new one). False with problem.
 */
NODISCARD bool items_have_place(const struct room *room, const struct item *before, size_t n, struct problem *problem);
/* Gives the item this row (taken). An item that is not in the list becomes the last one. */
void items_keep(struct room *room, struct item *item, char *row);
void items_drop(struct room *room, struct item *item); /* frees it */
/* Empties the list. Returns its items, oldest first: the caller's, as are their rows. */
NODISCARD struct item *items_take_all(struct room *room);
void items_free(struct room *room);
/* [row], of all kinds, oldest first. NULL: no memory. */
NODISCARD cJSON *items_rows(const struct room *room);
