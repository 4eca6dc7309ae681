/* Answers the questions about particle tracks: counts, files, lost particles with their regions, and the segment under
 * a pixel. */
#include <math.h>

#include "core/pick/pick_tracks.h"
#include "core/scene/scene_probe.h"
#include "core/scene/tracks_shown.h"
#include "server/renderer/answers.h"
#include "server/wire/json.h"
#include "server/wire/sentence_json.h"

static struct vec3 point_of(const float p[3])
{
    return vec3((double)p[0], (double)p[1], (double)p[2]);
}

static cJSON *point(struct vec3 p)
{
    return cJSON_CreateDoubleArray((double[3]){ p.x, p.y, p.z }, 3);
}

/* The innermost region at a point. Adds its id, or null; false: the point is outside all regions. */
static bool add_region(cJSON *json, const char *name, const struct snapshot *snapshot, struct vec3 at)
{
    struct plan_probe probe;
    scene_probe(snapshot, at, &probe);
    cJSON_AddItemToObject(json, name,
                          probe.n_regions ? cJSON_CreateString(snapshot->plan->regions.regions[probe.regions[0]].id)
                                          : cJSON_CreateNull());
    return probe.n_regions > 0;
}

/* Counts of one pass over all segments. */
struct track_counts {
    size_t n_shown, n_with_energy, n_lost;
    double energy_low_mev, energy_high_mev;
};

static struct track_counts count(const struct snapshot *snapshot)
{
    const struct track_set *set = &snapshot->plan->tracks;
    const struct tracks_shown shown = tracks_shown_of(set, &snapshot->scene.tracks);
    struct track_counts counts = { .n_lost = set->n_of_class[TRACK_LOST],
                                   .energy_low_mev = INFINITY,
                                   .energy_high_mev = -INFINITY };
    for (size_t i = 0; i < set->n_segments; i++) {
        const struct track_segment *segment = &set->segments[i];
        counts.n_shown += i >= shown.first && i < shown.end && track_is_shown(&shown, segment);
        if (isnan(segment->energy_mev))
            continue;
        counts.n_with_energy++;
        counts.energy_low_mev = fmin(counts.energy_low_mev, (double)segment->energy_mev);
        counts.energy_high_mev = fmax(counts.energy_high_mev, (double)segment->energy_mev);
    }
    return counts;
}

static void add_files(cJSON *json, const struct track_set *set)
{
    cJSON *files = cJSON_AddArrayToObject(json, "files");
    size_t first = 0;
    for (size_t i = 0; i < set->n_files; i++) {
        cJSON *file = cJSON_CreateObject();
        cJSON_AddStringToObject(file, "path", set->files[i].path);
        json_add_finite(file, "first", (double)first);
        json_add_finite(file, "segments", (double)set->files[i].n_segments);
        cJSON_AddStringToObject(file, "unit", set->files[i].unit_mm == 10 ? "cm" : "mm");
        cJSON_AddItemToArray(files, file);
        first += set->files[i].n_segments;
    }
}

static void add_lost(cJSON *json, const struct snapshot *snapshot, size_t most)
{
    const struct track_set *set = &snapshot->plan->tracks;
    cJSON *lost = cJSON_AddArrayToObject(json, "lost");
    size_t n = 0, n_all = set->n_of_class[TRACK_LOST];
    for (size_t i = 0; i < set->n_segments && n < most && n < n_all; i++) {
        const struct track_segment *segment = &set->segments[i];
        if (segment->class != TRACK_LOST)
            continue;
        const struct vec3 from = point_of(segment->from_lps_mm), to = point_of(segment->to_lps_mm);
        cJSON *item = cJSON_CreateObject();
        json_add_finite(item, "segment", (double)i);
        bool is_inside = add_region(item, "region", snapshot, from);
        reason_add_json(item, "reason", is_inside ? NULL : "outside all regions");
        cJSON_AddItemToObject(item, "from_lps_mm", point(from));
        cJSON_AddItemToObject(item, "to_lps_mm", point(to));
        json_add_finite(item, "energy_mev", (double)segment->energy_mev);
        cJSON_AddItemToArray(lost, item);
        n++;
    }
    json_add_finite(json, "lost_left_out", (double)(n_all - n));
}

/* {segments, counts, shown, energies: {segments, low_mev, high_mev}, files: [{path, first, segments, unit}],
 * lost: [{segment, region, reason, from_lps_mm, to_lps_mm, energy_mev}], lost_left_out} */
cJSON *answer_tracks(struct question *question, struct derive *derived, struct problem *problem)
{
    const struct plan *plan = derive_plan(derived);
    const struct track_set *set = &plan->tracks;
    const struct track_counts counted = count(question->snapshot);
    const struct scene_fits *fits = &question->snapshot->fits;
    bool is_used = fit_is_used(&fits->tracks);
    char why[FIT_WHY_SIZE];
    cJSON *json = cJSON_CreateObject();
    (void)problem;
    json_add_finite(json, "segments", (double)set->n_segments);
    cJSON *counts = cJSON_AddObjectToObject(json, "counts");
    for (int class = 0; class < TRACK_N_CLASSES; class ++)
        json_add_finite(counts, track_class_word((enum track_class) class), (double)set->n_of_class[class]);
    json_add_finite(json, "shown", is_used ? (double)counted.n_shown : 0);
    fit_use_sentence(fits, (struct fit_part){ FIT_TRACKS, 0 }, &fits->tracks, why);
    cJSON_AddItemToObject(json, "reason", is_used ? cJSON_CreateNull() : cJSON_CreateString(why));
    cJSON *energies = cJSON_AddObjectToObject(json, "energies");
    json_add_finite(energies, "segments", (double)counted.n_with_energy);
    json_add_finite(energies, "low_mev", counted.energy_low_mev);
    json_add_finite(energies, "high_mev", counted.energy_high_mev);
    add_files(json, set);
    add_lost(json, question->snapshot, is_used ? (size_t)question->packet.tracks.lost : 0);
    return json;
}

/* {segment, class, energy_mev, length_mm, from_lps_mm, to_lps_mm, from_region, to_region, file, file_segment,
 * point_lps_mm, distance_mm, distance_px}; all null where no segment is near */
cJSON *answer_track(struct question *question, struct derive *derived, struct problem *problem)
{
    static const char *const names[] = { "segment",      "class",       "energy_mev", "length_mm", "from_lps_mm",
                                         "to_lps_mm",    "from_region", "to_region",  "file",      "file_segment",
                                         "point_lps_mm", "distance_mm", "distance_px" };
    const struct plan *plan = derive_plan(derived);
    struct pick_track_hit hit;
    cJSON *json = cJSON_CreateObject();
    (void)problem;
    if (!pick_track(question->snapshot, question->packet.track.px, question->packet.track.py, &hit)) {
        for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
            cJSON_AddNullToObject(json, names[i]);
        return json;
    }
    const struct track_segment *segment = &plan->tracks.segments[hit.segment];
    const struct vec3 from = point_of(segment->from_lps_mm), to = point_of(segment->to_lps_mm);
    json_add_finite(json, "segment", (double)hit.segment);
    cJSON_AddStringToObject(json, "class", track_class_word((enum track_class)segment->class));
    json_add_finite(json, "energy_mev", (double)segment->energy_mev);
    json_add_finite(json, "length_mm", vec3_length(vec3_sub(to, from)));
    cJSON_AddItemToObject(json, "from_lps_mm", point(from));
    cJSON_AddItemToObject(json, "to_lps_mm", point(to));
    (void)add_region(json, "from_region", question->snapshot, from);
    (void)add_region(json, "to_region", question->snapshot, to);
    size_t file = 0, in_file = hit.segment;
    while (file < plan->tracks.n_files && in_file >= plan->tracks.files[file].n_segments)
        in_file -= plan->tracks.files[file++].n_segments;
    bool has_file = file < plan->tracks.n_files;
    cJSON_AddItemToObject(json, "file",
                          has_file ? cJSON_CreateString(plan->tracks.files[file].path) : cJSON_CreateNull());
    json_add_finite(json, "file_segment", has_file ? (double)in_file : NAN);
    cJSON_AddItemToObject(json, "point_lps_mm", point(hit.point_lps_mm));
    json_add_finite(json, "distance_mm", hit.distance_mm);
    json_add_finite(json, "distance_px", hit.distance_px);
    return json;
}
