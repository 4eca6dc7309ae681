#pragma once
/* Streams: one per own view of a member, one per kind and number for all who follow; of oblique views one per plane.
 * Their pictures: pictures.h. Internal to server/room.
 *   - A shared stream has one size, that of the presenter's view, for all who follow; a pane of another size or shape
 * shows the whole picture, with bars. Small panes are sent it reduced: size_class.h. A member who wants one of their
 * own size leaves. */
#include "server/room/state/room_state.h"

/* Takes view, a complete and checked document. The shared stream of an oblique plane ends once it has no viewer and the
 * next one is made: planes have any names, and there would be no bound on such streams. */
struct stream *stream_create(struct room *room, cJSON *view, bool is_shared);
void stream_destroy(struct room *room, struct stream *stream);
void stream_add_viewer(struct stream *stream, struct member_view *view);
/* The view shows its stream no longer: an own stream ends; of a shared one without any other viewer the requests are
 * forgotten. */
void stream_remove_viewer(struct room *room, struct member_view *view);
/* A viewer or a display is gone: what nobody shows any more ends, or its requests are forgotten. */
void stream_left(struct room *room, struct stream *stream);
/* Takes view. Returns true when it differs from the present one. */
bool stream_set_view(struct room *room, struct stream *stream, cJSON *view);
/* Raises the stream's version though nothing has changed: its picture is requested anew. */
void stream_again(struct room *room, struct stream *stream);
/* Raises the version of every stream; scene_is_new: overrides are applied anew. */
void streams_changed(struct room *room, bool scene_is_new);
/* The room's scene has changed by a merge patch from before: raises the version of the streams whose pictures differ,
 * and notes in is_reached which these are. */
void streams_scene_changed(struct room *room, const cJSON *before, const cJSON *patch);
/* Forgets outstanding requests without a word to the renderer: it is gone. */
void streams_forget_requests(struct room *room);
void streams_restart_pace(struct room *room);
/* The shared views as they are kept: [{view, mover}], and {walls} where walls have another layout than four. The text
 * is the caller's; NULL: no memory. Reading leaves out what is not a view. */
NODISCARD char *streams_write(const struct room *room);
void streams_read(struct room *room, const cJSON *list);
bool view_has_override(const cJSON *view);
/* True if the view's override fits the plan, or the plan is not known yet. */
bool override_is_valid(const struct room *room, const cJSON *view, struct problem *problem);
/* After a plan was loaded: removes overrides that do not fit it from their views, and tells their members. */
void streams_remove_bad_overrides(struct room *room);
/* The complete scene that the stream shows: with its view's override. NULL: the plan is not loaded, or no memory. */
const cJSON *stream_scene(struct room *room, struct stream *stream);
/* enum scene_kind of a view document. */
int view_kind(const cJSON *view);
/* True if two view documents are of one kind and number, and oblique ones of one plane: then one shared stream serves
 * both. */
bool views_are_alike(const cJSON *a, const cJSON *b);
/* A shared view that is made: with the camera of the bookmark that the room began with, where it has none of its own.
 * Takes document. */
NODISCARD cJSON *stream_first_view(const struct room *room, cJSON *document);
/* The shared stream for such views; NULL: there is none yet. */
struct stream *stream_shared(const struct room *room, const cJSON *view);
