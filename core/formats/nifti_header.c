/* Reads NIfTI-1 and NIfTI-2 headers: data type, scaling, geometry. */
#include <math.h>
#include <nifti/nifti1.h>
#include <stdio.h>
#include <string.h>

#include "core/formats/gzip.h"
#include "core/formats/nifti.h"
#include "core/formats/text.h"

enum { HEADER1_BYTES = 348, HEADER2_BYTES = 540 };

/* The fields of either version, in types wide enough for both. */
struct fields {
    int64_t dim[8];
    double pixdim[8];
    int datatype, bitpix;
    double vox_offset, slope, offset;
    int qform_code, sform_code, units;
    double quatern[3], qoffset[3], srow[3][4];
    char magic[8];
    bool is_pair;
};

static uint64_t get_bytes(const uint8_t *at, size_t n, bool is_big)
{
    uint64_t value = 0;
    for (size_t i = 0; i < n; i++)
        value |= (uint64_t)at[is_big ? n - 1 - i : i] << (8 * i);
    return value;
}
static int get_i16(const uint8_t *at, bool is_big)
{
    return (int16_t)get_bytes(at, 2, is_big);
}
static int get_i32(const uint8_t *at, bool is_big)
{
    return (int32_t)get_bytes(at, 4, is_big);
}
static double get_f32(const uint8_t *at, bool is_big)
{
    uint32_t raw = (uint32_t)get_bytes(at, 4, is_big);
    float value;
    memcpy(&value, &raw, sizeof value);
    return (double)value;
}
static double get_f64(const uint8_t *at, bool is_big)
{
    uint64_t raw = get_bytes(at, 8, is_big);
    double value;
    memcpy(&value, &raw, sizeof value);
    return value;
}

/* Offsets are those of struct nifti_1_header. */
static void get_fields1(const uint8_t *h, bool is_big, struct fields *f)
{
    for (size_t i = 0; i < 8; i++) {
        f->dim[i] = get_i16(h + 40 + 2 * i, is_big);
        f->pixdim[i] = get_f32(h + 76 + 4 * i, is_big);
    }
    f->datatype = get_i16(h + 70, is_big);
    f->bitpix = get_i16(h + 72, is_big);
    f->vox_offset = get_f32(h + 108, is_big);
    f->slope = get_f32(h + 112, is_big);
    f->offset = get_f32(h + 116, is_big);
    f->units = h[123];
    f->qform_code = get_i16(h + 252, is_big);
    f->sform_code = get_i16(h + 254, is_big);
    for (size_t i = 0; i < 3; i++) {
        f->quatern[i] = get_f32(h + 256 + 4 * i, is_big);
        f->qoffset[i] = get_f32(h + 268 + 4 * i, is_big);
        for (size_t j = 0; j < 4; j++)
            f->srow[i][j] = get_f32(h + 280 + 16 * i + 4 * j, is_big);
    }
    memcpy(f->magic, h + 344, 4);
}

/* Offsets are those of struct nifti_2_header. */
static void get_fields2(const uint8_t *h, bool is_big, struct fields *f)
{
    memcpy(f->magic, h + 4, 8);
    f->datatype = get_i16(h + 12, is_big);
    f->bitpix = get_i16(h + 14, is_big);
    for (size_t i = 0; i < 8; i++) {
        f->dim[i] = (int64_t)get_bytes(h + 16 + 8 * i, 8, is_big);
        f->pixdim[i] = get_f64(h + 104 + 8 * i, is_big);
    }
    f->vox_offset = (double)(int64_t)get_bytes(h + 168, 8, is_big);
    f->slope = get_f64(h + 176, is_big);
    f->offset = get_f64(h + 184, is_big);
    f->qform_code = get_i32(h + 344, is_big);
    f->sform_code = get_i32(h + 348, is_big);
    for (size_t i = 0; i < 3; i++) {
        f->quatern[i] = get_f64(h + 352 + 8 * i, is_big);
        f->qoffset[i] = get_f64(h + 376 + 8 * i, is_big);
        for (size_t j = 0; j < 4; j++)
            f->srow[i][j] = get_f64(h + 400 + 32 * i + 8 * j, is_big);
    }
    f->units = get_i32(h + 500, is_big) & 0xff;
}

static bool get_fields(const uint8_t *head, size_t size, const char *name, struct fields *f, bool *is_big, int *version,
                       struct error *err)
{
    if (size < HEADER1_BYTES)
        return error_set(err, ERROR_FORMAT, "%s: %zu bytes; a NIfTI header has at least %d", name, size, HEADER1_BYTES);
    for (int big = 0; big < 2; big++) {
        int length = get_i32(head, big);
        *is_big = big;
        if (length == HEADER1_BYTES) {
            *version = 1;
            get_fields1(head, big, f);
            if (memcmp(f->magic, "ni1", 4) == 0 || memcmp(f->magic, "n+1", 4) == 0) {
                f->is_pair = f->magic[1] == 'i';
                return true;
            }
            if (text_has_ending(name, ".nii") || text_has_ending(name, ".nii.gz"))
                return error_set(err, ERROR_FORMAT, "%s: byte 344: magic is %02x %02x %02x %02x, expected \"n+1\"",
                                 name, head[344], head[345], head[346], head[347]);
            return error_set(
                err, ERROR_UNSUPPORTED,
                "%s: byte 344: found %02x %02x %02x %02x, expected \"ni1\": an Analyze 7.5 header, which does not "
                "say which side is left, and is not read; convert it to NIfTI with what made it",
                name, head[344], head[345], head[346], head[347]);
        }
        if (length == HEADER2_BYTES) {
            *version = 2;
            if (size < HEADER2_BYTES)
                return error_set(err, ERROR_FORMAT, "%s: %zu bytes; a NIfTI-2 header has %d", name, size,
                                 HEADER2_BYTES);
            get_fields2(head, big, f);
            f->is_pair = memcmp(f->magic, "ni2\0\r\n\032\n", 8) == 0;
            if (!f->is_pair && memcmp(f->magic, "n+2\0\r\n\032\n", 8) != 0)
                return error_set(err, ERROR_FORMAT,
                                 "%s: byte 4: the magic of NIfTI-2 is wrong or was changed by a text transfer", name);
            return true;
        }
    }
    return error_set(err, ERROR_FORMAT,
                     "%s: byte 0: header length is %d, expected 348 (NIfTI-1) or 540 (NIfTI-2): not a NIfTI file", name,
                     get_i32(head, false));
}

static const char *type_name(int code)
{
    switch (code) {
    case DT_BINARY: return "1 bit";
    case DT_COMPLEX64:
    case DT_COMPLEX128:
    case DT_COMPLEX256: return "complex";
    case DT_RGB24:
    case DT_RGBA32: return "colour";
    case DT_FLOAT128: return "128-bit float";
    }
    return "unknown";
}

static bool get_type(int code, enum raw_type *type)
{
    static const struct {
        int code;
        enum raw_type type;
    } types[] = { { DT_UINT8, RAW_U8 },    { DT_INT8, RAW_I8 },    { DT_INT16, RAW_I16 }, { DT_UINT16, RAW_U16 },
                  { DT_INT32, RAW_I32 },   { DT_UINT32, RAW_U32 }, { DT_INT64, RAW_I64 }, { DT_UINT64, RAW_U64 },
                  { DT_FLOAT32, RAW_F32 }, { DT_FLOAT64, RAW_F64 } };
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
        if (types[i].code == code) {
            *type = types[i].type;
            return true;
        }
    return false;
}

static bool get_size(const struct fields *f, const char *name, uint32_t size[3], struct error *err)
{
    if (f->dim[0] < 1 || f->dim[0] > 7)
        return error_set(err, ERROR_FORMAT, "%s: dim[0] is %lld, expected 1 to 7", name, (long long)f->dim[0]);
    size[0] = size[1] = size[2] = 1;
    for (int i = 1; i <= f->dim[0]; i++) {
        if (i > 3 && f->dim[i] > 1)
            return error_set(err, ERROR_UNSUPPORTED,
                             "%s: dim[%d] is %lld: a series of volumes is not read, only one volume", name, i,
                             (long long)f->dim[i]);
        if (i > 3 ? f->dim[i] < 0 : f->dim[i] < 1)
            return error_set(err, ERROR_FORMAT, "%s: dim[%d] is %lld, expected 1 or more", name, i,
                             (long long)f->dim[i]);
        if (f->dim[i] > VOLUME_MAX_SIDE)
            return error_set(err, ERROR_LIMIT, "%s: dim[%d] is %lld; at most %d voxels a side are read", name, i,
                             (long long)f->dim[i], VOLUME_MAX_SIDE);
        if (i <= 3)
            size[i - 1] = (uint32_t)f->dim[i];
    }
    return true;
}

/* Method 2: a rotation as a quaternion, spacings, and a sign for the third axis. */
static struct affine ras_from_quaternion(const struct fields *f)
{
    double b = f->quatern[0], c = f->quatern[1], d = f->quatern[2];
    double rest = 1 - (b * b + c * c + d * d), a = 0;
    if (rest < 1e-7) { /* half a turn: a is 0, and (b, c, d) is normalised */
        double length = sqrt(b * b + c * c + d * d);
        b /= length;
        c /= length;
        d /= length;
    } else {
        a = sqrt(rest);
    }
    double dx = f->pixdim[1] > 0 ? f->pixdim[1] : 1, dy = f->pixdim[2] > 0 ? f->pixdim[2] : 1;
    double dz = (f->pixdim[3] > 0 ? f->pixdim[3] : 1) * (f->pixdim[0] < 0 ? -1 : 1);
    struct affine ras = { .origin = vec3(f->qoffset[0], f->qoffset[1], f->qoffset[2]) };
    ras.columns[0] = vec3_scale(vec3(a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c)), dx);
    ras.columns[1] = vec3_scale(vec3(2 * (b * c - a * d), a * a + c * c - b * b - d * d, 2 * (c * d + a * b)), dy);
    ras.columns[2] = vec3_scale(vec3(2 * (b * d + a * c), 2 * (c * d - a * b), a * a + d * d - c * c - b * b), dz);
    return ras;
}

static struct affine ras_from_rows(const struct fields *f)
{
    const double(*r)[4] = f->srow;
    return (struct affine){ { vec3(r[0][0], r[1][0], r[2][0]), vec3(r[0][1], r[1][1], r[2][1]),
                              vec3(r[0][2], r[1][2], r[2][2]) },
                            vec3(r[0][3], r[1][3], r[2][3]) };
}

static struct affine ras_from_spacing(const struct fields *f)
{
    double spacing[3];
    for (int i = 0; i < 3; i++)
        spacing[i] = f->pixdim[i + 1] > 0 ? f->pixdim[i + 1] : 1;
    return (struct affine){ { vec3(spacing[0], 0, 0), vec3(0, spacing[1], 0), vec3(0, 0, spacing[2]) }, vec3(0, 0, 0) };
}

static double largest_corner_distance(const struct affine *a, const struct affine *b, const uint32_t size[3])
{
    double largest = 0;
    for (int corner = 0; corner < 8; corner++) {
        struct vec3 at =
            vec3(corner & 1 ? size[0] - 1.0 : 0, corner & 2 ? size[1] - 1.0 : 0, corner & 4 ? size[2] - 1.0 : 0);
        largest = fmax(largest, vec3_length(vec3_sub(affine_point(a, at), affine_point(b, at))));
    }
    return largest;
}

/* Refuses b, c, d longer than 1, which is no rotation; a little over 1 is rounding. */
static bool check_quaternion(const struct fields *f, const char *name, struct error *err)
{
    double square = f->quatern[0] * f->quatern[0] + f->quatern[1] * f->quatern[1] + f->quatern[2] * f->quatern[2];
    return square <= 1.001 ||
           error_set(err, ERROR_RANGE,
                     "%s: quatern_b, c, d are %g, %g, %g: the sum of their squares is %g, expected 1 or less", name,
                     f->quatern[0], f->quatern[1], f->quatern[2], square);
}

/* Reports a missing size of a voxel; methods 1 and 2 then take 1. */
static void note_spacing(const struct fields *f, const char *name, const uint32_t size[3], struct report *report)
{
    for (int i = 0; i < 3; i++)
        if (size[i] > 1 && !(f->pixdim[i + 1] > 0))
            report_add(report, REPORT_WARNING, "geometry.assumed", name,
                       "pixdim[%d], the size of a voxel, is %g; 1 was taken. Distances may be wrong.", i + 1,
                       f->pixdim[i + 1]);
}

/* True if the rows of the sform are all 0, so that it says nothing though its code says that it does. */
static bool is_sform_empty(const struct fields *f)
{
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++)
            if (f->srow[row][column] != 0)
                return false;
    return true;
}

static double handedness(const struct affine *map)
{
    return vec3_dot(vec3_cross(map->columns[0], map->columns[1]), map->columns[2]);
}

/* The patient axis, 0 to 2, that a column runs along, with 3 added where it runs against it. */
static int direction_of(struct vec3 column)
{
    double along[3] = { column.x, column.y, column.z };
    int axis = fabs(along[1]) > fabs(along[0]) ? 1 : 0;
    axis = fabs(along[2]) > fabs(along[axis]) ? 2 : axis;
    return along[axis] < 0 ? axis + 3 : axis;
}

/* Reports two orientations that differ. With different codes they stand for two spaces, scanner and aligned, and may
 * lie apart; but a mirrored one, or one that points another way, is never an alignment. */
static void compare_forms(const struct fields *f, const char *name, const struct affine *sform, const uint32_t size[3],
                          struct report *report)
{
    static const char *const sides[] = { "right", "anterior", "superior", "left", "posterior", "inferior" };
    if (f->qform_code <= 0)
        return;
    struct affine qform = ras_from_quaternion(f);
    if (!isfinite(handedness(&qform)))
        return;
    for (int i = 0; i < 3; i++) {
        int s = direction_of(sform->columns[i]), q = direction_of(qform.columns[i]);
        bool is_mirrored = handedness(sform) * handedness(&qform) < 0;
        if (s == q || !(is_mirrored || s % 3 == q % 3))
            continue;
        report_add(
            report, REPORT_WARNING, "geometry.forms-disagree", name,
            "The two orientations in the file put its sides differently: its axis %d runs to the patient's %s by "
            "sform, to the %s by qform. The sform was used; other programs may use the qform. Check left and right.",
            i + 1, sides[s], sides[q]);
        return;
    }
    double apart = f->qform_code == f->sform_code ? largest_corner_distance(sform, &qform, size) : 0;
    if (apart > 1)
        report_add(report, REPORT_WARNING, "geometry.forms-disagree", name,
                   "The two orientations in the file (sform, qform) put a corner %.1f units apart; the sform was used.",
                   apart);
}

static bool get_geometry(const struct fields *f, const char *name, const uint32_t size[3], struct grid *grid,
                         struct report *report, struct error *err)
{
    struct affine ras;
    bool has_sform = f->sform_code > 0 && !(f->qform_code > 0 && is_sform_empty(f));
    if (has_sform) {
        ras = ras_from_rows(f);
        compare_forms(f, name, &ras, size, report);
    } else if (f->qform_code > 0) {
        if (!check_quaternion(f, name, err))
            return false;
        ras = ras_from_quaternion(f);
        note_spacing(f, name, size, report);
        if (f->sform_code > 0)
            report_add(report, REPORT_NOTE, "geometry.forms-disagree", name,
                       "The sform of the file is all 0; its qform was used.");
    } else {
        ras = ras_from_spacing(f);
        note_spacing(f, name, size, report);
        report_add(
            report, REPORT_WARNING, "geometry.assumed", name,
            "The file does not say how its voxels lie in the patient; x was taken to grow to the patient's right-to-left, "
            "NIfTI's first method. Left and right may be wrong.");
    }
    double mm = 1;
    switch (f->units & 7) {
    case NIFTI_UNITS_METER: mm = 1000; break;
    case NIFTI_UNITS_MICRON: mm = 0.001; break;
    default: break; /* millimetres, also when the unit is not given */
    }
    struct affine lps;
    for (int i = 0; i < 3; i++)
        lps.columns[i] = vec3(-ras.columns[i].x * mm, -ras.columns[i].y * mm, ras.columns[i].z * mm);
    lps.origin = vec3(-ras.origin.x * mm, -ras.origin.y * mm, ras.origin.z * mm);
    if (!grid_init(grid, size, &lps, err)) {
        error_prefix(err, "%s: %s", name, has_sform ? "sform" : f->qform_code > 0 ? "qform" : "pixdim");
        return false;
    }
    return true;
}

bool nifti_parse_header(const uint8_t *head, size_t size, const char *name, struct nifti_header *header,
                        struct report *report, struct error *err)
{
    struct fields f = { 0 };
    bool is_big = false;
    int version = 0;
    uint32_t sides[3];
    if (!get_fields(head, size, name, &f, &is_big, &version, err) || !get_size(&f, name, sides, err))
        return false;
    if (!get_type(f.datatype, &header->type))
        return error_set(
            err, ERROR_UNSUPPORTED,
            "%s: data type %d (%s) is not read; expected whole numbers of 8 to 64 bits or floats of 32 or 64", name,
            f.datatype, type_name(f.datatype));
    header->voxel_bytes = raw_type_bytes(header->type);
    if (f.bitpix != 0 && f.bitpix != (int)(8 * header->voxel_bytes))
        return error_set(err, ERROR_FORMAT, "%s: bitpix is %d, but data type %d has %u bits", name, f.bitpix,
                         f.datatype, 8 * header->voxel_bytes);
    if (!get_geometry(&f, name, sides, &header->grid, report, err))
        return false;
    header->is_swapped = is_big != (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__);
    bool is_scaled = isfinite(f.slope) && f.slope != 0;
    if (is_scaled && !isfinite(f.offset))
        return error_set(err, ERROR_FORMAT, "%s: scl_inter is not a finite number", name);
    if (!isfinite(f.slope))
        report_add(report, REPORT_WARNING, "image.rescale", name, "scl_slope is %g; the values were taken as stored.",
                   f.slope);
    header->slope = is_scaled ? f.slope : 1;
    header->offset = is_scaled ? f.offset : 0;
    header->is_pair = f.is_pair;
    double least = f.is_pair ? 0 : version == 1 ? HEADER1_BYTES + 4 : HEADER2_BYTES + 4;
    if (f.vox_offset == 0)
        f.vox_offset = least;
    if (!(f.vox_offset >= least && f.vox_offset <= 1 << 30))
        return error_set(err, ERROR_FORMAT, "%s: vox_offset is %g, expected %g or more", name, f.vox_offset, least);
    header->data_at = (uint64_t)f.vox_offset;
    uint64_t n_voxels = grid_n_voxels(&header->grid);
    header->data_bytes = n_voxels * header->voxel_bytes;
    if (header->data_bytes > VOLUME_MAX_BYTES)
        return error_set(err, ERROR_LIMIT, "%s: %u x %u x %u voxels of %u bytes; at most %llu bytes are read", name,
                         sides[0], sides[1], sides[2], header->voxel_bytes, (unsigned long long)VOLUME_MAX_BYTES);
    return true;
}

bool nifti_check_place(const struct nifti_header *header, bool is_pair, const char *name, struct error *err)
{
    if (header->is_pair == is_pair)
        return true;
    return error_set(
        err, ERROR_FORMAT,
        is_pair
            ? "%s: the magic says that the voxels follow in the same file (\"n+1\"), but the name is that of a pair (\"ni1\")"
            : "%s: the magic says that the voxels lie in another file (\"ni1\"); such a pair is named .hdr and .img",
        name);
}

bool nifti_peek(const struct bytes *file, const char *name, struct nifti_header *header, struct report *report,
                struct error *err)
{
    if (!gzip_is(file->data, file->size))
        return nifti_parse_header(file->data, file->size, name, header, report, err);
    uint8_t head[NIFTI_HEAD_BYTES];
    size_t n_lacked = error_n_memory(), n = gzip_head(file->data, file->size, head, sizeof head);
    if (n == 0 && error_n_memory() != n_lacked)
        return error_set(err, ERROR_MEMORY, "%s: no memory to undo its compression", name);
    if (n == 0)
        return error_set(err, ERROR_FORMAT, "%s: the gzip stream is broken at its start", name);
    return nifti_parse_header(head, n, name, header, report, err);
}
