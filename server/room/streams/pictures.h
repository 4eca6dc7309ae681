#pragma once
/* When a picture of a stream is requested, how good, and to whom it is sent. Internal to server/room.
 *   - Nothing is requested while no viewer could be sent it; what is requested shows the newest state.
 *   - A picture older than the newest one is never sent.
 *   - Moving pictures are followed by a still. */
#include "server/room/state/room_state.h"

/* The answers to a request; room_picture_came and room_picture_failed. */
void streams_picture_came(struct room *room, uint64_t number, struct frame *picture); /* takes picture */
void streams_picture_failed(struct room *room, uint64_t number, const struct problem *problem);
/* Sends the latest picture to the view, if it is new there, the view has credit and can be drawn as it is now. */
void stream_send_picture(struct room *room, struct member *member, struct member_view *view);
/* Sends the member the small picture of the presenter whose turn has come. */
void stream_send_watch(struct room *room, struct member *member);
/* Like stream_send_watch, to all members. Returns INT64_MAX. */
int64_t streams_send_watches(struct room *room);
/* Sends the problem to a member who opened a view of a stream that cannot be drawn. */
void stream_send_refusal(struct room *room, struct member *member, const struct member_view *view);
void stream_acknowledged(struct room *room, struct member_view *view, uint32_t sequence);
/* Requests the pictures that are due; returns when to call again. */
int64_t streams_request_due(struct room *room);
