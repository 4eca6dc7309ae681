/* Compares the slices of one series: slices may differ in sign, bits, unit or rescale. Each slice is read by its own
 * elements; the differences are reported. */
#include <stdio.h>
#include <string.h>

#include "core/formats/dicom/dicom_slices.h"
#include "core/formats/dicom/dicom_tags.h"

enum trait { SIGN, ALLOCATED, STORED, HIGH_BIT, UNIT, SLOPE, OFFSET, N_TRAITS };

static const struct {
    uint32_t tag;
    const char *name;
} traits[N_TRAITS] = {
    [SIGN] = { DICOM_TAG(0x0028, 0x0103), "pixel representation" },
    [ALLOCATED] = { DICOM_TAG(0x0028, 0x0100), "bits allocated" },
    [STORED] = { DICOM_TAG(0x0028, 0x0101), "bits stored" },
    [HIGH_BIT] = { DICOM_TAG(0x0028, 0x0102), "high bit" },
    [UNIT] = { TAG_RESCALE_TYPE, "unit of the values" },
    [SLOPE] = { TAG_SLOPE, "rescale slope" },
    [OFFSET] = { TAG_OFFSET, "rescale intercept" },
};

static bool is_equal(const struct dicom_image *a, const struct dicom_image *b, enum trait trait)
{
    switch (trait) {
    case SIGN: return a->pixels.is_signed == b->pixels.is_signed;
    case ALLOCATED: return a->pixels.bits_allocated == b->pixels.bits_allocated;
    case STORED: return a->pixels.bits_stored == b->pixels.bits_stored;
    case HIGH_BIT: return a->pixels.high_bit == b->pixels.high_bit;
    case UNIT: return strcmp(a->unit, b->unit) == 0;
    case SLOPE: return a->slope == b->slope;
    case OFFSET: return a->offset == b->offset;
    case N_TRAITS: break;
    }
    return true;
}

static void put_value(const struct dicom_image *image, enum trait trait, char out[32])
{
    switch (trait) {
    case SIGN: snprintf(out, 32, "%d", image->pixels.is_signed); break;
    case ALLOCATED: snprintf(out, 32, "%u", image->pixels.bits_allocated); break;
    case STORED: snprintf(out, 32, "%u", image->pixels.bits_stored); break;
    case HIGH_BIT: snprintf(out, 32, "%u", image->pixels.high_bit); break;
    case UNIT: snprintf(out, 32, "%s", image->unit[0] ? image->unit : "nothing"); break;
    case SLOPE: snprintf(out, 32, "%.10g", image->slope); break;
    case OFFSET: snprintf(out, 32, "%.10g", image->offset); break;
    case N_TRAITS: out[0] = 0; break;
    }
}

static const struct dicom_image *image_of(const struct dicom_index *index, const struct dicom_stack *stack, size_t i)
{
    return index->objects[stack->objects[i]].image;
}

/* The slice whose value more than half of the slices share, if there is one. Source: R. S. Boyer, J S. Moore, MJRTY: A
 * Fast Majority Vote Algorithm, 1981. */
static size_t usual_slice(const struct dicom_index *index, const struct dicom_stack *stack, enum trait trait)
{
    size_t usual = 0, lead = 0;
    for (size_t i = 0; i < stack->n_objects; i++) {
        if (lead == 0)
            usual = i;
        lead += lead == 0 || is_equal(image_of(index, stack, i), image_of(index, stack, usual), trait) ? 1 : (size_t)-1;
    }
    return usual;
}

void dicom_slices_compare(const struct dicom_index *index, const struct dicom_stack *stack, struct report *report)
{
    for (int t = 0; t < N_TRAITS; t++) {
        enum trait trait = (enum trait)t;
        if ((trait == SLOPE || trait == OFFSET) && strcmp(stack->modality, "CT") != 0)
            continue; /* PET and some MR have a rescale per slice */
        const struct dicom_image *usual = image_of(index, stack, usual_slice(index, stack, trait));
        size_t n_others = 0, first = 0;
        for (size_t i = 0; i < stack->n_objects; i++)
            if (!is_equal(image_of(index, stack, i), usual, trait)) {
                first = n_others == 0 ? i : first;
                n_others++;
            }
        if (n_others == 0)
            continue;
        char expected[32], found[32];
        bool is_of_pet =
            trait == UNIT && strcmp(stack->modality, "PT") == 0; /* PET gives its unit in Units, not in Rescale Type */
        uint32_t tag = is_of_pet ? TAG_UNITS : traits[t].tag;
        put_value(usual, trait, expected);
        put_value(image_of(index, stack, first), trait, found);
        report_add(
            report, REPORT_WARNING, "image.slices-contradict", index->objects[stack->objects[first]].path,
            "Element (%04X,%04X), %s: found %s, expected %s as in other slices of the series; %zu of %zu slices differ. Each was read as "
            "it says.",
            tag >> 16, tag & 0xFFFF, traits[t].name, found, expected, n_others, stack->n_objects);
    }
}

void dicom_slices_report_surplus(const struct dicom_index *index, const struct dicom_stack *stack,
                                 struct report *report)
{
    size_t n = 0;
    const struct dicom_object *first = NULL;
    for (size_t i = 0; i < stack->n_objects; i++) {
        const struct dicom_object *object = &index->objects[stack->objects[i]];
        const struct dicom_pixels *pixels = &object->image->pixels;
        if (pixels->surplus_bytes < (uint64_t)pixels->rows * pixels->columns * (pixels->bits_allocated / 8))
            continue;
        first = first ? first : object;
        n++;
    }
    if (n > 0)
        report_add(
            report, REPORT_WARNING, "dicom.surplus-pixels", first->path,
            "The pixel data of %zu of %zu files hold more frames than the files declare (here %llu bytes more than "
            "%u frames need); they are not shown.",
            n, stack->n_objects, (unsigned long long)first->image->pixels.surplus_bytes, first->image->pixels.n_frames);
}
