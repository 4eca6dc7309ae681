/* Beams of `beamroom transport` from files of particles: MCPL and phase spaces of the IAEA. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/formats/iaea_phase_space.h"
#include "core/formats/mcpl.h"
#include "core/formats/text.h"
#include "core/transport/particle_list.h"
#include "core/transport/photon_data.h"
#include "server/cli/text.h"
#include "server/cli/transport_parts.h"

bool transport_is_particles(const char *name)
{
    static const char *const endings[] = { ".mcpl", ".mcpl.gz", ".IAEAheader", ".IAEAphsp" };
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
        if (text_has_ending(name, endings[i]))
            return true;
    return false;
}

static bool read_file(const struct folder *folder, const char *name, uint64_t limit, struct bytes *bytes,
                      struct error *err)
{
    if (folder_look(folder, name, NULL) == FOLDER_ABSENT)
        return error_set(err, ERROR_IO, "%.150s: the file of particles is not there", name);
    return folder_read(folder, name, limit, UINT64_MAX, bytes, err);
}

/* Either file of a phase space may be named. */
static bool read_iaea(const struct folder *folder, const char *name, struct beam_particles *particles,
                      struct error *err)
{
    char head_name[FOLDER_NAME_SIZE + 8], data_name[FOLDER_NAME_SIZE + 8];
    size_t stem = strlen(name) - strlen(text_has_ending(name, ".IAEAphsp") ? ".IAEAphsp" : ".IAEAheader");
    snprintf(head_name, sizeof head_name, "%.*s.IAEAheader", (int)stem, name);
    snprintf(data_name, sizeof data_name, "%.*s.IAEAphsp", (int)stem, name);
    struct bytes bytes;
    struct iaea_header header;
    if (!read_file(folder, head_name, IAEA_HEADER_MAX_BYTES, &bytes, err))
        return false;
    bool is_read = iaea_header_parse(bytes.data, bytes.size, head_name, &header, err);
    bytes_free(&bytes);
    if (!is_read || !read_file(folder, data_name, IAEA_PHASE_SPACE_MAX_BYTES, &bytes, err))
        return false;
    is_read = iaea_phase_space_read(&header, bytes.data, bytes.size, data_name, particles, err);
    bytes_free(&bytes);
    return is_read;
}

bool transport_read_particles(const struct folder *folder, const char *name, struct beam_particles *particles,
                              struct error *err)
{
    struct bytes bytes;
    if (text_has_ending(name, ".IAEAheader") || text_has_ending(name, ".IAEAphsp"))
        return read_iaea(folder, name, particles, err);
    if (!read_file(folder, name, MCPL_MAX_BYTES, &bytes, err))
        return false;
    bool is_read = mcpl_is(bytes.data, bytes.size)
                       ? mcpl_read(bytes.data, bytes.size, name, particles, err)
                       : error_set(err, ERROR_FORMAT, "%.150s: neither MCPL nor named .IAEAheader or .IAEAphsp", name);
    bytes_free(&bytes);
    return is_read;
}

/* The angle from the beam's x, as transport lays it, to where the person says. */
static bool turn_of(const struct beam_file *file, double *turn_rad, struct error *err)
{
    struct vec3 along = vec3_normalize(vec3_sub(file->target_lps_mm, file->entry_lps_mm)), axes[2];
    transport_beam_axes(along, axes);
    *turn_rad = 0;
    if (!file->particles.has_across_lps)
        return true;
    double x = vec3_dot(file->particles.across_lps, axes[0]), y = vec3_dot(file->particles.across_lps, axes[1]);
    *turn_rad = atan2(y, x);
    return hypot(x, y) > 1e-3 * vec3_length(file->particles.across_lps) ||
           error_set(err, ERROR_RANGE, "particles.across_lps has no part across the beam");
}

static bool frame_of(const struct beam_file *file, struct particle_frame *frame, struct error *err)
{
    const struct beam_file_particles *from = &file->particles;
    double origin_cm[3] = { from->origin_mm.x / 10, from->origin_mm.y / 10, from->origin_mm.z / 10 };
    double along[3] = { from->direction.x, from->direction.y, from->direction.z };
    double across[3] = { from->across.x, from->across.y, from->across.z };
    return particle_frame_init(frame, origin_cm, along, across, err) && turn_of(file, &frame->turn_rad, err);
}

static bool strength_of(const struct beam_file *file, const struct beam_particles *particles, double *per_weight,
                        struct error *err)
{
    const struct beam_file_particles *from = &file->particles;
    double sum = 0, histories = from->histories > 0 ? from->histories : particles->histories;
    for (size_t i = 0; i < particles->n_neutrons; i++)
        sum += (double)particles->neutrons[i].weight;
    if (!(sum > 0))
        return error_set(err, ERROR_RANGE, "%.100s: no neutrons in it (%zu photons, %llu other particles)", from->path,
                         particles->n_photons, (unsigned long long)particles->n_others);
    if (from->neutrons_per_unit > 0) {
        *per_weight = from->neutrons_per_unit / sum;
        return true;
    }
    *per_weight = histories > 0 ? from->histories_per_unit / histories : 0;
    return histories > 0 || error_set(err, ERROR_NOT_FOUND,
                                      "%.100s does not say how many histories it comes of; particles.histories of the "
                                      "beam's file does",
                                      from->path);
}

static void print_kind(const char *word, size_t n, const struct particle_weights *weights, double per_weight)
{
    printf("  %zu %s, %.4g per unit of the source", n, word, weights->all * per_weight);
    if (weights->backward + weights->beside > 0)
        printf("; left out: %.3g %% do not go the beam's way, %.3g %% pass beyond %g cm from the axis",
               100 * weights->backward / weights->all, 100 * weights->beside / weights->all, PARTICLE_FARTHEST_CM);
    if (weights->soft > 0)
        printf("; left out: %.3g %% are photons below %g MeV, which are not followed",
               100 * weights->soft / weights->all, PHOTON_LOWEST_MEV);
    puts("");
}

static void print_used(const struct beam_file *file, const struct beam_particles *particles,
                       const struct particle_frame *frame)
{
    fputs("particles of ", stdout);
    text_print(stdout, file->particles.path, 0);
    if (particles->title[0]) {
        fputs(", by ", stdout);
        text_print(stdout, particles->title, 0);
    }
    puts(", read in cm and MeV:");
    if (!particles->is_count_given)
        puts("  its header counts none (its program may have ended early); the file's size says how many there are");
    if (particles->n_others > 0)
        printf("  %llu particles that are neither neutrons nor photons, left out\n",
               (unsigned long long)particles->n_others);
    const double *o = frame->origin_cm, *z = frame->axes[2], *x = frame->axes[0];
    printf(
        "  the aperture's centre is %g, %g, %g cm in the file; the beam goes to %.3g, %.3g, %.3g; its x is %.3g, %.3g, "
        "%.3g\n",
        o[0], o[1], o[2], z[0], z[1], z[2], x[0], x[1], x[2]);
    struct vec3 along = vec3_normalize(vec3_sub(file->target_lps_mm, file->entry_lps_mm)), axes[2];
    transport_beam_axes(along, axes);
    struct vec3 to = vec3_add(vec3_scale(axes[0], cos(frame->turn_rad)), vec3_scale(axes[1], sin(frame->turn_rad)));
    printf("  that x lies along %.3f, %.3f, %.3f in patient LPS%s\n", to.x, to.y, to.z,
           file->particles.has_across_lps ? "" : " (nothing says so: particles.across_lps does)");
}

bool transport_list_of_particles(struct phase_space *space, const struct beam_file *file,
                                 const struct beam_particles *particles, size_t n_neutrons, size_t n_photons,
                                 uint64_t seed, struct error *err)
{
    struct particle_frame frame;
    struct particle_weights neutrons, photons;
    double per_weight = 0;
    if (!frame_of(file, &frame, err) || !strength_of(file, particles, &per_weight, err))
        return false;
    print_used(file, particles, &frame);
    if (!phase_space_of_particles(space, particles, &frame, per_weight, n_neutrons, n_photons, seed, &neutrons,
                                  &photons, err))
        return false;
    print_kind("neutrons", particles->n_neutrons, &neutrons, per_weight);
    if (particles->n_photons > 0)
        print_kind("photons", particles->n_photons, &photons, per_weight);
    if (particles->n_photons > 0 && space->photons.n == 0)
        puts("  too few photons go through the aperture plane: they are left out");
    return true;
}
