#include "server/wire/document.h"

#include <stdio.h>
#include <string.h>

/* The fields of a scene that name something of the plan, and where the plan document lists what there is. An empty id
 * names nothing. */
static const struct reference {
    const char *object, *id;        /* the field; id NULL: the keys of object are the ids */
    const char *list, *list_member; /* of the plan document; what a member is called */
} references[] = {
    { "regions", NULL, "regions", "region" },
    { "check", "region", "regions", "region" },
    { "image", "id", "images", "image" },
    { "dose", "id", "doses", "dose" },
};
enum { N_REFERENCES = sizeof references / sizeof references[0] };

/* The member of list with this id, or NULL. The search begins at *next and leaves it behind the member found: ids that
 * are asked for in the list's order are found at once. */
static const cJSON *find_member(const cJSON *list, const cJSON **next, const char *id)
{
    const cJSON *first = list ? list->child : NULL, *start = *next ? *next : first, *member = start;
    while (member) {
        const char *member_id = json_text(member, "id");
        const cJSON *after = member->next ? member->next : first;
        if (member_id && strcmp(member_id, id) == 0) {
            *next = after;
            return member;
        }
        member = after == start ? NULL : after;
    }
    return NULL;
}

static bool unknown_id(const struct reference *reference, const char *id, struct problem *problem)
{
    char pointer[160];
    (void)snprintf(pointer, sizeof pointer, "/%s/%s", reference->object, reference->id ? reference->id : id);
    return problem_set(problem, PROBLEM_VALIDATION, pointer, "unknown-id", "the plan has no %s \"%.63s\"",
                       reference->list_member, id);
}

/* Every id in the document, a scene whose fields were checked, must be the plan's. */
static bool ids_are_known(const cJSON *plan, const cJSON *document, struct problem *problem)
{
    for (size_t i = 0; i < N_REFERENCES; i++) {
        const struct reference *reference = &references[i];
        const cJSON *list = cJSON_GetObjectItemCaseSensitive(plan, reference->list), *next = NULL;
        const cJSON *object = cJSON_GetObjectItemCaseSensitive(document, reference->object), *member;
        if (reference->id) {
            const char *id = json_text(object, reference->id);
            if (id && id[0] && !find_member(list, &next, id))
                return unknown_id(reference, id, problem);
            continue;
        }
        cJSON_ArrayForEach(member, object)
        {
            if (!find_member(list, &next, member->string))
                return unknown_id(reference, member->string, problem);
        }
    }
    return true;
}

/* Takes ids the plan does not have out of a scene. */
static void remove_unknown_ids(const cJSON *plan, cJSON *document)
{
    for (size_t i = 0; i < N_REFERENCES; i++) {
        const struct reference *reference = &references[i];
        const cJSON *list = cJSON_GetObjectItemCaseSensitive(plan, reference->list), *next = NULL;
        cJSON *object = cJSON_GetObjectItemCaseSensitive(document, reference->object);
        const char *id = reference->id ? json_text(object, reference->id) : NULL;
        if (id && id[0] && !find_member(list, &next, id))
            cJSON_DeleteItemFromObjectCaseSensitive(object, reference->id);
        for (cJSON *member = reference->id || !object ? NULL : object->child, *following; member; member = following) {
            following = member->next;
            if (!find_member(list, &next, member->string))
                cJSON_Delete(cJSON_DetachItemViaPointer(object, member));
        }
    }
}

/* Members of the map that a merge left incomplete (a region's style with only "opacity") are completed from defaults by
 * laying the document over them: what the document does not say is the default's. */
static cJSON *check_scene(const cJSON *plan, const cJSON *defaults, cJSON *merged, struct problem *problem)
{
    struct scene scene;
    /* the checks run on what was said, so that the pointer names what the sender wrote */
    if (!fields_read(&scene_object, merged, NULL, &scene, problem)) {
        cJSON_Delete(merged);
        return NULL;
    }
    scene_finish(&scene);
    if (!ids_are_known(plan, merged, problem)) {
        cJSON_Delete(merged);
        return NULL;
    }
    cJSON *complete = json_merge(defaults, merged);
    cJSON_Delete(merged);
    return complete;
}

cJSON *scene_document_patch(const cJSON *plan, const cJSON *defaults, const cJSON *current, const cJSON *patch,
                            struct problem *problem)
{
    if (!cJSON_IsObject(patch)) {
        problem_set(problem, PROBLEM_VALIDATION, "", "type", "a merge patch on the scene must be an object");
        return NULL;
    }
    return check_scene(plan, defaults, json_merge(current, patch), problem);
}

cJSON *scene_document_renew(const cJSON *plan, const cJSON *defaults, const cJSON *current)
{
    cJSON *kept = cJSON_Duplicate(current, true);
    remove_unknown_ids(plan, kept);
    cJSON *scene = check_scene(plan, defaults, kept, NULL);
    return scene ? scene : cJSON_Duplicate(defaults, true);
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
        cJSON_AddItemToObject(told, field->string,
                              document_told_patch(cJSON_GetObjectItemCaseSensitive(document, field->string), field));
    return told;
}

cJSON *scene_document_for_view(const cJSON *plan, const cJSON *defaults, const cJSON *scene, const cJSON *view,
                               struct problem *problem)
{
    const cJSON *override = cJSON_GetObjectItemCaseSensitive(view, "override");
    if (!cJSON_IsObject(override))
        return cJSON_Duplicate(scene, true);
    cJSON *shown = check_scene(plan, defaults, json_merge(scene, override), problem);
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
