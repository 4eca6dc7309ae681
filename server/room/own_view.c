/* Copies a shared view for a member who leaves: size, scale, slice positions. */
#include "server/room/own_view.h"

#include <math.h>
#include <string.h>

#include "server/wire/json.h"

static const double least_height_mm = 0.1, largest_height_mm = 10000; /* of camera.height_mm in proto/scene.json */

static bool is_parallel(const cJSON *view, const cJSON *camera)
{
    const char *kind = json_text(view, "kind"), *projection = json_text(camera, "projection");
    return (kind && strcmp(kind, "3d") != 0) || (projection && strcmp(projection, "parallel") == 0);
}

/* Replaces or adds a member of object. Takes value, NULL for no memory. Returns it in its place, or NULL. */
static cJSON *set(cJSON *object, const char *name, cJSON *value)
{
    if (!value)
        return NULL;
    bool is_set = cJSON_GetObjectItemCaseSensitive(object, name)
                      ? cJSON_ReplaceItemInObjectCaseSensitive(object, name, value)
                      : cJSON_AddItemToObject(object, name, value);
    if (is_set)
        return value;
    cJSON_Delete(value);
    return NULL;
}

static int smaller_side(const cJSON *view)
{
    const cJSON *size = cJSON_GetObjectItemCaseSensitive(view, "size_px");
    int width = cJSON_GetArrayItem(size, 0)->valueint, height = cJSON_GetArrayItem(size, 1)->valueint;
    return width < height ? width : height;
}

static bool set_size(cJSON *view, const int size_px[2])
{
    cJSON *camera = cJSON_GetObjectItemCaseSensitive(view, "camera");
    double height_mm = json_number(camera, "height_mm", 0), before_px = smaller_side(view);
    if (!set(view, "size_px", cJSON_CreateIntArray(size_px, 2)))
        return false;
    if (height_mm <= 0 || !is_parallel(view, camera))
        return true;
    double own_mm = fmin(fmax(height_mm * smaller_side(view) / before_px, least_height_mm), largest_height_mm);
    return set(camera, "height_mm", cJSON_CreateNumber(own_mm)) != NULL;
}

/* The object `name` of an override, to set fields in. A view's override holds no null: merging removed them. */
static cJSON *object_in(cJSON *override, const char *name)
{
    cJSON *present = cJSON_GetObjectItemCaseSensitive(override, name);
    return cJSON_IsObject(present) ? present : set(override, name, cJSON_CreateObject());
}

static bool set_slices(cJSON *view, const cJSON *scene)
{
    static const char *const names[] = { "axial", "coronal", "sagittal" };
    const cJSON *image = cJSON_GetObjectItemCaseSensitive(scene, "image"),
                *shown = cJSON_GetObjectItemCaseSensitive(image, "slices");
    cJSON *override = object_in(view, "override"), *own_image = override ? object_in(override, "image") : NULL,
          *slices = own_image ? object_in(own_image, "slices") : NULL;
    for (size_t i = 0; slices && i < sizeof names / sizeof names[0]; i++) {
        double mm = json_number(cJSON_GetObjectItemCaseSensitive(shown, names[i]), "position_mm", 0);
        cJSON *slice = object_in(slices, names[i]);
        if (!slice || !set(slice, "position_mm", cJSON_CreateNumber(mm)))
            return false;
    }
    return slices != NULL;
}

cJSON *own_view(const cJSON *shared, const cJSON *scene, const int size_px[2], struct problem *problem)
{
    cJSON *view = cJSON_Duplicate(shared, true);
    if (view && set_size(view, size_px) && (!scene || set_slices(view, scene)))
        return view;
    cJSON_Delete(view);
    (void)json_no_memory(problem, "a view");
    return NULL;
}
