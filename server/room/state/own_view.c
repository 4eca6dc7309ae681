/* Copies a shared view for a member who leaves: size, scale, slice positions, oblique plane. */
#include "server/room/state/own_view.h"

#include <math.h>
#include <string.h>

#include "server/wire/json.h"

static const double least_height_mm = 0.1, largest_height_mm = 10000; /* of camera.height_mm in proto/scene.json */

static bool is_parallel(const cJSON *view, const cJSON *camera)
{
    const char *kind = json_text(view, "kind"), *projection = json_text(camera, "projection");
    bool is_of_beam = kind && strcmp(kind, "beam") == 0, is_in_space = !kind || is_of_beam || strcmp(kind, "3d") == 0;
    const cJSON *beam = cJSON_GetObjectItemCaseSensitive(view, "beam");
    bool has_ring = is_of_beam && cJSON_IsNumber(cJSON_GetObjectItemCaseSensitive(beam, "aperture_mm"));
    return !is_in_space || has_ring || (projection && strcmp(projection, "parallel") == 0);
}

static int smaller_side(const cJSON *view)
{
    const cJSON *size = cJSON_GetObjectItemCaseSensitive(view, "size_px");
    int width = cJSON_GetArrayItem(size, 0)->valueint, height = cJSON_GetArrayItem(size, 1)->valueint;
    return width < height ? width : height;
}

static void set_size(cJSON *view, const int size_px[2])
{
    cJSON *camera = cJSON_GetObjectItemCaseSensitive(view, "camera"),
          *height = cJSON_GetObjectItemCaseSensitive(camera, "height_mm"),
          *size = cJSON_GetObjectItemCaseSensitive(view, "size_px");
    double before_px = smaller_side(view);
    for (int i = 0; i < 2; i++)
        cJSON_SetNumberValue(cJSON_GetArrayItem(size, i), size_px[i]);
    if (!cJSON_IsNumber(height) || !is_parallel(view, camera))
        return;
    double own_mm = height->valuedouble * smaller_side(view) / before_px;
    cJSON_SetNumberValue(height, fmin(fmax(own_mm, least_height_mm), largest_height_mm));
}

/* The object `name` of an override, made when there is none; NULL: no memory. An override holds no null: merging
 * removed them. */
static cJSON *object_in(cJSON *override, const char *name)
{
    cJSON *present = cJSON_GetObjectItemCaseSensitive(override, name);
    return present ? present : cJSON_AddObjectToObject(override, name);
}

static bool set_position(cJSON *slice, const char *name, double mm)
{
    cJSON *present = cJSON_GetObjectItemCaseSensitive(slice, name);
    if (!present)
        return cJSON_AddNumberToObject(slice, name, mm) != NULL;
    cJSON_SetNumberValue(present, mm);
    return true;
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
        if (!slice || !set_position(slice, "position_mm", mm))
            return false;
    }
    return slices != NULL;
}

/* Keeps the beam slice where it is. */
static bool set_beam_slice(cJSON *view, const cJSON *scene)
{
    const cJSON *beam = cJSON_GetObjectItemCaseSensitive(scene, "beam"),
                *shown = cJSON_GetObjectItemCaseSensitive(beam, "slice");
    if (!shown)
        return true;
    cJSON *override = object_in(view, "override"), *own_beam = override ? object_in(override, "beam") : NULL,
          *slice = own_beam ? object_in(own_beam, "slice") : NULL;
    return slice && set_position(slice, "along_mm", json_number(shown, "along_mm", 0));
}

/* Keeps the plane of an oblique view where it is; a plane that the scene does not have stays the axial slice. */
static bool set_oblique(cJSON *view, const cJSON *scene)
{
    static const char *const fields[] = { "origin_mm", "normal" };
    const char *kind = json_text(view, "kind"), *id = json_text(view, "plane");
    const cJSON *image = cJSON_GetObjectItemCaseSensitive(scene, "image"),
                *planes = cJSON_GetObjectItemCaseSensitive(image, "obliques"),
                *shown = id ? cJSON_GetObjectItemCaseSensitive(planes, id) : NULL;
    if (!kind || strcmp(kind, "oblique") != 0 || !shown)
        return true;
    cJSON *override = object_in(view, "override"), *own_image = override ? object_in(override, "image") : NULL,
          *own_planes = own_image ? object_in(own_image, "obliques") : NULL,
          *plane = own_planes ? object_in(own_planes, id) : NULL;
    for (size_t i = 0; plane && i < sizeof fields / sizeof fields[0]; i++) {
        cJSON *copy = cJSON_Duplicate(cJSON_GetObjectItemCaseSensitive(shown, fields[i]), true);
        cJSON_DeleteItemFromObjectCaseSensitive(plane, fields[i]);
        if (!copy || !cJSON_AddItemToObject(plane, fields[i], copy)) {
            cJSON_Delete(copy);
            return false;
        }
    }
    return plane != NULL;
}

cJSON *own_view(const cJSON *shared, const cJSON *scene, const int size_px[2], struct problem *problem)
{
    cJSON *view = cJSON_Duplicate(shared, true);
    if (view)
        set_size(view, size_px);
    if (view && (!scene || (set_slices(view, scene) && set_beam_slice(view, scene) && set_oblique(view, scene))))
        return view;
    cJSON_Delete(view);
    (void)json_no_memory(problem, "a view");
    return NULL;
}
