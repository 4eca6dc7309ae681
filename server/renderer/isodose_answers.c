/* The answer to the question isodose: figures of a level's surface, or the surface as a file. */
#include <math.h>
#include <string.h>

#include "core/scene/isodoses.h"
#include "core/surface/mesh_export.h"
#include "server/renderer/answers.h"
#include "server/renderer/dose_answers.h"
#include "server/wire/json.h"
#include "server/wire/sentence_json.h"
#include "wire_gen.h"

static bool find_level(const struct snapshot *snapshot, const char *id, size_t *level, struct problem *problem)
{
    for (*level = 0; *level < snapshot->scene.dose.n_levels; ++*level)
        if (strcmp(snapshot->scene.dose.levels[*level].id, id) == 0)
            return true;
    return problem_set(problem, PROBLEM_NOT_FOUND, "/level", "", "the scene has no level \"%.64s\"", id);
}

static const char *algorithm_word(const struct snapshot *snapshot)
{
    return scene_algorithm_words.words[snapshot->scene.surface.algorithm];
}

static uint8_t *write_file(const struct snapshot *snapshot, const struct isodose *isodose, const struct mesh *mesh,
                           enum mesh_format format, size_t *n_bytes, struct error *err)
{
    uint32_t rgb = isodose->color_rgb;
    const struct mesh_export_about about = { .plan_id = snapshot->plan->id,
                                             .region_id = snapshot->scene.dose.levels[isodose->subject.index].id,
                                             .algorithm = algorithm_word(snapshot),
                                             .is_phantom = snapshot->plan->is_phantom,
                                             .is_faceted = snapshot->scene.surface.normals == SCENE_NORMALS_FACE,
                                             .rgb = { (uint8_t)(rgb >> 16), (uint8_t)(rgb >> 8), (uint8_t)rgb } };
    return mesh_export(mesh, format, &about, PACKET_MAX_BLOB, n_bytes, err);
}

static void add_facts(cJSON *json, const struct isodose_shape *made)
{
    struct shape_facts facts = { .area_mm2 = NAN, .volume_mm3 = NAN };
    if (made)
        isodose_shape_measure(made, &facts);
    json_add_finite(json, "triangles", made ? (double)facts.n_triangles : NAN);
    json_add_finite(json, "vertices", made ? (double)facts.n_vertices : NAN);
    json_add_finite(json, "area_mm2", facts.area_mm2);
    json_add_finite(json, "volume_mm3", facts.volume_mm3);
    json_add_finite(json, "ms", made ? facts.build_ms : NAN);
}

/* Answers the dose's basis and {level, value, grid, algorithm, triangles, vertices, area_mm2, volume_mm3, ms,
 * level_reason}; of a file {format} and its bytes. */
cJSON *answer_isodose(struct question *question, struct derive *derived, struct problem *problem)
{
    const struct snapshot *snapshot = question->snapshot;
    const char *word = question->packet.isodose.format;
    enum mesh_format format = MESH_STL;
    bool is_file = word[0] && strcmp(word, "json") != 0;
    size_t level;
    if (is_file && !mesh_format_from_word(word, &format)) {
        (void)problem_set(problem, PROBLEM_VALIDATION, "/format", "enum", "\"%.40s\" is not json, stl, ply or glb",
                          word);
        return NULL;
    }
    if (!dose_is_there(snapshot, problem) || !find_level(snapshot, question->packet.isodose.level, &level, problem))
        return NULL;
    struct error err = { 0 };
    struct dose_scale scale;
    struct isodose isodose = { .choice.value = NAN };
    struct isodose_shape *made = NULL;
    if (!dose_scale_of(snapshot, &scale))
        err = scale.why;
    else if (isodose_of_level(snapshot, &scale, level, &isodose, &err))
        made = isodose_shape_get(derived, &isodose.choice, SURFACE_FULL, &err);
    cJSON *json = cJSON_CreateObject();
    bool is_good = made || (!is_file && err.code != ERROR_MEMORY);
    if (is_file && made) {
        cJSON_AddStringToObject(json, ANSWER_MESH, mesh_format_word(format));
        question->file = write_file(snapshot, &isodose, made->shape->mesh, format, &question->n_file, &err);
        is_good = question->file != NULL;
    } else if (is_good) {
        dose_add_basis(json, snapshot, &scale);
        cJSON_AddStringToObject(json, "level", question->packet.isodose.level);
        json_add_finite(json, "value", isodose.choice.value);
        cJSON_AddStringToObject(json, "grid", scene_isodose_grid_words.words[snapshot->scene.dose.surfaces.grid]);
        cJSON_AddStringToObject(json, "algorithm", algorithm_word(snapshot));
        add_facts(json, made);
        reason_add_json(json, "level_reason", made ? NULL : err.text);
    }
    if (made)
        derive_result_unref(&made->base);
    dose_scale_finish(&scale);
    if (is_good)
        return json;
    cJSON_Delete(json);
    (void)problem_from_error(problem, &err);
    return NULL;
}
