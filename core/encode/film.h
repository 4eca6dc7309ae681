#pragma once
/* A film that grows picture by picture, of which the first gives it its size: shared by whoever adds pictures and
 * whoever waits for it. One thread at a time, but for the references. */
#include "core/encode/video.h"

struct film_options {
    int fps, quality, n_threads; /* as of video_create */
    int spare_px;                /* rows of white below the first picture, for later ones whose caption is higher */
    size_t max_bytes;            /* 0: VIDEO_MAX_BYTES */
};
struct film;
/* One reference, the caller's. errors ERROR_MEMORY */
NODISCARD struct film *film_create(const struct film_options *options, struct error *err);
struct film *film_ref(struct film *film);
void film_unref(struct film *film); /* NULL is allowed; any thread */
int film_n_pictures(const struct film *film);
/* Adds the picture, which stands for n_times frames. The first begins the film.
 * errors  ERROR_RANGE a picture that is larger than the film; ERROR_LIMIT max_bytes, VIDEO_MAX_FRAMES; ERROR_MEMORY */
NODISCARD bool film_add(struct film *film, const struct image *image, int n_times, struct error *err);
/* The whole film, as video_finish. size_px: its width and height. */
NODISCARD bool film_finish(struct film *film, struct encoded *out, int size_px[2], struct error *err);
