/* Adds particle tracks to a plan. */
#include "core/load/assemble_tracks.h"

#include <math.h>
#include <stdio.h>

#include "core/formats/sera_pp.h"
#include "core/load/part_format.h"

static bool add_file(struct plan *plan, const struct folder *folder, const struct plan_file_tracks *entry,
                     struct error *err)
{
    struct bytes bytes;
    size_t first = plan->tracks.n_segments;
    if (!folder_read(folder, entry->path, PP_MAX_BYTES, UINT64_MAX, &bytes, err))
        return false;
    bool is_read = pp_parse(bytes.data, bytes.size, entry->path, &plan->tracks, &plan->report, err);
    bytes_free(&bytes);
    if (!is_read)
        return false;
    double mm = pp_unit_mm(&plan->tracks, first, entry->mm, &plan->bounds_lps_mm, entry->path, &plan->report);
    if (!(mm > 0))
        return error_set(err, ERROR_MEMORY, "%s: no memory to tell its unit", entry->path);
    pp_scale(&plan->tracks, first, mm, entry->path, &plan->report);
    return true;
}

static struct vec3 point_of(const float p[3])
{
    return vec3((double)p[0], (double)p[1], (double)p[2]);
}

/* Takes the beam of a plan without beams from its tracks: seraMC writes the beam line as a track from the centre of the
 * source plane to the target. */
static void beam_from_tracks(struct plan *plan)
{
    for (size_t i = 0; plan->n_beams == 0 && i < plan->tracks.n_segments; i++) {
        const struct track_segment *segment = &plan->tracks.segments[i];
        struct vec3 from = point_of(segment->from_lps_mm), to = point_of(segment->to_lps_mm);
        if (segment->class != TRACK_BEAM_LINE || vec3_length(vec3_sub(from, to)) < BEAM_MIN_LENGTH_MM)
            continue;
        struct beam *beam = &plan->beams[plan->n_beams++];
        *beam = (struct beam){ .id = "beam-1", .entry_lps_mm = from, .target_lps_mm = to, .aperture_mm = NAN };
        report_add(&plan->report, REPORT_NOTE, "beam.from-tracks", "",
                   "The plan gives no beam; the beam line of the tracks was taken, "
                   "from the source plane to the target. Its aperture is unknown.");
    }
}

bool plan_add_tracks(struct plan *plan, const struct folder *folder, const struct plan_file *file, struct error *err)
{
    for (size_t i = 0; i < file->n_tracks; i++) {
        const char *path = file->tracks[i].path;
        enum part_format format = part_format_of(folder, path);
        if (format == PART_ABSENT)
            return error_set(err, ERROR_NOT_FOUND, "%s: there is no such file in the plan's folder", path);
        if (format != PART_PP) {
            report_add(&plan->report, REPORT_WARNING, "tracks.unsupported", path,
                       "Tracks of this kind are not read by this version; the plan is shown without them.");
            continue;
        }
        if (!add_file(plan, folder, &file->tracks[i], err))
            return false;
    }
    beam_from_tracks(plan);
    return true;
}
