#pragma once
// Decodes one compressed frame to stored values, by DCMTK's decoders or dicom_j2k.
extern "C" {
#include "core/formats/dicom/dicom_walk.h"
}
#include <vector>

// Registers the decoders, once. Any thread.
void dicom_decoders_register();
// Returns whether frames of this transfer syntax can be decoded; if not, name is set to its name for the error
// sentence.
bool dicom_can_decode(const char *transfer_syntax, const char **name);
// Returns true if bytes begin with the marker that starts an image of this transfer syntax. A frame in several
// fragments starts with it, and the frame before ends with the end marker. Always false for encodings without such
// markers (RLE).
bool dicom_begins_picture(const char *transfer_syntax, const uint8_t *bytes, size_t size);
bool dicom_ends_picture(const uint8_t *bytes, size_t size);
// Lists all fragments, offset table first. first_fragments: the number of each frame's first fragment, then the number
// of fragments.
bool dicom_find_frames(const dicom_layout &layout, const char *name, uint32_t n_frames,
                       std::vector<dicom_fragment> &fragments, std::vector<size_t> &first_fragments, error *err);
// Decodes the fragments of one frame. out holds rows * columns * bits_allocated / 8 bytes and receives stored values as
// dicom_pixels_read gives them. Throws what the standard library throws.
bool dicom_decode_frame(const dicom_layout &layout, const dicom_pixels &pixels, const char *name,
                        const std::vector<dicom_fragment> &fragments, void *out, dicom_decoded *decoded, error *err);
