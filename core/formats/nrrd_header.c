/* Reads NRRD headers: fields, axes, geometry. */
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "core/formats/nrrd.h"
#include "core/formats/text.h"

enum { MOST_AXES = 16, WORD_SIZE = 64 };

enum field {
    TYPE,
    DIMENSION,
    SIZES,
    ENCODING,
    ENDIAN,
    SPACE,
    SPACE_DIMENSION,
    SPACE_DIRECTIONS,
    SPACE_ORIGIN,
    SPACE_UNITS,
    SPACINGS,
    KINDS,
    DATA_FILE,
    LINE_SKIP,
    BYTE_SKIP,
    N_FIELDS
};
static const char *const field_names[N_FIELDS] = { "type",         "dimension",   "sizes",           "encoding",
                                                   "endian",       "space",       "space dimension", "space directions",
                                                   "space origin", "space units", "spacings",        "kinds",
                                                   "data file",    "line skip",   "byte skip" };
static const struct {
    const char *name;
    enum field field;
} other_names[] = { { "datafile", DATA_FILE }, { "lineskip", LINE_SKIP }, { "byteskip", BYTE_SKIP } };
/* Fields of the format that we do not need. */
static const char *const passed_over[] = { "content",     "number",       "min",         "max",
                                           "old min",     "oldmin",       "old max",     "oldmax",
                                           "thicknesses", "axis mins",    "axismins",    "axis maxs",
                                           "axismaxs",    "centers",      "centerings",  "labels",
                                           "units",       "sample units", "sampleunits", "measurement frame",
                                           "block size",  "blocksize" };

/* The value of a field and its line in the header; line 0 and at "" when the field is absent. */
struct field_value {
    const char *at;
    size_t n, line;
};

struct header_text {
    const char *at, *start, *end;
    size_t line;
    const char *name;
    struct field_value values[N_FIELDS];
    struct report *report;
    struct error *err;
};

static bool refuse(const struct header_text *head, size_t line, enum error_code code, const char *format, ...)
    PRINTF_LIKE(4, 5);
static bool refuse(const struct header_text *head, size_t line, enum error_code code, const char *format, ...)
{
    char what[200];
    va_list args;
    va_start(args, format);
    vsnprintf(what, sizeof what, format, args);
    va_end(args);
    return error_set(head->err, code, "%s: line %zu: %s", head->name, line, what);
}

/* Sets the error for a field with a wrong value. */
static bool refuse_value(const struct header_text *head, enum field field, enum error_code code, const char *expected)
{
    const struct field_value *value = &head->values[field];
    char found[44], clean[44];
    if (value->line == 0)
        return error_set(head->err, code, "%s: the header has no \"%s\", expected %s", head->name, field_names[field],
                         expected);
    snprintf(found, sizeof found, "%.*s", (int)(value->n < 40 ? value->n : 40), value->at);
    text_clean(found, clean, sizeof clean);
    return refuse(head, value->line, code, "%s is \"%s%s\", expected %s", field_names[field], clean,
                  value->n > 40 ? "..." : "", expected);
}

/* ---- lines ------------------------------------------------------------------------------------------------------ */

/* Reads the next line without its end; false at the end of the header's bytes. */
static bool next_line(struct header_text *head, struct field_value *line)
{
    if (head->at >= head->end)
        return false;
    const char *end = memchr(head->at, '\n', (size_t)(head->end - head->at));
    const char *stop = end ? end : head->end;
    head->line++;
    *line = (struct field_value){ head->at, (size_t)(stop - head->at), head->line };
    if (line->n > 0 && line->at[line->n - 1] == '\r')
        line->n--;
    head->at = end ? end + 1 : head->end;
    return true;
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t';
}

static void copy(const char *at, size_t n, char *out, size_t size)
{
    n = n < size - 1 ? n : size - 1;
    memcpy(out, at, n);
    out[n] = 0;
}

static bool keep_field(struct header_text *head, const char *key, const struct field_value *value)
{
    size_t field = 0;
    while (field < N_FIELDS && !text_equal(key, field_names[field]))
        field++;
    for (size_t i = 0; i < sizeof other_names / sizeof other_names[0]; i++)
        if (text_equal(key, other_names[i].name))
            field = other_names[i].field;
    if (field == N_FIELDS) {
        for (size_t i = 0; i < sizeof passed_over / sizeof passed_over[0]; i++)
            if (text_equal(key, passed_over[i]))
                return true;
        char clean[WORD_SIZE];
        text_clean(key, clean, sizeof clean);
        report_add(head->report, REPORT_NOTE, "header.unknown-key", head->name,
                   "Line %zu: \"%s\" is not a field that is known; it was "
                   "ignored.",
                   value->line, clean);
        return true;
    }
    if (head->values[field].line != 0)
        return refuse(head, value->line, ERROR_FORMAT, "\"%s\" is there twice, first in line %zu", field_names[field],
                      head->values[field].line);
    if (value->n >= NRRD_MAX_VALUE)
        return refuse(head, value->line, ERROR_LIMIT, "the value of \"%s\" has %zu characters; at most %d are read",
                      field_names[field], value->n, NRRD_MAX_VALUE - 1);
    head->values[field] = *value;
    return true;
}

static bool take_line(struct header_text *head, const struct field_value *line, struct nrrd_header *header)
{
    const char *colon = memchr(line->at, ':', line->n);
    if (!colon)
        return refuse(head, line->line, ERROR_FORMAT, "expected \"field: value\", found a line without a colon");
    struct field_value value = { colon + 1, line->n - (size_t)(colon - line->at) - 1, line->line };
    char key[WORD_SIZE];
    copy(line->at, (size_t)(colon - line->at), key, sizeof key);
    if (value.n > 0 && *value.at == '=') {
        char text[NRRD_MAX_VALUE];
        copy(value.at + 1, value.n - 1, text, sizeof text);
        nrrd_segment_key(header, head->name, line->line, key, text, head->report);
        return true; /* other pairs are free notes of the writing program */
    }
    while (value.n > 0 && is_blank(*value.at)) {
        value.at++;
        value.n--;
    }
    while (value.n > 0 && is_blank(value.at[value.n - 1]))
        value.n--;
    return keep_field(head, key, &value);
}

static bool get_lines(struct header_text *head, struct nrrd_header *header, bool is_cut)
{
    struct field_value line;
    if (!next_line(head, &line) || line.n != 8 || memcmp(line.at, "NRRD000", 7) != 0 || line.at[7] < '1' ||
        line.at[7] > '5')
        return error_set(head->err, ERROR_FORMAT, "%s: line 1: expected NRRD0001 to NRRD0005: not a NRRD file",
                         head->name);
    bool has_end = false;
    while (!has_end && next_line(head, &line)) {
        has_end = line.n == 0;
        if (!has_end && *line.at != '#' && !take_line(head, &line, header))
            return false;
    }
    header->head_bytes = (size_t)(head->at - head->start);
    if (!has_end && is_cut)
        return error_set(head->err, ERROR_LIMIT, "%s: the header does not end within %d bytes", head->name,
                         NRRD_HEAD_BYTES);
    if (!has_end && head->values[DATA_FILE].line == 0)
        return refuse(head, head->line, ERROR_FORMAT,
                      "the header has no end: expected an empty line and then the voxels, or a \"data file\"");
    return true;
}

/* ---- words and numbers of a value ------------------------------------------------------------------------------- */

/* Reads the next word up to a separator: blanks, or commas within brackets; "" at the end. A word longer than WORD_SIZE
 * is cut, and is then no number. */
static void next_word(struct field_value *rest, const char *separators, char word[WORD_SIZE])
{
    while (rest->n > 0 && strchr(separators, *rest->at)) {
        rest->at++;
        rest->n--;
    }
    size_t n = 0;
    while (n < rest->n && rest->at[n] != 0 && !strchr(separators, rest->at[n]))
        n++;
    copy(rest->at, n, word, WORD_SIZE);
    rest->at += n;
    rest->n -= n;
}

/* Reads a vector, "(1,0,0)". */
static bool next_vector(struct field_value *rest, struct vec3 *vector)
{
    while (rest->n > 0 && is_blank(*rest->at)) {
        rest->at++;
        rest->n--;
    }
    const char *close = rest->n > 0 && *rest->at == '(' ? memchr(rest->at, ')', rest->n) : NULL;
    if (!close)
        return false;
    struct field_value inside = { rest->at + 1, (size_t)(close - rest->at) - 1, rest->line };
    rest->n -= (size_t)(close + 1 - rest->at);
    rest->at = close + 1;
    double v[3];
    char word[WORD_SIZE];
    for (int i = 0; i < 3; i++) {
        next_word(&inside, ", \t", word);
        if (!text_number(word, &v[i]))
            return false;
    }
    next_word(&inside, ", \t", word);
    *vector = vec3(v[0], v[1], v[2]);
    return word[0] == 0;
}

static bool get_whole(const struct header_text *head, enum field field, double least, double most, int64_t *out)
{
    struct field_value rest = head->values[field];
    char word[WORD_SIZE], expected[80];
    double number = 0;
    next_word(&rest, " \t", word);
    bool is_number = text_number(word, &number) && rest.n == 0;
    if (!is_number || number < least || number > most || number != (double)(int64_t)number) {
        snprintf(expected, sizeof expected, "a whole number from %.0f to %.0f", least, most);
        return refuse_value(head, field, is_number && number > most ? ERROR_LIMIT : ERROR_FORMAT, expected);
    }
    *out = (int64_t)number;
    return true;
}

static bool value_is(const struct header_text *head, enum field field, const char *word)
{
    const struct field_value *value = &head->values[field];
    char text[WORD_SIZE];
    copy(value->at, value->line ? value->n : 0, text, sizeof text);
    return value->line != 0 && text_equal(text, word);
}

/* ---- meaning of the fields -------------------------------------------------------------------------------------- */

static bool get_type(const struct header_text *head, struct nrrd_header *header)
{
    static const struct {
        const char *word;
        enum raw_type type;
    } types[] = { { "signed char", RAW_I8 },
                  { "int8", RAW_I8 },
                  { "int8_t", RAW_I8 },
                  { "uchar", RAW_U8 },
                  { "unsigned char", RAW_U8 },
                  { "uint8", RAW_U8 },
                  { "uint8_t", RAW_U8 },
                  { "short", RAW_I16 },
                  { "short int", RAW_I16 },
                  { "signed short", RAW_I16 },
                  { "signed short int", RAW_I16 },
                  { "int16", RAW_I16 },
                  { "int16_t", RAW_I16 },
                  { "ushort", RAW_U16 },
                  { "unsigned short", RAW_U16 },
                  { "unsigned short int", RAW_U16 },
                  { "uint16", RAW_U16 },
                  { "uint16_t", RAW_U16 },
                  { "int", RAW_I32 },
                  { "signed int", RAW_I32 },
                  { "int32", RAW_I32 },
                  { "int32_t", RAW_I32 },
                  { "uint", RAW_U32 },
                  { "unsigned int", RAW_U32 },
                  { "uint32", RAW_U32 },
                  { "uint32_t", RAW_U32 },
                  { "longlong", RAW_I64 },
                  { "long long", RAW_I64 },
                  { "long long int", RAW_I64 },
                  { "signed long long", RAW_I64 },
                  { "signed long long int", RAW_I64 },
                  { "int64", RAW_I64 },
                  { "int64_t", RAW_I64 },
                  { "ulonglong", RAW_U64 },
                  { "unsigned long long", RAW_U64 },
                  { "unsigned long long int", RAW_U64 },
                  { "uint64", RAW_U64 },
                  { "uint64_t", RAW_U64 },
                  { "float", RAW_F32 },
                  { "double", RAW_F64 } };
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
        if (value_is(head, TYPE, types[i].word)) {
            header->type = types[i].type;
            header->voxel_bytes = raw_type_bytes(header->type);
            return true;
        }
    return refuse_value(head, TYPE, head->values[TYPE].line ? ERROR_UNSUPPORTED : ERROR_FORMAT,
                        "a whole number of 8 to 64 bits, float or double");
}

static bool get_encoding(const struct header_text *head, struct nrrd_header *header)
{
    header->is_packed = value_is(head, ENCODING, "gzip") || value_is(head, ENCODING, "gz");
    if (!header->is_packed && !value_is(head, ENCODING, "raw"))
        return refuse_value(head, ENCODING, head->values[ENCODING].line ? ERROR_UNSUPPORTED : ERROR_FORMAT,
                            "raw or gzip");
    bool is_big = value_is(head, ENDIAN, "big");
    if (!is_big && !value_is(head, ENDIAN, "little") && (header->voxel_bytes > 1 || head->values[ENDIAN].line != 0))
        return refuse_value(head, ENDIAN, ERROR_FORMAT, "little or big");
    header->is_swapped = header->voxel_bytes > 1 && is_big != (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__);
    return true;
}

struct axes {
    int n;
    uint32_t sizes[4];
    bool has_directions;
    struct vec3 directions[4];
    bool is_space[4];
    char kinds[4][16]; /* "" when not given */
    int list;          /* index of the axis of layers; -1: none */
};

static bool get_sizes(const struct header_text *head, struct axes *axes)
{
    int64_t n;
    if (!get_whole(head, DIMENSION, 1, MOST_AXES, &n))
        return false;
    if (n != 3 && n != 4)
        return refuse_value(head, DIMENSION, ERROR_UNSUPPORTED, "3, or 4 with an axis of layers");
    axes->n = (int)n;
    struct field_value rest = head->values[SIZES];
    char word[WORD_SIZE];
    for (int i = 0; i < axes->n; i++) {
        double size;
        next_word(&rest, " \t", word);
        if (!text_number(word, &size) || size < 1 || size > UINT32_MAX || size != (double)(uint32_t)size)
            return refuse_value(head, SIZES, ERROR_FORMAT,
                                axes->n == 3 ? "three whole numbers above 0" : "four whole numbers above 0");
        if (size > VOLUME_MAX_SIDE)
            return refuse(head, head->values[SIZES].line, ERROR_LIMIT, "sizes: %.0f; at most %d voxels a side are read",
                          size, VOLUME_MAX_SIDE);
        axes->sizes[i] = (uint32_t)size;
    }
    next_word(&rest, " \t", word);
    return word[0] == 0 || refuse_value(head, SIZES, ERROR_FORMAT, axes->n == 3 ? "three numbers" : "four numbers");
}

static bool is_space_kind(const char *kind)
{
    static const char *const kinds[] = { "", "domain", "space", "???", "none" };
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        if (text_equal(kind, kinds[i]))
            return true;
    return false;
}

static bool get_axes(const struct header_text *head, struct axes *axes)
{
    struct field_value kinds = head->values[KINDS], directions = head->values[SPACE_DIRECTIONS];
    axes->has_directions = directions.line != 0;
    axes->list = -1;
    int n_other = 0;
    for (int i = 0; i < axes->n; i++) {
        char word[WORD_SIZE] = "", clean[WORD_SIZE];
        if (kinds.line != 0)
            next_word(&kinds, " \t", word);
        text_clean(word, clean, sizeof clean);
        copy(clean, strlen(clean), axes->kinds[i], sizeof axes->kinds[i]);
        axes->is_space[i] = is_space_kind(axes->kinds[i]);
        if (axes->has_directions) {
            struct field_value ahead = directions;
            next_word(&ahead, " \t", word);
            bool is_none = text_equal(word, "none");
            if (is_none)
                directions = ahead;
            else if (!next_vector(&directions, &axes->directions[i]))
                return refuse_value(head, SPACE_DIRECTIONS, ERROR_RANGE,
                                    "(x,y,z) of finite numbers for each axis, or none");
            axes->is_space[i] = axes->is_space[i] && !is_none;
        }
        if (!axes->is_space[i]) {
            axes->list = i;
            n_other++;
        }
    }
    if (axes->n - n_other != 3) {
        if (axes->list < 0)
            return refuse(head, head->values[DIMENSION].line, ERROR_UNSUPPORTED,
                          "four axes, and neither kinds nor space directions say which one is no axis of space");
        return refuse(head, head->values[KINDS].line ? head->values[KINDS].line : head->values[SPACE_DIRECTIONS].line,
                      ERROR_UNSUPPORTED, "axis %d (%s) is no axis of space; expected three axes of space in %d",
                      axes->list, axes->kinds[axes->list], axes->n);
    }
    if (axes->list > 0 && axes->list < 3)
        return refuse(head, head->values[SIZES].line, ERROR_UNSUPPORTED,
                      "the axis of layers is number %d, expected the first or the last", axes->list);
    return true;
}

/* The patient's direction (LPS) of an axis of a space by its word: "left", "L", ... which: 0 for L-R, 1 for P-A, 2 for
 * S-I. Returns false for another word. */
static bool get_direction(const char *word, size_t n, int *which, struct vec3 *direction)
{
    static const char *const words[] = { "left", "right", "posterior", "anterior", "superior", "inferior" };
    char text[16];
    copy(word, n, text, sizeof text);
    for (int i = 0; i < 6; i++) {
        char letter[2] = { words[i][0], 0 };
        if (!text_equal(text, words[i]) && !text_equal(text, letter))
            continue;
        double sign = i % 2 ? -1 : 1;
        *which = i / 2;
        *direction = vec3(i / 2 == 0 ? sign : 0, i / 2 == 1 ? sign : 0, i / 2 == 2 ? sign : 0);
        return true;
    }
    return false;
}

/* Reads the file's space, "left-posterior-superior", "LPS" or any other order: the patient's direction along each of
 * its three axes. */
static bool get_space(const struct header_text *head, struct vec3 lps_from_space[3], bool *is_known)
{
    static const char *const elsewhere[] = { "scanner-xyz", "3D-right-handed", "3D-left-handed" };
    const struct field_value *value = &head->values[SPACE];
    for (int i = 0; i < 3; i++)
        lps_from_space[i] = vec3(i == 0, i == 1, i == 2);
    *is_known = false;
    int64_t dimension;
    if (head->values[SPACE_DIMENSION].line != 0 && !get_whole(head, SPACE_DIMENSION, 3, 3, &dimension))
        return false;
    if (value->line == 0)
        return true;
    for (size_t i = 0; i < sizeof elsewhere / sizeof elsewhere[0]; i++)
        if (value_is(head, SPACE, elsewhere[i]))
            return true;
    int seen = 0, which = 0;
    const char *at = value->at, *end = at + value->n;
    for (int i = 0; i < 3; i++) {
        const char *dash = memchr(at, '-', (size_t)(end - at));
        size_t n = value->n == 3 && at < end ? 1 : (size_t)((dash ? dash : end) - at);
        if (!get_direction(at, n, &which, &lps_from_space[i]))
            return refuse_value(head, SPACE, ERROR_UNSUPPORTED,
                                "left-posterior-superior, right-anterior-superior or alike");
        seen |= 1 << which;
        at += n;
        at += at < end && *at == '-';
    }
    *is_known = true;
    return (seen == 7 && at == end) ||
           refuse_value(head, SPACE, ERROR_UNSUPPORTED, "three axes, one along each of L-R, P-A, S-I");
}

static double get_unit_mm(const struct header_text *head)
{
    static const struct {
        const char *word;
        double mm;
    } units[] = { { "mm", 1 }, { "cm", 10 }, { "m", 1000 }, { "um", 0.001 } };
    struct field_value rest = head->values[SPACE_UNITS];
    char word[WORD_SIZE];
    if (rest.line == 0)
        return 1;
    next_word(&rest, " \t\"", word);
    for (size_t i = 0; i < sizeof units / sizeof units[0]; i++)
        if (text_equal(word, units[i].word) || word[0] == 0)
            return word[0] ? units[i].mm : 1;
    char clean[WORD_SIZE];
    text_clean(word, clean, sizeof clean);
    report_add(head->report, REPORT_WARNING, "geometry.unit-assumed", head->name,
               "Line %zu: the unit \"%s\" is not known; millimetres were taken.", rest.line, clean);
    return 1;
}

/* Directions of a header that gives spacings only: along the axes of the space. */
static bool directions_from_spacings(const struct header_text *head, struct axes *axes)
{
    struct field_value rest = head->values[SPACINGS];
    for (int i = 0, along = 0; i < axes->n; i++) {
        char word[WORD_SIZE];
        double spacing = 1;
        if (rest.line != 0)
            next_word(&rest, " \t", word);
        if (i == axes->list)
            continue;
        if (rest.line != 0 && !text_number(word, &spacing))
            return refuse_value(head, SPACINGS, ERROR_RANGE, "a finite number for each axis");
        axes->directions[i] = vec3(along == 0 ? spacing : 0, along == 1 ? spacing : 0, along == 2 ? spacing : 0);
        along++;
    }
    return true;
}

/* Reports what the file does not say about its position in the patient. */
static void note_assumed(const struct header_text *head, const struct axes *axes, bool is_known, bool has_origin)
{
    const char *apart = axes->has_directions || head->values[SPACINGS].line != 0 ? "" : ", 1 mm apart";
    if (!is_known)
        report_add(
            head->report, REPORT_WARNING, "geometry.assumed", head->name,
            "The file does not say how the axes of its space lie in the patient; they were taken to grow to the left, the "
            "posterior and the superior side%s. Left and right may be wrong.",
            apart);
    else if (!axes->has_directions)
        report_add(
            head->report, REPORT_WARNING, "geometry.assumed", head->name,
            "The file gives no directions; its voxels were taken to lie along the axes of its space%s. Left and right may be "
            "wrong.",
            apart);
    else if (!has_origin)
        report_add(head->report, REPORT_WARNING, "geometry.assumed", head->name,
                   "The file does not say where its first voxel lies; it was put at the origin.");
}

static bool get_geometry(const struct header_text *head, struct axes *axes, struct grid *grid)
{
    struct vec3 lps_from_space[3], origin = vec3(0, 0, 0);
    struct field_value rest = head->values[SPACE_ORIGIN];
    bool has_origin = rest.line != 0, is_known;
    if (!get_space(head, lps_from_space, &is_known))
        return false;
    if (has_origin && !next_vector(&rest, &origin))
        return refuse_value(head, SPACE_ORIGIN, ERROR_RANGE, "(x,y,z) of finite numbers");
    if (!axes->has_directions && !directions_from_spacings(head, axes))
        return false;
    note_assumed(head, axes, is_known, has_origin);
    double mm = get_unit_mm(head);
    struct affine map = { .origin = vec3(0, 0, 0) };
    struct affine lps = { { lps_from_space[0], lps_from_space[1], lps_from_space[2] }, vec3(0, 0, 0) };
    uint32_t size[3] = { 0 };
    for (int i = 0, along = 0; i < axes->n; i++) {
        if (i == axes->list)
            continue;
        size[along] = axes->sizes[i];
        map.columns[along++] = vec3_scale(affine_vector(&lps, axes->directions[i]), mm);
    }
    map.origin = vec3_scale(affine_vector(&lps, origin), mm);
    if (!grid_init(grid, size, &map, head->err)) {
        const struct field_value *value = &head->values[axes->has_directions ? SPACE_DIRECTIONS : SPACINGS];
        error_prefix(head->err, "%s: line %zu", head->name, value->line ? value->line : head->values[SIZES].line);
        return false;
    }
    return true;
}

/* Finds the voxels: after the header, or in a file named relative to it. */
static bool get_place(const struct header_text *head, struct nrrd_header *header)
{
    const struct field_value *value = &head->values[DATA_FILE];
    int64_t skip = 0;
    if (head->values[LINE_SKIP].line != 0 && !get_whole(head, LINE_SKIP, 0, NRRD_MAX_SKIP, &skip))
        return false;
    header->line_skip = (uint64_t)skip;
    if (head->values[BYTE_SKIP].line != 0 &&
        !get_whole(head, BYTE_SKIP, header->is_packed ? 0 : -1, NRRD_MAX_SKIP, &header->byte_skip))
        return false;
    if (value->line == 0)
        return true;
    const char *slash = strrchr(head->name, '/');
    const char *file = value->at;
    size_t n = value->n, folder = slash ? (size_t)(slash + 1 - head->name) : 0;
    bool is_local = n > 2 && file[0] == '.' && file[1] == '/';
    file += is_local ? 2 : 0;
    n -= is_local ? 2 : 0;
    if (n == 0 || memchr(file, 0, n) || memchr(file, '%', n) ||
        (n >= 4 && memcmp(file, "LIST", 4) == 0 && (n == 4 || is_blank(file[4]))))
        return refuse_value(head, DATA_FILE, ERROR_UNSUPPORTED, "the name of one file");
    if (file[0] == '/')
        return refuse_value(head, DATA_FILE, ERROR_RANGE, "a name relative to the header");
    int length =
        snprintf(header->data_file, sizeof header->data_file, "%.*s%.*s", (int)folder, head->name, (int)n, file);
    if (length < 0 || (size_t)length >= sizeof header->data_file)
        return refuse_value(head, DATA_FILE, ERROR_LIMIT, "a shorter name");
    if (!folder_check_name(header->data_file, head->err)) {
        header->data_file[0] = 0;
        error_prefix(head->err, "%s: line %zu: data file", head->name, value->line);
        return false;
    }
    return true;
}

bool nrrd_parse_header(const uint8_t *bytes, size_t size, const char *name, struct nrrd_header *header,
                       struct report *report, struct error *err)
{
    bool is_cut = size >= NRRD_HEAD_BYTES;
    struct header_text head = { .at = (const char *)bytes, .name = name, .report = report, .err = err };
    struct axes axes = { 0 };
    for (size_t i = 0; i < N_FIELDS; i++)
        head.values[i].at = "";
    head.start = head.at;
    head.end = head.at + (is_cut ? NRRD_HEAD_BYTES : size);
    *header = (struct nrrd_header){ 0 };
    if (!get_lines(&head, header, is_cut) || !get_type(&head, header) || !get_encoding(&head, header) ||
        !get_sizes(&head, &axes) || !get_axes(&head, &axes) || !get_geometry(&head, &axes, &header->grid) ||
        !get_place(&head, header))
        return false;
    header->n_layers = axes.list >= 0 ? axes.sizes[axes.list] : 1;
    header->is_layer_fastest = axes.list == 0;
    if (axes.list >= 0)
        memcpy(header->list_kind, axes.kinds[axes.list], sizeof header->list_kind);
    uint64_t n_voxels = grid_n_voxels(&header->grid); /* at most 2^36, so the product stays below 2^51 */
    header->data_bytes = n_voxels * header->n_layers * header->voxel_bytes;
    if (header->data_bytes > VOLUME_MAX_BYTES)
        return refuse(&head, head.values[SIZES].line, ERROR_LIMIT,
                      "sizes: %llu voxels of %u bytes; at most %llu bytes are read",
                      (unsigned long long)(n_voxels * header->n_layers), header->voxel_bytes,
                      (unsigned long long)VOLUME_MAX_BYTES);
    nrrd_segments_check(header, name, report);
    return true;
}
