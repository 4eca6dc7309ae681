/* Gives and takes the presenter's role. */
#include "server/room/people/presenter.h"

#include "server/room/out/send.h"
#include "server/room/people/control.h"
#include "server/room/state/member_list.h"
#include "server/room/state/roles.h"
#include "server/room/views/member_view.h"
#include "server/room/views/shared_scene.h"
#include "server/wire/json_merge.h"

static const int64_t kept_us = ROOM_PRESENTER_KEPT_S * INT64_C(1000000);

/* The override of a view of the member's own; NULL: it has none. */
static const cJSON *own_override(const struct member_view *view)
{
    if (!view->stream || view->is_following)
        return NULL;
    const cJSON *override = cJSON_GetObjectItemCaseSensitive(view->stream->view, "override");
    return cJSON_IsObject(override) && override->child ? override : NULL;
}

/* Applies the overrides of the member's own views to the scene. A page gives all its views the same one. */
static bool share_overrides(struct room *room, struct member *member, uint32_t input, struct problem *problem)
{
    const cJSON *last = NULL;
    for (int i = 0; i < ROOM_MAX_VIEWS; i++) {
        const cJSON *override = own_override(&member->views[i]);
        if (!override || json_equal(override, last))
            continue;
        if (!scene_apply_patch(room, override, member, input, problem))
            return false;
        last = override;
    }
    return true;
}

/* The member's own views become the room's. */
static bool share(struct room *room, struct member *member, uint32_t input, struct problem *problem)
{
    const bool keep_override = !room->shared.scene; /* without a plan it can be neither checked nor applied */
    return (keep_override || share_overrides(room, member, input, problem)) &&
           views_share(room, member, keep_override, input, problem);
}

bool presenter_take_over(struct room *room, struct member *member, uint32_t input, struct problem *problem)
{
    struct member *before = room->presenter;
    if (before && before != member)
        return refuse_not_presenter(room, problem, "take over");
    control_pass(room, member);
    if (!share(room, member, input, problem)) {
        room->presenter = before;
        return false;
    }
    send_members(room);
    return true;
}

bool presenter_present(struct room *room, struct member *member, const struct message *message, struct problem *problem)
{
    return presenter_take_over(room, member, (uint32_t)message->present.input, problem);
}

bool presenter_show_everyone(struct room *room, struct member *member, const struct message *message,
                             struct problem *problem)
{
    if (!member_presents(room, member))
        return refuse_not_presenter(room, problem, "call everybody back");
    if (!share(room, member, (uint32_t)message->show_everyone.input, problem))
        return false;
    bool is_done = true;
    for (int i = 0; i < room->members.n; i++)
        if (room->members.list[i] != member)
            is_done = views_follow(room, room->members.list[i], 0, problem) && is_done;
    send_members(room);
    return is_done;
}

static struct member *only_connected(const struct room *room)
{
    struct member *only = NULL;
    for (int i = 0; i < room->members.n; i++) {
        if (!room->members.list[i]->connection || room->members.list[i]->role == WIRE_MEMBER_ROLE_WALL)
            continue;
        if (only)
            return NULL;
        only = room->members.list[i];
    }
    return only && member_has_right(only, WIRE_RIGHT_SCENE) ? only : NULL;
}

bool presenter_settle(struct room *room)
{
    const struct member *before = room->presenter;
    if (room->replay) /* it presents itself */
        return false;
    if (before && !before->connection && room->now_us >= presenter_due_us(room))
        control_pass(room, NULL);
    struct member *only = room->presenter ? NULL : only_connected(room);
    if (only) {
        struct problem problem = { 0 };
        control_pass(room, only);
        if (!share(room, only, 0, &problem))
            control_pass(room, NULL); /* tried again */
    }
    return room->presenter != before;
}

int64_t presenter_due_us(struct room *room)
{
    const struct member *presenter = room->presenter;
    if (room->replay)
        return INT64_MAX;
    if (presenter)
        return presenter->connection ? INT64_MAX : presenter->away_us + kept_us;
    return only_connected(room) ? room->now_us + RETRY_US : INT64_MAX; /* there was no memory to share the views */
}
