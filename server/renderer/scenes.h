#pragma once
/* The scenes that a picture or a question may name: the plan's own and the rooms', as the daemon sent them; and the
 * snapshots made from them. Thread: the main thread. */
#include "core/scene/snapshot.h"
#include "server/wire/packet.h"

struct scenes;
struct scenes *scenes_create(void);
void scenes_destroy(struct scenes *scenes);
/* Once, when the plan is loaded; before that there is nothing to make snapshots of. derived: the plan's store,
 * borrowed until scenes_destroy. */
void scenes_set_plan(struct scenes *scenes, struct derive *derived);
/* The plan's own scene, complete; NULL before scenes_set_plan. */
const cJSON *scenes_default(const struct scenes *scenes);
/* Takes scene and acceptances (NULL: none), which replace the room's last. False: SCENE_MAX_ROOMS rooms are kept
 * already. */
NODISCARD bool scenes_put_room(struct scenes *scenes, const char *room, uint32_t revision, cJSON *scene,
                               cJSON *acceptances);
void scenes_forget_room(struct scenes *scenes, const char *room);
/* Makes the snapshot that a packet is about: of the scene it brings, else the room's, else the plan's own. revision: of
 * that scene. Returns one reference, the caller's; NULL with problem, whose pointer begins with the packet's field. */
NODISCARD struct snapshot *scenes_snapshot(const struct scenes *scenes, const struct packet_snapshot *shown,
                                           uint32_t *revision, struct problem *problem);
