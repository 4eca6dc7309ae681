/* Reads MCPL. */
#include "core/formats/mcpl.h"

#include <math.h>

#include "core/formats/gzip.h"
#include "core/formats/particle_bytes.h"
#include "core/formats/text.h"

enum { HEAD_BYTES = 48, NEUTRON = 2112, PHOTON = 22 };

struct mcpl {
    const uint8_t *data, *at; /* at: after what was read */
    size_t size;
    const char *name;
    bool is_big, is_single, has_polarisation, has_flags, has_weight;
    int32_t pdg; /* of all; 0: each its own */
    double weight;
    size_t record_bytes;
    uint64_t n;
};

static size_t n_left(const struct mcpl *file)
{
    return file->size - (size_t)(file->at - file->data);
}

static uint64_t whole(const struct mcpl *file, size_t offset, int n)
{
    return particle_bytes_whole(file->data + offset, n, file->is_big);
}

/* A text with its length before it; out (may be NULL) receives its beginning. */
static bool skip_text(struct mcpl *file, const char *what, char *out, size_t out_size, struct error *err)
{
    size_t offset = (size_t)(file->at - file->data);
    uint64_t n = n_left(file) < 4 ? 0 : particle_bytes_whole(file->at, 4, file->is_big);
    if (n_left(file) < 4 || n > n_left(file) - 4)
        return error_set(err, ERROR_FORMAT, "%s: %s at byte %zu is cut: the file has %zu bytes", file->name, what,
                         offset, file->size);
    if (out) {
        char start[BEAM_PARTICLES_TITLE_SIZE] = "";
        memcpy(start, file->at + 4, n < sizeof start - 1 ? (size_t)n : sizeof start - 1);
        text_clean(start, out, out_size);
    }
    file->at += 4 + n;
    return true;
}

static bool check_flags(struct mcpl *file, struct error *err)
{
    static const char *const flags[] = { "userflags", "polarisation", "single precision" };
    for (size_t i = 0; i < 3; i++)
        if (whole(file, 24 + 4 * i, 4) > 1)
            return error_set(err, ERROR_FORMAT, "%s: %s at byte %zu is %llu, expected 0 or 1", file->name, flags[i],
                             24 + 4 * i, (unsigned long long)whole(file, 24 + 4 * i, 4));
    file->has_flags = whole(file, 24, 4) == 1;
    file->has_polarisation = whole(file, 28, 4) == 1;
    file->is_single = whole(file, 32, 4) == 1;
    file->pdg = (int32_t)whole(file, 36, 4);
    file->has_weight = whole(file, 44, 4) == 0;
    size_t number = file->is_single ? 4 : 8;
    size_t expected = number * (7 + 3 * (size_t)file->has_polarisation + (size_t)file->has_weight) +
                      4 * (size_t)(file->pdg == 0) + 4 * (size_t)file->has_flags;
    file->record_bytes = (size_t)whole(file, 40, 4);
    return file->record_bytes == expected ||
           error_set(err, ERROR_FORMAT, "%s: a particle has %zu bytes by byte 40, and %zu by what it holds", file->name,
                     file->record_bytes, expected);
}

static bool read_head(struct mcpl *file, char title[BEAM_PARTICLES_TITLE_SIZE], struct error *err)
{
    if (file->size < HEAD_BYTES || memcmp(file->data, "MCPL", 4) != 0)
        return error_set(err, ERROR_FORMAT, "%s: is not MCPL: its first bytes are not those of a header", file->name);
    if (memcmp(file->data + 4, "003", 3) != 0)
        return error_set(err, ERROR_UNSUPPORTED, "%s: MCPL version '%.3s', version 003 is read", file->name,
                         (const char *)file->data + 4);
    if (file->data[7] != 'L' && file->data[7] != 'B')
        return error_set(err, ERROR_FORMAT, "%s: byte 7 is neither L nor B, the orders of bytes", file->name);
    file->is_big = file->data[7] == 'B';
    if (!check_flags(file, err))
        return false;
    file->n = whole(file, 8, 8);
    file->at = file->data + HEAD_BYTES;
    file->weight = 1;
    if (!file->has_weight) {
        if (n_left(file) < 8)
            return error_set(err, ERROR_FORMAT, "%s: the weight of all particles at byte 48 is cut", file->name);
        file->weight = particle_bytes_double(file->at, file->is_big);
        file->at += 8;
    }
    uint64_t n_comments = whole(file, 16, 4), n_blobs = whole(file, 20, 4);
    if (n_comments > MCPL_MAX_TEXTS || n_blobs > MCPL_MAX_TEXTS)
        return error_set(err, ERROR_LIMIT, "%s: %llu comments and blobs, at most %d of each expected", file->name,
                         (unsigned long long)(n_comments + n_blobs), MCPL_MAX_TEXTS);
    if (!skip_text(file, "the program's name", title, BEAM_PARTICLES_TITLE_SIZE, err))
        return false;
    for (uint64_t i = 0; i < n_comments + 2 * n_blobs; i++)
        if (!skip_text(file, i < n_comments ? "a comment" : "a blob", NULL, 0, err))
            return false;
    return true;
}

/* The number of particles, from the header or from the size. */
static bool take_count(struct mcpl *file, bool *is_given, struct error *err)
{
    uint64_t there = n_left(file) / file->record_bytes;
    *is_given = file->n > 0;
    if (!*is_given)
        file->n = there;
    if (file->n > there || (*is_given && n_left(file) != file->n * file->record_bytes))
        return error_set(err, ERROR_FORMAT,
                         "%s: its header counts %llu particles of %zu bytes, and %zu bytes follow it", file->name,
                         (unsigned long long)file->n, file->record_bytes, n_left(file));
    return file->n > 0 || error_set(err, ERROR_FORMAT, "%s: not one particle", file->name);
}

static double number(const struct mcpl *file, const uint8_t **at)
{
    const uint8_t *from = *at;
    *at += file->is_single ? 4 : 8;
    return file->is_single ? particle_bytes_float(from, file->is_big) : particle_bytes_double(from, file->is_big);
}

static double third(double a, double b, bool is_negative)
{
    double square = 1 - a * a - b * b, value = sqrt(fmax(0, square));
    return square < -2e-3 ? NAN : is_negative ? -value : value;
}

/* The largest component is left out; instead of the third one, if it is smaller, its inverse stands, which is beyond
 * 1. The sign of the energy is that of the component left out. */
static void unpack_direction(const double in[2], bool is_negative, float out[3])
{
    double x = in[0], y = in[1], z;
    if (fabs(x) > 1) {
        z = 1 / x;
        x = third(y, z, is_negative);
    } else if (fabs(y) > 1) {
        z = 1 / y;
        y = third(x, z, is_negative);
    } else
        z = third(x, y, is_negative);
    out[0] = (float)x;
    out[1] = (float)y;
    out[2] = (float)z;
}

static int32_t code_of(const struct mcpl *file, const uint8_t *record)
{
    if (file->pdg != 0)
        return file->pdg;
    return (int32_t)particle_bytes_whole(record + file->record_bytes - (file->has_flags ? 8 : 4), 4, file->is_big);
}

static struct beam_particle read_particle(const struct mcpl *file, const uint8_t *record)
{
    struct beam_particle particle = { .weight = (float)file->weight };
    const uint8_t *at = record;
    double packed[2];
    for (int i = 0; i < 3 && file->has_polarisation; i++)
        number(file, &at);
    for (int i = 0; i < 3; i++)
        particle.position_cm[i] = (float)number(file, &at);
    packed[0] = number(file, &at);
    packed[1] = number(file, &at);
    double energy_mev = number(file, &at);
    particle.energy_mev = (float)fabs(energy_mev);
    unpack_direction(packed, signbit(energy_mev), particle.direction);
    number(file, &at); /* its time */
    if (file->has_weight)
        particle.weight = (float)number(file, &at);
    return particle;
}

static bool read_all(const struct mcpl *file, struct beam_particles *particles, struct error *err)
{
    for (uint64_t i = 0; i < file->n; i++) {
        const uint8_t *record = file->at + i * file->record_bytes;
        int32_t code = code_of(file, record);
        if (code != NEUTRON && code != PHOTON) {
            particles->n_others++;
            continue;
        }
        struct beam_particle particle = read_particle(file, record);
        const char *wrong = beam_particle_check(&particle);
        if (wrong)
            return error_set(err, ERROR_FORMAT, "%s: particle %llu, at byte %zu: %s is no number in its range",
                             file->name, (unsigned long long)i + 1, (size_t)(record - file->data), wrong);
        if (code == NEUTRON)
            particles->neutrons[particles->n_neutrons++] = particle;
        else
            particles->photons[particles->n_photons++] = particle;
    }
    return true;
}

static bool read_unpacked(struct mcpl *file, struct beam_particles *particles, struct error *err)
{
    char title[BEAM_PARTICLES_TITLE_SIZE] = "";
    bool is_given;
    uint64_t n_neutrons = 0, n_photons = 0;
    if (!read_head(file, title, err) || !take_count(file, &is_given, err))
        return false;
    for (uint64_t i = 0; i < file->n; i++) {
        int32_t code = code_of(file, file->at + i * file->record_bytes);
        n_neutrons += code == NEUTRON;
        n_photons += code == PHOTON;
    }
    if (!beam_particles_init(particles, n_neutrons, n_photons, file->name, err))
        return false;
    memcpy(particles->title, title, sizeof title);
    particles->is_count_given = is_given;
    if (read_all(file, particles, err))
        return true;
    beam_particles_finish(particles);
    return false;
}

bool mcpl_is(const uint8_t *data, size_t size)
{
    uint8_t head[4];
    if (gzip_is(data, size))
        return gzip_head(data, size, head, sizeof head) == sizeof head && memcmp(head, "MCPL", 4) == 0;
    return size >= 4 && memcmp(data, "MCPL", 4) == 0;
}

bool mcpl_read(const uint8_t *data, size_t size, const char *name, struct beam_particles *particles, struct error *err)
{
    struct mcpl file = { .data = data, .size = size, .name = name };
    struct bytes unpacked = { 0 };
    *particles = (struct beam_particles){ 0 };
    if (gzip_is(data, size)) {
        if (!gzip_all(data, size, name, MCPL_MAX_BYTES, &unpacked, err))
            return false;
        file.data = unpacked.data;
        file.size = unpacked.size;
    } else if (size > MCPL_MAX_BYTES)
        return error_set(err, ERROR_LIMIT, "%s: %zu bytes, at most %llu expected", name, size,
                         (unsigned long long)MCPL_MAX_BYTES);
    bool is_read = read_unpacked(&file, particles, err);
    bytes_free(&unpacked);
    return is_read;
}
