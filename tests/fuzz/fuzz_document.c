/* HTTP bodies: a merge patch on the scene and on a view. What is accepted must be a scene that reads, and patching nothing onto it
 * must change nothing. */
#include <stdlib.h>

#include "server/wire/document.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    static const char *const images[] = { "ct", NULL };
    static cJSON *defaults;
    struct problem problem;
    if (!defaults) {
        struct scene scene = scene_default;
        struct scene_region_style_entry entries[2] = { { "brain", scene_region_style_default }, { "tumor", scene_region_style_default } };
        scene.regions = entries;
        scene.n_regions = 2;
        defaults = scene_write(&scene);
    }
    cJSON *patch = json_read((const char *)data, n, &problem);
    if (!patch)
        return 0;
    cJSON *scene = scene_document_patch(defaults, images, defaults, patch, &problem);
    if (scene) {
        struct scene decoded;
        if (!scene_read(scene, &decoded, &problem))
            abort();
        scene_finish(&decoded);
        cJSON *nothing = cJSON_CreateObject();
        cJSON *same = scene_document_patch(defaults, images, scene, nothing, &problem);
        if (!same || !cJSON_Compare(same, scene, true))
            abort();
        cJSON_Delete(same);
        cJSON_Delete(nothing);
        cJSON_Delete(scene);
    }
    cJSON *view = view_document_patch(NULL, patch, &problem);
    if (view) {
        cJSON_Delete(scene_document_for_view(defaults, images, defaults, view, &problem));
        cJSON_Delete(view);
    }
    cJSON_Delete(patch);
    return 0;
}
