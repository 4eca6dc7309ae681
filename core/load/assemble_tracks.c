/* Adds particle tracks to a plan. */
#include "core/load/assemble_tracks.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/load/reader_table.h"

_Static_assert((int)TRACK_MAX_FILES >= (int)PLAN_FILE_MAX_TRACKS, "each file of tracks of a plan is kept");
_Static_assert((int)TRACK_FILE_NAME_SIZE == (int)FOLDER_NAME_SIZE, "the path of a file fits");

static bool add_file(struct plan *plan, const struct folder *folder, const struct plan_file_tracks *entry,
                     const struct part_reader *reader, struct error *err)
{
    struct bytes bytes;
    double unit_mm;
    size_t first = plan->tracks.n_segments;
    if (!folder_read(folder, entry->path, reader->tracks_max_bytes, UINT64_MAX, &bytes, err))
        return false;
    bool is_read = reader->read_tracks(plan, entry, &bytes, &unit_mm, err);
    bytes_free(&bytes);
    if (!is_read)
        return false;
    struct track_file *kept = &plan->tracks.files[plan->tracks.n_files++];
    memcpy(kept->path, entry->path, sizeof kept->path);
    kept->n_segments = plan->tracks.n_segments - first;
    kept->unit_mm = unit_mm;
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

bool plan_add_tracks(struct loading *loading, struct error *err)
{
    struct plan *plan = loading->plan;
    const struct folder *folder = &loading->folder;
    const struct plan_file *file = loading->file;
    for (size_t i = 0; i < file->n_tracks; i++) {
        const char *path = file->tracks[i].path;
        const struct part_reader *reader = part_reader_of(folder, path);
        struct error why = { 0 };
        size_t n_before = plan->tracks.n_segments;
        if (reader == &part_absent) {
            error_set(&why, ERROR_NOT_FOUND, "%s: there is no such file in the plan's folder", path);
            loading_leave_out(loading, "part.unreadable", path, &why);
            continue;
        }
        if (!reader->read_tracks) {
            report_add(&plan->report, REPORT_WARNING, "tracks.unsupported", path,
                       "Tracks of this kind are not read by this version; the plan is shown without them.");
            continue;
        }
        if (add_file(plan, folder, &file->tracks[i], reader, &why))
            continue;
        plan->tracks.n_segments = n_before;
        if (!loading_may_leave_out(&why)) {
            if (err)
                *err = why;
            return false;
        }
        loading_leave_out(loading, "part.unreadable", path, &why);
    }
    beam_from_tracks(plan);
    return true;
}
