#pragma once
/* The messages that a room sends to its members, one function each. A member without a connection is sent nothing.
 * Internal to server/room. */
#include "server/room/state/room_state.h"
#include "server/wire/message.h"

void send_to_member(struct room *room, struct member *member, const struct message *message);
/* False: there was no memory for it, and the connection was closed. */
bool send_to_connection(struct room *room, void *connection, const struct message *message);
/* Sends a slow receiver only the newest of the messages with one key. */
void send_latest(struct room *room, struct member *member, uint32_t key, const struct message *message);
void send_latest_to_others(struct room *room, const struct member *but, uint32_t key, const struct message *message);
void send_to_all(struct room *room, const struct message *message); /* and to listeners */
/* For messages that each member is sent in another form. */
void send_to_listeners(struct room *room, const struct message *message);

/* To all; in a large room soon, when the list went out just before (MEMBERS_EVERY_US). */
void send_members(struct room *room);
/* Like send_members, but to the newcomer at once. */
void send_members_to_newcomer(struct room *room, struct member *newcomer);
int64_t send_members_due(struct room *room); /* sends a list that is due; returns when one is due, INT64_MAX: none */
void send_renderer_state(struct room *room, struct member *member); /* member NULL: to all */
void send_plan(struct room *room);                                  /* to all */
/* The accepted patch; by: who made it, or NULL; input: the maker's number. to_all false: only to the maker.
 * Consumes patch. */
void send_scene_patch(struct room *room, cJSON *patch, struct member *by, uint32_t input, bool to_all);
/* The document of one of the member's views; by: id of the member who moved it, "" for none. */
void send_view(struct room *room, struct member *member, int index, const char *by);
void send_view_forget(struct stream *stream); /* the stream's view is another one, or ends */
/* to: type of the refused message, "" when it was none; view, input: of that message, 0 when it had none. Counts as a
 * refused message. False as send_to_connection. */
bool send_problem(struct room *room, void *connection, const char *to, int64_t view, int64_t input,
                  const struct problem *problem);
/* Sends which regions the pictures of this view leave out; missing NULL: none. */
void send_missing(struct room *room, struct member *member, int index, const cJSON *missing);
/* Sends bye and closes the connection; retry_ms < 0: the page is not to come back. */
void send_bye(struct room *room, void *connection, int retry_ms, const char *reason);
/* Like send_bye, with the word that says why: proto/messages.json. */
void send_bye_for(struct room *room, void *connection, const char *code, int retry_ms, const char *reason);
