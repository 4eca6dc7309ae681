/* Writes DICOM segmentations. */
#include "tests/unit/made_seg.h"

#include "tests/check.h"
#include "tests/unit/rt_files.h"

#define TAG DICOM_TAG

bool made_seg_is_set(int segment, double z_mm, int x, int y)
{
    return (2 * x + 3 * y + segment + 7 * (int)lround((z_mm + 5) / 3)) % 5 == 0;
}

static const double *cosines_of(const struct made_seg *seg)
{
    static const double straight[6] = { 1, 0, 0, 0, 1, 0 };
    return seg->cosines ? seg->cosines : straight;
}

struct vec3 made_seg_lps_mm(const struct made_seg *seg, double z_mm, int x, int y)
{
    const double *c = cosines_of(seg);
    struct vec3 row = vec3(c[0], c[1], c[2]), column = vec3(c[3], c[4], c[5]);
    struct vec3 in_plane = vec3_add(vec3_scale(row, 0.5 * x), vec3_scale(column, 2.0 * y));
    return vec3_add(vec3_add(vec3(10, 20, 0), in_plane), vec3_scale(vec3_cross(row, column), z_mm));
}

static void put_shared(struct made_dicom *made, const struct made_seg *seg)
{
    made_sequence(made, TAG(0x5200, 0x9229));
    made_item(made);
    made_sequence(made, TAG(0x0020, 0x9116));
    made_item(made);
    made_numbers(made, TAG(0x0020, 0x0037), cosines_of(seg), 6);
    made_item_end(made);
    made_sequence_end(made);
    made_sequence(made, TAG(0x0028, 0x9110));
    made_item(made);
    if (seg->thickness_mm > 0)
        made_numbers(made, TAG(0x0018, 0x0050), &seg->thickness_mm, 1);
    if (seg->between_mm > 0)
        made_numbers(made, TAG(0x0018, 0x0088), &seg->between_mm, 1);
    made_text(made, TAG(0x0028, 0x0030), "DS", "2\\0.5");
    made_item_end(made);
    made_sequence_end(made);
    made_item_end(made);
    made_sequence_end(made);
}

static void put_frames(struct made_dicom *made, const struct made_seg *seg)
{
    made_sequence(made, TAG(0x5200, 0x9230));
    for (int f = 0; f < seg->n_frames; f++) {
        struct vec3 first = made_seg_lps_mm(seg, seg->frames[f].z_mm, 0, 0);
        double position[3] = { first.x, first.y, first.z };
        made_item(made);
        made_sequence(made, TAG(0x0020, 0x9113));
        made_item(made);
        made_numbers(made, TAG(0x0020, 0x0032), position, 3);
        made_item_end(made);
        made_sequence_end(made);
        made_sequence(made, TAG(0x0062, 0x000A));
        made_item(made);
        made_u16(made, TAG(0x0062, 0x000B), (uint16_t)seg->frames[f].segment);
        made_item_end(made);
        made_sequence_end(made);
        made_item_end(made);
    }
    made_sequence_end(made);
}

static void put_pixels(struct made_dicom *made, const struct made_seg *seg)
{
    size_t n = (size_t)seg->n_frames * MADE_SEG_ROWS * MADE_SEG_COLUMNS, at = 0;
    uint8_t *cells = calloc(n + 1, 1), *bits = calloc(n / 8 + 3, 1);
    for (int f = 0; f < seg->n_frames; f++)
        for (int y = 0; y < MADE_SEG_ROWS; y++)
            for (int x = 0; x < MADE_SEG_COLUMNS; x++, at++) {
                bool is_set = made_seg_is_set(seg->frames[f].segment, seg->frames[f].z_mm, x, y);
                cells[at] = is_set ? 100 + (uint8_t)x : 99 - (uint8_t)x; /* largest value 200: half is 100 */
                bits[at / 8] |= (uint8_t)(is_set << at % 8);
            }
    for (size_t i = 0; seg->is_big_endian && i < (n + 7) / 8; i += 2) {
        uint8_t low = bits[i];
        bits[i] = bits[i + 1];
        bits[i + 1] = low;
    }
    made_element(made, TAG(0x7FE0, 0x0010), seg->is_fractional ? "OB" : "OW", seg->is_fractional ? cells : bits,
                 seg->is_fractional ? n : (n + 15) / 16 * 2);
    free(cells);
    free(bits);
}

void made_seg_bytes(struct made_dicom *made, const struct made_seg *seg)
{
    made_begin(made, seg->is_big_endian ? MADE_BIG_ENDIAN : MADE_EXPLICIT);
    made_text(made, TAG(0x0008, 0x0016), "UI", "1.2.840.10008.5.1.4.1.1.66.4");
    made_text(made, TAG(0x0008, 0x0018), "UI", "1.2.3.66");
    made_text(made, TAG(0x0008, 0x0060), "CS", "SEG");
    if (seg->series) {
        made_sequence(made, TAG(0x0008, 0x1115));
        made_item(made);
        made_text(made, TAG(0x0020, 0x000E), "UI", seg->series);
        made_item_end(made);
        made_sequence_end(made);
    }
    made_text(made, TAG(0x0020, 0x000D), "UI", "1.2.1");
    made_text(made, TAG(0x0020, 0x000E), "UI", "1.2.66");
    if (seg->frame_of_reference)
        made_text(made, TAG(0x0020, 0x0052), "UI", seg->frame_of_reference);
    made_u16(made, TAG(0x0028, 0x0002), 1);
    made_text(made, TAG(0x0028, 0x0004), "CS", "MONOCHROME2");
    made_integer(made, TAG(0x0028, 0x0008), seg->n_frames);
    made_u16(made, TAG(0x0028, 0x0010), MADE_SEG_ROWS);
    made_u16(made, TAG(0x0028, 0x0011), MADE_SEG_COLUMNS);
    made_u16(made, TAG(0x0028, 0x0100), seg->is_fractional ? 8 : 1);
    made_u16(made, TAG(0x0028, 0x0101), seg->is_fractional ? 8 : 1);
    made_u16(made, TAG(0x0028, 0x0102), seg->is_fractional ? 7 : 0);
    made_u16(made, TAG(0x0028, 0x0103), 0);
    made_text(made, TAG(0x0062, 0x0001), "CS", seg->is_fractional ? "FRACTIONAL" : "BINARY");
    made_sequence(made, TAG(0x0062, 0x0002));
    for (int s = 1; s <= seg->n_segments; s++) {
        char label[16];
        snprintf(label, sizeof label, "Part %d", s);
        made_item(made);
        made_u16(made, TAG(0x0062, 0x0004), (uint16_t)s);
        made_text(made, TAG(0x0062, 0x0005), "LO", label);
        if (s == 1) { /* sRGB red in CIELab for white D50, from Lindbloom's tables: L 54.29, a 80.81, b 69.89 */
            made_head(made, TAG(0x0062, 0x000D), "US", 6);
            made_words(made, (uint16_t[]){ 35579, 53665, 50858 }, 3);
        }
        made_item_end(made);
    }
    made_sequence_end(made);
    if (seg->is_fractional) {
        made_u16(made, TAG(0x0062, 0x000E), 200);
        made_text(made, TAG(0x0062, 0x0010), "CS", "PROBABILITY");
    }
    put_shared(made, seg);
    put_frames(made, seg);
    put_pixels(made, seg);
}
