#pragma once
/* Questions to the net thread about meetings (server/meeting/meeting.h). Net thread. */
#include "server/meeting/meeting.h"
#include "server/net/net.h"

enum {
    NET_MAX_MEETINGS = STORE_MAX_MEETINGS,
    NET_MAX_MEETINGS_OF_ONE = NET_MAX_MEETINGS / 4 /* of one owner, where people sign in */
};

/* Called once, when the change is on disk: the meeting as it is now; NULL: it was deleted. problem: it was not written,
 * and nothing has changed. */
typedef void net_meeting_done(void *context, const struct meeting *meeting, const struct problem *problem);

size_t net_n_meetings(const struct net *net);
/* A meeting as it was last brought up to date; NULL: it is still being written. */
const struct meeting *net_meeting_at(const struct net *net, size_t index);
/* With what its rooms know brought up to date: attendance, decisions, words of plans. Good until the next call. */
const struct meeting *net_meeting_find(struct net *net, const char *id); /* NULL: there is none */
/* The role that this identity has in the meeting as a whole: planner and presenter edit it. Capped by the highest that
 * they have on the plans of its cases, of a meeting without cases on any plan. False: it is not there for them. */
bool net_meeting_role(const struct net *net, const struct meeting *meeting, const struct identity *who,
                      enum wire_member_role *role);
/* Whether the caller may see the plan of this case: by grants, or because of a seat in its room (member: as in
 * room_call_may, NULL: none). */
bool net_meeting_case_is_open(const struct net *net, const struct meeting_case *one, const struct identity *who,
                              const char *member);
/* The caller sits in one of its rooms: in which role, and whether they present. False: they do not. */
bool net_meeting_seat(const struct net *net, const struct meeting *meeting, const struct identity *who,
                      const char *member, enum wire_member_role *role, bool *presents);
/* A new meeting with an id of its own. NULL with problem: limit. */
NODISCARD struct meeting *net_meeting_new(struct net *net, const char *owner, struct problem *problem);

/* A change of a meeting, as the audit is told it. Borrowed. */
struct net_meeting_act {
    const struct identity *who;
    const char *address;
    const char *name;    /* of the member who did it; NULL: that of the identity */
    const char *what;    /* "made", "changed", "case", "ended", ... */
    const char *case_id; /* "": none in particular */
    bool deletes;
};
/* Writes a changed copy (taken), which counts when it is on disk. False with problem: storage; busy, while another
 * change of it is under way. */
NODISCARD bool net_meeting_commit(struct net *net, struct meeting *changed, const struct net_meeting_act *act,
                                  net_meeting_done *done, void *context, struct problem *problem);

/* The meeting is to be in another case, whose room is made or woken; people, walls and the presenter go along. */
struct net_meeting_go {
    const char *meeting, *to; /* to "next": the case behind the one of now */
    const char *from;         /* the case that the caller believes is now; NULL, "": none */
    const struct identity *who;
    const char *address, *name; /* name: of who does it; "": that of the identity */
    const char *room, *member;  /* of the member who does it, "": nobody of a room */
    bool only_prepares;         /* makes the room of the case `to` and goes nowhere */
};
/* False with problem: not-found, conflict (from, last, over), forbidden (the case is not open to who asks), limit,
 * busy, storage. Else done is called, later. */
NODISCARD bool net_meeting_go(struct net *net, const struct net_meeting_go *go, net_meeting_done *done, void *context,
                              struct problem *problem);
/* Tells the people in all rooms of the meeting how it stands. */
void net_meeting_tell(struct net *net, const struct meeting *meeting);
/* Puts out who came by this link of the meeting; returns how many. */
size_t net_meeting_put_out(struct net *net, const struct meeting *meeting, const char *digits);
