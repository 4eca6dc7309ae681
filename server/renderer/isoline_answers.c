/* Answers to the question about isodose lines: their labels. */
#include <math.h>
#include <stdio.h>

#include "core/render/visible/isoline_labels.h"
#include "server/renderer/answers.h"
#include "server/wire/document.h"
#include "server/wire/json.h"

static void add_labels(cJSON *json, const struct isoline_labels *labels, size_t level)
{
    cJSON *list = cJSON_AddArrayToObject(json, "labels");
    for (size_t i = 0; i < labels->n; i++) {
        const struct label_place *place = &labels->labels[i].place;
        if (labels->labels[i].level != level)
            continue;
        cJSON *label = cJSON_CreateObject();
        json_add_finite(label, "x_px", place->x_px);
        json_add_finite(label, "y_px", place->y_px);
        json_add_finite(label, "angle_deg", place->angle_deg);
        json_add_finite(label, "width_px", place->width_px);
        json_add_finite(label, "height_px", place->height_px);
        cJSON_AddItemToArray(list, label);
    }
}

/* {unit, levels: [{id, value, percent, color, text, labels: [{x_px, y_px, angle_deg, width_px, height_px}]}]} */
cJSON *answer_isolines(struct question *question, struct derive *derived, struct problem *problem)
{
    const struct snapshot *snapshot = question->snapshot;
    struct isoline_scene lines;
    struct isoline_labels labels = { .n = 0 };
    struct error err = { 0 };
    (void)derived;
    bool has_lines = isoline_scene_init(&lines, snapshot);
    enum isoline_labels_for what = question->packet.isolines.choice ? ISOLINE_LABELS_CHOICE : ISOLINE_LABELS_TURNED;
    if (has_lines && !isoline_labels_place(&labels, snapshot, &lines, question->packet.isolines.text_px, what, &err)) {
        isoline_scene_finish(&lines);
        (void)problem_from_error(problem, &err);
        return NULL;
    }
    const char *unit = has_lines ? lines.doses[0].field->unit : "";
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "unit", unit);
    cJSON *list = cJSON_AddArrayToObject(json, "levels");
    for (size_t i = 0; i < lines.n_levels; i++) {
        const struct scene_dose_level_entry *level = &snapshot->scene.dose.levels[lines.levels[i].index];
        char text[ISOLINE_TEXT_SIZE], color[8];
        isoline_text(text, &level->value, unit);
        (void)snprintf(color, sizeof color, "#%06x", (unsigned)level->value.color_rgb & 0xffffffu);
        cJSON *item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "id", level->id);
        json_add_finite(item, "value", lines.levels[i].value);
        json_add_finite(item, "percent", 100 * lines.levels[i].value / lines.reference);
        cJSON_AddStringToObject(item, "color", color);
        cJSON_AddStringToObject(item, "text", text);
        add_labels(item, &labels, lines.levels[i].index);
        cJSON_AddItemToArray(list, item);
    }
    isoline_scene_finish(&lines);
    return json;
}
