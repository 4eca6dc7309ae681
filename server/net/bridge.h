#pragma once
/* Between rooms and the fleet: a room's picture requests become packets to the renderer, answers become pictures of the
 * room, and a plan's states are reported to its rooms. Internal to server/net; net thread. */
#include "server/net/net_state.h"

/* struct room_callbacks; context is the net */
void bridge_render(void *context, struct room *room, const struct room_render *request);
void bridge_forget(void *context, struct room *room, uint64_t request);
void bridge_scene_changed(void *context, struct room *room, const cJSON *scene, uint32_t revision);
/* fleet_options.changed; context is the net */
void bridge_fleet_changed(void *context, const char *plan_id);
/* Tells a room that plays or records the revision of the plan's files, if it is known by now; else it is looked for. */
void bridge_tell_revision(struct net_room *room);
/* Reports the plan's state to the room, if it differs from the one last reported. */
void bridge_report_plan(struct net_room *room);
/* Has the files of plans looked at that people have open, every LOOK_AT_FILES_S. */
enum { LOOK_AT_FILES_S = 15 };
void bridge_look_at_files(struct net *net, int64_t now_us);
/* A connection entered its room: the plan is opened if it is closed, and held until bridge_leave. */
void bridge_enter(struct visitor *visitor);
void bridge_leave(struct visitor *visitor);
/* The room is being closed: its requests are forgotten, here and in the renderer. */
void bridge_close_room(struct net_room *room);
