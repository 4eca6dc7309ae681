#include "server/wire/document.h"

#include <stdio.h>
#include <string.h>

/* Region ids and the image id must be the plan's. */
static bool names_are_known(const cJSON *defaults, const char *const *image_ids, const cJSON *document, struct problem *problem)
{
    const cJSON *known = cJSON_GetObjectItemCaseSensitive(defaults, "regions");
    const cJSON *regions = cJSON_GetObjectItemCaseSensitive(document, "regions");
    const cJSON *region;
    cJSON_ArrayForEach(region, regions)
    {
        if (!cJSON_GetObjectItemCaseSensitive(known, region->string)) {
            char pointer[128];
            (void)snprintf(pointer, sizeof pointer, "/regions/%.63s", region->string);
            return problem_set(problem, PROBLEM_NOT_FOUND, pointer, "", "the plan has no region \"%.63s\"", region->string);
        }
    }
    const char *image = json_text(cJSON_GetObjectItemCaseSensitive(document, "image"), "id");
    if (!image || image[0] == 0)
        return true;
    for (const char *const *id = image_ids; id && *id; id++)
        if (strcmp(*id, image) == 0)
            return true;
    return problem_set(problem, PROBLEM_NOT_FOUND, "/image/id", "", "the plan has no image \"%.63s\"", image);
}

/* Members of the map that a merge left incomplete (a region's style with only "opacity") are completed from defaults by laying the
 * document over them: what the document does not say is the default's. */
static cJSON *check_scene(const cJSON *defaults, const char *const *image_ids, cJSON *merged, struct problem *problem)
{
    struct scene scene;
    /* the checks run on what was said, so that the pointer names what the sender wrote */
    if (!fields_read(&scene_object, merged, NULL, &scene, problem)) {
        cJSON_Delete(merged);
        return NULL;
    }
    scene_finish(&scene);
    if (!names_are_known(defaults, image_ids, merged, problem)) {
        cJSON_Delete(merged);
        return NULL;
    }
    cJSON *complete = json_merge(defaults, merged);
    cJSON_Delete(merged);
    return complete;
}

cJSON *scene_document_patch(const cJSON *defaults, const char *const *image_ids, const cJSON *current, const cJSON *patch,
                            struct problem *problem)
{
    if (!cJSON_IsObject(patch)) {
        problem_set(problem, PROBLEM_VALIDATION, "", "type", "a merge patch on the scene must be an object");
        return NULL;
    }
    return check_scene(defaults, image_ids, json_merge(current, patch), problem);
}

cJSON *document_told_patch(const cJSON *document, const cJSON *patch)
{
    if (cJSON_IsNull(patch) && document)
        return cJSON_Duplicate(document, true);
    if (!cJSON_IsObject(patch))
        return cJSON_Duplicate(patch, true);
    cJSON *told = cJSON_CreateObject();
    const cJSON *field;
    cJSON_ArrayForEach(field, patch)
        cJSON_AddItemToObject(told, field->string, document_told_patch(cJSON_GetObjectItemCaseSensitive(document, field->string), field));
    return told;
}

cJSON *scene_document_for_view(const cJSON *defaults, const char *const *image_ids, const cJSON *scene, const cJSON *view,
                               struct problem *problem)
{
    const cJSON *override = cJSON_GetObjectItemCaseSensitive(view, "override");
    if (!cJSON_IsObject(override))
        return cJSON_Duplicate(scene, true);
    cJSON *shown = check_scene(defaults, image_ids, json_merge(scene, override), problem);
    if (!shown && problem) { /* the place is inside the view's override */
        char pointer[sizeof problem->pointer];
        memcpy(pointer, problem->pointer, sizeof pointer);
        (void)snprintf(problem->pointer, sizeof problem->pointer, "/override%.*s", (int)sizeof pointer - 12, pointer);
    }
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
    bool ok = fields_read(&view_object, merged, NULL, &view, problem);
    cJSON_Delete(merged);
    if (!ok)
        return NULL;
    cJSON *complete = fields_write(&view_object, &view);
    view_finish(&view);
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
