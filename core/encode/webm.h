#pragma once
/* WebM around VP9 frames: what stands where is RFC 8794 (EBML), RFC 9559 (Matroska) and the WebM container guidelines.
 * One track; a cluster, and a cue to it, for each key frame. Any thread. */
#include "core/encode/encode.h"

struct webm_frame {
    size_t at, n; /* in the bytes of all frames */
    bool is_key;
};
struct webm {
    int width_px, height_px, fps;
    const struct webm_frame *frames; /* the first is a key frame */
    size_t n_frames;
    const uint8_t *bytes;
};
/* The file; out->bytes is the caller's. errors ERROR_MEMORY */
NODISCARD bool webm_write(const struct webm *webm, struct encoded *out, struct error *err);
