/* Reads NRRD headers: what the fields mean, data type, axes, geometry, the place of the voxels. */
#include <stdio.h>
#include <string.h>

#include "core/formats/nrrd_fields.h"
#include "core/formats/text.h"

enum { MOST_AXES = 16 };

static bool get_type(const struct nrrd_fields *head, struct nrrd_header *header)
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
        if (nrrd_value_is(head, NRRD_TYPE, types[i].word)) {
            header->type = types[i].type;
            header->voxel_bytes = raw_type_bytes(header->type);
            return true;
        }
    return nrrd_refuse_value(head, NRRD_TYPE, head->values[NRRD_TYPE].line ? ERROR_UNSUPPORTED : ERROR_FORMAT,
                             "a whole number of 8 to 64 bits, float or double");
}

static bool get_encoding(const struct nrrd_fields *head, struct nrrd_header *header)
{
    header->is_packed = nrrd_value_is(head, NRRD_ENCODING, "gzip") || nrrd_value_is(head, NRRD_ENCODING, "gz");
    if (!header->is_packed && !nrrd_value_is(head, NRRD_ENCODING, "raw"))
        return nrrd_refuse_value(head, NRRD_ENCODING,
                                 head->values[NRRD_ENCODING].line ? ERROR_UNSUPPORTED : ERROR_FORMAT, "raw or gzip");
    bool is_big = nrrd_value_is(head, NRRD_ENDIAN, "big");
    if (!is_big && !nrrd_value_is(head, NRRD_ENDIAN, "little") &&
        (header->voxel_bytes > 1 || head->values[NRRD_ENDIAN].line != 0))
        return nrrd_refuse_value(head, NRRD_ENDIAN, ERROR_FORMAT, "little or big");
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

static bool get_sizes(const struct nrrd_fields *head, struct axes *axes)
{
    int64_t n;
    if (!nrrd_get_whole(head, NRRD_DIMENSION, 1, MOST_AXES, &n))
        return false;
    if (n != 3 && n != 4)
        return nrrd_refuse_value(head, NRRD_DIMENSION, ERROR_UNSUPPORTED, "3, or 4 with an axis of layers");
    axes->n = (int)n;
    struct nrrd_value rest = head->values[NRRD_SIZES];
    char word[NRRD_WORD_SIZE];
    for (int i = 0; i < axes->n; i++) {
        double size;
        nrrd_next_word(&rest, " \t", word);
        if (!text_number(word, &size) || size < 1 || size > UINT32_MAX || size != (double)(uint32_t)size)
            return nrrd_refuse_value(head, NRRD_SIZES, ERROR_FORMAT,
                                     axes->n == 3 ? "three whole numbers above 0" : "four whole numbers above 0");
        if (size > VOLUME_MAX_SIDE)
            return nrrd_refuse(head, head->values[NRRD_SIZES].line, ERROR_LIMIT,
                               "sizes: %.0f; at most %d voxels a side are read", size, VOLUME_MAX_SIDE);
        axes->sizes[i] = (uint32_t)size;
    }
    nrrd_next_word(&rest, " \t", word);
    return word[0] == 0 ||
           nrrd_refuse_value(head, NRRD_SIZES, ERROR_FORMAT, axes->n == 3 ? "three numbers" : "four numbers");
}

static bool is_space_kind(const char *kind)
{
    static const char *const kinds[] = { "", "domain", "space", "???", "none" };
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        if (text_equal(kind, kinds[i]))
            return true;
    return false;
}

static bool get_axes(const struct nrrd_fields *head, struct axes *axes)
{
    struct nrrd_value kinds = head->values[NRRD_KINDS], directions = head->values[NRRD_SPACE_DIRECTIONS];
    axes->has_directions = directions.line != 0;
    axes->list = -1;
    int n_other = 0;
    for (int i = 0; i < axes->n; i++) {
        char word[NRRD_WORD_SIZE] = "", clean[NRRD_WORD_SIZE];
        if (kinds.line != 0)
            nrrd_next_word(&kinds, " \t", word);
        text_clean(word, clean, sizeof clean);
        nrrd_copy(clean, strlen(clean), axes->kinds[i], sizeof axes->kinds[i]);
        axes->is_space[i] = is_space_kind(axes->kinds[i]);
        if (axes->has_directions) {
            struct nrrd_value ahead = directions;
            nrrd_next_word(&ahead, " \t", word);
            bool is_none = text_equal(word, "none");
            if (is_none)
                directions = ahead;
            else if (!nrrd_next_vector(&directions, &axes->directions[i]))
                return nrrd_refuse_value(head, NRRD_SPACE_DIRECTIONS, ERROR_RANGE,
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
            return nrrd_refuse(head, head->values[NRRD_DIMENSION].line, ERROR_UNSUPPORTED,
                               "four axes, and neither kinds nor space directions say which one is no axis of space");
        return nrrd_refuse(head,
                           head->values[NRRD_KINDS].line ? head->values[NRRD_KINDS].line
                                                         : head->values[NRRD_SPACE_DIRECTIONS].line,
                           ERROR_UNSUPPORTED, "axis %d (%s) is no axis of space; expected three axes of space in %d",
                           axes->list, axes->kinds[axes->list], axes->n);
    }
    if (axes->list > 0 && axes->list < 3)
        return nrrd_refuse(head, head->values[NRRD_SIZES].line, ERROR_UNSUPPORTED,
                           "the axis of layers is number %d, expected the first or the last", axes->list);
    return true;
}

/* The patient's direction (LPS) of an axis of a space by its word: "left", "L", ... which: 0 for L-R, 1 for P-A, 2 for
 * S-I. Returns false for another word. */
static bool get_direction(const char *word, size_t n, int *which, struct vec3 *direction)
{
    static const char *const words[] = { "left", "right", "posterior", "anterior", "superior", "inferior" };
    char text[16];
    nrrd_copy(word, n, text, sizeof text);
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
static bool get_space(const struct nrrd_fields *head, struct vec3 lps_from_space[3], bool *is_known)
{
    static const char *const elsewhere[] = { "scanner-xyz", "3D-right-handed", "3D-left-handed" };
    const struct nrrd_value *value = &head->values[NRRD_SPACE];
    for (int i = 0; i < 3; i++)
        lps_from_space[i] = vec3(i == 0, i == 1, i == 2);
    *is_known = false;
    int64_t dimension;
    if (head->values[NRRD_SPACE_DIMENSION].line != 0 && !nrrd_get_whole(head, NRRD_SPACE_DIMENSION, 3, 3, &dimension))
        return false;
    if (value->line == 0)
        return true;
    for (size_t i = 0; i < sizeof elsewhere / sizeof elsewhere[0]; i++)
        if (nrrd_value_is(head, NRRD_SPACE, elsewhere[i]))
            return true;
    int seen = 0, which = 0;
    const char *at = value->at, *end = at + value->n;
    for (int i = 0; i < 3; i++) {
        const char *dash = memchr(at, '-', (size_t)(end - at));
        size_t n = value->n == 3 && at < end ? 1 : (size_t)((dash ? dash : end) - at);
        if (!get_direction(at, n, &which, &lps_from_space[i]))
            return nrrd_refuse_value(head, NRRD_SPACE, ERROR_UNSUPPORTED,
                                     "left-posterior-superior, right-anterior-superior or alike");
        seen |= 1 << which;
        at += n;
        at += at < end && *at == '-';
    }
    *is_known = true;
    return (seen == 7 && at == end) ||
           nrrd_refuse_value(head, NRRD_SPACE, ERROR_UNSUPPORTED, "three axes, one along each of L-R, P-A, S-I");
}

static double get_unit_mm(const struct nrrd_fields *head)
{
    static const struct {
        const char *word;
        double mm;
    } units[] = { { "mm", 1 }, { "cm", 10 }, { "m", 1000 }, { "um", 0.001 } };
    struct nrrd_value rest = head->values[NRRD_SPACE_UNITS];
    char word[NRRD_WORD_SIZE];
    if (rest.line == 0)
        return 1;
    nrrd_next_word(&rest, " \t\"", word);
    for (size_t i = 0; i < sizeof units / sizeof units[0]; i++)
        if (text_equal(word, units[i].word) || word[0] == 0)
            return word[0] ? units[i].mm : 1;
    char clean[NRRD_WORD_SIZE];
    text_clean(word, clean, sizeof clean);
    report_add(head->report, REPORT_WARNING, "geometry.unit-assumed", head->name,
               "Line %zu: the unit \"%s\" is not known; millimetres were taken.", rest.line, clean);
    return 1;
}

/* Directions of a header that gives spacings only: along the axes of the space. */
static bool directions_from_spacings(const struct nrrd_fields *head, struct axes *axes)
{
    struct nrrd_value rest = head->values[NRRD_SPACINGS];
    for (int i = 0, along = 0; i < axes->n; i++) {
        char word[NRRD_WORD_SIZE];
        double spacing = 1;
        if (rest.line != 0)
            nrrd_next_word(&rest, " \t", word);
        if (i == axes->list)
            continue;
        if (rest.line != 0 && !text_number(word, &spacing))
            return nrrd_refuse_value(head, NRRD_SPACINGS, ERROR_RANGE, "a finite number for each axis");
        axes->directions[i] = vec3(along == 0 ? spacing : 0, along == 1 ? spacing : 0, along == 2 ? spacing : 0);
        along++;
    }
    return true;
}

/* Reports which parts of its position in the patient the file does not state. */
static void note_assumed(const struct nrrd_fields *head, const struct axes *axes, bool is_known, bool has_origin)
{
    const char *apart = axes->has_directions || head->values[NRRD_SPACINGS].line != 0 ? "" : ", 1 mm apart";
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

static bool get_geometry(const struct nrrd_fields *head, struct axes *axes, struct grid *grid)
{
    struct vec3 lps_from_space[3], origin = vec3(0, 0, 0);
    struct nrrd_value rest = head->values[NRRD_SPACE_ORIGIN];
    bool has_origin = rest.line != 0, is_known;
    if (!get_space(head, lps_from_space, &is_known))
        return false;
    if (has_origin && !nrrd_next_vector(&rest, &origin))
        return nrrd_refuse_value(head, NRRD_SPACE_ORIGIN, ERROR_RANGE, "(x,y,z) of finite numbers");
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
        const struct nrrd_value *value = &head->values[axes->has_directions ? NRRD_SPACE_DIRECTIONS : NRRD_SPACINGS];
        error_prefix(head->err, "%s: line %zu", head->name, value->line ? value->line : head->values[NRRD_SIZES].line);
        return false;
    }
    return true;
}

/* Finds the voxels: after the header, or in a file named relative to it. */
static bool get_place(const struct nrrd_fields *head, struct nrrd_header *header)
{
    const struct nrrd_value *value = &head->values[NRRD_DATA_FILE];
    int64_t skip = 0;
    if (head->values[NRRD_LINE_SKIP].line != 0 && !nrrd_get_whole(head, NRRD_LINE_SKIP, 0, NRRD_MAX_SKIP, &skip))
        return false;
    header->line_skip = (uint64_t)skip;
    if (head->values[NRRD_BYTE_SKIP].line != 0 &&
        !nrrd_get_whole(head, NRRD_BYTE_SKIP, header->is_packed ? 0 : -1, NRRD_MAX_SKIP, &header->byte_skip))
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
        (n >= 4 && memcmp(file, "LIST", 4) == 0 && (n == 4 || file[4] == ' ' || file[4] == '\t')))
        return nrrd_refuse_value(head, NRRD_DATA_FILE, ERROR_UNSUPPORTED, "the name of one file");
    if (file[0] == '/')
        return nrrd_refuse_value(head, NRRD_DATA_FILE, ERROR_RANGE, "a name relative to the header");
    int length =
        snprintf(header->data_file, sizeof header->data_file, "%.*s%.*s", (int)folder, head->name, (int)n, file);
    if (length < 0 || (size_t)length >= sizeof header->data_file)
        return nrrd_refuse_value(head, NRRD_DATA_FILE, ERROR_LIMIT, "a shorter name");
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
    struct nrrd_fields head = { .at = (const char *)bytes, .name = name, .report = report, .err = err };
    struct axes axes = { 0 };
    for (size_t i = 0; i < NRRD_N_FIELDS; i++)
        head.values[i].at = "";
    head.start = head.at;
    head.end = head.at + (is_cut ? NRRD_HEAD_BYTES : size);
    *header = (struct nrrd_header){ 0 };
    if (!nrrd_fields_read(&head, header, is_cut) || !get_type(&head, header) || !get_encoding(&head, header) ||
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
        return nrrd_refuse(&head, head.values[NRRD_SIZES].line, ERROR_LIMIT,
                           "sizes: %llu voxels of %u bytes; at most %llu bytes are read",
                           (unsigned long long)(n_voxels * header->n_layers), header->voxel_bytes,
                           (unsigned long long)VOLUME_MAX_BYTES);
    nrrd_segments_check(header, name, report);
    return true;
}
