/* Fills in and sends each message from a room to its members. */
#include "server/room/out/send.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/room/out/listeners.h"
#include "server/room/state/event.h"
#include "server/room/state/member_list.h"
#include "server/wire/document.h"
#include "server/wire/message.h"

/* text NULL: there was no memory for it. A page that misses a message would show a stale state, so its
 * connection is closed: it connects again and is sent everything. */
static bool send_text(struct room *room, void *connection, const char *text)
{
    if (text) {
        room->callbacks.send_text(room->callbacks.context, connection, text);
        return true;
    }
    struct member *member = member_of_connection(room, connection);
    if (member) {
        member->connection = NULL;
        member->is_lost = room->members.has_lost = true;
        member->away_us = room->now_us;
    }
    room->callbacks.close(room->callbacks.context, connection);
    return false;
}

bool send_to_connection(struct room *room, void *connection, const struct message *message)
{
    char *text = message_write(message);
    bool is_sent = send_text(room, connection, text);
    free(text);
    return is_sent;
}

void send_to_member(struct room *room, struct member *member, const struct message *message)
{
    if (member->connection)
        (void)send_to_connection(room, member->connection, message);
}

static void send_latest_text(struct room *room, struct member *member, uint32_t key, const char *text)
{
    if (!member->connection)
        return;
    if (text)
        room->callbacks.send_latest(room->callbacks.context, member->connection, key, text);
    else
        (void)send_text(room, member->connection, NULL);
}

void send_latest(struct room *room, struct member *member, uint32_t key, const struct message *message)
{
    char *text = message_write(message);
    send_latest_text(room, member, key, text);
    free(text);
}

void send_latest_to_others(struct room *room, const struct member *but, uint32_t key, const struct message *message)
{
    char *text = message_write(message); /* written once for all */
    for (int i = 0; i < room->members.n; i++)
        if (room->members.list[i] != but)
            send_latest_text(room, room->members.list[i], key, text);
    free(text);
}

/* The message, written once for all. */
static void send_text_to_members(struct room *room, const char *text)
{
    for (int i = 0; i < room->members.n; i++)
        if (room->members.list[i]->connection)
            (void)send_text(room, room->members.list[i]->connection, text);
}

static void send_to_members(struct room *room, const struct message *message)
{
    char *text = message_write(message);
    send_text_to_members(room, text);
    free(text);
}

void send_to_all(struct room *room, const struct message *message)
{
    char *text = message_write(message);
    listeners_tell(room, message->type, text);
    send_text_to_members(room, text);
    free(text);
}

/* Where the documents in a message are borrowed, message_finish is not called on it. */

static void send_members_now(struct room *room, struct member *only)
{
    struct message message = { .type = MESSAGE_MEMBERS, .members = { room_members(room) } };
    if (only)
        send_to_member(room, only, &message);
    else
        send_to_all(room, &message);
    message_finish(&message);
}

void send_members(struct room *room)
{
    room_event(room, ROOM_MEMBERS, NULL);
    int64_t due_us = room->members.sent_us + MEMBERS_EVERY_US * (int64_t)room->members.n;
    if (room->members.n > FEW_MEMBERS && room->now_us < due_us) {
        room->members.due_us = due_us;
        return;
    }
    room->members.sent_us = room->now_us;
    room->members.due_us = 0;
    send_members_now(room, NULL);
}

void send_to_listeners(struct room *room, const struct message *message)
{
    if (!listeners_are_told(room, message->type))
        return;
    char *text = message_write(message);
    listeners_tell(room, message->type, text);
    free(text);
}

void send_members_to_newcomer(struct room *room, struct member *newcomer)
{
    send_members(room);
    if (room->members.due_us)
        send_members_now(room, newcomer);
}

int64_t send_members_due(struct room *room)
{
    if (room->members.due_us && room->now_us >= room->members.due_us)
        send_members(room);
    return room->members.due_us ? room->members.due_us : INT64_MAX;
}

void send_renderer_state(struct room *room, struct member *member)
{
    struct message message = { .type = MESSAGE_RENDERER };
    message.renderer.state = room->renderer.state;
    message.renderer.percent = room->renderer.percent;
    mem_put_text(message.renderer.phase, sizeof message.renderer.phase, room->renderer.phase);
    if (room->renderer.problem.type != PROBLEM_NONE)
        message.renderer.problem = problem_to_json(&room->renderer.problem);
    if (member)
        send_to_member(room, member, &message);
    else
        send_to_all(room, &message);
    message_finish(&message);
}

void send_plan(struct room *room)
{
    struct message message = { .type = MESSAGE_PLAN };
    message.plan.plan = room->shared.plan;
    message.plan.scene = room->shared.scene;
    message.plan.revision = room->shared.revision;
    mem_put_text(message.plan.gl, sizeof message.plan.gl, room->renderer.gl);
    send_to_members(room, &message);
    message.plan.plan = cJSON_CreateObject(); /* GET of the plan has it */
    send_to_listeners(room, &message);
    cJSON_Delete(message.plan.plan);
}

/* Numbers of the member's open views that the newest change of the scene did not reach; NULL: none. */
static cJSON *unreached_views(const struct member *member)
{
    cJSON *numbers = NULL;
    for (int i = 0; i < ROOM_MAX_VIEWS; i++) {
        const struct stream *stream = member->views[i].stream;
        if (!stream || stream->is_reached)
            continue;
        numbers = numbers ? numbers : cJSON_CreateArray();
        json_append(numbers, cJSON_CreateNumber(i + 1));
    }
    return numbers;
}

void send_scene_patch(struct room *room, cJSON *patch, struct member *by, uint32_t input, bool to_all)
{
    struct message message = { .type = MESSAGE_SCENE, .scene = { .revision = room->shared.revision, .patch = patch } };
    if (by)
        mem_put_text(message.scene.by, sizeof message.scene.by, by->id);
    if (to_all)
        send_to_listeners(room, &message);
    for (int i = 0; i < room->members.n; i++) {
        struct member *member = room->members.list[i];
        if (member != by && !to_all)
            continue;
        message.scene.input = member == by ? input : 0; /* the input number is only for its sender */
        message.scene.unchanged = to_all ? unreached_views(member) : NULL;
        send_to_member(room, member, &message);
        cJSON_Delete(message.scene.unchanged);
        message.scene.unchanged = NULL;
    }
    message_finish(&message);
}

void send_view_forget(struct stream *stream)
{
    free(stream->told.text);
    stream->told.text = NULL;
}

static void write_view(struct stream *stream, int index, bool is_following, bool is_late, const char *by)
{
    struct message message = { .type = MESSAGE_VIEW };
    message.view.view = index + 1;
    message.view.document = stream->view;
    message.view.follow = is_following;
    message.view.late = is_late;
    mem_put_text(message.view.by, sizeof message.view.by, by);
    send_view_forget(stream);
    stream->told.text = message_write(&message);
    stream->told.index = index;
    stream->told.is_following = is_following;
    stream->told.is_late = is_late;
    mem_put_text(stream->told.by, sizeof stream->told.by, by);
}

void send_view(struct room *room, struct member *member, int index, const char *by)
{
    const struct member_view *view = &member->views[index];
    struct stream *stream = view->stream;
    const bool is_late = view_is_watch(view) && member->watch.is_late;
    if (!member->connection)
        return;
    if (!stream->told.text || stream->told.index != index || stream->told.is_following != view->is_following ||
        stream->told.is_late != is_late || strcmp(stream->told.by, by) != 0)
        write_view(stream, index, view->is_following, is_late, by);
    (void)send_text(room, member->connection, stream->told.text);
}

bool send_problem(struct room *room, void *connection, const char *to, int64_t view, int64_t input,
                  const struct problem *problem)
{
    struct message message = { .type = MESSAGE_PROBLEM };
    mem_put_text(message.problem.to, sizeof message.problem.to, to);
    message.problem.view = view;
    message.problem.input = input;
    message.problem.problem = problem_to_json(problem);
    bool is_sent = send_to_connection(room, connection, &message);
    message_finish(&message);
    room->counters.messages_refused++;
    return is_sent;
}

void send_missing(struct room *room, struct member *member, int index, const cJSON *missing)
{
    struct message message = { .type = MESSAGE_MISSING };
    cJSON *nothing = cJSON_CreateArray();
    cJSON *regions = cJSON_GetObjectItemCaseSensitive(missing, "regions");
    message.missing.view = index + 1;
    message.missing.n = (int64_t)json_number(missing, "n", 0);
    message.missing.regions = regions ? regions : nothing;
    send_to_member(room, member, &message);
    cJSON_Delete(nothing);
}

void send_bye_for(struct room *room, void *connection, const char *code, int retry_ms, const char *reason)
{
    struct message message = { .type = MESSAGE_BYE, .bye = { .has_retry_ms = retry_ms >= 0, .retry_ms = retry_ms } };
    const struct room_callbacks *callbacks = &room->callbacks;
    mem_put_text(message.bye.reason, sizeof message.bye.reason, reason);
    mem_put_text(message.bye.code, sizeof message.bye.code, code);
    if (!send_to_connection(room, connection, &message))
        return;
    if (strcmp(code, "sign-in") == 0 && callbacks->close_signed_out)
        callbacks->close_signed_out(callbacks->context, connection);
    else
        callbacks->close(callbacks->context, connection);
}

void send_bye(struct room *room, void *connection, int retry_ms, const char *reason)
{
    send_bye_for(room, connection, "", retry_ms, reason);
}
