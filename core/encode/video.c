/* Films: video.h. */
#include "core/encode/video.h"

#include <stdlib.h>
#include <string.h>
#include <vpx/vp8cx.h>
#include <vpx/vpx_encoder.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/encode/webm.h"

enum { KEY_EVERY_S = 2, SPEED = 5 /* of 0 to 8: half of real time on two cores at 1024 x 768 */, Q_MOST = 50 };

struct video {
    int width_px, height_px, fps;
    vpx_codec_ctx_t codec;
    vpx_image_t picture;
    bool has_codec, is_finished;
    struct webm_frame *frames; /* place for VIDEO_MAX_FRAMES */
    size_t n_frames, n_added;
    uint8_t *bytes;
    size_t n_bytes, capacity;
};

static bool refuse(struct video *video, const char *what, struct error *err)
{
    const char *detail = vpx_codec_error(&video->codec);
    return error_set(err, ERROR_MEMORY, "%s: %.80s", what, detail ? detail : "libvpx gave no reason");
}

static bool start(struct video *video, int quality, int n_threads, struct error *err)
{
    vpx_codec_enc_cfg_t settings;
    if (vpx_codec_enc_config_default(vpx_codec_vp9_cx(), &settings, 0) != VPX_CODEC_OK)
        return error_set(err, ERROR_UNSUPPORTED, "libvpx has no VP9");
    const unsigned q = (unsigned)((100 - quality) * Q_MOST / 100);
    settings.g_w = (unsigned)video->width_px;
    settings.g_h = (unsigned)video->height_px;
    settings.g_timebase = (vpx_rational_t){ 1, video->fps };
    settings.g_threads = (unsigned)(n_threads > 0 ? n_threads : parallel_cores());
    settings.g_lag_in_frames = 0; /* a picture in, a frame out */
    settings.rc_end_usage = VPX_Q;
    settings.rc_min_quantizer = settings.rc_max_quantizer = q;
    settings.kf_mode = VPX_KF_AUTO;
    settings.kf_max_dist = (unsigned)(KEY_EVERY_S * video->fps);
    video->has_codec = vpx_codec_enc_init(&video->codec, vpx_codec_vp9_cx(), &settings, 0) == VPX_CODEC_OK;
    return (video->has_codec && vpx_codec_control(&video->codec, VP8E_SET_CPUUSED, SPEED) == VPX_CODEC_OK &&
            vpx_codec_control(&video->codec, VP8E_SET_CQ_LEVEL, q) == VPX_CODEC_OK &&
            vpx_codec_control(&video->codec, VP9E_SET_ROW_MT, 1) == VPX_CODEC_OK &&
            vpx_codec_control(&video->codec, VP9E_SET_COLOR_SPACE, VPX_CS_BT_709) == VPX_CODEC_OK &&
            vpx_codec_control(&video->codec, VP9E_SET_COLOR_RANGE, VPX_CR_STUDIO_RANGE) == VPX_CODEC_OK) ||
           refuse(video, "the encoder does not start", err);
}

struct video *video_create(int width_px, int height_px, int fps, int quality, int n_threads, struct error *err)
{
    if (width_px < 16 || height_px < 16 || width_px > VIDEO_MAX_SIDE_PX || height_px > VIDEO_MAX_SIDE_PX ||
        width_px % 2 || height_px % 2) {
        (void)error_set(err, ERROR_RANGE, "a film of %d x %d: both are even, 16 to %d", width_px, height_px,
                        VIDEO_MAX_SIDE_PX);
        return NULL;
    }
    if (fps < 1 || fps > VIDEO_MAX_FPS || quality < 1 || quality > 100) {
        (void)error_set(err, ERROR_RANGE, "%d pictures a second in quality %d: 1 to %d and 1 to 100", fps, quality,
                        VIDEO_MAX_FPS);
        return NULL;
    }
    struct video *video = mem_array(1, sizeof *video, UINT64_MAX, err);
    if (!video)
        return NULL;
    *video = (struct video){ .width_px = width_px, .height_px = height_px, .fps = fps };
    video->frames = mem_array(VIDEO_MAX_FRAMES, sizeof video->frames[0], UINT64_MAX, err);
    const bool has_picture =
        video->frames && vpx_img_alloc(&video->picture, VPX_IMG_FMT_I420, (unsigned)width_px, (unsigned)height_px, 32);
    if (video->frames && !has_picture)
        (void)error_set(err, ERROR_MEMORY, "no memory for the pictures of a film");
    if (has_picture && start(video, quality, n_threads, err))
        return video;
    video_destroy(video);
    return NULL;
}

size_t video_bytes(const struct video *video)
{
    return video->n_bytes;
}

void video_destroy(struct video *video)
{
    if (!video)
        return;
    if (video->has_codec)
        (void)vpx_codec_destroy(&video->codec);
    vpx_img_free(&video->picture);
    free(video->frames);
    free(video->bytes);
    free(video);
}

/* ---- colours ---------------------------------------------------------------------------------------------------- */

/* BT.709-6: Y' = 0.2126 R' + 0.7152 G' + 0.0722 B', C_B = (B' - Y') / 1.8556, C_R = (R' - Y') / 1.5748; 8 bits:
 * 219 Y' + 16, 224 C + 128. */
static double luma_of(const double rgb[3])
{
    return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

static uint8_t rounded(double value)
{
    return (uint8_t)(value + 0.5);
}

static void take_block(const struct image *image, int x, int y, vpx_image_t *to)
{
    double sum[3] = { 0, 0, 0 };
    for (int i = 0; i < 4; i++) {
        const int column = x + (i & 1), row = y + (i >> 1);
        const uint8_t *pixel = image->rgba + 4 * ((size_t)row * (size_t)image->width_px + (size_t)column);
        const double rgb[3] = { pixel[0] / 255.0, pixel[1] / 255.0, pixel[2] / 255.0 };
        to->planes[VPX_PLANE_Y][(ptrdiff_t)row * to->stride[VPX_PLANE_Y] + column] = rounded(219 * luma_of(rgb) + 16);
        for (int c = 0; c < 3; c++)
            sum[c] += rgb[c] / 4;
    }
    const double luma = luma_of(sum);
    to->planes[VPX_PLANE_U][(ptrdiff_t)(y / 2) * to->stride[VPX_PLANE_U] + x / 2] =
        rounded(224 * (sum[2] - luma) / 1.8556 + 128);
    to->planes[VPX_PLANE_V][(ptrdiff_t)(y / 2) * to->stride[VPX_PLANE_V] + x / 2] =
        rounded(224 * (sum[0] - luma) / 1.5748 + 128);
}

/* ---- frames ----------------------------------------------------------------------------------------------------- */

static bool keep(struct video *video, const vpx_codec_cx_pkt_t *packet, struct error *err)
{
    const size_t n = packet->data.frame.sz;
    if (video->n_bytes + n > VIDEO_MAX_BYTES || video->n_frames == VIDEO_MAX_FRAMES)
        return error_set(err, ERROR_LIMIT, "a film has at most %d pictures and %d MiB", VIDEO_MAX_FRAMES,
                         VIDEO_MAX_BYTES >> 20);
    if (video->n_bytes + n > video->capacity) {
        const size_t capacity = 2 * video->capacity + n;
        uint8_t *more = realloc(video->bytes, capacity);
        if (!more)
            return error_set(err, ERROR_MEMORY, "no memory for a film");
        video->bytes = more;
        video->capacity = capacity;
    }
    memcpy(video->bytes + video->n_bytes, packet->data.frame.buf, n);
    video->frames[video->n_frames++] =
        (struct webm_frame){ video->n_bytes, n, (packet->data.frame.flags & VPX_FRAME_IS_KEY) != 0 };
    video->n_bytes += n;
    return true;
}

static bool encode(struct video *video, const vpx_image_t *picture, struct error *err)
{
    vpx_codec_iter_t at = NULL;
    const vpx_codec_cx_pkt_t *packet;
    if (vpx_codec_encode(&video->codec, picture, (vpx_codec_pts_t)video->n_added, 1, 0, VPX_DL_GOOD_QUALITY) !=
        VPX_CODEC_OK)
        return refuse(video, "a picture was not encoded", err);
    while ((packet = vpx_codec_get_cx_data(&video->codec, &at)) != NULL)
        if (packet->kind == VPX_CODEC_CX_FRAME_PKT && !keep(video, packet, err))
            return false;
    return true;
}

bool video_add(struct video *video, const struct image *image, struct error *err)
{
    if (image->width_px != video->width_px || image->height_px != video->height_px)
        return error_set(err, ERROR_RANGE, "a picture of %d x %d in a film of %d x %d", image->width_px,
                         image->height_px, video->width_px, video->height_px);
    if (video->is_finished)
        return error_set(err, ERROR_STATE, "the film is finished");
    for (int y = 0; y < video->height_px; y += 2)
        for (int x = 0; x < video->width_px; x += 2)
            take_block(image, x, y, &video->picture);
    const bool is_added = encode(video, &video->picture, err);
    video->n_added += is_added;
    return is_added;
}

bool video_finish(struct video *video, struct encoded *out, struct error *err)
{
    if (!video->n_added)
        return error_set(err, ERROR_STATE, "the film has no picture");
    if (!video->is_finished && !encode(video, NULL, err))
        return false;
    video->is_finished = true;
    const struct webm webm = { .width_px = video->width_px,
                               .height_px = video->height_px,
                               .fps = video->fps,
                               .frames = video->frames,
                               .n_frames = video->n_frames,
                               .bytes = video->bytes };
    return webm_write(&webm, out, err);
}
