/* Films that grow: film.h. */
#include "core/encode/film.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

struct film {
    atomic_int n_references;
    struct film_options options;
    struct video *video; /* NULL before the first picture */
    int size_px[2], n_pictures;
};

struct film *film_create(const struct film_options *options, struct error *err)
{
    struct film *film = mem_array(1, sizeof *film, UINT64_MAX, err);
    if (!film)
        return NULL;
    *film = (struct film){ .options = *options };
    atomic_init(&film->n_references, 1);
    if (!film->options.max_bytes)
        film->options.max_bytes = VIDEO_MAX_BYTES;
    return film;
}

struct film *film_ref(struct film *film)
{
    atomic_fetch_add(&film->n_references, 1);
    return film;
}

void film_unref(struct film *film)
{
    if (!film || atomic_fetch_sub(&film->n_references, 1) > 1)
        return;
    video_destroy(film->video);
    free(film);
}

int film_n_pictures(const struct film *film)
{
    return film->n_pictures;
}

/* The picture of the film's size. An odd side is continued by its last row or column; the spare rows are white, as the
 * caption's ground is. */
static struct image *fit(const struct film *film, const struct image *image, struct error *err)
{
    const int width_px = film->size_px[0], height_px = film->size_px[1];
    const bool has_spare = film->options.spare_px > 0;
    struct image *even = NULL;
    if (image->width_px > width_px || image->height_px > height_px)
        (void)error_set(err, ERROR_RANGE, "the caption needs more lines in a part of the film: choose a wider picture");
    else
        even = image_create(width_px, height_px, err);
    for (int y = 0; even && y < height_px; y++)
        for (int x = 0; x < width_px; x++) {
            const int row = y < image->height_px ? y : image->height_px - 1,
                      column = x < image->width_px ? x : image->width_px - 1;
            uint8_t *pixel = even->rgba + 4 * ((size_t)y * (size_t)width_px + (size_t)x);
            if (has_spare && y >= image->height_px)
                memset(pixel, 255, 4);
            else
                memcpy(pixel, image->rgba + 4 * ((size_t)row * (size_t)image->width_px + (size_t)column), 4);
        }
    return even;
}

static bool begin(struct film *film, const struct image *image, struct error *err)
{
    const int height_px = image->height_px + film->options.spare_px;
    film->size_px[0] = image->width_px + image->width_px % 2;
    film->size_px[1] = height_px + height_px % 2;
    film->video = video_create(film->size_px[0], film->size_px[1], film->options.fps, film->options.quality,
                               film->options.n_threads, err);
    return film->video != NULL;
}

bool film_add(struct film *film, const struct image *image, int n_times, struct error *err)
{
    if (!film->video && !begin(film, image, err))
        return false;
    struct image *even = fit(film, image, err);
    bool is_added = even != NULL;
    for (int i = 0; is_added && i < n_times; i++)
        is_added = video_add(film->video, even, err);
    image_destroy(even);
    if (is_added && video_bytes(film->video) > film->options.max_bytes)
        is_added = error_set(err, ERROR_LIMIT, "the film is larger than %zu MiB: choose smaller or fewer pictures",
                             film->options.max_bytes >> 20);
    film->n_pictures += is_added;
    return is_added;
}

bool film_finish(struct film *film, struct encoded *out, int size_px[2], struct error *err)
{
    memcpy(size_px, film->size_px, sizeof film->size_px);
    return film->video ? video_finish(film->video, out, err) : error_set(err, ERROR_STATE, "the film has no picture");
}
