/* Beams of `beamroom transport`: those of the library, and files. */
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "core/formats/plan/beam_file.h"
#include "core/formats/sera/sera_source.h"
#include "server/cli/text.h"
#include "server/cli/transport_parts.h"

void transport_print_report(const struct report *report)
{
    for (size_t i = 0; i < report->n_lines; i++) {
        fputs("beamroom transport: ", stderr);
        text_print(stderr, report->lines[i].where, 0);
        fputs(": ", stderr);
        text_print(stderr, report->lines[i].sentence, 0);
        fputc('\n', stderr);
    }
}

static bool parse(const uint8_t *data, size_t size, const char *name, struct beam_file *file, struct error *err)
{
    struct report report = { 0 };
    bool is_read = beam_file_parse(data, size, name, file, &report, err);
    transport_print_report(&report);
    report_finish(&report);
    return is_read;
}

static bool read_in_folder(const struct folder *folder, const char *name, struct beam_file *file,
                           struct beam_particles *particles, struct error *err)
{
    struct bytes bytes = { 0 };
    if (transport_is_particles(name)) {
        file->particles = beam_file_particles_of(name);
        return transport_read_particles(folder, name, particles, err);
    }
    if (folder_look(folder, name, NULL) == FOLDER_ABSENT)
        return error_set(err, ERROR_NOT_FOUND, "%.100s: no such file, and no beam of the library (%s)", name,
                         transport_library_names());
    if (!folder_read(folder, name, BEAM_FILE_MAX_BYTES, UINT64_MAX, &bytes, err))
        return false;
    bool is_read = parse(bytes.data, bytes.size, name, file, err);
    bytes_free(&bytes);
    if (is_read && file->particles.path[0])
        return transport_read_particles(folder, file->particles.path, particles, err);
    if (!is_read || !file->source_path[0])
        return is_read;
    if (folder_look(folder, file->source_path, NULL) == FOLDER_ABSENT)
        return error_set(err, ERROR_IO, "%.150s: the beam file names it, and it is not there", file->source_path);
    if (!folder_read(folder, file->source_path, SERA_SOURCE_MAX_BYTES, UINT64_MAX, &bytes, err))
        return false;
    const struct beam_delimiter delimiter = file->source.delimiter;
    is_read = sera_source_parse(bytes.data, bytes.size, file->source_path, &file->source, err);
    file->source.delimiter = delimiter;
    bytes_free(&bytes);
    return is_read;
}

bool transport_read_beam(const char *path_or_name, struct beam_file *file, struct beam_particles *particles,
                         struct error *err)
{
    const char *text = transport_library_beam(path_or_name);
    if (text)
        return parse((const uint8_t *)text, strlen(text), path_or_name, file, err);
    char path[PATH_MAX];
    if (strlen(path_or_name) >= sizeof path)
        return error_set(err, ERROR_RANGE, "the path of the beam's file is too long");
    memcpy(path, path_or_name, strlen(path_or_name) + 1);
    char *slash = strrchr(path, '/');
    const char *name = slash ? slash + 1 : path, *parent = slash == path ? "/" : slash ? path : ".";
    if (slash)
        *slash = '\0';
    struct folder folder;
    if (!folder_open(&folder, parent, err))
        return false;
    bool is_read = read_in_folder(&folder, name, file, particles, err);
    folder_close(&folder);
    return is_read;
}

bool transport_pose_of_beam(const struct plan *plan, size_t index, struct beam_file *file, struct error *err)
{
    const struct beam *beam = &plan->beams[index];
    if (beam->has_delivery)
        return error_set(err, ERROR_UNSUPPORTED,
                         "beam '%.60s' is of a treatment plan, and its entry is the source; --entry and --target say "
                         "where the aperture is",
                         beam->id);
    if (!transport_fits(plan, (struct fit_part){ FIT_BEAM, index }, err))
        return false;
    struct vec3 along = vec3_normalize(vec3_sub(beam->target_lps_mm, beam->entry_lps_mm));
    file->entry_lps_mm = vec3_add(beam->entry_lps_mm, vec3_scale(along, 10 * file->source.to_aperture_cm));
    /* A target between source and aperture would turn the axis round. */
    file->target_lps_mm = vec3_add(file->entry_lps_mm, vec3_scale(along, 100));
    return true;
}
