// Pixels of a parsed DICOM file, by the plain C functions of dicom_file.h: checks the image pixel module, finds native
// pixels, reads and decodes frames. No exception leaves it.
extern "C" {
#include "core/formats/dicom/dicom_unpack.h"
}
#include <algorithm>
#include <cstring>

#include <dcmtk/config/osconfig.h>

#include <dcmtk/dcmdata/dcxfer.h>

#include "core/formats/dicom/dicom_decode.hh"
#include "core/formats/dicom/dicom_file.hh"

namespace {

bool need_integer(const dicom_file *file, uint32_t tag, const char *what, int64_t low, int64_t high, uint32_t *out,
                  error *err)
{
    int64_t value = 0;
    if (!dicom_integer(&file->root, tag, &value))
        return error_set(err, ERROR_FORMAT, "%s: element (%04X,%04X), %s: expected a whole number, found none",
                         file->name.c_str(), tag >> 16, tag & 0xFFFF, what);
    if (value < low || value > high)
        return error_set(err, value > high ? ERROR_LIMIT : ERROR_FORMAT,
                         "%s: element (%04X,%04X), %s: found %lld, expected %lld to %lld", file->name.c_str(),
                         tag >> 16, tag & 0xFFFF, what, static_cast<long long>(value), static_cast<long long>(low),
                         static_cast<long long>(high));
    *out = static_cast<uint32_t>(value);
    return true;
}

// Reads an optional element: otherwise if absent. A present one must be a whole number of at most `high`.
bool optional_integer(const dicom_file *file, uint32_t tag, const char *what, uint32_t high, uint32_t otherwise,
                      uint32_t *out, error *err)
{
    double ignored;
    *out = otherwise;
    return dicom_numbers(&file->root, tag, &ignored, 1) == 0 || need_integer(file, tag, what, 0, high, out, err);
}

bool look(const dicom_file *file, dicom_pixels *pixels, error *err)
{
    const char *name = file->name.c_str();
    const dicom_layout &layout = file->layout;
    *pixels = dicom_pixels{};
    if (layout.has_float_pixels)
        return error_set(err, ERROR_UNSUPPORTED, "%s: its pixels are floating-point numbers; only whole ones are read",
                         name);
    if (!layout.has_pixels)
        return error_set(err, ERROR_FORMAT, "%s: expected pixel data (7FE0,0010), found none", name);
    if (!need_integer(file, 0x00280010, "rows", 1, DICOM_MAX_SIDE, &pixels->rows, err) ||
        !need_integer(file, 0x00280011, "columns", 1, DICOM_MAX_SIDE, &pixels->columns, err) ||
        !need_integer(file, 0x00280100, "bits allocated", 1, 64, &pixels->bits_allocated, err))
        return false;
    if (pixels->bits_allocated != 8 && pixels->bits_allocated != 16 && pixels->bits_allocated != 32)
        return error_set(err, ERROR_UNSUPPORTED,
                         "%s: element (0028,0100), bits allocated: found %u, expected 8, 16 or 32", name,
                         pixels->bits_allocated);
    uint32_t is_signed = 0;
    if (!optional_integer(file, 0x00280002, "samples per pixel", 16, 1, &pixels->n_samples, err) ||
        !optional_integer(file, 0x00280101, "bits stored", 64, pixels->bits_allocated, &pixels->bits_stored, err) ||
        !optional_integer(file, 0x00280102, "high bit", 63, pixels->bits_stored - 1, &pixels->high_bit, err) ||
        !optional_integer(file, 0x00280103, "pixel representation", 1, 0, &is_signed, err))
        return false;
    pixels->is_signed = is_signed == 1;
    char color[20];
    bool has_color = dicom_text(&file->root, 0x00280004, color, sizeof color);
    pixels->is_monochrome1 = std::strcmp(color, "MONOCHROME1") == 0;
    if (pixels->n_samples != 1 || (has_color && !pixels->is_monochrome1 && std::strcmp(color, "MONOCHROME2") != 0))
        return error_set(err, ERROR_UNSUPPORTED,
                         "%s: it is a colour picture (%s, %u samples a pixel); only grey ones are read", name,
                         has_color ? color : "kind not said", pixels->n_samples);
    if (pixels->bits_stored < 1 || pixels->bits_stored > pixels->bits_allocated ||
        pixels->high_bit >= pixels->bits_allocated || pixels->high_bit + 1 < pixels->bits_stored)
        return error_set(err, ERROR_FORMAT,
                         "%s: elements (0028,0100) to (0028,0102): %u bits up to bit %u do not fit into %u", name,
                         pixels->bits_stored, pixels->high_bit, pixels->bits_allocated);
    pixels->n_frames = 1;
    if (dicom_has(&file->root, 0x00280008) &&
        !need_integer(file, 0x00280008, "number of frames", 1, INT32_MAX, &pixels->n_frames, err))
        return false;
    if (layout.is_encapsulated) {
        const char *encoding;
        bool can_decode = dicom_can_decode(layout.transfer_syntax, &encoding);
        if (DcmXfer(layout.transfer_syntax).getXfer() == EXS_Unknown && dicom_uid_word(layout.transfer_syntax)[0])
            encoding = dicom_uid_word(layout.transfer_syntax);
        if (!can_decode)
            return error_set(err, ERROR_UNSUPPORTED, "%s: its pixels are encoded as %s (%s), which is not read", name,
                             encoding, layout.transfer_syntax);
        return true;
    }
    const char *encoding;
    if (dicom_can_decode(layout.transfer_syntax, &encoding) || DcmXfer(layout.transfer_syntax).isEncapsulated())
        return error_set(err, ERROR_FORMAT,
                         "%s: byte %zu: pixel data of %llu bytes where the transfer syntax (%s) needs fragments", name,
                         layout.pixels_at, static_cast<unsigned long long>(layout.pixels_size), encoding);
    uint64_t frame = uint64_t(pixels->rows) * pixels->columns * (pixels->bits_allocated / 8);
    uint64_t needed = frame * pixels->n_frames;
    if (layout.pixels_size < needed)
        return error_set(err, ERROR_FORMAT,
                         "%s: byte %zu: pixel data of %llu bytes; %u x %u x %u pixels of %u bits need %llu", name,
                         layout.pixels_at, static_cast<unsigned long long>(layout.pixels_size), pixels->columns,
                         pixels->rows, pixels->n_frames, pixels->bits_allocated,
                         static_cast<unsigned long long>(needed));
    uint64_t even = needed + needed % 2;
    pixels->surplus_bytes = layout.pixels_size > even ? layout.pixels_size - even : 0;
    return true;
}

// Bytes (OB) have no byte order; words (OW) do, also where two pixels of 8 bits share one.
bool is_swapped(const dicom_layout &layout)
{
    return layout.is_big_endian && std::strcmp(layout.pixels_vr, "OB") != 0;
}

bool read_frame(dicom_file &file, uint32_t frame, void *out, error *err)
{
    dicom_pixels pixels;
    if (!look(&file, &pixels, err))
        return false;
    const char *name = file.name.c_str();
    const dicom_layout &layout = file.layout;
    if (frame >= pixels.n_frames)
        return error_set(err, ERROR_RANGE, "%s: frame %u of %u", name, frame, pixels.n_frames);
    size_t n = size_t(pixels.rows) * pixels.columns, bytes = n * (pixels.bits_allocated / 8);
    if (layout.is_encapsulated) {
        if (!file.has_frames &&
            !dicom_find_frames(layout, name, pixels.n_frames, file.fragments, file.first_fragments, err))
            return false;
        file.has_frames = true;
        std::vector<dicom_fragment> own(file.fragments.begin() +
                                            static_cast<std::ptrdiff_t>(file.first_fragments[frame]),
                                        file.fragments.begin() +
                                            static_cast<std::ptrdiff_t>(file.first_fragments[frame + 1]));
        return dicom_decode_frame(layout, pixels, name, own, out, &file.decoded, err);
    }
    uint64_t at = layout.pixels_at + uint64_t(frame) * bytes;
    if (at > layout.size || bytes > layout.size - at)
        return error_set(err, ERROR_FORMAT, "%s: byte %llu: frame %u needs %zu bytes, the file ends at %zu", name,
                         static_cast<unsigned long long>(at), frame, bytes, layout.size);
    std::memcpy(out, layout.data + at, bytes);
    dicom_pixels_unpack(&pixels, is_swapped(layout), out, n);
    return true;
}

} // namespace

extern "C" {

bool dicom_pixels_look(const struct dicom_file *file, struct dicom_pixels *pixels, struct error *err)
{
    return guarded_call(file->name.c_str(), err, [&] { return look(file, pixels, err); });
}

bool dicom_pixels_read(const struct dicom_file *file, uint32_t frame, void *out, struct error *err)
{
    // caches the fragments for the next frame; one thread reads a file at a time
    return guarded_call(file->name.c_str(), err,
                        [&] { return read_frame(*const_cast<dicom_file *>(file), frame, out, err); });
}

struct dicom_decoded dicom_pixels_decoded(const struct dicom_file *file)
{
    return file->decoded;
}

const uint8_t *dicom_pixels_bytes(const struct dicom_file *file, uint64_t *size, bool *swapped)
{
    const dicom_layout &layout = file->layout;
    if (!layout.has_pixels || layout.is_encapsulated || layout.pixels_at > layout.size)
        return nullptr;
    *size = std::min<uint64_t>(layout.pixels_size, layout.size - layout.pixels_at);
    *swapped = is_swapped(layout);
    return layout.data + layout.pixels_at;
}

bool dicom_pixels_stored(const struct dicom_file *file, struct dicom_stored *stored)
{
    const dicom_layout &layout = file->layout;
    if (!layout.has_pixels || layout.is_encapsulated || layout.inflated)
        return false;
    *stored = { layout.pixels_at, layout.pixels_size, is_swapped(layout) };
    return true;
}

} // extern "C"
