/* Merge patches on the scene of a plan of many regions, as the net thread handles them: read, apply, compare, tell. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "server/wire/document.h"
#include "server/wire/json_merge.h"
#include "server/wire/patch.h"

enum { REPEATS = 5 };

struct made_plan {
    cJSON *plan, *defaults;
};

static cJSON *must(cJSON *json)
{
    if (!json)
        abort();
    return json;
}

static void region_id(char id[16], int i)
{
    (void)snprintf(id, 16, "region-%d", i);
}

static struct made_plan made_plan(int n_regions)
{
    struct made_plan made = { .plan = must(cJSON_CreateObject()) };
    cJSON *list = must(cJSON_AddArrayToObject(made.plan, "regions"));
    struct scene scene = scene_default;
    scene.n_regions = (size_t)n_regions;
    scene.regions = calloc(scene.n_regions, sizeof *scene.regions);
    if (!scene.regions)
        abort();
    for (int i = 0; i < n_regions; i++) {
        cJSON *region = must(cJSON_CreateObject());
        region_id(scene.regions[i].id, i);
        scene.regions[i].value = scene_region_style_default;
        cJSON_AddStringToObject(region, "id", scene.regions[i].id);
        cJSON_AddItemToArray(list, region);
    }
    made.defaults = must(scene_write(&scene));
    free(scene.regions);
    return made;
}

/* Text of a patch that touches n regions from first on; step -1 names them from the last one on. */
static char *patch_text(int first, int n, int step, double opacity)
{
    cJSON *patch = must(cJSON_CreateObject()), *regions = must(cJSON_AddObjectToObject(patch, "regions"));
    for (int i = 0; i < n; i++) {
        char id[16];
        region_id(id, step > 0 ? first + i : first + n - 1 - i);
        cJSON_AddNumberToObject(cJSON_AddObjectToObject(regions, id), "opacity", opacity);
    }
    char *text = json_write(patch);
    cJSON_Delete(patch);
    return text;
}

/* The scene after the patch; takes scene. */
static cJSON *handled(const struct made_plan *made, cJSON *scene, const char *text)
{
    struct problem problem = { 0 };
    cJSON *patch = must(json_read(text, strlen(text), &problem));
    cJSON *next = must(scene_document_patch(made->plan, made->defaults, scene, patch, &problem));
    if (json_equal(next, scene))
        abort(); /* every patch here changes something */
    cJSON *told = patch_told(scene, next, patch);
    free(json_write(told));
    cJSON_Delete(told);
    cJSON_Delete(patch);
    cJSON_Delete(scene);
    return next;
}

/* Least ms of several tries: one patch of all regions, or n patches of one region each. */
static double measure_ms(const struct made_plan *made, int n, int step, bool is_one_by_one)
{
    double best_ms = 1e9;
    for (int repeat = 0; repeat < REPEATS; repeat++) {
        cJSON *scene = must(cJSON_Duplicate(made->defaults, true));
        int n_texts = is_one_by_one ? n : 1;
        char **texts = calloc((size_t)n_texts, sizeof *texts);
        if (!texts)
            abort();
        for (int i = 0; i < n_texts; i++)
            texts[i] = patch_text(is_one_by_one ? i : 0, is_one_by_one ? 1 : n, step, 0.5);
        int64_t began_us = clock_now_us();
        for (int i = 0; i < n_texts; i++)
            scene = handled(made, scene, texts[i]);
        double ms = (double)(clock_now_us() - began_us) / 1e3;
        best_ms = ms < best_ms ? ms : best_ms;
        for (int i = 0; i < n_texts; i++)
            free(texts[i]);
        free(texts);
        cJSON_Delete(scene);
    }
    return best_ms;
}

static void print(const char *name, int n_regions, double ms)
{
    printf("{\"name\":\"%s, %d regions\",\"value\":%.3f,\"unit\":\"ms\"}\n", name, n_regions, ms);
}

int main(void)
{
    for (int n = 64; n <= 1024; n *= 4) {
        struct made_plan made = made_plan(n);
        print("patch of all regions", n, measure_ms(&made, n, 1, false));
        print("patch of all regions, last first", n, measure_ms(&made, n, -1, false));
        print("patch of one region", n, measure_ms(&made, n, 1, true) / n);
        cJSON_Delete(made.plan);
        cJSON_Delete(made.defaults);
    }
    return 0;
}
