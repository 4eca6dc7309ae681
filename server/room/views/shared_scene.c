/* Applies patches to the shared scene. */
#include "server/room/views/shared_scene.h"

#include "server/room/out/audit.h"
#include "server/room/out/send.h"
#include "server/room/state/event.h"
#include "server/room/state/member_list.h"
#include "server/room/streams/main_view.h"
#include "server/room/streams/pictures.h"
#include "server/room/streams/stream.h"
#include "server/room/views/marks.h"
#include "server/room/views/member_view.h"
#include "server/wire/bookmark.h"
#include "server/wire/json_merge.h"
#include "server/wire/patch.h"

/* Whether a patch can change what is recorded. */
static bool may_be_audited(const cJSON *patch)
{
    return cJSON_HasObjectItem(patch, "dose") || cJSON_HasObjectItem(patch, "beam");
}

static bool apply(struct room *room, const cJSON *patch, struct member *by, uint32_t input, struct problem *problem)
{
    cJSON *scene = scene_document_patch(room->shared.plan, room->shared.defaults, room->shared.scene, patch, problem);
    if (!scene)
        return false;
    bool has_changed = !json_equal(scene, room->shared.scene);
    const bool is_audited = has_changed && may_be_audited(patch) && audit_is_of_scene(room->shared.scene, scene);
    if (is_audited && !audit_has_place(room, problem)) {
        cJSON_Delete(scene);
        return false;
    }
    cJSON *told = patch_told(room->shared.scene, scene, patch);
    if (!told) {
        cJSON_Delete(scene);
        return json_no_memory(problem, "a scene");
    }
    cJSON *before = room->shared.scene;
    room->shared.scene = scene;
    if (has_changed) {
        room->shared.revision++;
        room->shared.is_changed = true;
        room_event(room, ROOM_SCENE, NULL);
        if (is_audited)
            audit_scene(room, before, by ? by : room->call.by);
        streams_scene_changed(room, before, patch);
        room->callbacks.scene_changed(room->callbacks.context, room, room->shared.scene, room->shared.revision);
    }
    cJSON_Delete(before);
    for (int i = 0; by && i < ROOM_MAX_VIEWS; i++) {
        if (has_changed && by->views[i].stream && !by->views[i].stream->is_reached)
            continue; /* the scene message says so */
        view_add_input(&by->views[i], input);
        stream_send_picture(room, by, &by->views[i]);
    }
    send_scene_patch(room, told, by, input,
                     has_changed); /* a patch that changed nothing is answered to its sender only */
    return true;
}

bool scene_show(struct room *room, cJSON *scene)
{
    cJSON *told = bookmark_difference(room->shared.scene, scene);
    if (!told) {
        cJSON_Delete(scene);
        return false;
    }
    cJSON *before = room->shared.scene;
    room->shared.scene = scene;
    if (told->child) {
        room->shared.revision++;
        room_event(room, ROOM_SCENE, NULL);
        streams_scene_changed(room, before, told);
        room->callbacks.scene_changed(room->callbacks.context, room, room->shared.scene, room->shared.revision);
        send_scene_patch(room, told, NULL, 0, true);
    } else {
        cJSON_Delete(told);
    }
    cJSON_Delete(before);
    return true;
}

bool scene_apply_patch(struct room *room, const cJSON *patch, struct member *by, uint32_t input,
                       struct problem *problem)
{
    if (!room->shared.scene) {
        problem_set(problem, PROBLEM_BUSY, "", "", "the plan is not loaded yet");
        if (problem)
            problem->retry_after_ms = 500;
        return false;
    }
    const struct member *author = by ? by : room->call.by;
    cJSON *authored = author ? marks_authored(room, author, patch) : NULL;
    if (author && !authored)
        return json_no_memory(problem, "a scene");
    const bool is_done = apply(room, authored ? authored : patch, by, input, problem);
    cJSON_Delete(authored);
    return is_done;
}

bool member_scene_patch(struct room *room, struct member *member, const struct message *message,
                        struct problem *problem)
{
    const struct message_scene_patch *patch = &message->scene_patch;
    if (!member_presents(room, member) && !marks_are_own(room, member, patch->patch, problem))
        return false;
    struct stream *acted = patch->view > 0 ? member->views[patch->view - 1].stream : NULL;
    if (acted) {
        acted->acted_us = room->now_us;
        main_view_scene_patched(member, (int)patch->view, patch->patch);
    }
    return scene_apply_patch(room, patch->patch, member, (uint32_t)patch->input, problem);
}
