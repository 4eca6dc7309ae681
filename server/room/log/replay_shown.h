#pragma once
/* Makes a room show the state of a meeting log. Internal to server/room. */
#include "server/room/state/room_state.h"

/* Each makes the room what the state says and tells the members; before: what it showed before, or NULL. */
/* The scene as far as the plan has it; report, if not NULL, gets what it does not have: [{pointer, code, detail}],
 * the caller's. False: no memory, and the room shows what it showed. */
bool shown_scene(struct room *room, const cJSON *state, cJSON **report);
void shown_views(struct room *room, const cJSON *state);
void shown_items(struct room *room, const cJSON *state);
void shown_pointers(struct room *room, const cJSON *before, const cJSON *state);
/* To a member who has just come. */
void shown_pointers_to(struct room *room, struct member *member, const cJSON *state);
void shown_members(struct room *room, struct member *only, const cJSON *state); /* only NULL: to all */
