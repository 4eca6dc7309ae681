#pragma once
/* The list of meetings and what is written of it. Internal to server/net; net thread. */
#include "server/net/meetings.h"
#include "server/net/net_state.h"

enum { MEETINGS_PAUSE_MS = 1000 }; /* between writes of what rooms know: who is there, what was decided */

/* The meeting that this is the room of a case of; *one: the case. NULL: none. */
struct meeting *meetings_of_room(const struct net *net, const char *room, struct meeting_case **one);
/* Whether this user was asked to the meeting of which this is a room. */
bool meetings_ask_in(const struct net *net, const char *room, const struct identity *who);
/* Something of the meeting was changed that need not be on disk before it counts. */
void meetings_touch(struct net *net, const struct meeting *meeting);
/* A user came along to a room of the meeting; a member was removed from one. */
void meetings_came(struct net *net, const struct meeting *meeting, const char *user);
void meetings_bar(struct net *net, const struct meeting *meeting, const char *user, const char *link);
/* The first saved view of the case is shown now. False: the case does not open, or it was shown already. */
bool meetings_opened(struct net *net, const struct meeting *meeting, const char *case_id);
/* The room has other people in it, or something was decided there. */
void meetings_room_changed(struct net *net, const char *room);
/* Takes over what the room knows of attendance and decisions. */
void meetings_look_at_room(struct net *net, const char *room);
void meetings_write_due(struct net *net, bool is_last);
/* An answer of the store; borrowed. True: it was one to a change of a meeting. */
bool meetings_written(struct net *net, const struct store_answer *answer);
void meetings_add_all(struct net *net, const struct store_answer *opened); /* what is on disk */
void meetings_erase(struct net *net, const char *plan, const char *other); /* a plan is erased */
void meetings_end(struct net *net);                                        /* the server stops: answers who waits */
void meetings_finish(struct net *net);                                     /* frees all */
/* True, with problem: a change of the meeting is being written. */
bool meetings_is_busy(const struct net *net, const char *id, const char **now, struct problem *problem);
