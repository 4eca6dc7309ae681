/* Checks the markers of a JPEG 2000 codestream against the image and against limits, then decodes it with OpenJPEG. */
#include "core/formats/dicom/dicom_j2k.h"

#include <string.h>

#include <openjpeg-2.5/openjpeg.h>

/* ---- checking the markers --------------------------------------------------------------------------------------- */

enum marker {
    SOC = 0xFF4F,
    SOT = 0xFF90,
    SOD = 0xFF93,
    EOC = 0xFFD9,
    SIZ = 0xFF51,
    COD = 0xFF52,
    COC = 0xFF53,
    RGN = 0xFF5E,
    POC = 0xFF5F,
    CAP = 0xFF50
};

struct scan {
    const uint8_t *data;
    size_t size;
    const char *name;
    const struct dicom_pixels *pixels;
    uint32_t precision, n_tiles;
    uint32_t tile_width, tile_height;
    bool is_signed, has_size, has_coding, is_lossy;
    struct error *err;
};

static uint32_t big16(const uint8_t *p)
{
    return (uint32_t)p[0] << 8 | p[1];
}
static uint32_t big32(const uint8_t *p)
{
    return big16(p) << 16 | big16(p + 2);
}

static bool refuse(const struct scan *scan, enum error_code code, const char *what)
{
    return error_set(scan->err, code, "%s: a JPEG 2000 frame %s", scan->name, what);
}

/* SIZ marker: size, tiles, components. T.800 A.5.1. */
static bool read_size(struct scan *scan, const uint8_t *p, size_t n)
{
    if (n < 41)
        return refuse(scan, ERROR_FORMAT, "has a size segment (SIZ) that is too short");
    uint32_t x1 = big32(p + 4), y1 = big32(p + 8), x0 = big32(p + 12), y0 = big32(p + 16), tile_x = big32(p + 20),
             tile_y = big32(p + 24);
    uint32_t tile_x0 = big32(p + 28), tile_y0 = big32(p + 32), n_components = big16(p + 36);
    uint32_t columns = x1 > x0 ? x1 - x0 : 0, rows = y1 > y0 ? y1 - y0 : 0;
    scan->precision = (p[38] & 0x7Fu) + 1;
    scan->is_signed = p[38] >> 7;
    if (columns != scan->pixels->columns || rows != scan->pixels->rows || n_components != 1 ||
        scan->precision > scan->pixels->bits_allocated)
        return error_set(
            scan->err, ERROR_FORMAT,
            "%s: a JPEG 2000 frame of %u x %u, %u components of %u bits; expected %u x %u, 1 of at most %u", scan->name,
            columns, rows, n_components, scan->precision, scan->pixels->columns, scan->pixels->rows,
            scan->pixels->bits_allocated);
    if (p[39] != 1 || p[40] != 1)
        return refuse(scan, ERROR_UNSUPPORTED, "has fewer values than pixels (subsampling), which is not read");
    if (tile_x == 0 || tile_y == 0 || tile_x0 > x0 || tile_y0 > y0 || (uint64_t)tile_x0 + tile_x <= x0 ||
        (uint64_t)tile_y0 + tile_y <= y0)
        return refuse(scan, ERROR_FORMAT, "has tiles that do not cover it");
    uint64_t n_x = ((uint64_t)x1 - tile_x0 + tile_x - 1) / tile_x, n_y = ((uint64_t)y1 - tile_y0 + tile_y - 1) / tile_y;
    if (n_x > J2K_MAX_TILES || n_y > J2K_MAX_TILES || n_x * n_y > J2K_MAX_TILES)
        return error_set(scan->err, ERROR_LIMIT, "%s: a JPEG 2000 frame of %llu x %llu tiles; at most %d are read",
                         scan->name, (unsigned long long)n_x, (unsigned long long)n_y, J2K_MAX_TILES);
    scan->n_tiles = (uint32_t)(n_x * n_y);
    scan->tile_width = tile_x < columns ? tile_x : columns;
    scan->tile_height = tile_y < rows ? tile_y : rows;
    scan->has_size = true;
    return true;
}

/* COD marker: counts the code-blocks, precincts and packets of all tiles. T.800 A.6.1. */
static bool read_coding(struct scan *scan, const uint8_t *p, size_t n)
{
    if (!scan->has_size || n < 12)
        return refuse(scan, ERROR_FORMAT, "has a coding style segment (COD) that is too short or out of place");
    bool has_precincts = p[2] & 1;
    uint32_t n_layers = big16(p + 4), n_levels = p[7], block_x = (p[8] & 15u) + 2, block_y = (p[9] & 15u) + 2;
    if (n_levels > 32 || block_x > 10 || block_y > 10 || block_x + block_y > 12 ||
        (has_precincts && n < 12 + 1 + (size_t)n_levels))
        return refuse(scan, ERROR_FORMAT, "has a coding style (COD) that the standard does not allow");
    if (p[10] & 0xC0)
        return refuse(scan, ERROR_UNSUPPORTED,
                      "has code-blocks of high throughput (part 15 of the standard), which are not read");
    scan->is_lossy |= p[11] == 0;
    uint64_t n_blocks = 0, n_precincts = 0;
    for (uint32_t level = 0; level <= n_levels; level++) { /* p[12] belongs to the lowest resolution */
        uint32_t down = n_levels - level < 31 ? n_levels - level : 31;
        uint64_t width = (scan->tile_width >> down) + 2,
                 height = (scan->tile_height >> down) + 2; /* rounded up: tile edges */
        uint32_t x = has_precincts ? p[12 + level] & 15u : 15, y = has_precincts ? p[12 + level] >> 4 : 15;
        uint32_t half = level > 0; /* above the lowest resolution, precincts are divided over the subbands */
        uint32_t cut_x = x > half && x - half < block_x ? x - half : x > half ? block_x : 0;
        uint32_t cut_y = y > half && y - half < block_y ? y - half : y > half ? block_y : 0;
        n_precincts += ((width >> x) + 2) * ((height >> y) + 2);
        n_blocks += ((width >> cut_x) + 2) * ((height >> cut_y) + 2);
    }
    n_precincts *= scan->n_tiles;
    n_blocks *= scan->n_tiles;
    if (n_blocks > J2K_MAX_BLOCKS || n_precincts > J2K_MAX_BLOCKS || n_precincts * n_layers > J2K_MAX_PACKETS)
        return error_set(
            scan->err, ERROR_LIMIT,
            "%s: a JPEG 2000 frame of about %llu code-blocks, %llu precincts and %u layers; at most %d, %d, and "
            "%d packets are read",
            scan->name, (unsigned long long)n_blocks, (unsigned long long)n_precincts, n_layers, J2K_MAX_BLOCKS,
            J2K_MAX_BLOCKS, J2K_MAX_PACKETS);
    scan->has_coding = true;
    return true;
}

static bool read_segment(struct scan *scan, uint32_t marker, const uint8_t *p, size_t n)
{
    switch (marker) {
    case SIZ: return scan->has_size ? refuse(scan, ERROR_FORMAT, "says its size twice") : read_size(scan, p, n);
    case COD: return read_coding(scan, p, n);
    case COC: return refuse(scan, ERROR_UNSUPPORTED, "codes components differently (COC), which is not read");
    case POC: return refuse(scan, ERROR_UNSUPPORTED, "changes its order of progression (POC), which is not read");
    case RGN: return refuse(scan, ERROR_UNSUPPORTED, "has a region of interest (RGN), which is not read");
    case CAP:
        return refuse(scan, ERROR_UNSUPPORTED,
                      "uses a part of the standard (CAP: high throughput, or another) that is not read");
    default: return true;
    }
}

/* Reads marker segments up to SOT, SOD or EOC. Returns that marker and sets `at` to the byte after it; 0 on error. */
static uint32_t read_segments(struct scan *scan, size_t *at)
{
    while (*at + 4 <= scan->size) {
        uint32_t marker = big16(scan->data + *at);
        if (marker < 0xFF00) {
            error_set(scan->err, ERROR_FORMAT, "%s: byte %zu of a JPEG 2000 frame: expected a marker, found %04X",
                      scan->name, *at, marker);
            return 0;
        }
        *at += 2;
        if (marker == SOD || marker == SOT || marker == EOC)
            return marker;
        size_t n = big16(scan->data + *at);
        if (n < 2 || n > scan->size - *at) {
            error_set(scan->err, ERROR_FORMAT,
                      "%s: byte %zu of a JPEG 2000 frame: a segment of %zu bytes, the frame ends after %zu", scan->name,
                      *at, n, scan->size - *at);
            return 0;
        }
        if (!read_segment(scan, marker, scan->data + *at, n))
            return 0;
        *at += n;
    }
    refuse(scan, ERROR_FORMAT, "ends within its headers");
    return 0;
}

/* Checks the main header and the header of every tile-part. T.800 A.3, A.4.2. */
static bool scan_stream(struct scan *scan)
{
    size_t at = 2;
    if (scan->size < 4 || big16(scan->data) != SOC)
        return refuse(scan, ERROR_FORMAT, "does not begin with FF 4F");
    uint32_t marker = read_segments(scan, &at);
    if (marker != 0 && (marker != SOT || !scan->has_size || !scan->has_coding))
        return refuse(scan, ERROR_FORMAT, "has no size (SIZ), coding style (COD) or tile (SOT)");
    while (marker == SOT) {
        size_t begin = at - 2;
        if (scan->size - at < 10)
            return refuse(scan, ERROR_FORMAT, "ends within the head of a tile (SOT)");
        size_t length = big32(scan->data + at + 4);
        at += 10;
        marker = read_segments(scan, &at);
        if (marker != SOD)
            return marker == 0 ? false : refuse(scan, ERROR_FORMAT, "has a tile without data (SOD)");
        if (length == 0)
            return true; /* length 0: the last tile-part, up to the end */
        if (length > scan->size - begin || begin + length < at)
            return refuse(scan, ERROR_FORMAT, "has a tile that is longer than it is, or shorter than its head");
        at = begin + length;
        if (scan->size - at < 2)
            return true; /* no end marker: OpenJPEG reports missing data */
        marker = big16(scan->data + at);
        at += 2;
    }
    return marker == EOC ? true
           : marker == 0 ? false
                         : refuse(scan, ERROR_FORMAT, "has something other than a tile between its tiles");
}

/* Finds the codestream inside JP2 boxes, which some writers leave around it. T.800 I.4. */
static void unwrap(const uint8_t **data, size_t *size)
{
    static const uint8_t signature[] = { 0, 0, 0, 12, 'j', 'P', ' ', ' ' };
    if (*size < sizeof signature || memcmp(*data, signature, sizeof signature) != 0)
        return;
    for (size_t at = 0; *size - at >= 8;) {
        size_t n = big32(*data + at);
        n = n == 0 ? *size - at : n;
        if (n < 8 || n > *size - at)
            return;
        if (memcmp(*data + at + 4, "jp2c", 4) == 0) {
            *data += at + 8;
            *size = n - 8;
            return;
        }
        at += n;
    }
}

/* ---- decoding with OpenJPEG ------------------------------------------------------------------------------------- */

struct source {
    const uint8_t *data;
    size_t size, at;
};

static OPJ_SIZE_T source_read(void *out, OPJ_SIZE_T n, void *context)
{
    struct source *source = context;
    size_t left = source->size - source->at;
    if (left == 0)
        return (OPJ_SIZE_T)-1;
    n = n < left ? n : left;
    memcpy(out, source->data + source->at, n);
    source->at += n;
    return n;
}

static OPJ_OFF_T source_skip(OPJ_OFF_T n, void *context)
{
    struct source *source = context;
    if (n < 0 || (uint64_t)n > source->size - source->at)
        return -1;
    source->at += (size_t)n;
    return n;
}

static OPJ_BOOL source_seek(OPJ_OFF_T at, void *context)
{
    struct source *source = context;
    if (at < 0 || (uint64_t)at > source->size)
        return OPJ_FALSE;
    source->at = (size_t)at;
    return OPJ_TRUE;
}

static void keep_quiet(const char *message, void *context)
{
    (void)message;
    (void)context;
}

static void put_values(const OPJ_INT32 *from, size_t n, uint32_t precision, const struct dicom_pixels *pixels,
                       void *out)
{
    uint32_t up = 32 - precision;
    for (size_t i = 0; i < n; i++) {
        uint32_t top = (uint32_t)from[i] << up;
        uint32_t value = pixels->is_signed ? (uint32_t)((int32_t)top >> up) : top >> up;
        if (pixels->bits_allocated == 8)
            ((uint8_t *)out)[i] = (uint8_t)value;
        else if (pixels->bits_allocated == 16)
            ((uint16_t *)out)[i] = (uint16_t)value;
        else
            ((uint32_t *)out)[i] = value;
    }
}

static bool run_decoder(const struct scan *scan, opj_codec_t *codec, opj_stream_t *stream, opj_image_t **image,
                        void *out)
{
    const struct dicom_pixels *pixels = scan->pixels;
    opj_dparameters_t parameters;
    opj_set_default_decoder_parameters(&parameters);
    if (!opj_setup_decoder(codec, &parameters) || !opj_decoder_set_strict_mode(codec, OPJ_TRUE))
        return error_set(scan->err, ERROR_MEMORY, "%s: no memory for a JPEG 2000 decoder", scan->name);
    if (!opj_read_header(stream, codec, image) || !opj_decode(codec, stream, *image) ||
        !opj_end_decompress(codec, stream))
        return refuse(scan, ERROR_FORMAT, "cannot be decoded: it is damaged or cut short");
    const opj_image_comp_t *component = (*image)->comps;
    if ((*image)->numcomps != 1 || component->w != pixels->columns || component->h != pixels->rows ||
        component->prec != scan->precision || !component->data)
        return refuse(scan, ERROR_FORMAT, "was decoded to another size than its header says");
    put_values(component->data, (size_t)pixels->rows * pixels->columns, scan->precision, pixels, out);
    return true;
}

bool dicom_j2k_decode(const uint8_t *data, size_t size, const struct dicom_pixels *pixels, const char *name, void *out,
                      struct dicom_decoded *decoded, struct error *err)
{
    unwrap(&data, &size);
    struct scan scan = { .data = data, .size = size, .name = name, .pixels = pixels, .err = err };
    if (!scan_stream(&scan))
        return false;
    struct source source = { data, size, 0 };
    opj_codec_t *codec = opj_create_decompress(OPJ_CODEC_J2K);
    opj_stream_t *stream = opj_stream_default_create(OPJ_TRUE);
    opj_image_t *image = NULL;
    bool is_decoded = false;
    if (codec && stream) {
        opj_set_error_handler(codec, keep_quiet, NULL);
        opj_set_warning_handler(codec, keep_quiet, NULL);
        opj_set_info_handler(codec, keep_quiet, NULL);
        opj_stream_set_user_data(stream, &source, NULL);
        opj_stream_set_user_data_length(stream, size);
        opj_stream_set_read_function(stream, source_read);
        opj_stream_set_skip_function(stream, source_skip);
        opj_stream_set_seek_function(stream, source_seek);
        is_decoded = run_decoder(&scan, codec, stream, &image, out);
    } else {
        error_set(err, ERROR_MEMORY, "%s: no memory for a JPEG 2000 decoder", name);
    }
    if (is_decoded)
        *decoded =
            (struct dicom_decoded){ .is_lossy = scan.is_lossy, .is_signed = scan.is_signed, .n_bits = scan.precision };
    opj_image_destroy(image);
    opj_stream_destroy(stream);
    opj_destroy_codec(codec);
    return is_decoded;
}
