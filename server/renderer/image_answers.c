/* Answers to questions about the values of an image: histogram, ellipse. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/derive/image_histogram.h"
#include "core/plan/fit.h"
#include "core/volume/ellipse.h"
#include "server/renderer/answers.h"
#include "server/wire/document.h"
#include "server/wire/json.h"

/* NULL with problem: the plan has no such image, or it is of another patient. */
static const struct plan_image *find_image(const struct plan *plan, const char *id, struct problem *problem)
{
    for (size_t i = 0; i < plan->n_images; i++)
        if (strcmp(plan->images[i].id, id) == 0 && fit_is_of_other(plan, (struct fit_part){ FIT_IMAGE, i })) {
            (void)problem_set(problem, PROBLEM_NOT_FOUND, "/image", "not-used",
                              "the image \"%.64s\" belongs to another patient than the one shown", id);
            return NULL;
        } else if (strcmp(plan->images[i].id, id) == 0)
            return &plan->images[i];
    (void)problem_set(problem, PROBLEM_NOT_FOUND, "/image", "", "the plan has no image \"%.64s\"", id);
    return NULL;
}

/* {image, unit, low, high, n, n_left_out, counts: [n_bins], percentiles: {"0.1", "1", "50", "99", "99.9"}} */
cJSON *answer_histogram(struct question *question, struct derive *derived, struct problem *problem)
{
    const struct plan *plan = derive_plan(derived);
    const struct plan_image *image = find_image(plan, question->packet.histogram.image, problem);
    size_t n_bins = (size_t)question->packet.histogram.bins;
    struct error err = { 0 };
    if (!image)
        return NULL;
    struct image_histogram *histogram = image_histogram_get(derived, (size_t)(image - plan->images), &err);
    uint64_t counts[IMAGE_HISTOGRAM_MAX_BINS];
    if (!histogram) {
        (void)problem_from_error(problem, &err);
        return NULL;
    }
    image_histogram_counts(histogram, n_bins, counts);
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "image", image->id);
    cJSON_AddStringToObject(json, "unit", image->unit);
    json_add_finite(json, "low", histogram->low);
    json_add_finite(json, "high", histogram->high);
    json_add_finite(json, "n", (double)histogram->n);
    json_add_finite(json, "n_left_out", (double)histogram->n_left_out);
    cJSON *list = cJSON_AddArrayToObject(json, "counts");
    for (size_t i = 0; i < n_bins; i++)
        cJSON_AddItemToArray(list, cJSON_CreateNumber((double)counts[i]));
    cJSON *percentiles = cJSON_AddObjectToObject(json, "percentiles");
    for (int i = 0; i < IMAGE_HISTOGRAM_N_PERCENTILES; i++) {
        char name[16];
        (void)snprintf(name, sizeof name, "%g", image_histogram_percents[i]);
        json_add_finite(percentiles, name, histogram->percentiles[i]);
    }
    derive_result_unref(&histogram->base);
    return json;
}

/* {image, unit, area_mm2, mean, sd, min, max, n, n_left_out, step_mm} */
cJSON *answer_ellipse(struct question *question, struct derive *derived, struct problem *problem)
{
    const struct plan_image *image = find_image(derive_plan(derived), question->packet.ellipse.image, problem);
    struct ellipse_values values;
    if (!image)
        return NULL;
    if (!ellipse_values(image->volume, question->packet.ellipse.center, question->packet.ellipse.a,
                        question->packet.ellipse.b, &values)) {
        (void)problem_set(problem, PROBLEM_VALIDATION, "/b", "range",
                          "center, a and b are on one line: there is no ellipse");
        return NULL;
    }
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "image", image->id);
    cJSON_AddStringToObject(json, "unit", image->unit);
    json_add_finite(json, "area_mm2", values.area_mm2);
    json_add_finite(json, "mean", values.mean);
    json_add_finite(json, "sd", values.sd);
    json_add_finite(json, "min", values.low);
    json_add_finite(json, "max", values.high);
    json_add_finite(json, "n", (double)values.n);
    json_add_finite(json, "n_left_out", (double)values.n_left_out);
    json_add_finite(json, "step_mm", values.step_mm);
    return json;
}
