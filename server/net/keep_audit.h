#pragma once
/* Rows for the audit on their way to the store: those of a room wait with it, those of no room with the net. Internal
 * to server/net; net thread. */
#include "server/net/net_state.h"

/* The room's entry; NULL: rooms are not kept. */
struct net_room *keep_find(const struct net *net, const struct room *room);
/* struct room_callbacks; context is the net */
void keep_audited(void *context, struct room *room, const struct room_audit *row);
bool keep_audit_has_place(void *context);
const struct identity *keep_caller(void *context);
/* The row as JSON, without its number. */
cJSON *keep_audit_describe(const char *room, const char *plan_id, const struct room_audit *row);
/* Adds a row (taken) that waits already. */
void keep_audit_add(struct net *net, char ***rows, size_t *n, char *row);
void keep_audit_write(struct net *net); /* hands over the rows of no room */
/* An answer of the store that has the audit's head; borrowed. */
void keep_audit_written(struct net *net, const struct store_answer *answer);
