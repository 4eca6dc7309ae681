#pragma once
/* Writes rooms to the store: what changed since the last write, at most one write of a room at a time, the newest state
 * with each. Internal to server/net; net thread. */
#include "server/net/net_state.h"

enum { /* between the beginnings of two writes of one room */
       KEEP_PAUSE_MS = 200,
       KEEP_VIEWS_PAUSE_MS = 1000,   /* while only shared views have changed: a drag changes them with each picture */
       KEEP_REFUSED_PAUSE_MS = 10000 /* after one that the store dropped */
};

/* struct room_callbacks; context is the net */
void keep_changed(void *context, struct room *room, unsigned parts);
void keep_is_saved(void *context, const struct room *room, struct room_saved *saved);
bool keep_item_first(void *context, struct room *room, uint64_t number, const struct room_item_write *write,
                     struct problem *problem);
/* The plan's files were looked at: decisions that waited for that are written, or refused where they have changed. */
void keep_files_looked(struct net_room *entry, const struct fleet_plan *plan);
void keep_item_changed(void *context, struct room *room, const char *row, const char *id);
/* Hands over what is due. is_last: all that changed, whatever is under way. */
void keep_write_due(struct net *net, bool is_last);
/* True if the room is on disk as it is. */
bool keep_is_written(const struct net_room *room);
/* Answers of the store; borrowed. */
void keep_written(struct net *net, const struct store_answer *answer);
void keep_all_again(struct net *net); /* what is on disk was lost */
/* The room's row is deleted; at once or when the store has place for it. */
void keep_delete(struct net *net, const char *room_id);
void keep_room_finish(struct net_room *room); /* before it is freed; rows for the audit go to the net */
/* Makes room what was read. */
void keep_restore(struct net_room *room, const struct store_room *kept);
