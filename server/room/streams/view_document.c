/* Documents of views: which are alike, with which a room begins, whether their overrides fit, and the scenes that these
 * make. */
#include "server/room/streams/stream.h"

#include <string.h>

#include "core/base/log.h"

int view_kind(const cJSON *view)
{
    const char *word = json_text(view, "kind");
    for (size_t i = 0; word && i < scene_kind_words.n; i++)
        if (strcmp(word, scene_kind_words.words[i]) == 0)
            return (int)i;
    return SCENE_KIND_3D;
}

bool views_are_alike(const cJSON *a, const cJSON *b)
{
    const char *plane_a = json_text(a, "plane"), *plane_b = json_text(b, "plane");
    if (view_kind(a) != view_kind(b) || json_number(a, "number", 1) != json_number(b, "number", 1))
        return false;
    return view_kind(a) != SCENE_KIND_OBLIQUE || strcmp(plane_a ? plane_a : "", plane_b ? plane_b : "") == 0;
}

static bool has_camera(const cJSON *document)
{
    const cJSON *camera = cJSON_GetObjectItemCaseSensitive(document, "camera");
    static const char *const fields[] = { "position_mm", "target_mm", "up", "height_mm" };
    for (size_t i = 0; i < sizeof fields / sizeof fields[0]; i++) {
        const cJSON *field = cJSON_GetObjectItemCaseSensitive(camera, fields[i]);
        if (field && !cJSON_IsNull(field))
            return true;
    }
    return false;
}

cJSON *stream_first_view(const struct room *room, cJSON *document)
{
    const cJSON *entry;
    cJSON_ArrayForEach(entry, room->beginning.views)
    {
        const cJSON *first = cJSON_GetObjectItemCaseSensitive(entry, "document");
        if (!views_are_alike(first, document) || has_camera(document))
            continue;
        cJSON *patch = cJSON_CreateObject();
        json_add(patch, "camera", cJSON_Duplicate(cJSON_GetObjectItemCaseSensitive(first, "camera"), true));
        json_add(patch, "beam", cJSON_Duplicate(cJSON_GetObjectItemCaseSensitive(first, "beam"), true));
        cJSON *view = view_document_patch(document, patch, NULL);
        cJSON_Delete(patch);
        if (!view)
            return document; /* no memory: the home camera */
        cJSON_Delete(document);
        return view;
    }
    return document;
}

bool view_has_override(const cJSON *view)
{
    const cJSON *override = cJSON_GetObjectItemCaseSensitive(view, "override");
    return cJSON_IsObject(override) && override->child;
}

bool override_is_valid(const struct room *room, const cJSON *view, struct problem *problem)
{
    if (!room->shared.scene || !view_has_override(view))
        return true; /* not known before the plan is; checked then by streams_remove_bad_overrides */
    cJSON *shown = scene_document_for_view(room->shared.plan, room->shared.defaults, room->shared.scene, view, problem);
    cJSON_Delete(shown);
    return shown != NULL;
}

/* False: no memory for the scene with the view's override, and without that nothing is drawn. */
static bool make_scene(struct room *room, struct stream *stream)
{
    if (!stream->scene_is_stale)
        return true;
    struct problem problem = { 0 };
    cJSON *scene = view_has_override(stream->view) ? scene_document_for_view(room->shared.plan, room->shared.defaults,
                                                                             room->shared.scene, stream->view, &problem)
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
    if (!room->shared.scene || !make_scene(room, stream))
        return NULL;
    return stream->scene ? stream->scene : room->shared.scene;
}
