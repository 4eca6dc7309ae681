#pragma once
/* Pictures one after the other as a film: VP9 (libvpx) in WebM, which browsers play. The only module that uses libvpx.
 * One thread at a time. */
#include "core/encode/encode.h"

enum { VIDEO_MAX_FRAMES = 3600, VIDEO_MAX_FPS = 60, VIDEO_MAX_BYTES = 512 << 20, VIDEO_MAX_SIDE_PX = 4096 };

struct video;
/* width, height: even, 16 to VIDEO_MAX_SIDE_PX: colour is stored for two by two pixels (4:2:0, BT.709, ITU-R BT.709-6
 * table 3.4 in 8 bits)
 * quality: 1..100; 100 loses least
 * n_threads: of the encoder; 0: one for each core
 * errors  ERROR_RANGE, ERROR_MEMORY */
NODISCARD struct video *video_create(int width_px, int height_px, int fps, int quality, int n_threads,
                                     struct error *err);
void video_destroy(struct video *video);
/* The next picture, of the film's size.
 * errors  ERROR_RANGE another size, VIDEO_MAX_FRAMES; ERROR_LIMIT VIDEO_MAX_BYTES; ERROR_MEMORY */
NODISCARD bool video_add(struct video *video, const struct image *image, struct error *err);
size_t video_bytes(const struct video *video); /* of the frames so far */
/* The whole film, out->bytes the caller's; nothing can be added afterwards. errors ERROR_STATE without a picture;
 * ERROR_MEMORY */
NODISCARD bool video_finish(struct video *video, struct encoded *out, struct error *err);
