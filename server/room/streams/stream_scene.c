/* Overrides of views: whether they fit, and the scenes that they make. */
#include "core/base/log.h"
#include "server/room/streams/stream.h"

bool view_has_override(const cJSON *view)
{
    const cJSON *override = cJSON_GetObjectItemCaseSensitive(view, "override");
    return cJSON_IsObject(override) && override->child;
}

bool override_is_valid(const struct room *room, const cJSON *view, struct problem *problem)
{
    if (!room->scene || !view_has_override(view))
        return true; /* not known before the plan is; checked then by streams_remove_bad_overrides */
    cJSON *shown = scene_document_for_view(room->plan, room->defaults, room->scene, view, problem);
    cJSON_Delete(shown);
    return shown != NULL;
}

/* False: no memory for the scene with the view's override, and without that nothing is drawn. */
static bool make_scene(struct room *room, struct stream *stream)
{
    if (!stream->scene_is_stale)
        return true;
    struct problem problem = { 0 };
    cJSON *scene = view_has_override(stream->view)
                       ? scene_document_for_view(room->plan, room->defaults, room->scene, stream->view, &problem)
                       : NULL;
    if (problem.type == PROBLEM_INTERNAL)
        return false;
    if (problem.type != PROBLEM_NONE) /* a bug: overrides are checked when they are set and when a plan is loaded */
        log_error("room %s: a view's override does not apply: %s", room->id, problem.detail);
    cJSON_Delete(stream->scene);
    stream->scene = scene;
    stream->scene_is_stale = false;
    return true;
}

const cJSON *stream_scene(struct room *room, struct stream *stream)
{
    if (!room->scene || !make_scene(room, stream))
        return NULL;
    return stream->scene ? stream->scene : room->scene;
}
