/* Which pictures a change of the scene reaches. */
#include "server/room/reach.h"

#include <string.h>

#include "server/wire/json_merge.h"

static const cJSON *field(const cJSON *object, const char *name)
{
    return cJSON_GetObjectItemCaseSensitive(object, name);
}

static bool is_one_of(const char *name, const char *const *names)
{
    for (; *names; names++)
        if (strcmp(name, *names) == 0)
            return true;
    return false;
}

static bool is_3d(const cJSON *view)
{
    const char *kind = json_text(view, "kind");
    return !kind || strcmp(kind, "3d") == 0;
}

/* True if the field differs; a NULL is a field that is not there. */
static bool differs(const cJSON *before, const cJSON *after)
{
    return before && after ? !json_equal(before, after) : before != after;
}

/* The name of the slice that a pane shows; NULL: none, or the oblique plane of this id. */
static const char *slice_of(const cJSON *view, const cJSON *scene)
{
    const char *kind = json_text(view, "kind"), *plane = json_text(view, "plane");
    if (!kind || strcmp(kind, "oblique") != 0)
        return kind;
    bool has_plane = plane && field(field(field(scene, "image"), "obliques"), plane);
    return has_plane ? NULL : "axial"; /* a plane that the scene does not have: core/scene/plane.h */
}

/* A plane in the patient: a 3-D view shows it while it is visible, its own pane always. */
static bool plane_reaches(const cJSON *view, bool is_own, const cJSON *before, const cJSON *after)
{
    if (is_3d(view))
        return json_flag(before, "visible", false) || json_flag(after, "visible", false);
    static const char *const geometry[] = { "position_mm", "origin_mm", "normal" };
    for (size_t i = 0; is_own && i < sizeof geometry / sizeof geometry[0]; i++)
        if (differs(field(before, geometry[i]), field(after, geometry[i])))
            return true;
    return false;
}

static bool planes_reach(const cJSON *view, const char *own, const cJSON *before, const cJSON *after,
                         const cJSON *patch)
{
    for (const cJSON *plane = patch->child; plane; plane = plane->next) {
        const cJSON *was = field(before, plane->string), *is = field(after, plane->string);
        if (differs(was, is) && plane_reaches(view, own && strcmp(own, plane->string) == 0, was, is))
            return true;
    }
    return false;
}

static bool image_reaches(const cJSON *view, const cJSON *before, const cJSON *after, const cJSON *patch)
{
    static const char *const in_3d[] = { "volume", "clipped", "cull_below", NULL };
    const cJSON *image_before = field(before, "image"), *image_after = field(after, "image");
    for (const cJSON *item = patch->child; item; item = item->next) {
        const char *name = item->string;
        const cJSON *was = field(image_before, name), *is = field(image_after, name);
        if (!differs(was, is))
            continue;
        if (cJSON_IsObject(item) && strcmp(name, "slices") == 0) {
            if (planes_reach(view, slice_of(view, after), was, is, item))
                return true;
        } else if (cJSON_IsObject(item) && strcmp(name, "obliques") == 0) {
            if (slice_of(view, before) != slice_of(view, after) ||
                planes_reach(view, json_text(view, "plane"), was, is, item))
                return true;
        } else if (!is_one_of(name, in_3d) || is_3d(view)) {
            return true;
        }
    }
    return false;
}

bool change_reaches(const cJSON *view, const cJSON *before, const cJSON *after, const cJSON *patch)
{
    static const char *const in_3d[] = { "axes", "clip", "still", NULL };
    static const char *const in_browser[] = { "measures", NULL };
    if (!cJSON_IsObject(patch))
        return true;
    for (const cJSON *item = patch->child; item; item = item->next) {
        const char *name = item->string;
        if (is_one_of(name, in_browser) || !differs(field(before, name), field(after, name)))
            continue;
        if (cJSON_IsObject(item) && strcmp(name, "image") == 0) {
            if (image_reaches(view, before, after, item))
                return true;
        } else if (!is_one_of(name, in_3d) || is_3d(view)) {
            return true;
        }
    }
    return false;
}
