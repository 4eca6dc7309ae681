/* Which pictures a change of the scene reaches. */
#include "server/room/state/reach.h"

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

static bool is_kind(const cJSON *view, const char *word)
{
    const char *kind = json_text(view, "kind");
    return kind && strcmp(kind, word) == 0;
}

/* A view into space: 3-D or along a beam. */
static bool is_3d(const cJSON *view)
{
    return !json_text(view, "kind") || is_kind(view, "3d") || is_kind(view, "beam");
}

/* True if the field differs; a NULL is a field that is not there. */
static bool differs(const cJSON *before, const cJSON *after)
{
    return before && after ? !json_equal(before, after) : before != after;
}

/* The name of the slice that a pane shows; NULL: none, or the oblique plane of this id. A beam slice is axial in a plan
 * without beams, and of the plan nothing is known here. */
static const char *slice_of(const cJSON *view, const cJSON *scene)
{
    const char *plane = json_text(view, "plane");
    if (is_kind(view, "beam-slice"))
        return "axial";
    if (!is_kind(view, "oblique"))
        return json_text(view, "kind");
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

/* True if the patient axes of 3-D views stand through the crosshair, whose place the slices have. */
static bool axes_follow_crosshair(const cJSON *scene)
{
    const cJSON *axes = field(scene, "axes");
    const char *form = json_text(axes, "form");
    return json_flag(axes, "visible", false) && form && strcmp(form, "crosshair") == 0;
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
            if ((is_3d(view) && axes_follow_crosshair(after)) ||
                planes_reach(view, slice_of(view, after), was, is, item))
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

/* ---- dose ------------------------------------------------------------------------------------------------------- */

static bool is_shown(const cJSON *object, const char *name)
{
    return json_flag(field(object, name), "visible", false);
}

static bool any_flag(const cJSON *map, const char *name)
{
    for (const cJSON *item = map ? map->child : NULL; item; item = item->next)
        if (json_flag(item, name, false))
            return true;
    return false;
}

/* True if a scene has planes in the 3-D view: slices, oblique planes, the beam slice, caps. */
static bool has_planes(const cJSON *scene)
{
    const cJSON *image = field(scene, "image");
    return any_flag(field(image, "slices"), "visible") || any_flag(field(image, "obliques"), "visible") ||
           any_flag(field(scene, "clip"), "enabled") || is_shown(field(scene, "beam"), "slice");
}

static bool has_dose_texture(const cJSON *scene)
{
    const cJSON *regions = field(scene, "regions");
    for (const cJSON *region = regions ? regions->child : NULL; region; region = region->next) {
        const char *texture = json_text(region, "texture");
        if (texture && strcmp(texture, "dose") == 0)
            return true;
    }
    return false;
}

/* A second dose may be shown as a wash and as lines. */
static bool shows_comparison(const cJSON *scene)
{
    const char *mode = json_text(field(field(scene, "dose"), "compare"), "mode");
    return mode && strcmp(mode, "none") != 0;
}

static bool shows_wash(const cJSON *view, const cJSON *scene)
{
    return (is_shown(field(scene, "dose"), "wash") || shows_comparison(scene)) &&
           (!is_3d(view) || has_planes(scene) || is_shown(field(scene, "image"), "volume") || has_dose_texture(scene));
}

static bool shows_lines(const cJSON *view, const cJSON *scene)
{
    return (is_shown(field(scene, "dose"), "lines") || shows_comparison(scene)) && (!is_3d(view) || has_planes(scene));
}

static bool shows_surfaces(const cJSON *view, const cJSON *scene)
{
    return is_shown(field(scene, "dose"), "surfaces") && is_3d(view);
}

static bool shows_coverage(const cJSON *view, const cJSON *scene)
{
    (void)view;
    return is_shown(field(scene, "dose"), "coverage");
}

/* True if the view's picture of a scene shows anything that depends on values of dose. */
static bool shows_dose(const cJSON *view, const cJSON *scene)
{
    return shows_wash(view, scene) || shows_lines(view, scene) || shows_surfaces(view, scene) ||
           shows_coverage(view, scene);
}

static bool dose_reaches(const cJSON *view, const cJSON *before, const cJSON *after, const cJSON *patch)
{
    static const struct {
        const char *name;
        bool (*shows)(const cJSON *view, const cJSON *scene);
    } parts[] = {
        { "wash", shows_wash }, { "lines", shows_lines }, { "surfaces", shows_surfaces }, { "coverage", shows_coverage }
    };
    const cJSON *dose_before = field(before, "dose"), *dose_after = field(after, "dose");
    for (const cJSON *item = patch->child; item; item = item->next) {
        const char *name = item->string;
        bool (*shows)(const cJSON *, const cJSON *) = shows_dose;
        if (strcmp(name, "weights_name") == 0 || !differs(field(dose_before, name), field(dose_after, name)))
            continue;
        if (strcmp(name, "grid") == 0 || (strcmp(name, "id") == 0 && (json_flag(dose_before, "grid", false) ||
                                                                      json_flag(dose_after, "grid", false))))
            return true;
        for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++)
            if (strcmp(name, parts[i].name) == 0)
                shows = parts[i].shows;
        if (shows(view, before) || shows(view, after))
            return true;
    }
    return false;
}

/* ---- beams and tracks ------------------------------------------------------------------------------------------- */

static bool is_drafted(const cJSON *scene)
{
    return json_flag(field(field(scene, "beam"), "draft"), "enabled", false);
}

static bool shows_beams(const cJSON *scene)
{
    return is_drafted(scene) || any_flag(field(field(scene, "beam"), "looks"), "visible");
}

/* True if the view's picture of a scene lies along or across the chosen beam, or shows what does. */
static bool follows_beam(const cJSON *view, const cJSON *scene)
{
    return is_kind(view, "beam") || is_kind(view, "beam-slice") || shows_beams(scene) ||
           (is_3d(view) && (is_shown(field(scene, "beam"), "slice") ||
                            json_flag(field(field(scene, "clip"), "beam"), "enabled", false)));
}

static bool beam_slice_reaches(const cJSON *view, const cJSON *before, const cJSON *after)
{
    if (is_3d(view))
        return json_flag(before, "visible", false) || json_flag(after, "visible", false);
    return is_kind(view, "beam-slice") && differs(field(before, "along_mm"), field(after, "along_mm"));
}

static bool beam_reaches(const cJSON *view, const cJSON *before, const cJSON *after, const cJSON *patch)
{
    const cJSON *beam_before = field(before, "beam"), *beam_after = field(after, "beam");
    for (const cJSON *item = patch->child; item; item = item->next) {
        const char *name = item->string;
        const cJSON *was = field(beam_before, name), *is = field(beam_after, name);
        if (strcmp(name, "kept") == 0 || !differs(was, is))
            continue;
        bool reaches = true;
        if (strcmp(name, "slice") == 0)
            reaches = beam_slice_reaches(view, was, is);
        else if (strcmp(name, "opacity") == 0)
            reaches = shows_beams(before) || shows_beams(after);
        else if (strcmp(name, "draft") == 0)
            reaches =
                (is_drafted(before) || is_drafted(after)) && (follows_beam(view, before) || follows_beam(view, after));
        else if (strcmp(name, "id") == 0)
            reaches = follows_beam(view, before) || follows_beam(view, after);
        if (reaches)
            return true;
    }
    return false;
}

static bool tracks_reach(const cJSON *view, const cJSON *before, const cJSON *after)
{
    return is_3d(view) && (is_shown(before, "tracks") || is_shown(after, "tracks"));
}

/* ---- all -------------------------------------------------------------------------------------------------------- */

bool change_reaches(const cJSON *view, const cJSON *before, const cJSON *after, const cJSON *patch)
{
    static const char *const in_3d[] = { "axes", "clip", "lights", "space", "still", NULL };
    static const char *const in_browser[] = { "measures", "constraints", NULL };
    if (!cJSON_IsObject(patch))
        return true;
    for (const cJSON *item = patch->child; item; item = item->next) {
        const char *name = item->string;
        if (is_one_of(name, in_browser) || !differs(field(before, name), field(after, name)))
            continue;
        if (cJSON_IsObject(item) && strcmp(name, "image") == 0) {
            if (image_reaches(view, before, after, item))
                return true;
        } else if (cJSON_IsObject(item) && strcmp(name, "dose") == 0) {
            if (dose_reaches(view, before, after, item))
                return true;
        } else if (cJSON_IsObject(item) && strcmp(name, "beam") == 0) {
            if (beam_reaches(view, before, after, item))
                return true;
        } else if (strcmp(name, "tracks") == 0) {
            if (tracks_reach(view, before, after))
                return true;
        } else if (!is_one_of(name, in_3d) || is_3d(view)) {
            return true;
        }
    }
    return false;
}
