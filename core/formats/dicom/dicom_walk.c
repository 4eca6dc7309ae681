/* Walks the elements of a DICOM file without a library: checks lengths, depth and order; finds the pixels and their
 * fragments. */
#include "core/formats/dicom/dicom_walk.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#define UNDEFINED UINT32_MAX

#define TAG_ITEM DICOM_TAG(0xFFFE, 0xE000)
#define TAG_ITEM_END DICOM_TAG(0xFFFE, 0xE00D)
#define TAG_SEQUENCE_END DICOM_TAG(0xFFFE, 0xE0DD)
#define TAG_PIXELS DICOM_TAG(0x7FE0, 0x0010)
#define TAG_FLOAT_PIXELS DICOM_TAG(0x7FE0, 0x0008)
#define TAG_DOUBLE_PIXELS DICOM_TAG(0x7FE0, 0x0009)

static uint32_t get16(const uint8_t *p, bool is_big_endian)
{
    return is_big_endian ? (uint32_t)p[0] << 8 | p[1] : (uint32_t)p[1] << 8 | p[0];
}

static uint32_t get32(const uint8_t *p, bool is_big_endian)
{
    return is_big_endian ? get16(p, true) << 16 | get16(p + 2, true) : get16(p + 2, false) << 16 | get16(p, false);
}

static uint32_t get_tag(const uint8_t *p, bool is_big_endian)
{
    return get16(p, is_big_endian) << 16 | get16(p + 2, is_big_endian);
}

static bool is_upper(uint8_t c)
{
    return c >= 'A' && c <= 'Z';
}

static bool is_vr(const uint8_t *p)
{
    static const char known[] = "AEASATCSDADSDTFDFLISLOLTOBODOFOLOVOWPNSHSLSQSSSTSVTMUCUIULUNURUSUTUV";
    for (size_t i = 0; i + 1 < sizeof known; i += 2)
        if (p[0] == (uint8_t)known[i] && p[1] == (uint8_t)known[i + 1])
            return true;
    return false;
}

/* Returns true if the length after a value representation (VR) has 32 bits. Unknown VRs of two letters are newer ones,
 * all with 32 bits; other characters stand in old files, with 16 bits. */
static bool has_long_length(const uint8_t *vr)
{
    static const char shorts[] = "AEASATCSDADSDTFDFLISLOLTPNSHSLSSSTTMUIULUS";
    for (size_t i = 0; i + 1 < sizeof shorts; i += 2)
        if (vr[0] == (uint8_t)shorts[i] && vr[1] == (uint8_t)shorts[i + 1])
            return false;
    return is_vr(vr) || (is_upper(vr[0]) && is_upper(vr[1]));
}

bool dicom_looks_like(const uint8_t *data, size_t size)
{
    if (size >= 132 && memcmp(data + 128, "DICM", 4) == 0)
        return true;
    if (size < 16)
        return false;
    for (int order = 0; order < 2; order++) {
        uint32_t group = get16(data, order == 1), element = get16(data + 2, order == 1);
        if (group != 0x0002 && group != 0x0008)
            continue;
        if (is_vr(data + 4) &&
            element <= 0x0100) /* the first element of its group: a group length, a version, a character set, a type */
            return true;
        if (order == 0 && group == 0x0008 && element <= 0x0018 && get32(data + 4, false) <= 128) /* implicit VR */
            return true;
    }
    return false;
}

struct element {
    uint32_t tag, length;
    uint8_t vr[2]; /* 0, 0 for implicit VR and for items */
    size_t at, value_at;
};

struct walk {
    const uint8_t *data;
    size_t size;
    const char *name;
    enum dicom_extent extent;
    struct error *err;
    size_t n_elements, n_disorder;
    bool is_cut; /* the only failure was that data ends */
};

static bool cut_short(struct walk *walk, size_t at, const char *what)
{
    walk->is_cut = true;
    return error_set(walk->err, ERROR_FORMAT, "%s: byte %zu: expected %s, found the end of the file", walk->name, at,
                     what);
}

static bool read_element(struct walk *walk, size_t at, bool is_implicit, bool is_big_endian, struct element *element)
{
    const uint8_t *p = walk->data + at;
    size_t left = walk->size - at;
    if (left < 8)
        return cut_short(walk, at, "an element");
    *element = (struct element){ .tag = get_tag(p, is_big_endian), .at = at, .value_at = at + 8 };
    if (is_implicit || element->tag >> 16 == 0xFFFE) {
        element->length = get32(p + 4, is_big_endian);
        return true;
    }
    element->vr[0] = p[4];
    element->vr[1] = p[5];
    if (!has_long_length(element->vr)) {
        element->length = get16(p + 6, is_big_endian);
        return true;
    }
    if (left < 12)
        return cut_short(walk, at, "the length of an element");
    element->length = get32(p + 8, is_big_endian);
    element->value_at = at + 12;
    return true;
}

static bool wrong_element(struct walk *walk, const struct element *element, const char *what)
{
    return error_set(walk->err, ERROR_FORMAT, "%s: byte %zu: element (%04X,%04X): %s", walk->name, element->at,
                     element->tag >> 16, element->tag & 0xFFFF, what);
}

/* A container around an element: the data set, a sequence (of items) or an item (of elements). */
struct level {
    size_t end;         /* nothing inside may reach beyond */
    bool is_open_ended; /* undefined length: an end marker closes it */
    bool is_sequence, is_implicit, is_big_endian;
    bool is_fragments; /* a sequence whose items hold bytes: encapsulated pixels */
    uint32_t last_tag; /* largest tag of the elements so far */
};

static bool begins_with_item(const struct walk *walk, const struct element *element)
{
    return element->length >= 8 && walk->size - element->value_at >= 4 &&
           get_tag(walk->data + element->value_at, false) == TAG_ITEM;
}

static bool vr_is(const struct element *element, const char *vr)
{
    return element->vr[0] == (uint8_t)vr[0] && element->vr[1] == (uint8_t)vr[1];
}

/* Returns true if the element opens a sequence. DCMTK also reads a value of unknown VR (UN, or none) as a sequence if
 * it begins with an item and the dictionary says so; its depth counts too. */
static bool opens_level(const struct walk *walk, const struct element *element, const struct level *inside,
                        struct level *opened)
{
    opened->is_sequence = true;
    if (vr_is(element, "SQ"))
        return true;
    if (element->tag == TAG_PIXELS && element->length == UNDEFINED) {
        opened->is_fragments = true;
        return true;
    }
    if (inside->is_implicit || vr_is(element, "UN")) {
        opened->is_implicit = true;
        opened->is_big_endian = inside->is_implicit && inside->is_big_endian;
        return element->length == UNDEFINED || begins_with_item(walk, element);
    }
    return false;
}

/* One step through the data set: past an element or into it. depth counts open levels without the data set itself. */
static bool step(struct walk *walk, struct level *levels, int *depth, size_t *at)
{
    struct level *inside = &levels[*depth];
    struct element element;
    if (inside->end < walk->size && inside->end - *at < 8)
        return error_set(walk->err, ERROR_FORMAT,
                         "%s: byte %zu: expected an end mark, found the end of what holds the sequence", walk->name,
                         *at);
    if (!read_element(walk, *at, inside->is_implicit, inside->is_big_endian, &element))
        return false;
    if (++walk->n_elements > DICOM_MAX_ELEMENTS)
        return error_set(walk->err, ERROR_LIMIT, "%s: more than %d elements", walk->name, DICOM_MAX_ELEMENTS);
    bool is_end = element.tag == (inside->is_sequence ? TAG_SEQUENCE_END : TAG_ITEM_END);
    if (is_end && *depth > 0) {
        if (!inside->is_open_ended)
            return wrong_element(walk, &element, "an end mark where the length is given");
        (*depth)--;
        *at = element.value_at;
        return true;
    }
    if (inside->is_sequence != (element.tag == TAG_ITEM))
        return wrong_element(walk, &element,
                             inside->is_sequence ? "expected an item of a sequence" : "an item outside a sequence");
    if (!inside->is_sequence && element.tag >> 16 == 0xFFFE)
        return wrong_element(walk, &element, "an end mark of something that is not open");
    if (!inside->is_sequence && element.tag <= inside->last_tag && ++walk->n_disorder > DICOM_MAX_DISORDER)
        return error_set(walk->err, ERROR_FORMAT,
                         "%s: byte %zu: element (%04X,%04X) behind (%04X,%04X): more than %d are not in order",
                         walk->name, element.at, element.tag >> 16, element.tag & 0xFFFF, inside->last_tag >> 16,
                         inside->last_tag & 0xFFFF, DICOM_MAX_DISORDER);
    inside->last_tag = element.tag > inside->last_tag ? element.tag : inside->last_tag;
    if (element.value_at > inside->end ||
        (element.length != UNDEFINED && element.length > inside->end - element.value_at)) {
        walk->is_cut = inside->end == walk->size;
        return error_set(walk->err, ERROR_FORMAT,
                         "%s: byte %zu: element (%04X,%04X) says %u bytes, but %s ends after %zu", walk->name,
                         element.at, element.tag >> 16, element.tag & 0xFFFF, element.length,
                         walk->is_cut ? "the file" : "what holds it",
                         element.value_at > inside->end ? 0 : inside->end - element.value_at);
    }
    struct level opened = { .end = element.length == UNDEFINED ? inside->end : element.value_at + element.length,
                            .is_open_ended = element.length == UNDEFINED,
                            .is_implicit = inside->is_implicit,
                            .is_big_endian = inside->is_big_endian };
    bool is_opened = inside->is_sequence ? !inside->is_fragments : opens_level(walk, &element, inside, &opened);
    *at = element.value_at;
    if (is_opened) {
        if (*depth >= 2 * DICOM_MAX_DEPTH)
            return error_set(walk->err, ERROR_LIMIT, "%s: byte %zu: sequences are nested more than %d deep", walk->name,
                             element.at, DICOM_MAX_DEPTH);
        levels[++*depth] = opened;
        return true;
    }
    if (element.length == UNDEFINED)
        return wrong_element(walk, &element, "no length, and not a sequence");
    *at += element.length;
    return true;
}

/* Closes the levels that end here. An item longer than its sequence was refused when it was opened. */
static void close_levels(const struct level *levels, int *depth, size_t at)
{
    while (*depth > 0 && !levels[*depth].is_open_ended && levels[*depth].end == at)
        (*depth)--;
}

static bool look_at_pixels(struct walk *walk, const struct level *root, size_t at, struct dicom_layout *layout)
{
    struct element element;
    if (!read_element(walk, at, root->is_implicit, root->is_big_endian, &element))
        return false;
    layout->has_pixels = element.tag == TAG_PIXELS;
    layout->has_float_pixels = !layout->has_pixels;
    layout->is_encapsulated = element.length == UNDEFINED;
    memcpy(layout->pixels_vr, element.vr, 2);
    layout->pixels_at = element.value_at;
    layout->pixels_size = element.length == UNDEFINED ? 0 : element.length;
    return true;
}

static bool walk_elements(struct walk *walk, struct dicom_layout *layout)
{
    struct level levels[2 * DICOM_MAX_DEPTH + 1] = {
        { .end = walk->size, .is_implicit = layout->is_implicit, .is_big_endian = layout->is_big_endian }
    };
    int depth = 0;
    size_t at = layout->begin;
    while (at < walk->size || depth > 0) {
        if (depth == 0) {
            layout->end = at;
            if (walk->size - at >= 4) {
                uint32_t tag = get_tag(walk->data + at, layout->is_big_endian);
                if (tag == TAG_PIXELS || tag == TAG_FLOAT_PIXELS || tag == TAG_DOUBLE_PIXELS)
                    return look_at_pixels(walk, &levels[0], at, layout);
                if (tag >> 16 == 0 || (tag == 0xFFFFFFFF)) /* padding after the last element */
                    return at > layout->begin ? true
                                              : error_set(walk->err, ERROR_FORMAT,
                                                          "%s: byte %zu: no element of a data set", walk->name, at);
            }
        }
        if (!step(walk, levels, &depth, &at))
            return false;
        close_levels(levels, &depth, at);
    }
    layout->end = at;
    return true;
}

/* Inflates (RFC 1951) all data up to the limit. A truncated stream is no error here: the walk reports it. */
static bool inflate_data_set(struct walk *walk, size_t from, struct dicom_layout *layout)
{
    size_t limit = walk->extent == DICOM_START ? (size_t)1 << 20 : (size_t)DICOM_MAX_INFLATED_MIB << 20;
    size_t room = 0, n = 0;
    z_stream stream = { .next_in = (Bytef *)(uintptr_t)(walk->data + from), .avail_in = (uInt)(walk->size - from) };
    if (inflateInit2(&stream, -MAX_WBITS) != Z_OK)
        return error_set(walk->err, ERROR_MEMORY, "%s: no memory to inflate", walk->name);
    int status = Z_OK;
    while (status == Z_OK && n < limit) {
        if (n == room) {
            room = room ? 2 * room : 4 * (walk->size - from) + 65536;
            room = room < limit ? room : limit;
            uint8_t *larger = realloc(layout->inflated, room);
            if (!larger) {
                inflateEnd(&stream);
                return error_set(walk->err, ERROR_MEMORY, "%s: no memory for %zu bytes", walk->name, room);
            }
            layout->inflated = larger;
        }
        stream.next_out = layout->inflated + n;
        stream.avail_out = (uInt)(room - n);
        status = inflate(&stream, Z_NO_FLUSH);
        n = room - stream.avail_out;
    }
    inflateEnd(&stream);
    if (status == Z_DATA_ERROR)
        return error_set(walk->err, ERROR_FORMAT, "%s: the deflated data set is damaged after %zu bytes", walk->name,
                         n);
    if (status == Z_OK && walk->extent != DICOM_START)
        return error_set(walk->err, ERROR_LIMIT, "%s: the deflated data set is larger than %d MiB", walk->name,
                         DICOM_MAX_INFLATED_MIB);
    walk->data = layout->inflated;
    walk->size = n;
    layout->begin = 0;
    return true;
}

/* Walks group 0002 (always explicit, little-endian); finds the transfer syntax and the start of the data set. */
static bool walk_header(struct walk *walk, size_t at, struct dicom_layout *layout)
{
    while (walk->size - at >= 8 && get16(walk->data + at, false) == 0x0002) {
        struct element element;
        if (!is_vr(walk->data + at + 4))
            return error_set(walk->err, ERROR_FORMAT, "%s: byte %zu: the file header is not in explicit encoding",
                             walk->name, at);
        if (!read_element(walk, at, false, false, &element))
            return false;
        if (element.length > walk->size - element.value_at)
            return wrong_element(walk, &element, "longer than the file");
        if (element.tag == 0x00020010) {
            size_t n = element.length < DICOM_UID_SIZE - 1 ? element.length : DICOM_UID_SIZE - 1;
            memcpy(layout->transfer_syntax, walk->data + element.value_at, n);
            layout->transfer_syntax[n] = 0;
            while (n > 0 && (layout->transfer_syntax[n - 1] == ' ' || layout->transfer_syntax[n - 1] == 0))
                layout->transfer_syntax[--n] = 0;
            for (size_t i = 0; i < n; i++)
                if ((layout->transfer_syntax[i] < '0' || layout->transfer_syntax[i] > '9') &&
                    layout->transfer_syntax[i] != '.')
                    return wrong_element(walk, &element, "the transfer syntax is not a UID");
        }
        at = element.value_at + element.length;
    }
    layout->begin = at;
    return true;
}

/* Takes the encoding from the first element rather than from the header: every viewer reads files that contradict
 * themselves. */
static void look_at_encoding(const struct walk *walk, struct dicom_layout *layout)
{
    const uint8_t *p = walk->data + layout->begin;
    layout->is_big_endian = strcmp(layout->transfer_syntax, "1.2.840.10008.1.2.2") == 0;
    layout->is_implicit = strcmp(layout->transfer_syntax, "1.2.840.10008.1.2") == 0;
    if (walk->size - layout->begin < 8)
        return;
    layout->is_implicit = !is_vr(p + 4);
    uint32_t little = get16(p, false), big = get16(p, true);
    if (!layout->is_implicit && (little == 0x0008 || big == 0x0008))
        layout->is_big_endian = big == 0x0008;
    else if (layout->is_implicit)
        layout->is_big_endian = false; /* implicit big-endian does not exist */
}

bool dicom_walk(const uint8_t *data, size_t size, const char *name, enum dicom_extent extent,
                struct dicom_layout *layout, struct error *err)
{
    struct walk walk = { .data = data, .size = size, .name = name, .extent = extent, .err = err };
    *layout = (struct dicom_layout){ 0 };
    if (!dicom_looks_like(data, size))
        return error_set(err, ERROR_FORMAT,
                         "%s: not a DICOM file: neither \"DICM\" at byte 128 nor an element at byte 0", name);
    if (size >> 20 >= DICOM_MAX_FILE_MIB)
        return error_set(err, ERROR_LIMIT, "%s: %zu bytes; at most %d MiB are read", name, size, DICOM_MAX_FILE_MIB);
    bool has_preamble = size >= 132 && memcmp(data + 128, "DICM", 4) == 0;
    if (!walk_header(&walk, has_preamble ? 132 : 0, layout))
        return false;
    if (strcmp(layout->transfer_syntax, "1.2.840.10008.1.2.1.99") == 0 &&
        !inflate_data_set(&walk, layout->begin, layout))
        goto fail;
    layout->data = walk.data;
    layout->size = walk.size;
    if (walk.size == layout->begin) {
        error_set(err, ERROR_FORMAT, "%s: byte %zu: expected a data set, found the end of the file", name,
                  layout->begin);
        goto fail;
    }
    look_at_encoding(&walk, layout);
    if (!walk_elements(&walk, layout)) {
        layout->is_cut = walk.is_cut && extent == DICOM_START && layout->end > layout->begin;
        if (!layout->is_cut)
            goto fail;
        if (err)
            *err = (struct error){ 0 };
    }
    return true;
fail:
    free(layout->inflated);
    layout->inflated = NULL;
    return false;
}

bool dicom_walk_fragments(const struct dicom_layout *layout, const char *name, struct dicom_fragment *fragments,
                          size_t most, size_t *n_fragments, struct error *err)
{
    *n_fragments = 0;
    struct walk walk = { .data = layout->data, .size = layout->size, .name = name, .err = err };
    for (size_t at = layout->pixels_at;;) {
        struct element element;
        if (!read_element(&walk, at, true, layout->is_big_endian, &element))
            return false;
        if (element.tag == TAG_SEQUENCE_END)
            return true;
        if (element.tag != TAG_ITEM)
            return wrong_element(&walk, &element, "expected a fragment of compressed pixels");
        if (element.length > layout->size - element.value_at)
            return wrong_element(&walk, &element, "a fragment of compressed pixels that is longer than the file");
        if (*n_fragments < most)
            fragments[*n_fragments] = (struct dicom_fragment){ element.value_at, element.length };
        (*n_fragments)++;
        at = element.value_at + element.length;
    }
}
