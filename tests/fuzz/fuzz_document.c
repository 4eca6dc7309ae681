/* Merge patches on scene and view, from WebSocket and HTTP bodies. An odd first byte patches the view instead of the
 * scene. */
#include "server/wire/document.h"
#include "tests/fuzz/fuzz.h"

static cJSON *plan_of_scenes(void)
{
    static const char text[] =
        "{\"images\":[{\"id\":\"ct\"},{\"id\":\"mr-1\"}],\"regions\":[{\"id\":\"scalp\"},{\"id\":\"brain\"},{\"id\":\"tumour\"}],"
        "\"doses\":[{\"id\":\"plan\"}]}";
    return json_read(text, strlen(text), NULL);
}

/* Defaults that a renderer could give for a plan with three regions. */
static cJSON *plan_defaults(void)
{
    struct scene scene = scene_default;
    struct scene_region_style_entry entries[3] = { { "scalp", scene_region_style_default },
                                                   { "brain", scene_region_style_default },
                                                   { "tumour", scene_region_style_default } };
    scene.n_regions = 3;
    scene.regions = entries;
    cJSON *json = scene_write(&scene);
    REQUIRE(json);
    return json;
}

static void scene_patch(const cJSON *plan, const cJSON *defaults, const cJSON *patch)
{
    struct problem problem = { 0 };
    cJSON *document = scene_document_patch(plan, defaults, defaults, patch, &problem);
    if (!document) {
        REQUIRE(problem.type != PROBLEM_NONE && problem.detail[0] != '\0');
        return;
    }
    struct scene scene;
    REQUIRE(scene_read(document, &scene, &problem));
    REQUIRE(scene.n_regions == 3);
    scene_finish(&scene);

    cJSON *nothing = cJSON_CreateObject();
    cJSON *same = scene_document_patch(plan, defaults, document, nothing, &problem);
    REQUIRE(same && cJSON_Compare(document, same, true));
    cJSON_Delete(same);
    cJSON_Delete(nothing);
    cJSON_Delete(document);
}

static void view_patch(const cJSON *plan, const cJSON *defaults, const cJSON *patch)
{
    struct problem problem = { 0 };
    cJSON *document = view_document_patch(NULL, patch, &problem);
    if (!document) {
        REQUIRE(problem.type != PROBLEM_NONE && problem.detail[0] != '\0');
        return;
    }
    struct view view;
    REQUIRE(view_read(document, &view, &problem));
    REQUIRE(view.size_px[0] > 0 && view.size_px[1] > 0);
    view_finish(&view);

    cJSON *scene = scene_document_for_view(plan, defaults, defaults, document, &problem);
    if (scene) {
        struct scene read;
        REQUIRE(scene_read(scene, &read, &problem));
        scene_finish(&read);
        cJSON_Delete(scene);
    }
    cJSON_Delete(document);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    if (n < 1)
        return 0;
    struct problem problem = { 0 };
    cJSON *patch = json_read((const char *)data + 1, n - 1, &problem);
    if (!patch) {
        REQUIRE(problem.type != PROBLEM_NONE && problem.detail[0] != '\0');
        return 0;
    }
    cJSON *plan = plan_of_scenes(), *defaults = plan_defaults();
    (data[0] % 2 == 0 ? scene_patch : view_patch)(plan, defaults, patch);
    cJSON_Delete(plan);
    cJSON_Delete(defaults);
    cJSON_Delete(patch);
    return 0;
}
