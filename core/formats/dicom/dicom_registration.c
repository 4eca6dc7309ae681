/* Reads rigid registrations. */
#include "core/formats/dicom/dicom_registration.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum {
    FRAME_UID = DICOM_TAG(0x0020, 0x0052),
    REGISTRATION_SEQUENCE = DICOM_TAG(0x0070, 0x0308),
    MATRIX_REGISTRATION_SEQUENCE = DICOM_TAG(0x0070, 0x0309),
    MATRIX_SEQUENCE = DICOM_TAG(0x0070, 0x030a),
    MATRIX_TYPE = DICOM_TAG(0x0070, 0x030c),
    MATRIX = DICOM_TAG(0x3006, 0x00c6)
};

#define FARTHEST_MM 1e5 /* of a shift; more is no place in a room */

static bool is_left_out(const char *why, const char *where, struct report *report)
{
    report_add(report, REPORT_WARNING, "registration.not-applied", where, "A registration is not applied: %s.", why);
    return false;
}

/* True if the columns are those of a rotation, without scaling and mirroring. */
static bool is_rotation(const struct affine *map)
{
    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++)
            if (!(fabs(vec3_dot(map->columns[i], map->columns[j]) - (i == j)) <= DICOM_REGISTRATION_TOLERANCE))
                return false;
    return affine_determinant(map) > 0;
}

/* Reads a matrix of 4 rows of 4 numbers. */
static bool read_matrix(const struct dicom_item *item, const char *where, struct affine *map, struct report *report)
{
    double m[16];
    char type[17];
    bool is_finite = dicom_numbers(item, MATRIX, m, 16) == 16;
    for (int i = 0; is_finite && i < 16; i++)
        is_finite = isfinite(m[i]);
    if (!is_finite)
        return is_left_out("its matrix (3006,00C6) is not 16 numbers", where, report);
    if (dicom_text(item, MATRIX_TYPE, type, sizeof type) && strcmp(type, "RIGID") != 0)
        return is_left_out("its matrix (0070,030C) is not of the type RIGID", where, report);
    for (int i = 0; i < 3; i++)
        map->columns[i] = vec3(m[i], m[4 + i], m[8 + i]);
    map->origin = vec3(m[3], m[7], m[11]);
    if (!is_rotation(map) || fabs(m[12]) + fabs(m[13]) + fabs(m[14]) + fabs(m[15] - 1) > DICOM_REGISTRATION_TOLERANCE)
        return is_left_out("its matrix (3006,00C6) is no rotation with a shift", where, report);
    if (!(vec3_length(map->origin) <= FARTHEST_MM))
        return is_left_out("its matrix (3006,00C6) shifts by more than 100 m", where, report);
    return true;
}

static bool read_matrices(const struct dicom_item *item, const char *where, struct affine *whole, struct report *report)
{
    size_t n_items = dicom_n_items(item, MATRIX_REGISTRATION_SEQUENCE);
    const struct dicom_item *registration = n_items == 1 ? dicom_item_at(item, MATRIX_REGISTRATION_SEQUENCE, 0) : NULL;
    size_t n = registration ? dicom_n_items(registration, MATRIX_SEQUENCE) : 0;
    *whole = (struct affine){ { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, { 0, 0, 0 } };
    if (n == 0)
        return is_left_out("it has no matrix (0070,030A)", where, report);
    for (size_t i = 0; i < n; i++) {
        struct affine map;
        if (!read_matrix(dicom_item_at(registration, MATRIX_SEQUENCE, i), where, &map, report))
            return false;
        *whole = affine_compose(&map, whole); /* the first is applied first */
    }
    return is_rotation(whole) || is_left_out("its matrices together are no rotation with a shift", where, report);
}

size_t dicom_registration_read(const struct dicom_file *file, const char *where, struct dicom_registration *out,
                               size_t most, struct report *report)
{
    const struct dicom_item *root = dicom_root(file);
    struct dicom_registration read = { 0 };
    size_t n = 0, n_items = dicom_n_items(root, REGISTRATION_SEQUENCE);
    if (!dicom_text(root, FRAME_UID, read.to_uid, sizeof read.to_uid)) {
        (void)is_left_out("it does not say to which frame of reference (0020,0052)", where, report);
        return 0;
    }
    for (size_t i = 0; i < n_items; i++) {
        const struct dicom_item *item = dicom_item_at(root, REGISTRATION_SEQUENCE, i);
        if (!dicom_text(item, FRAME_UID, read.from_uid, sizeof read.from_uid)) {
            (void)is_left_out("it does not say from which frame of reference (0020,0052)", where, report);
            continue;
        }
        if (strcmp(read.from_uid, read.to_uid) == 0 || !read_matrices(item, where, &read.to_from_lps_mm, report))
            continue;
        if (n == most) {
            (void)is_left_out("there are too many of them", where, report);
            break;
        }
        out[n++] = read;
    }
    return n;
}
