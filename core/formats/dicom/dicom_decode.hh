#pragma once
// One compressed frame to stored values, by DCMTK's decoders, or that for JPEG 2000.
extern "C" {
#include "core/formats/dicom/dicom_walk.h"
}
#include <vector>

// Registers the decoders, once. Any thread.
void dicom_decoders_register();
// Whether frames of this transfer syntax can be decoded; if not, its name is for the sentence.
bool dicom_can_decode(const char *transfer_syntax, const char **name);
// Where the marker that begins a picture of this transfer syntax stands at the beginning of bytes: a frame in several fragments begins so,
// and the one before it ends with the end mark. Always false for encodings without such marks (RLE).
bool dicom_begins_picture(const char *transfer_syntax, const uint8_t *bytes, size_t size);
bool dicom_ends_picture(const uint8_t *bytes, size_t size);
// All fragments, the table of offsets first, and which of them begin a frame, with the end behind the last.
bool dicom_find_frames(const dicom_layout &layout, const char *name, uint32_t n_frames, std::vector<dicom_fragment> &fragments,
                       std::vector<size_t> &first_fragments, error *err);
// fragments of one frame, in order. out holds rows * columns * bits_allocated / 8 bytes: stored values as of dicom_pixels_read. Throws what
// the standard library throws.
bool dicom_decode_frame(const dicom_layout &layout, const dicom_pixels &pixels, const char *name, const std::vector<dicom_fragment> &fragments,
                        void *out, dicom_decoded *decoded, error *err);
