/* Reads MetaImage. */
#include "core/formats/metaimage.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/formats/text.h"
#include "core/formats/zlib_stream.h"

enum { VALUE_SIZE = 512 };

enum key {
    OBJECT_TYPE,
    N_DIMS,
    DIM_SIZE,
    SPACING,
    SIZE,
    OFFSET,
    POSITION,
    ORIGIN,
    MATRIX,
    ROTATION,
    ORIENTATION,
    BINARY,
    MSB,
    ELEMENT_MSB,
    PACKED,
    TYPE,
    CHANNELS,
    HEADER_SIZE,
    UNITS,
    SLOPE,
    INTERCEPT,
    DATA_FILE,
    N_KEYS
};
static const char *const key_words[N_KEYS] = {
    "ObjectType",
    "NDims",
    "DimSize",
    "ElementSpacing",
    "ElementSize",
    "Offset",
    "Position",
    "Origin",
    "TransformMatrix",
    "Rotation",
    "Orientation",
    "BinaryData",
    "BinaryDataByteOrderMSB",
    "ElementByteOrderMSB",
    "CompressedData",
    "ElementType",
    "ElementNumberOfChannels",
    "HeaderSize",
    "DistanceUnits",
    "ElementToIntensityFunctionSlope",
    "ElementToIntensityFunctionOffset",
    "ElementDataFile",
};

struct reading {
    const char *name;
    struct metaimage_header *header;
    struct report *report;
    struct error *err;
    char values[N_KEYS][VALUE_SIZE]; /* "" not given */
    size_t lines[N_KEYS];            /* from 1; 0: not given */
};

static bool refuse(const struct reading *reading, enum key key, enum error_code code, const char *expected)
{
    char clean[64];
    text_clean(reading->values[key], clean, sizeof clean);
    return error_set(reading->err, code, "%s: line %zu: %s is '%s', expected %s", reading->name, reading->lines[key],
                     key_words[key], clean, expected);
}

/* ---- lines -------------------------------------------------------------------------------------------------------- */

static bool take_line(struct reading *reading, const char *at, size_t n, size_t number)
{
    const char *equals = memchr(at, '=', n);
    if (!equals || memchr(at, '\0', n))
        return error_set(reading->err, ERROR_FORMAT, "%s: line %zu: expected KEY = VALUE", reading->name, number);
    size_t key_n = (size_t)(equals - at), value_n = n - key_n - 1;
    while (key_n > 0 && (at[key_n - 1] == ' ' || at[key_n - 1] == '\t'))
        key_n--;
    const char *value = equals + 1;
    while (value_n > 0 && (*value == ' ' || *value == '\t')) {
        value++;
        value_n--;
    }
    while (value_n > 0 && strchr(" \t\r", value[value_n - 1]))
        value_n--;
    for (int key = 0; key < N_KEYS; key++) {
        if (strlen(key_words[key]) != key_n || memcmp(key_words[key], at, key_n) != 0)
            continue;
        if (reading->lines[key] || value_n >= VALUE_SIZE)
            return error_set(reading->err, ERROR_FORMAT, "%s: line %zu: %s is there twice, or longer than %d bytes",
                             reading->name, number, key_words[key], VALUE_SIZE - 1);
        memcpy(reading->values[key], value, value_n);
        reading->lines[key] = number;
    }
    return true;
}

/* The header ends with the line of the data file. */
static bool read_lines(struct reading *reading, const uint8_t *head, size_t size)
{
    size_t at = 0;
    for (size_t number = 1; !reading->lines[DATA_FILE]; number++) {
        const uint8_t *end = at < size ? memchr(head + at, '\n', size - at) : NULL;
        if (!end && at >= size)
            return error_set(reading->err, ERROR_FORMAT, "%s: no ElementDataFile within %zu bytes", reading->name,
                             size);
        size_t n = end ? (size_t)(end - head) - at : size - at;
        if (n > 0 && !(n == 1 && head[at] == '\r') && !take_line(reading, (const char *)head + at, n, number))
            return false;
        at += n + (end != NULL);
    }
    reading->header->head_bytes = at;
    return true;
}

/* ---- values ------------------------------------------------------------------------------------------------------- */

/* n numbers, no more. */
static bool numbers(const struct reading *reading, enum key key, int n, double *out)
{
    char copy[VALUE_SIZE], *rest = NULL, what[48];
    memcpy(copy, reading->values[key], sizeof copy);
    char *word = strtok_r(copy, " \t", &rest);
    snprintf(what, sizeof what, "%d numbers", n);
    for (int i = 0; i < n; i++, word = strtok_r(NULL, " \t", &rest))
        if (!word || !text_number(word, &out[i]))
            return refuse(reading, key, ERROR_FORMAT, what);
    return !word || refuse(reading, key, ERROR_FORMAT, what);
}

static bool flag(const struct reading *reading, enum key key, bool *is_true)
{
    char first = reading->values[key][0];
    *is_true = first == 'T' || first == 't' || first == '1';
    return !reading->lines[key] || *is_true || first == 'F' || first == 'f' || first == '0' ||
           refuse(reading, key, ERROR_FORMAT, "True or False");
}

static bool take_type(struct reading *reading)
{
    static const struct {
        const char *word;
        enum raw_type type;
    } types[] = { { "MET_CHAR", RAW_I8 },        { "MET_UCHAR", RAW_U8 },  { "MET_SHORT", RAW_I16 },
                  { "MET_USHORT", RAW_U16 },     { "MET_INT", RAW_I32 },   { "MET_UINT", RAW_U32 },
                  { "MET_LONG", RAW_I32 },       { "MET_ULONG", RAW_U32 }, { "MET_LONG_LONG", RAW_I64 },
                  { "MET_ULONG_LONG", RAW_U64 }, { "MET_FLOAT", RAW_F32 }, { "MET_DOUBLE", RAW_F64 } };
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (strcmp(reading->values[TYPE], types[i].word) == 0) {
            reading->header->type = types[i].type;
            return true;
        }
    return refuse(reading, TYPE, ERROR_UNSUPPORTED, "a type of one number, as MET_SHORT");
}

static bool take_size(struct reading *reading, int n_dims, uint32_t size[3])
{
    double sides[3] = { 1, 1, 1 };
    if (!numbers(reading, DIM_SIZE, n_dims, sides))
        return false;
    for (int i = 0; i < 3; i++) {
        if (!(sides[i] >= 1 && sides[i] <= VOLUME_MAX_SIDE && sides[i] == floor(sides[i])))
            return refuse(reading, DIM_SIZE, ERROR_LIMIT, "whole numbers from 1 to 4096");
        size[i] = (uint32_t)sides[i];
    }
    return true;
}

/* The first of several keys of one meaning that is given; N_KEYS: none. */
static enum key first_given(const struct reading *reading, enum key a, enum key b, enum key c)
{
    return reading->lines[a] ? a : reading->lines[b] ? b : c != N_KEYS && reading->lines[c] ? c : N_KEYS;
}

static bool take_grid(struct reading *reading, int n_dims)
{
    double spacing[3] = { 1, 1, 1 }, offset[3] = { 0 }, flat[9], matrix[9] = { 1, 0, 0, 0, 1, 0, 0, 0, 1 };
    enum key spacing_key = first_given(reading, SPACING, SIZE, N_KEYS),
             offset_key = first_given(reading, OFFSET, POSITION, ORIGIN),
             matrix_key = first_given(reading, MATRIX, ROTATION, ORIENTATION);
    uint32_t size[3];
    if (!take_size(reading, n_dims, size) ||
        (spacing_key != N_KEYS && !numbers(reading, spacing_key, n_dims, spacing)) ||
        (offset_key != N_KEYS && !numbers(reading, offset_key, n_dims, offset)))
        return false;
    if (matrix_key != N_KEYS && !numbers(reading, matrix_key, n_dims * n_dims, flat))
        return false;
    for (int i = 0; i < n_dims && matrix_key != N_KEYS; i++)
        for (int j = 0; j < n_dims; j++)
            matrix[3 * i + j] = flat[n_dims * i + j];
    struct affine map = { .origin = vec3(offset[0], offset[1], offset[2]) };
    for (int i = 0; i < 3; i++)
        map.columns[i] = vec3_scale(vec3(matrix[3 * i], matrix[3 * i + 1], matrix[3 * i + 2]), spacing[i]);
    if (!grid_init(&reading->header->grid, size, &map, reading->err)) {
        error_prefix(reading->err, "%s", reading->name);
        return false;
    }
    char missing[96] = "";
    snprintf(missing, sizeof missing, "%s%s%s%s", spacing_key == N_KEYS ? " spacing," : "",
             offset_key == N_KEYS ? " place of the first voxel," : "", matrix_key == N_KEYS ? " directions," : "",
             n_dims == 2 ? " thickness of its one slice," : "");
    if (missing[0]) {
        missing[strlen(missing) - 1] = '\0';
        report_add(reading->report, REPORT_WARNING, "image.place-assumed", reading->name,
                   "The header gives no %s: 1 mm, the origin and the axes L, P, S were taken.", missing + 1);
    }
    return true;
}

static bool take_data_file(struct reading *reading)
{
    struct metaimage_header *header = reading->header;
    const char *value = reading->values[DATA_FILE], *slash = strrchr(reading->name, '/');
    if (text_equal(value, "LOCAL"))
        return true;
    if (!value[0] || strncmp(value, "LIST", 4) == 0 || strchr(value, '%'))
        return refuse(reading, DATA_FILE, ERROR_UNSUPPORTED, "LOCAL, or the name of one file");
    int n = snprintf(header->data_file, sizeof header->data_file, "%.*s%s",
                     slash ? (int)(slash + 1 - reading->name) : 0, reading->name, value);
    return (n < FOLDER_NAME_SIZE && folder_check_name(header->data_file, NULL)) ||
           refuse(reading, DATA_FILE, ERROR_RANGE, "a file in the plan's folder");
}

static bool take_skip(struct reading *reading)
{
    double skip = 0;
    if (reading->lines[HEADER_SIZE] && !numbers(reading, HEADER_SIZE, 1, &skip))
        return false;
    if (!(skip >= -1 && skip <= 1 << 30 && skip == floor(skip)))
        return refuse(reading, HEADER_SIZE, ERROR_LIMIT, "-1, or up to a gibibyte");
    reading->header->skip = (int64_t)skip;
    return true;
}

/* Readers pass these over; where they say anything, lengths or values would be wrong by a factor. */
static bool check_units(const struct reading *reading)
{
    const char *units = reading->values[UNITS];
    double slope = 1, offset = 0;
    if (reading->lines[UNITS] && units[0] && strcmp(units, "mm") != 0 && strcmp(units, "?") != 0)
        return refuse(reading, UNITS, ERROR_UNSUPPORTED, "mm");
    if (reading->lines[SLOPE] && (!numbers(reading, SLOPE, 1, &slope) || slope != 1))
        return refuse(reading, SLOPE, ERROR_UNSUPPORTED, "1");
    return !reading->lines[INTERCEPT] || (numbers(reading, INTERCEPT, 1, &offset) && offset == 0) ||
           refuse(reading, INTERCEPT, ERROR_UNSUPPORTED, "0");
}

static bool take_values(struct reading *reading)
{
    struct metaimage_header *header = reading->header;
    bool is_binary = true, is_big = false, is_big_too = false;
    double n_dims = 0, n_channels = 1;
    static const enum key needed[] = { N_DIMS, DIM_SIZE, TYPE };
    for (size_t i = 0; i < sizeof needed / sizeof *needed; i++)
        if (!reading->lines[needed[i]])
            return error_set(reading->err, ERROR_FORMAT, "%s: the header gives no %s", reading->name,
                             key_words[needed[i]]);
    if (reading->lines[OBJECT_TYPE] && strcmp(reading->values[OBJECT_TYPE], "Image") != 0)
        return refuse(reading, OBJECT_TYPE, ERROR_UNSUPPORTED, "Image");
    if (!numbers(reading, N_DIMS, 1, &n_dims))
        return false;
    if (n_dims != 2 && n_dims != 3)
        return refuse(reading, N_DIMS, ERROR_UNSUPPORTED, "2 or 3");
    if (reading->lines[CHANNELS] && (!numbers(reading, CHANNELS, 1, &n_channels) || n_channels != 1))
        return refuse(reading, CHANNELS, ERROR_UNSUPPORTED, "1");
    if ((reading->lines[BINARY] && !flag(reading, BINARY, &is_binary)) || !flag(reading, MSB, &is_big) ||
        !flag(reading, ELEMENT_MSB, &is_big_too) || !flag(reading, PACKED, &header->is_packed))
        return false;
    if (!is_binary)
        return refuse(reading, BINARY, ERROR_UNSUPPORTED, "True");
    if (!check_units(reading) || !take_type(reading) || !take_grid(reading, (int)n_dims) || !take_data_file(reading) ||
        !take_skip(reading))
        return false;
    header->is_swapped = is_big || is_big_too;
    header->data_bytes = (uint64_t)grid_n_voxels(&header->grid) * raw_type_bytes(header->type);
    return header->data_bytes <= VOLUME_MAX_BYTES ||
           error_set(reading->err, ERROR_LIMIT, "%s: %llu bytes of voxels, at most %llu expected", reading->name,
                     (unsigned long long)header->data_bytes, (unsigned long long)VOLUME_MAX_BYTES);
}

bool metaimage_parse_header(const uint8_t *head, size_t size, const char *name, struct metaimage_header *header,
                            struct report *report, struct error *err)
{
    struct reading reading = { .name = name, .header = header, .report = report, .err = err };
    *header = (struct metaimage_header){ 0 };
    return read_lines(&reading, head, size < METAIMAGE_HEAD_BYTES ? size : METAIMAGE_HEAD_BYTES) &&
           take_values(&reading);
}

/* ---- voxels ------------------------------------------------------------------------------------------------------- */

static bool find_start(const struct metaimage_header *header, const struct bytes *data, const char *name, size_t *start,
                       struct error *err)
{
    uint64_t at = header->data_file[0] ? 0 : header->head_bytes;
    if (header->skip >= 0)
        at += (uint64_t)header->skip;
    else if (!header->is_packed && data->size >= header->data_bytes)
        at = data->size - header->data_bytes;
    *start = (size_t)at;
    return at <= data->size ||
           error_set(err, ERROR_FORMAT, "%s: cut short: %zu bytes, but the voxels begin at byte %llu", name, data->size,
                     (unsigned long long)at);
}

struct volume *metaimage_read(const struct metaimage_header *header, const struct bytes *data, const char *data_name,
                              enum raw_use use, struct report *report, struct error *err)
{
    struct bytes plain = { 0 };
    struct raw_unpacked unpacked;
    struct volume *volume = NULL;
    size_t start;
    if (!find_start(header, data, data_name, &start, err))
        return NULL;
    struct raw_place place = { .file = { data->data + start, data->size - start },
                               .is_swapped = header->is_swapped,
                               .data_bytes = header->data_bytes,
                               .voxel_bytes = raw_type_bytes(header->type) };
    if (header->is_packed) {
        if (!zlib_all(place.file.data, place.file.size, data_name, header->data_bytes, &plain, err))
            return NULL;
        place.file = plain;
    }
    if (raw_unpack(&place, data_name, &unpacked, report, err)) {
        struct raw_voxels voxels = {
            unpacked.data, grid_n_voxels(&header->grid), header->type, &header->grid, 1, 0, data_name, &unpacked.owned
        };
        volume = raw_read(&voxels, use, report, err);
        free(unpacked.owned);
    }
    bytes_free(&plain);
    return volume;
}
