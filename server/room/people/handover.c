/* Hands control over. */
#include "server/room/people/handover.h"

#include <string.h>

#include "server/room/out/send.h"
#include "server/room/people/control.h"
#include "server/room/people/presenter.h"
#include "server/room/state/member_list.h"
#include "server/room/state/roles.h"
#include "server/room/views/member_view.h"

/* ---- passing it on ---------------------------------------------------------------------------------------------- */

/* The member presents from now on, with the views that the room has: nobody's picture moves. */
static bool pass_on(struct room *room, struct member *member, enum wire_control_act act, uint32_t input,
                    struct problem *problem)
{
    struct member *before = room->presenter;
    const bool was_locked = room->control->is_locked;
    const uint64_t request = member->request;
    control_pass(room, member);
    control_note(room, act, member, act == WIRE_CONTROL_ACT_GIVEN ? before : member);
    (void)control_settle(room); /* first: the page takes the views that follow as those it presents */
    if (!views_follow(room, member, input, problem)) {
        room->presenter = before;
        room->control->is_locked = was_locked;
        member->request = request;
        control_note(room, WIRE_CONTROL_ACT_NONE, NULL, NULL);
        return false;
    }
    send_members(room);
    return true;
}

static struct member *find(const struct room *room, const char *id, struct problem *problem)
{
    for (int i = 0; i < room->members.n; i++)
        if (strcmp(room->members.list[i]->id, id) == 0)
            return room->members.list[i];
    problem_set(problem, PROBLEM_NOT_FOUND, "/member", "", "there is no member \"%.63s\" in this room", id);
    return NULL;
}

/* False with problem: the member presents another case of the meeting, to others there. */
static bool may_have_control(struct room *room, const struct member *member, struct problem *problem)
{
    const struct room_meeting_callbacks *meeting = room->callbacks.meeting;
    const size_t n = meeting && meeting->presents_case
                         ? meeting->presents_case(room->callbacks.context, room, member->connection)
                         : 0;
    return n == 0 ||
           problem_set(problem, PROBLEM_CONFLICT, "/member", "presents",
                       "%s presents case %zu of this meeting, and nobody presents two at once", member->id, n);
}

/* ---- handlers --------------------------------------------------------------------------------------------------- */

bool control_request(struct room *room, struct member *member, const struct message *message, struct problem *problem)
{
    const int64_t again_us = member->refused_us + ROOM_REQUEST_AGAIN_S * INT64_C(1000000);
    if (!message->control_request.wanted) {
        control_left(room, member);
        return true;
    }
    if (member_presents(room, member) || member->request)
        return true;
    if (!room->presenter)
        return presenter_take_over(room, member, 0, problem);
    if (member->refused_us && room->now_us < again_us) {
        problem_set(problem, PROBLEM_LIMIT, "", "", "%s refused control; it can be requested again %d s later",
                    room->presenter->id, ROOM_REQUEST_AGAIN_S);
        if (problem)
            problem->retry_after_ms = (int)((again_us - room->now_us) / 1000) + 1;
        return false;
    }
    member->request = ++room->control->n_requests;
    control_note(room, WIRE_CONTROL_ACT_REQUESTED, member, member);
    return true;
}

bool control_give(struct room *room, struct member *member, const struct message *message, struct problem *problem)
{
    if (!member_presents(room, member))
        return refuse_not_presenter(room, problem, "give control");
    struct member *other = find(room, message->control_give.member, problem);
    if (!other || other == member)
        return other != NULL;
    if (!other->connection)
        return problem_set(problem, PROBLEM_NOT_FOUND, "/member", "", "%s is away and cannot be given control",
                           other->id);
    if (!member_check(other, WIRE_RIGHT_SCENE, problem)) {
        problem_below(problem, "/member");
        return false;
    }
    return may_have_control(room, other, problem) && pass_on(room, other, WIRE_CONTROL_ACT_GIVEN, 0, problem);
}

bool control_refuse(struct room *room, struct member *member, const struct message *message, struct problem *problem)
{
    if (!member_presents(room, member))
        return refuse_not_presenter(room, problem, "refuse control");
    struct member *other = find(room, message->control_refuse.member, problem);
    if (!other)
        return false;
    if (!other->request)
        return true; /* withdrawn meanwhile */
    other->request = 0;
    other->refused_us = room->now_us;
    control_note(room, WIRE_CONTROL_ACT_REFUSED, other, member);
    return true;
}

bool control_take(struct room *room, struct member *member, const struct message *message, struct problem *problem)
{
    const uint32_t input = (uint32_t)message->control_take.input;
    const struct member *presenter = room->presenter;
    if (member_presents(room, member))
        return true;
    if (!presenter)
        return presenter_take_over(room, member, input, problem);
    if (!member_has_right(member, WIRE_RIGHT_CONTROL))
        return problem_set(problem, PROBLEM_NOT_PRESENTER, "", "",
                           "%s presents: request control, or take it when %s has been away for %d s", presenter->id,
                           presenter->id, ROOM_PRESENTER_KEPT_S);
    if (room->control->is_locked)
        return problem_set(problem, PROBLEM_NOT_PRESENTER, "", "locked", "%s has locked control: request it",
                           presenter->id);
    return may_have_control(room, member, problem) && pass_on(room, member, WIRE_CONTROL_ACT_TAKEN, input, problem);
}

bool control_lock(struct room *room, struct member *member, const struct message *message, struct problem *problem)
{
    const bool is_locked = message->control_lock.locked;
    if (!member_presents(room, member))
        return refuse_not_presenter(room, problem, "lock control");
    if (is_locked != room->control->is_locked)
        control_note(room, is_locked ? WIRE_CONTROL_ACT_LOCKED : WIRE_CONTROL_ACT_UNLOCKED, NULL, member);
    room->control->is_locked = is_locked;
    return true;
}
