#pragma once
// One compressed frame to stored values, by DCMTK's decoders.
extern "C" {
#include "core/formats/dicom/dicom_walk.h"
}
#include <vector>

// Registers the decoders, once. Any thread.
void dicom_decoders_register();
// Whether frames of this transfer syntax can be decoded; if not, its name is for the sentence.
bool dicom_can_decode(const char *transfer_syntax, const char **name);
// fragments of one frame, in order. out holds rows * columns * bits_allocated / 8 bytes. Throws what the standard library throws.
bool dicom_decode_frame(const dicom_layout &layout, const dicom_pixels &pixels, const char *name, const std::vector<dicom_fragment> &fragments,
                        void *out, error *err);
