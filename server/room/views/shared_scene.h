#pragma once
/* The scene that all members of a room share. Internal to server/room. */
#include "server/room/state/room_state.h"
#include "server/wire/message.h"

/* Applies a merge patch to the scene and tells the members. by: who made it, NULL: a change over HTTP; input: that
 * member's number of it. Returns false with problem when nothing was applied. */
bool scene_apply_patch(struct room *room, const cJSON *patch, struct member *by, uint32_t input,
                       struct problem *problem);
/* Shows another complete and checked scene (taken) and tells the members. False: no memory, and nothing was applied. */
bool scene_show(struct room *room, cJSON *scene);
/* The handler of scene.patch. */
bool member_scene_patch(struct room *room, struct member *member, const struct message *message,
                        struct problem *problem);
