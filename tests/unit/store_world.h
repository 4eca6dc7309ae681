#pragma once
/* A store in a folder of its own, and what it answered. */
#include "server/store/store.h"

struct queue;

struct store_world {
    char folder[256], path[300];
    struct store *store;
    struct queue *answers;
};

void store_world_open(struct store_world *world);  /* folder "": a new one */
void store_world_begin(struct store_world *world); /* a new one, whose answer to being opened is taken */
/* Closes the store and opens it anew on the same folder: what was read, the caller's. */
struct store_answer *store_world_reopen(struct store_world *world);
void store_world_close(struct store_world *world); /* the store alone */
void store_world_end(struct store_world *world);
/* The next answer; fails the test when none comes within a minute. */
struct store_answer *store_world_answer(struct store_world *world);
/* The next one, which must be of this kind; the caller's. */
struct store_answer *store_world_await(struct store_world *world, enum store_event event);
/* The room as it is on disk now; NULL: there is none. */
struct store_room *store_world_read(struct store_world *world, const char *id);
/* A room with a scene of n bytes beside {} and these many members. */
struct store_room *store_made_room(const char *id, uint32_t revision, size_t n, size_t n_members);
/* Writes it and waits until it is on disk. */
void store_world_write(struct store_world *world, struct store_room *room);
