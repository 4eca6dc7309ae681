/* Reads a phase space of the IAEA. */
#include "core/formats/iaea_phase_space.h"

#include <math.h>
#include <stdlib.h>

#include "core/formats/particle_bytes.h"
#include "core/formats/text.h"

enum { PHOTON = 1, NEUTRON = 4, MOST_KIND = 5 };

/* ---- header ------------------------------------------------------------------------------------------------------- */

struct header_reading {
    struct iaea_header *header;
    const char *name;
    struct error *err;
    char block[64]; /* "" before the first */
    size_t n_lines; /* of the block, that hold something */
    double contents[IAEA_N_FIELDS + 2];
    size_t n_contents, n_constants;
    double constants[IAEA_N_FIELDS];
    double length, order, particles, checksum; /* not-a-number: not there */
};

/* The number a line begins with; what follows // is a comment. */
static bool line_number(const struct header_reading *reading, char *line, double low, double high, double *value)
{
    char *comment = strstr(line, "//");
    if (comment)
        *comment = '\0';
    size_t n = strcspn(line, " \t");
    line[n] = '\0';
    char clean[40];
    text_clean(line, clean, sizeof clean);
    return (text_number(line, value) && *value >= low && *value <= high) ||
           error_set(reading->err, ERROR_FORMAT, "%s: $%s: '%s', expected a number from %g to %g", reading->name,
                     reading->block, clean, low, high);
}

static bool take_line(struct header_reading *reading, char *line)
{
    struct iaea_header *header = reading->header;
    const char *block = reading->block;
    bool is_first = reading->n_lines++ == 0;
    if (strcmp(block, "RECORD_CONTENTS") == 0) {
        if (reading->n_contents == IAEA_N_FIELDS + 2)
            return true; /* kinds of the extra numbers */
        return line_number(reading, line, 0, IAEA_MAX_EXTRAS, &reading->contents[reading->n_contents++]);
    }
    if (strcmp(block, "RECORD_CONSTANT") == 0)
        return reading->n_constants == IAEA_N_FIELDS ||
               line_number(reading, line, -BEAM_PARTICLE_MAX_WEIGHT, BEAM_PARTICLE_MAX_WEIGHT,
                           &reading->constants[reading->n_constants++]);
    if (!is_first)
        return true;
    if (strcmp(block, "TITLE") == 0)
        text_clean(line, header->title, sizeof header->title);
    if (strcmp(block, "RECORD_LENGTH") == 0)
        return line_number(reading, line, 5, 4096, &reading->length);
    if (strcmp(block, "BYTE_ORDER") == 0)
        return line_number(reading, line, 0, 4321, &reading->order);
    if (strcmp(block, "PARTICLES") == 0)
        return line_number(reading, line, 0, 1e15, &reading->particles);
    if (strcmp(block, "CHECKSUM") == 0)
        return line_number(reading, line, 0, 1e18, &reading->checksum);
    if (strcmp(block, "ORIG_HISTORIES") == 0)
        return line_number(reading, line, 0, 1.9e19, &header->histories);
    double kind = 0;
    if (strcmp(block, "FILE_TYPE") == 0 && !line_number(reading, line, 0, 9, &kind))
        return false;
    return kind == 0 ||
           error_set(reading->err, ERROR_UNSUPPORTED,
                     "%s: $FILE_TYPE is %g, an event generator; 0, a phase space, is read", reading->name, kind);
}

static bool take_contents(struct header_reading *reading)
{
    struct iaea_header *header = reading->header;
    static const char *const words[] = { "X", "Y", "Z", "U", "V", "W", "Weight" };
    size_t next = 0, bytes = 5; /* kind and energy */
    if (reading->n_contents < IAEA_N_FIELDS + 2)
        return error_set(reading->err, ERROR_FORMAT,
                         "%s: $RECORD_CONTENTS has %zu lines, expected 9: X, Y, Z, U, V, W, weight, floats, longs",
                         reading->name, reading->n_contents);
    for (int i = 0; i < IAEA_N_FIELDS; i++) {
        if (reading->contents[i] > 1 || reading->contents[i] != floor(reading->contents[i]))
            return error_set(reading->err, ERROR_FORMAT, "%s: $RECORD_CONTENTS: %s is %g, expected 0 or 1",
                             reading->name, words[i], reading->contents[i]);
        header->is_stored[i] = reading->contents[i] == 1;
        header->constants[i] = i == IAEA_WEIGHT;
        if (header->is_stored[i]) {
            bytes += i == IAEA_W ? 0 : 4;
            continue;
        }
        if (next < reading->n_constants)
            header->constants[i] = reading->constants[next++];
        else if (i != IAEA_WEIGHT)
            return error_set(reading->err, ERROR_FORMAT,
                             "%s: %s is not stored by $RECORD_CONTENTS, and $RECORD_CONSTANT does not give it",
                             reading->name, words[i]);
    }
    bytes += 4 * (size_t)(reading->contents[IAEA_N_FIELDS] + reading->contents[IAEA_N_FIELDS + 1]);
    header->record_bytes = isnan(reading->length) ? bytes : (size_t)reading->length;
    return header->record_bytes == bytes ||
           error_set(reading->err, ERROR_FORMAT, "%s: $RECORD_LENGTH is %zu, and what is stored takes %zu bytes",
                     reading->name, header->record_bytes, bytes);
}

static bool take_counts(struct header_reading *reading)
{
    struct iaea_header *header = reading->header;
    if (isnan(reading->particles) || reading->particles < 1)
        return error_set(reading->err, ERROR_FORMAT, "%s: $PARTICLES does not give the number of particles",
                         reading->name);
    header->n_particles = (uint64_t)reading->particles;
    double bytes = reading->particles * (double)header->record_bytes;
    if (reading->checksum > 0 && reading->checksum != bytes)
        return error_set(reading->err, ERROR_FORMAT, "%s: $CHECKSUM is %.0f, and %.0f particles take %.0f bytes",
                         reading->name, reading->checksum, reading->particles, bytes);
    if (reading->order != 1234 && reading->order != 4321)
        return error_set(reading->err, ERROR_FORMAT,
                         "%s: $BYTE_ORDER is not there or neither 1234, little-endian, nor 4321, big-endian",
                         reading->name);
    header->is_big = reading->order == 4321;
    if (header->histories >= 1.8e19) /* the largest whole number stands for an unknown one */
        header->histories = 0;
    return true;
}

bool iaea_header_parse(const uint8_t *data, size_t size, const char *name, struct iaea_header *header,
                       struct error *err)
{
    struct header_reading reading = { .header = header, .name = name, .err = err };
    struct text text;
    char line[TEXT_LINE_SIZE];
    *header = (struct iaea_header){ 0 };
    reading.length = reading.order = reading.particles = reading.checksum = NAN;
    if (size > IAEA_HEADER_MAX_BYTES)
        return error_set(err, ERROR_LIMIT, "%s: %zu bytes, at most %d expected", name, size, IAEA_HEADER_MAX_BYTES);
    text_start(&text, data, size);
    while (text_line(&text, line)) {
        if (line[0] == '$') {
            line[1 + strcspn(line + 1, ":")] = '\0';
            text_clean(line + 1, reading.block, sizeof reading.block);
            reading.n_lines = 0;
        } else if (line[0] && strncmp(line, "//", 2) != 0 && !take_line(&reading, line))
            return false;
    }
    return take_contents(&reading) && take_counts(&reading);
}

/* ---- records ------------------------------------------------------------------------------------------------------ */

static struct beam_particle read_particle(const struct iaea_header *header, const uint8_t *record, bool is_backward)
{
    double fields[IAEA_N_FIELDS];
    const uint8_t *at = record + 5;
    for (int i = 0; i < IAEA_N_FIELDS; i++) {
        fields[i] = header->constants[i];
        if (header->is_stored[i] && i != IAEA_W) {
            fields[i] = particle_bytes_float(at, header->is_big);
            at += 4;
        }
    }
    if (header->is_stored[IAEA_W]) {
        double square = 1 - fields[IAEA_U] * fields[IAEA_U] - fields[IAEA_V] * fields[IAEA_V];
        fields[IAEA_W] = square < -2e-3 ? NAN : sqrt(fmax(0, square)) * (is_backward ? -1 : 1);
    }
    return (struct beam_particle){ { (float)fields[IAEA_X], (float)fields[IAEA_Y], (float)fields[IAEA_Z] },
                                   { (float)fields[IAEA_U], (float)fields[IAEA_V], (float)fields[IAEA_W] },
                                   (float)fabs(particle_bytes_float(record + 1, header->is_big)),
                                   (float)fields[IAEA_WEIGHT] };
}

static int kind_of(const uint8_t *record)
{
    return abs((int8_t)record[0]);
}

bool iaea_phase_space_read(const struct iaea_header *header, const uint8_t *data, size_t size, const char *name,
                           struct beam_particles *particles, struct error *err)
{
    uint64_t n_neutrons = 0, n_photons = 0;
    *particles = (struct beam_particles){ 0 };
    if (size > IAEA_PHASE_SPACE_MAX_BYTES)
        return error_set(err, ERROR_LIMIT, "%s: %zu bytes, at most %llu expected", name, size,
                         (unsigned long long)IAEA_PHASE_SPACE_MAX_BYTES);
    if (header->n_particles > size / header->record_bytes || size != header->n_particles * header->record_bytes)
        return error_set(err, ERROR_FORMAT, "%s: %zu bytes, and its header counts %llu particles of %zu bytes", name,
                         size, (unsigned long long)header->n_particles, header->record_bytes);
    for (uint64_t i = 0; i < header->n_particles; i++) {
        int kind = kind_of(data + i * header->record_bytes);
        if (kind < 1 || kind > MOST_KIND)
            return error_set(err, ERROR_FORMAT, "%s: particle %llu is of kind %d, expected 1 to %d", name,
                             (unsigned long long)i + 1, kind, MOST_KIND);
        n_neutrons += kind == NEUTRON;
        n_photons += kind == PHOTON;
    }
    if (!beam_particles_init(particles, n_neutrons, n_photons, name, err))
        return false;
    memcpy(particles->title, header->title, sizeof particles->title);
    particles->histories = header->histories;
    particles->is_count_given = true;
    particles->n_others = header->n_particles - n_neutrons - n_photons;
    for (uint64_t i = 0; i < header->n_particles; i++) {
        const uint8_t *record = data + i * header->record_bytes;
        if (kind_of(record) != NEUTRON && kind_of(record) != PHOTON)
            continue;
        struct beam_particle particle = read_particle(header, record, (int8_t)record[0] < 0);
        const char *wrong = beam_particle_check(&particle);
        if (wrong) {
            beam_particles_finish(particles);
            return error_set(err, ERROR_FORMAT, "%s: particle %llu, at byte %llu: %s is no number in its range", name,
                             (unsigned long long)i + 1, (unsigned long long)(i * header->record_bytes), wrong);
        }
        if (kind_of(record) == NEUTRON)
            particles->neutrons[particles->n_neutrons++] = particle;
        else
            particles->photons[particles->n_photons++] = particle;
    }
    return true;
}
