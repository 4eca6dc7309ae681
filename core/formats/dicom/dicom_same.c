/* Compares the contents of two DICOM files: bytes, then what an image or a dose shows. */
#include "core/formats/dicom/dicom_same.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

/* Elements that change what the pixels mean. */
static const uint32_t meanings[] = {
    DICOM_TAG(0x0018, 0x0050), /* slice thickness */
    DICOM_TAG(0x0020, 0x0032), /* position */
    DICOM_TAG(0x0020, 0x0037), /* orientation */
    DICOM_TAG(0x0020, 0x0052), /* frame of reference */
    DICOM_TAG(0x0028, 0x0030), /* pixel spacing */
    DICOM_TAG(0x0028, 0x0120), /* padding value */
    DICOM_TAG(0x0028, 0x0121), /* padding range limit */
    DICOM_TAG(0x0028, 0x1052), /* rescale intercept */
    DICOM_TAG(0x0028, 0x1053), /* rescale slope */
    DICOM_TAG(0x0010, 0x0010), /* patient's name */
    DICOM_TAG(0x0010, 0x0020), /* patient ID */
    DICOM_TAG(0x3004, 0x0002), /* dose units */
    DICOM_TAG(0x3004, 0x0004), /* dose type */
    DICOM_TAG(0x3004, 0x0006), /* dose comment */
    DICOM_TAG(0x3004, 0x000a), /* dose summation type */
    DICOM_TAG(0x3004, 0x000e), /* dose grid scaling */
};

/* Compares the numbers of an element, or its text when it has none. */
static bool is_element_same(const struct dicom_item *a, const struct dicom_item *b, uint32_t tag)
{
    enum { MOST = 6 };
    double numbers[2][MOST] = { { 0 } };
    char texts[2][200];
    size_t n = dicom_numbers(a, tag, numbers[0], MOST);
    if (n != dicom_numbers(b, tag, numbers[1], MOST))
        return false;
    for (size_t i = 0; i < n && i < MOST; i++)
        if (numbers[0][i] != numbers[1][i] && !(numbers[0][i] != numbers[0][i] && numbers[1][i] != numbers[1][i]))
            return false;
    (void)dicom_text(a, tag, texts[0], sizeof texts[0]);
    (void)dicom_text(b, tag, texts[1], sizeof texts[1]);
    return n > 0 || strcmp(texts[0], texts[1]) == 0;
}

/* Compares all numbers of the positions of a dose's frames. */
static bool are_offsets_same(const struct dicom_item *a, const struct dicom_item *b, bool *is_same, struct error *err)
{
    const uint32_t offsets = DICOM_TAG(0x3004, 0x000c);
    size_t n = dicom_numbers(a, offsets, NULL, 0);
    *is_same = n == dicom_numbers(b, offsets, NULL, 0);
    if (n == 0 || !*is_same)
        return true;
    double *values = mem_array(n, 2 * sizeof *values, UINT64_MAX, err);
    if (!values)
        return false;
    (void)dicom_numbers(a, offsets, values, n);
    (void)dicom_numbers(b, offsets, values + n, n);
    for (size_t i = 0; i < n; i++)
        *is_same = *is_same && values[i] == values[n + i];
    free(values);
    return true;
}

static bool are_frames_same(const struct dicom_file *a, const struct dicom_file *b, const struct dicom_pixels *pixels,
                            bool *is_same, struct error *err)
{
    size_t n = (size_t)pixels->rows * pixels->columns * (pixels->bits_allocated / 8);
    uint8_t *cells = mem_array(n, 2, UINT32_MAX, err);
    if (!cells)
        return false;
    struct error why = { 0 };
    for (uint32_t f = 0; f < pixels->n_frames && *is_same; f++)
        *is_same = dicom_pixels_read(a, f, cells, &why) && dicom_pixels_read(b, f, cells + n, &why) &&
                   memcmp(cells, cells + n, n) == 0;
    free(cells);
    if (why.code == ERROR_MEMORY && err)
        *err = why;
    return why.code != ERROR_MEMORY;
}

static bool compare_parsed(const struct dicom_file *a, const struct dicom_file *b, bool *is_same, struct error *err)
{
    struct dicom_pixels pixels, other;
    const struct dicom_item *root = dicom_root(a), *other_root = dicom_root(b);
    *is_same = dicom_pixels_look(a, &pixels, NULL) && dicom_pixels_look(b, &other, NULL) && pixels.rows == other.rows &&
               pixels.columns == other.columns && pixels.n_frames == other.n_frames &&
               pixels.bits_allocated == other.bits_allocated && pixels.is_signed == other.is_signed &&
               pixels.is_monochrome1 == other.is_monochrome1;
    for (size_t i = 0; *is_same && i < sizeof meanings / sizeof meanings[0]; i++)
        *is_same = is_element_same(root, other_root, meanings[i]);
    /* the places of frames in functional groups are not compared: such files are the same by their bytes alone */
    *is_same = *is_same && !dicom_has(root, DICOM_TAG(0x5200, 0x9230));
    if (!*is_same)
        return true;
    return are_offsets_same(root, other_root, is_same, err) &&
           (!*is_same || are_frames_same(a, b, &pixels, is_same, err));
}

/* Parses both files and compares what they show. */
static bool compare_bytes(const struct bytes *a, const struct bytes *b, bool *is_same, struct error *err)
{
    struct dicom_file *first = dicom_file_parse(a->data, a->size, "", DICOM_WHOLE, err);
    struct dicom_file *second = first ? dicom_file_parse(b->data, b->size, "", DICOM_WHOLE, err) : NULL;
    bool is_compared = second && compare_parsed(first, second, is_same, err);
    dicom_file_destroy(first);
    dicom_file_destroy(second);
    return is_compared;
}

bool dicom_same_content(const struct folder *folder, const struct dicom_object *a, const struct dicom_object *b,
                        bool *is_same, struct error *err)
{
    const uint64_t limit = (uint64_t)DICOM_MAX_FILE_MIB << 20;
    struct bytes first = { 0 }, second = { 0 };
    struct error why = { 0 };
    *is_same = false;
    bool is_read = folder_read(folder, a->path, limit, UINT64_MAX, &first, &why) &&
                   folder_read(folder, b->path, limit, UINT64_MAX, &second, &why);
    bool has_pixels = a->kind == DICOM_KIND_IMAGE ||
                      (a->kind == DICOM_KIND_DOSE && strcmp(a->referenced_plan, b->referenced_plan) == 0 &&
                       strcmp(a->referenced_struct, b->referenced_struct) == 0 &&
                       strcmp(a->description, b->description) == 0); /* descriptions name components */
    if (is_read && first.size == second.size && memcmp(first.data, second.data, first.size) == 0)
        *is_same = true;
    else if (is_read && has_pixels)
        is_read = compare_bytes(&first, &second, is_same, &why);
    bytes_free(&first);
    bytes_free(&second);
    if (is_read || why.code != ERROR_MEMORY)
        return true;
    if (err)
        *err = why;
    return false;
}
