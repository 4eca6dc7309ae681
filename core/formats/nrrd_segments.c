/* Reads the segments of a 3D Slicer .seg.nrrd header: names, colours, layers, labels. */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/nrrd.h"
#include "core/formats/text.h"

/* Reads a whole number up to most; false for anything else. */
static bool get_whole(const char *text, uint32_t most, uint32_t *out)
{
    double value;
    if (!text_number(text, &value) || !(value >= 0 && value <= most) || value != (double)(uint32_t)value)
        return false;
    *out = (uint32_t)value;
    return true;
}

/* Replaces "\n" by a new line and "\\" by a backslash. */
static void unescape(const char *in, char *out, size_t size)
{
    size_t n = 0;
    while (*in && n + 1 < size) {
        char c = *in++;
        if (c == '\\' && *in == 'n') {
            c = ' ';
            in++;
        } else if (c == '\\' && *in == '\\') {
            in++;
        }
        out[n++] = c;
    }
    out[n] = 0;
}

static bool get_color(const char *value, uint8_t rgb[3])
{
    for (int i = 0; i < 3; i++) {
        char word[32];
        double share;
        size_t n = strcspn(value, " ");
        if (n >= sizeof word)
            return false;
        memcpy(word, value, n);
        word[n] = 0;
        if (!text_number(word, &share) || !(share >= 0 && share <= 1))
            return false;
        rgb[i] = (uint8_t)(share * 255 + 0.5);
        value += n;
        value += strspn(value, " ");
    }
    return *value == 0;
}

static void note_bad(struct report *report, const char *name, size_t line, const char *key, const char *value,
                     const char *expected)
{
    char clean[64], clean_key[64];
    text_clean(value, clean, sizeof clean);
    text_clean(key, clean_key, sizeof clean_key);
    report_add(report, REPORT_NOTE, "header.bad-number", name, "Line %zu: %s is \"%s\", expected %s; it was ignored.",
               line, clean_key, clean, expected);
}

bool nrrd_segment_key(struct nrrd_header *header, const char *name, size_t line, const char *key, const char *value,
                      struct report *report)
{
    static const char prefix[] = "Segment";
    if (strncmp(key, prefix, sizeof prefix - 1) != 0 || !isdigit((unsigned char)key[sizeof prefix - 1]))
        return false;
    char *end;
    unsigned long index = strtoul(key + sizeof prefix - 1, &end, 10);
    if (*end != '_')
        return false;
    const char *what = end + 1;
    if (index >= NRRD_MAX_SEGMENTS) {
        note_bad(report, name, line, key, value, "a segment below 1024");
        return true;
    }
    if (!header->segments)
        header->segments = mem_new(NRRD_MAX_SEGMENTS * sizeof *header->segments);
    struct nrrd_segment *segment = &header->segments[index];
    if (!segment->is_present) {
        *segment = (struct nrrd_segment){ .is_present = true, .label = 1 };
        header->n_segments = index + 1 > header->n_segments ? index + 1 : header->n_segments;
    }
    uint32_t number;
    if (strcmp(what, "Name") == 0 || (strcmp(what, "ID") == 0 && !segment->name[0])) {
        char plain[REGION_NAME_SIZE];
        unescape(value, plain, sizeof plain);
        text_clean(plain, segment->name, sizeof segment->name);
    } else if (strcmp(what, "LabelValue") == 0) {
        segment->has_bad_label = !get_whole(value, UINT16_MAX, &number) || number == 0;
        if (!segment->has_bad_label)
            segment->label = (uint16_t)number;
        else
            note_bad(report, name, line, key, value, "a whole number from 1 to 65535");
    } else if (strcmp(what, "Layer") == 0) {
        segment->has_layer = get_whole(value, UINT16_MAX, &segment->layer);
        if (!segment->has_layer)
            note_bad(report, name, line, key, value, "a whole number");
    } else if (strcmp(what, "Color") == 0) {
        segment->has_color = get_color(value, segment->rgb);
        if (!segment->has_color)
            note_bad(report, name, line, key, value, "three numbers from 0 to 1");
    }
    return true;
}

void nrrd_segments_check(struct nrrd_header *header, const char *name, struct report *report)
{
    for (size_t i = 0; i < header->n_segments; i++) {
        struct nrrd_segment *segment = &header->segments[i];
        segment->is_present =
            segment->is_present && !segment->has_bad_label; /* without a label nothing says which voxels are meant */
        if (!segment->is_present)
            continue;
        if (!segment->has_layer && header->n_layers > 1)
            segment->layer = (uint32_t)i; /* older files: a layer for each segment */
        if (!segment->name[0])
            snprintf(segment->name, sizeof segment->name, "segment %zu", i);
        if (segment->layer >= header->n_layers) {
            report_add(report, REPORT_WARNING, "header.bad-number", name,
                       "Segment%zu (\"%s\") lies on layer %u, but there are only layers 0 to %u; it was left out.", i,
                       segment->name, segment->layer, header->n_layers - 1);
            segment->is_present = false;
        }
    }
}
