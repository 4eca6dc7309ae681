/* Reads SERA univels, .uvh with .uv. */
#include "core/formats/sera/sera_uvh.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/gzip.h"
#include "core/formats/sera/sera_axes.h"
#include "core/formats/text.h"
#include "core/formats/zlib_stream.h"

void uvh_finish(struct uvh *uvh)
{
    free(uvh->bodies);
    *uvh = (struct uvh){ 0 };
}

/* Keys of the header itself; each is a bit in parser.seen. */
enum header_key {
    KEY_DIMENSIONALITY,
    KEY_ORIENTATION,
    KEY_COLUMNS,
    KEY_ROWS,
    KEY_SLICES,
    KEY_STEP_COLUMNS,
    KEY_STEP_ROWS,
    KEY_STEP_SLICES,
    KEY_RL_MIN,
    KEY_RL_MAX,
    KEY_PA_MIN,
    KEY_PA_MAX,
    KEY_IS_MIN,
    KEY_IS_MAX,
    KEY_COLUMN_AXIS,
    KEY_ROW_AXIS,
    KEY_SLICE_AXIS,
    KEY_TITLE,
    N_HEADER_KEYS,
    KEY_UNKNOWN = N_HEADER_KEYS
};
static const char *const header_words[N_HEADER_KEYS] = {
    "Dimensionality", "SliceOrientation", "ImageColumns",    "ImageRows",    "ImageSlices",    "PixelSizeColumns",
    "PixelSizeRows",  "PixelSizeSlices",  "RLaxisMin",       "RLaxisMax",    "PAaxisMin",      "PAaxisMax",
    "ISaxisMin",      "ISaxisMax",        "ImageColumnAxis", "ImageRowAxis", "ImageSliceAxis", "BodyDataTitle"
};

struct parser {
    struct text text;
    const char *name;
    struct uvh *uvh;
    struct sera_grid grid;
    char orientation[32];
    uint32_t seen; /* one bit for each header_key */
    size_t n_unknown, n_bad;
    char unknown[64]; /* the first unknown key */
    struct report *report;
    struct error *err;
};

static bool fail(const struct parser *p, const char *what, const char *found, const char *expected)
{
    return error_set(p->err, ERROR_FORMAT, "%s: line %zu: %s is \"%.40s\", expected %s", p->name, p->text.line, what,
                     found, expected);
}

static bool set_side(struct parser *p, int along, const char *word, const char *value)
{
    double number;
    if (!text_number(value, &number) || number != floor(number) || number < 1 || number > VOLUME_MAX_SIDE)
        return fail(p, word, value, "a whole number from 1 to 4096");
    p->grid.size[along] = (uint32_t)number;
    return true;
}

static bool set_header_value(struct parser *p, enum header_key key, const char *value)
{
    const char *word = header_words[key];
    double number = 0;
    switch (key) {
    case KEY_DIMENSIONALITY:
        if (text_equal(value, "mm"))
            p->grid.mm = 1;
        else if (text_equal(value, "cm"))
            p->grid.mm = 10;
        else
            return fail(p, word, value, "mm or cm");
        return true;
    case KEY_ORIENTATION:
        if (text_equal(value, "Oblique"))
            return error_set(p->err, ERROR_UNSUPPORTED, "%s: line %zu: oblique slices are not read", p->name,
                             p->text.line);
        snprintf(p->orientation, sizeof p->orientation, "%s", value);
        return true;
    case KEY_COLUMNS: return set_side(p, 0, word, value);
    case KEY_ROWS: return set_side(p, 1, word, value);
    case KEY_SLICES: return set_side(p, 2, word, value);
    case KEY_STEP_COLUMNS:
    case KEY_STEP_ROWS:
    case KEY_STEP_SLICES:
        if (!text_number(value, &number) || number <= 0)
            return fail(p, word, value, "a size above 0");
        p->grid.step[key - KEY_STEP_COLUMNS] = number;
        return true;
    case KEY_COLUMN_AXIS:
    case KEY_ROW_AXIS:
    case KEY_SLICE_AXIS:
        return sera_direction_from_word(value, &p->grid.along[key - KEY_COLUMN_AXIS]) ||
               fail(p, word, value, "one of RL+ RL- PA+ PA- IS+ IS-");
    case KEY_TITLE: return true;
    default:
        if (!text_number(value, &number))
            return fail(p, word, value, "a number");
        if ((key - KEY_RL_MIN) % 2 == 0)
            p->grid.low[(key - KEY_RL_MIN) / 2] = number;
        else
            p->grid.high[(key - KEY_RL_MIN) / 2] = number;
        return true;
    }
}

static enum header_key find_header_key(const char *word)
{
    for (int key = 0; key < N_HEADER_KEYS; key++)
        if (text_equal(word, header_words[key]))
            return (enum header_key)key;
    return KEY_UNKNOWN;
}

static void note_unknown(struct parser *p, const char *key)
{
    if (p->n_unknown++ == 0)
        text_clean(key, p->unknown, sizeof p->unknown);
}

static struct uvh_body *add_body(struct parser *p, const char *name)
{
    if (p->uvh->n_bodies >= UVH_MAX_BODIES) {
        error_set(p->err, ERROR_LIMIT, "%s: line %zu: more than %d bodies", p->name, p->text.line, UVH_MAX_BODIES);
        return NULL;
    }
    struct uvh_body *body = &p->uvh->bodies[p->uvh->n_bodies++];
    *body = (struct uvh_body){
        .uvval = -1, .boron_ratio = NAN, .cbe_boron = NAN, .rbe_nitrogen = NAN, .rbe_fast = NAN, .rbe_gamma = NAN
    };
    text_clean(name, body->name, sizeof body->name);
    return body;
}

static bool set_uvval(const struct parser *p, struct uvh_body *body, const char *value)
{
    double number;
    if (!text_number(value, &number) || number != floor(number) || number < 0 || number > 255)
        return fail(p, "uvval", value, "a whole number from 0 to 255");
    body->uvval = (int)number;
    return true;
}

/* Keys of a body that are not used here. They are listed so that a misspelt key is still noticed. */
static bool is_unused_key(const char *key)
{
    static const char *const quiet[] = { "regionnum",     "matname",       "mean_intensity", "nitrogen_DENS",
                                         "recoil_RBE",    "hydrogen_DENS", "other_RBE",      "ultrafast_RBE",
                                         "carbon_DENS",   "oxygen_DENS",   "maximum_dose",   "constraint_dose",
                                         "editable",      "parent_body",   "volume",         "BBoxRLaxisMin",
                                         "BBoxRLaxisMax", "BBoxPAaxisMin", "BBoxPAaxisMax",  "BBoxISaxisMin",
                                         "BBoxISaxisMax" };
    for (size_t i = 0; i < sizeof quiet / sizeof quiet[0]; i++)
        if (text_equal(key, quiet[i]))
            return true;
    return false;
}

static bool set_body_value(struct parser *p, struct uvh_body *body, const char *key, const char *value)
{
    if (text_equal(key, "uvval"))
        return set_uvval(p, body, value);
    static const char *const colors[] = { "color_red", "color_green", "color_blue" };
    for (int c = 0; c < 3; c++)
        if (text_equal(key, colors[c])) {
            double number;
            if (!text_number(value, &number) || number < 0 || number > 255) {
                p->n_bad++;
                return true;
            }
            body->rgb[c] = (uint8_t)number;
            body->has_color = true;
            return true;
        }
    const struct {
        const char *word;
        double *value;
    } tissue[] = { { "tissue_to_blood", &body->boron_ratio },
                   { "boron_CF", &body->cbe_boron },
                   { "nitrogen_RBE", &body->rbe_nitrogen },
                   { "hydrogen_RBE", &body->rbe_fast },
                   { "gamma_RBE", &body->rbe_gamma } };
    for (size_t i = 0; i < sizeof tissue / sizeof tissue[0]; i++)
        if (text_equal(key, tissue[i].word)) {
            double number;
            if (text_number(value, &number) && number >= 0 && number <= 1e6)
                *tissue[i].value = number;
            else
                p->n_bad++;
            return true;
        }
    if (!is_unused_key(key))
        note_unknown(p, key);
    return true;
}

/* Reads a block after "begin: name", "fiducial: name" or "constraint: name"; body is NULL for the last two. */
static bool parse_block(struct parser *p, struct uvh_body *body)
{
    char line[TEXT_LINE_SIZE], *key, *value;
    while (text_line(&p->text, line)) {
        if (text_equal(line, "end"))
            return true;
        if (!text_split(line, ":", &key, &value))
            continue;
        if (text_equal(key, "end"))
            return true;
        if (text_equal(key, "begin"))
            return error_set(p->err, ERROR_FORMAT, "%s: line %zu: a body begins before the one above has its \"end\"",
                             p->name, p->text.line);
        if (body && !set_body_value(p, body, key, value))
            return false;
    }
    return error_set(p->err, ERROR_FORMAT, "%s: the file ends inside a block, \"end\" expected", p->name);
}

static bool parse_v2(struct parser *p)
{
    char line[TEXT_LINE_SIZE], *key, *value;
    while (text_line(&p->text, line)) {
        if (line[0] == 0 || !text_split(line, ":", &key, &value))
            continue;
        if (text_equal(key, "begin")) {
            struct uvh_body *body = add_body(p, value);
            if (!body || !parse_block(p, body))
                return false;
            if (body->uvval < 0)
                return error_set(p->err, ERROR_FORMAT, "%s: line %zu: the body \"%.60s\" has no uvval", p->name,
                                 p->text.line, body->name);
        } else if (text_equal(key, "fiducial") || text_equal(key, "constraint")) {
            if (!parse_block(p, NULL))
                return false;
        } else {
            enum header_key which = find_header_key(key);
            if (which == KEY_UNKNOWN) {
                note_unknown(p, key);
                continue;
            }
            if (!set_header_value(p, which, value))
                return false;
            p->seen |= 1u << which;
        }
    }
    for (int which = 0; which < N_HEADER_KEYS; which++)
        if (which != KEY_TITLE && !(p->seen & 1u << which))
            return error_set(p->err, ERROR_FORMAT, "%s: the key %s is missing", p->name, header_words[which]);
    return true;
}

/* Reads version 1.0: ten numbers in a fixed order, centimetres, always axial; then triples of words. */
static bool parse_v1(struct parser *p)
{
    static const char *const what[] = {
        "the number of slices", "the number of columns", "the number of rows", "the x size",   "the y size",
        "the z size",           "the x minimum",         "the y minimum",      "the z minimum"
    };
    double numbers[9];
    char line[TEXT_LINE_SIZE];
    size_t n = 0;
    while (n < 9 && text_line(&p->text, line)) {
        if (line[0] == 0)
            continue;
        if (!text_number(line, &numbers[n]))
            return fail(p, what[n], line, "a number");
        if ((n < 3 && (numbers[n] != floor(numbers[n]) || numbers[n] < 1 || numbers[n] > VOLUME_MAX_SIDE)) ||
            (n >= 3 && n < 6 && numbers[n] <= 0))
            return fail(p, what[n], line, n < 3 ? "a whole number from 1 to 4096" : "a size above 0");
        n++;
    }
    if (n < 9)
        return error_set(p->err, ERROR_FORMAT, "%s: the file ends before %s", p->name, what[n]);
    p->grid.mm = 10;
    const double sides[3] = { numbers[1], numbers[2], numbers[0] };
    for (int a = 0; a < 3; a++) {
        p->grid.size[a] = (uint32_t)sides[a];
        p->grid.step[a] = numbers[3 + a];
        p->grid.low[a] = numbers[6 + a];
        p->grid.high[a] = p->grid.low[a] + p->grid.size[a] * p->grid.step[a];
    }
    p->grid.along[0] = (struct sera_direction){ SERA_RL, 1 };
    p->grid.along[1] = (struct sera_direction){ SERA_PA, -1 };
    p->grid.along[2] = (struct sera_direction){ SERA_IS, 1 };
    struct uvh_body *body = NULL;
    while (text_line(&p->text, line)) {
        char *key, *value;
        if (line[0] == 0 || !text_split(line, " ", &key, &value))
            continue;
        if (text_equal(key, "uvval")) {
            body = add_body(p, "");
            if (!body || !set_uvval(p, body, value))
                return false;
        } else if (text_equal(key, "bodyname") && body) {
            text_clean(value, body->name, sizeof body->name);
        } else if (!text_equal(key, "regionnum")) {
            note_unknown(p, key);
        }
    }
    return true;
}

static void check_orientation(const struct parser *p)
{
    enum sera_axis expected = text_equal(p->orientation, "Sagittal")  ? SERA_RL
                              : text_equal(p->orientation, "Coronal") ? SERA_PA
                                                                      : SERA_IS;
    if (p->orientation[0] && p->grid.along[2].axis != expected)
        report_add(p->report, REPORT_WARNING, "geometry.orientation-differs", p->name,
                   "The header calls the slices %.20s, but its slice axis is another; the axis codes were used.",
                   p->orientation);
}

bool uvh_parse(const uint8_t *data, size_t size, const char *name, struct uvh *uvh, struct report *report,
               struct error *err)
{
    return uvh_parse_in(data, size, name, 0, uvh, report, err);
}

bool uvh_parse_in(const uint8_t *data, size_t size, const char *name, double given_mm, struct uvh *uvh,
                  struct report *report, struct error *err)
{
    *uvh = (struct uvh){ .bodies = mem_new(UVH_MAX_BODIES * sizeof *uvh->bodies) };
    struct parser p = { .name = name, .uvh = uvh, .grid = { .given_mm = given_mm }, .report = report, .err = err };
    text_start(&p.text, data, size);
    char line[TEXT_LINE_SIZE] = "", *key, *value;
    while (line[0] == 0 && text_line(&p.text, line)) {
    }
    bool is_read;
    if (text_equal(line, "uvh1.0"))
        is_read = parse_v1(&p);
    else if (!text_split(line, ":", &key, &value) || !text_equal(key, "Version"))
        is_read = fail(&p, "the first line", line, "\"Version: uvh2.0\" or \"uvh1.0\"");
    else if (!text_equal(value, "uvh2.0"))
        is_read = fail(&p, "the version", value, "uvh2.0");
    else
        is_read = parse_v2(&p);
    if (is_read)
        check_orientation(&p);
    if (!is_read || !sera_grid_resolve(&p.grid, name, &uvh->grid, report, err)) {
        uvh_finish(uvh);
        return false;
    }
    if (p.n_unknown > 0)
        report_add(report, REPORT_NOTE, "header.unknown-key", name,
                   "%zu unknown keys were ignored, the first is \"%s\".", p.n_unknown, p.unknown);
    if (p.n_bad > 0)
        report_add(report, REPORT_WARNING, "header.bad-number", name,
                   "%zu values of bodies are not numbers in range; ignored.", p.n_bad);
    return true;
}

struct volume *uvh_read_univels(const struct uvh *uvh, const struct bytes *data, const char *name, struct error *err)
{
    size_t n = grid_n_voxels(&uvh->grid);
    const uint32_t *size = uvh->grid.size;
    bool is_packed = gzip_is(data->data, data->size) || text_has_ending(name, ".sz");
    if (is_packed ? gzip_most(data->size) < n : data->size < n) {
        error_set(err, ERROR_FORMAT, "%s: cut short: %zu bytes%s, but the header says %u x %u x %u univels", name,
                  data->size, is_packed ? ", packed" : "", size[0], size[1], size[2]);
        return NULL;
    }
    struct volume *volume = volume_create(&uvh->grid, VOXEL_U8, err);
    if (!volume)
        return NULL;
    struct bytes all = { 0 };
    bool is_read = sera_unpack(data, name, (uint64_t)n + 1, &is_packed, &all, err);
    const struct bytes *from = is_packed ? &all : data;
    if (is_read && from->size != n)
        is_read = error_set(err, ERROR_FORMAT, "%s: %zu bytes of univels, but the header says %u x %u x %u = %zu", name,
                            from->size, size[0], size[1], size[2], n);
    if (is_read)
        memcpy(volume->voxels, from->data, n);
    bytes_free(&all);
    if (!is_read) {
        volume_unref(volume);
        return NULL;
    }
    volume_measure(volume);
    return volume;
}
