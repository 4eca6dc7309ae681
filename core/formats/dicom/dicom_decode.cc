// Decodes one compressed frame by DCMTK's decoders or dicom_j2k, after comparing its own header with the image.
#include "core/formats/dicom/dicom_decode.hh"

extern "C" {
#include "core/formats/dicom/dicom_j2k.h"
#include "core/formats/dicom/dicom_unpack.h"
}
#include <cstring>
#include <memory>
#include <mutex>

#include <dcmtk/config/osconfig.h>

#include <dcmtk/dcmdata/dcpixel.h>
#include <dcmtk/dcmdata/dcpixseq.h>
#include <dcmtk/dcmdata/dcpxitem.h>
#include <dcmtk/dcmdata/dcrledrg.h>
#include <dcmtk/dcmdata/dctk.h>
#include <dcmtk/dcmjpeg/djdecode.h>
#include <dcmtk/dcmjpls/djdecode.h>

void dicom_decoders_register()
{
    static std::once_flag once;
    std::call_once(once, [] {
        DcmRLEDecoderRegistration::registerCodecs();
        DJDecoderRegistration::registerCodecs();
        DJLSDecoderRegistration::registerCodecs();
    });
}

namespace {

enum class stream { jpeg, jpeg_ls, jpeg_2000, rle };

const struct encoding {
    const char *uid;
    stream kind;
} decoded[] = {
    { "1.2.840.10008.1.2.4.50", stream::jpeg },      { "1.2.840.10008.1.2.4.51", stream::jpeg },
    { "1.2.840.10008.1.2.4.53", stream::jpeg },      { "1.2.840.10008.1.2.4.55", stream::jpeg },
    { "1.2.840.10008.1.2.4.57", stream::jpeg },      { "1.2.840.10008.1.2.4.70", stream::jpeg },
    { "1.2.840.10008.1.2.4.80", stream::jpeg_ls },   { "1.2.840.10008.1.2.4.81", stream::jpeg_ls },
    { "1.2.840.10008.1.2.4.90", stream::jpeg_2000 }, { "1.2.840.10008.1.2.4.91", stream::jpeg_2000 },
    { "1.2.840.10008.1.2.5", stream::rle },
};

const encoding *find_encoding(const char *uid)
{
    for (const encoding &one : decoded)
        if (std::strcmp(one.uid, uid) == 0)
            return &one;
    return nullptr;
}

uint32_t big16(const uint8_t *p)
{
    return uint32_t(p[0]) << 8 | p[1];
}

// Compares the size in a JPEG or JPEG-LS frame header with the image's, because a decoder trusts it. Source: ITU-T T.81
// B.1.1, B.2.2; T.87 C.2.2.
bool jpeg_fits(const std::vector<uint8_t> &bytes, const dicom_pixels &pixels, const char *name, error *err)
{
    size_t at = 2;
    if (bytes.size() < 4 || bytes[0] != 0xFF || bytes[1] != 0xD8)
        return error_set(err, ERROR_FORMAT, "%s: a compressed frame does not begin like JPEG (FF D8)", name);
    while (at + 4 <= bytes.size()) {
        if (bytes[at] != 0xFF)
            return error_set(err, ERROR_FORMAT, "%s: byte %zu of a JPEG frame: expected a marker, found %02X", name, at,
                             bytes[at]);
        uint8_t marker = bytes[at + 1];
        if (marker == 0xFF) {
            at++;
            continue;
        }
        size_t length = big16(&bytes[at + 2]);
        bool is_frame =
            (marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC) || marker == 0xF7;
        if (is_frame) {
            if (at + 10 > bytes.size())
                break;
            uint32_t bits = bytes[at + 4], rows = big16(&bytes[at + 5]), columns = big16(&bytes[at + 7]),
                     samples = bytes[at + 9];
            if (rows != pixels.rows || columns != pixels.columns || samples != 1 || bits > pixels.bits_allocated ||
                bits < 2)
                return error_set(
                    err, ERROR_FORMAT,
                    "%s: a JPEG frame of %u x %u, %u samples of %u bits; expected %u x %u, 1 of at most %u", name,
                    columns, rows, samples, bits, pixels.columns, pixels.rows, pixels.bits_allocated);
            return true;
        }
        if (length < 2 || marker == 0xDA || marker == 0xD9)
            break;
        at += 2 + length;
    }
    return error_set(err, ERROR_FORMAT, "%s: a compressed frame ends before its JPEG frame header", name);
}

// Checks the RLE header: 64 bytes with the start of each byte plane. Source: DICOM PS3.5 annex G.
bool rle_fits(const std::vector<uint8_t> &bytes, const dicom_pixels &pixels, const char *name, error *err)
{
    auto little32 = [&](size_t at) {
        return uint32_t(bytes[at + 3]) << 24 | uint32_t(bytes[at + 2]) << 16 | uint32_t(bytes[at + 1]) << 8 | bytes[at];
    };
    uint32_t expected = pixels.bits_allocated / 8, last = 64;
    if (bytes.size() < 64)
        return error_set(err, ERROR_FORMAT, "%s: an RLE frame of %zu bytes; its header alone has 64", name,
                         bytes.size());
    if (little32(0) != expected)
        return error_set(err, ERROR_FORMAT, "%s: an RLE frame of %u byte planes; expected %u", name, little32(0),
                         expected);
    for (uint32_t plane = 0; plane < expected; plane++) {
        uint32_t at = little32(4 + 4 * plane);
        if (at < last || at > bytes.size())
            return error_set(err, ERROR_FORMAT, "%s: byte plane %u of an RLE frame begins at %u of %zu bytes", name,
                             plane, at, bytes.size());
        last = at;
    }
    return true;
}

// False without memory.
bool describe(DcmDataset &image, const dicom_pixels &pixels)
{
    return image.putAndInsertUint16(DCM_SamplesPerPixel, 1).good() &&
           image.putAndInsertString(DCM_PhotometricInterpretation, "MONOCHROME2").good() &&
           image.putAndInsertString(DCM_NumberOfFrames, "1").good() &&
           image.putAndInsertUint16(DCM_Rows, Uint16(pixels.rows)).good() &&
           image.putAndInsertUint16(DCM_Columns, Uint16(pixels.columns)).good() &&
           image.putAndInsertUint16(DCM_BitsAllocated, Uint16(pixels.bits_allocated)).good() &&
           image.putAndInsertUint16(DCM_BitsStored, Uint16(pixels.bits_stored)).good() &&
           image.putAndInsertUint16(DCM_HighBit, Uint16(pixels.high_bit)).good() &&
           image.putAndInsertUint16(DCM_PixelRepresentation, pixels.is_signed ? 1 : 0).good();
}

} // namespace

bool dicom_can_decode(const char *transfer_syntax, const char **name)
{
    *name = DcmXfer(transfer_syntax).getXferName();
    return find_encoding(transfer_syntax) != nullptr;
}

bool dicom_begins_picture(const char *transfer_syntax, const uint8_t *bytes, size_t size)
{
    const encoding *encoding = find_encoding(transfer_syntax);
    static const uint8_t boxed[] = { 0, 0, 0, 12, 'j', 'P', ' ', ' ' };
    if (!encoding || encoding->kind == stream::rle || size < 8)
        return false;
    if (encoding->kind == stream::jpeg_2000)
        return (bytes[0] == 0xFF && bytes[1] == 0x4F && bytes[2] == 0xFF && bytes[3] == 0x51) ||
               std::memcmp(bytes, boxed, sizeof boxed) == 0;
    return bytes[0] == 0xFF && bytes[1] == 0xD8 && bytes[2] == 0xFF;
}

bool dicom_ends_picture(const uint8_t *bytes, size_t size)
{
    for (int filling = 0; filling < 2 && size > 0 && (bytes[size - 1] == 0); filling++)
        size--;
    return size >= 2 && bytes[size - 2] == 0xFF && bytes[size - 1] == 0xD9;
}

// DCMTK sees a data set made here from the checked values, and one frame: nothing else of the file.
bool dicom_decode_frame(const dicom_layout &layout, const dicom_pixels &pixels, const char *name,
                        const std::vector<dicom_fragment> &fragments, void *out, dicom_decoded *decoded, error *err)
{
    *decoded = dicom_decoded{};
    const encoding *encoding = find_encoding(layout.transfer_syntax);
    if (!encoding)
        return error_set(err, ERROR_UNSUPPORTED, "%s: transfer syntax %s cannot be decoded", name,
                         layout.transfer_syntax);
    std::vector<uint8_t> bytes;
    for (const dicom_fragment &fragment : fragments)
        bytes.insert(bytes.end(), layout.data + fragment.at, layout.data + fragment.at + fragment.size);
    if (encoding->kind == stream::jpeg_2000)
        return dicom_j2k_decode(bytes.data(), bytes.size(), &pixels, name, out, decoded, err);
    if (!(encoding->kind == stream::rle ? rle_fits(bytes, pixels, name, err) : jpeg_fits(bytes, pixels, name, err)))
        return false;
    if (bytes.size() % 2)
        bytes.push_back(0);
    // CharLS reads one byte beyond a damaged frame: let it find end markers there
    for (int i = 0; encoding->kind != stream::rle && i < 64; i++)
        bytes.push_back(i % 2 ? 0xD9 : 0xFF);

    DcmDataset image;
    if (!describe(image, pixels))
        return error_set(err, ERROR_MEMORY, "%s: no memory for a compressed frame", name);
    auto sequence = std::make_unique<DcmPixelSequence>(DCM_PixelSequenceTag);
    for (int item = 0; item < 2; item++) { // the first item is an empty offset table
        auto fragment = std::make_unique<DcmPixelItem>(DCM_PixelItemTag);
        if (item == 1 && fragment->putUint8Array(bytes.data(), static_cast<unsigned long>(bytes.size())).bad())
            return error_set(err, ERROR_MEMORY, "%s: no memory for a compressed frame", name);
        if (sequence->insert(fragment.get()).bad())
            return error_set(err, ERROR_MEMORY, "%s: no memory for a compressed frame", name);
        (void)fragment.release();
    }
    auto element = std::make_unique<DcmPixelData>(DCM_PixelData);
    E_TransferSyntax xfer = DcmXfer(layout.transfer_syntax).getXfer();
    element->putOriginalRepresentation(xfer, nullptr, sequence.release());
    DcmPixelData *frame = element.get();
    if (image.insert(frame).bad())
        return error_set(err, ERROR_MEMORY, "%s: no memory for a compressed frame", name);
    (void)element.release();

    size_t size = size_t(pixels.rows) * pixels.columns * (pixels.bits_allocated / 8);
    size_t padded = size + size % 2; // the decoder writes whole 16-bit words
    std::vector<uint8_t> odd(padded != size ? padded : 0);
    Uint32 first = 0;
    OFString colors;
    OFCondition condition =
        frame->getUncompressedFrame(&image, 0, first, odd.empty() ? out : odd.data(), Uint32(padded), colors);
    if (condition.bad())
        return error_set(err, condition == EC_MemoryExhausted ? ERROR_MEMORY : ERROR_FORMAT,
                         "%s: a compressed frame (%s) cannot be decoded: %.80s", name, DcmXfer(xfer).getXferName(),
                         condition.text());
    if (!odd.empty())
        std::memcpy(out, odd.data(), size);
    dicom_pixels_unpack(&pixels, false, out, size_t(pixels.rows) * pixels.columns);
    return true;
}
