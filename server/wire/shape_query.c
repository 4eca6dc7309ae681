/* Checks the parameters of the surface call: shape_query.h. */
#include "server/wire/shape_query.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "wire_gen.h"

const char *const shape_query_names[] = { "representation", "algorithm", "normals",  "outline",
                                          "inner_boundary", "order",     "sampling", "bins",
                                          "format",         "frames",    NULL };

/* Words of parameters that are not fields of the scene. The scene's own words are in the order of core's enums;
 * tests/unit/server/wire/test_shape_query.c checks that. */
static const struct field_words flags = { (const char *const[]){ "false", "true" }, 2 },
                                formats = { (const char *const[]){ "json", "stl", "ply", "glb" }, 4 };
/* The scene's methods that trace univels: its words without the last, "surface". */
enum { N_TRACED_METHODS = OUTLINE_MARCHING_SQUARES + 1 };

static bool refuse(struct problem *problem, const char *name, const char *found, const char *expected)
{
    char pointer[48];
    (void)snprintf(pointer, sizeof pointer, "/%s", name);
    return problem_set(problem, PROBLEM_VALIDATION, pointer, "enum", "%s is \"%.40s\", expected %s", name, found,
                       expected);
}

/* Index of a parameter's word in its list; start when the parameter is absent. */
static bool read_word(const cJSON *json, const char *name, const struct field_words *words, int start, int *at,
                      struct problem *problem)
{
    const char *word = json_text(json, name);
    char list[160] = "";
    *at = start;
    if (!word)
        return true;
    for (*at = 0; (size_t)*at < words->n; ++*at) {
        if (strcmp(word, words->words[*at]) == 0)
            return true;
        size_t used = strlen(list);
        (void)snprintf(list + used, sizeof list - used, "%s%s", used ? ", " : "", words->words[*at]);
    }
    return refuse(problem, name, word, list);
}

static bool read_whole(const cJSON *json, const char *name, int low, int high, int start, int *value,
                       struct problem *problem)
{
    const char *word = json_text(json, name);
    char *end;
    *value = start;
    if (!word)
        return true;
    long number = strtol(word, &end, 10);
    bool is_whole = word[0] >= '0' && word[0] <= '9' && *end == 0;
    if (is_whole && number >= low && number <= high) {
        *value = (int)number;
        return true;
    }
    char pointer[48];
    (void)snprintf(pointer, sizeof pointer, "/%s", name);
    return problem_set(problem, PROBLEM_VALIDATION, pointer, is_whole ? "range" : "type",
                       "%s is \"%.40s\", expected a whole number from %d to %d", name, word, low, high);
}

bool shape_query_read(const cJSON *json, struct shape_query *query, struct problem *problem)
{
    const struct scene *start = &scene_default;
    const struct field_words traced = { scene_outline_method_words.words, N_TRACED_METHODS };
    int representation, algorithm, outline, sampling, is_face, has_inner, format, order, bins, n_frames;
    if (!read_word(json, "representation", &scene_representation_words, REPRESENTATION_SURFACE, &representation,
                   problem) ||
        !read_word(json, "algorithm", &scene_algorithm_words, (int)start->surface.algorithm, &algorithm, problem) ||
        !read_word(json, "outline", &traced, OUTLINE_TRACED, &outline, problem) ||
        !read_word(json, "sampling", &scene_nurbs_sampling_words, NURBS_TRACES, &sampling, problem) ||
        !read_word(json, "inner_boundary", &flags, 0, &has_inner, problem) ||
        !read_word(json, "normals", &scene_normals_words, 0, &is_face, problem) ||
        !read_word(json, "format", &formats, 0, &format, problem) ||
        !read_whole(json, "order", 2, 4, (int)start->nurbs.order, &order, problem) ||
        !read_whole(json, "bins", 8, 360, (int)start->nurbs.bins, &bins, problem) ||
        !read_whole(json, "frames", 0, SHAPE_QUERY_MAX_FRAMES, 0, &n_frames, problem))
        return false;
    *query = (struct shape_query){ .key = { .representation = (enum region_representation)representation,
                                            .algorithm = (enum surface_algorithm)algorithm,
                                            .outline = (enum outline_method)outline,
                                            .has_inner_boundary = has_inner,
                                            .nurbs_order = order,
                                            .nurbs_sampling = (enum nurbs_sampling)sampling,
                                            .nurbs_bins = bins },
                                   .is_faceted = is_face,
                                   .is_file = format > 0,
                                   .n_frames = n_frames };
    shape_key_normalise(&query->key);
    const char *word = formats.words[format];
    if (query->is_file && !mesh_format_from_word(word, &query->format))
        return refuse(problem, "format", word, "json, stl, ply, glb");
    if (query->is_file && !shape_query_has_triangles(query))
        return problem_set(problem, PROBLEM_VALIDATION, "/format", "enum",
                           "%s has no triangles to write as %s, expected json",
                           scene_representation_words.words[representation], word);
    return true;
}

bool shape_query_has_triangles(const struct shape_query *query)
{
    enum region_representation r = query->key.representation;
    return r == REPRESENTATION_SURFACE || r == REPRESENTATION_UNIVELS || r == REPRESENTATION_NURBS ||
           r == REPRESENTATION_FAN;
}

static cJSON *add_object(cJSON *to, const char *name)
{
    return cJSON_AddObjectToObject(to, name);
}

cJSON *shape_query_scene(const struct shape_query *query, const char *region, const cJSON *scene)
{
    const struct shape_key *key = &query->key;
    cJSON *patch = cJSON_CreateObject(), *styles = add_object(patch, "regions");
    const cJSON *style;
    cJSON_ArrayForEach(style, cJSON_GetObjectItemCaseSensitive(scene, "regions"))
    {
        cJSON *own = add_object(styles, style->string);
        bool is_it = strcmp(style->string, region) == 0;
        cJSON_AddBoolToObject(own, "visible", is_it);
        if (is_it) {
            cJSON_AddStringToObject(own, "representation", scene_representation_words.words[key->representation]);
            cJSON_AddNumberToObject(own, "opacity", 1);
        }
    }
    if (key->representation == REPRESENTATION_SURFACE) {
        cJSON *surface = add_object(patch, "surface");
        cJSON_AddStringToObject(surface, "algorithm", scene_algorithm_words.words[key->algorithm]);
        cJSON_AddStringToObject(surface, "normals", scene_normals_words.words[query->is_faceted]);
    } else if (key->representation == REPRESENTATION_OUTLINE) {
        cJSON_AddStringToObject(add_object(patch, "outline"), "method", scene_outline_method_words.words[key->outline]);
    } else if (key->representation == REPRESENTATION_POINTS || key->representation == REPRESENTATION_SOLID) {
        cJSON_AddBoolToObject(add_object(patch, "points"), "inner_boundary", key->has_inner_boundary);
    } else if (key->representation == REPRESENTATION_NURBS) {
        cJSON *nurbs = add_object(patch, "nurbs");
        cJSON_AddNumberToObject(nurbs, "order", key->nurbs_order);
        cJSON_AddStringToObject(nurbs, "sampling", scene_nurbs_sampling_words.words[key->nurbs_sampling]);
        cJSON_AddNumberToObject(nurbs, "bins", key->nurbs_bins);
    }
    cJSON *slices = add_object(add_object(patch, "image"), "slices");
    static const char *const panes[] = { "axial", "coronal", "sagittal" };
    for (int i = 0; i < 3; i++)
        cJSON_AddBoolToObject(add_object(slices, panes[i]), "visible", false);
    return patch;
}
