/* Scene and view: the tables of proto/scene.json given to patch.h and fields.h. */
#include "server/wire/document.h"

#include "server/wire/json_merge.h"
#include "server/wire/patch.h"

cJSON *scene_document_patch(const cJSON *plan, const cJSON *defaults, const cJSON *current, const cJSON *patch,
                            struct problem *problem)
{
    return patch_apply(&scene_object, plan, defaults, current, patch, problem);
}

cJSON *scene_document_renew(const cJSON *plan, const cJSON *defaults, const cJSON *current)
{
    return patch_renew(&scene_object, plan, defaults, current);
}

cJSON *scene_document_for_view(const cJSON *plan, const cJSON *defaults, const cJSON *scene, const cJSON *view,
                               struct problem *problem)
{
    const cJSON *override = cJSON_GetObjectItemCaseSensitive(view, "override");
    if (!cJSON_IsObject(override)) {
        cJSON *copy = cJSON_Duplicate(scene, true);
        if (!copy)
            json_no_memory(problem, "a scene");
        return copy;
    }
    cJSON *shown = patch_apply(&scene_object, plan, defaults, scene, override, problem);
    if (!shown && problem)
        problem_below(problem, "/override");
    return shown;
}

cJSON *view_document_patch(const cJSON *current, const cJSON *patch, struct problem *problem)
{
    if (!cJSON_IsObject(patch)) {
        problem_set(problem, PROBLEM_VALIDATION, "", "type", "a merge patch on the view must be an object");
        return NULL;
    }
    cJSON *merged = json_merge(current, patch);
    struct view view;
    bool ok = merged ? fields_read(&view_object, merged, NULL, &view, problem) : json_no_memory(problem, "a view");
    cJSON_Delete(merged);
    if (!ok)
        return NULL;
    cJSON *complete = fields_write(&view_object, &view);
    view_finish(&view);
    if (!complete)
        json_no_memory(problem, "a view");
    return complete;
}

bool scene_read(const cJSON *json, struct scene *scene, struct problem *problem)
{
    return fields_read(&scene_object, json, NULL, scene, problem);
}

bool view_read(const cJSON *json, struct view *view, struct problem *problem)
{
    return fields_read(&view_object, json, NULL, view, problem);
}

cJSON *scene_write(const struct scene *scene)
{
    return fields_write(&scene_object, scene);
}

cJSON *camera_write(const struct scene_camera *camera)
{
    return fields_write(&scene_camera_object, camera);
}
