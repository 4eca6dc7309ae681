/* Writes a line for each picture that a render test makes to the file named by BEAMROOM_SAME (tests/same.sh): program,
 * back end, number, size, and a hash of the bytes. Without that variable it does nothing. The calls come here by the
 * linker's --wrap. */
#define _GNU_SOURCE /* the name of the program */
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>

#include "tests/render/shots.h"

struct image *__real_render_snapshot(struct renderer *renderer, const struct snapshot *snapshot,
                                     const struct render_options *options, struct camera *camera,
                                     struct render_timing *timing, struct error *err);
struct image *__wrap_render_snapshot(struct renderer *renderer, const struct snapshot *snapshot,
                                     const struct render_options *options, struct camera *camera,
                                     struct render_timing *timing, struct error *err);
struct image *__real_render_end(struct render_picture *picture, struct camera *camera, struct render_timing *timing);
struct image *__wrap_render_end(struct render_picture *picture, struct camera *camera, struct render_timing *timing);

static uint64_t hash_of(const struct image *image)
{
    const size_t n_bytes = 4 * (size_t)image->width_px * (size_t)image->height_px;
    uint64_t hash = 0xcbf29ce484222325; /* FNV-1a, 64 bits */
    for (size_t i = 0; i < n_bytes; i++)
        hash = (hash ^ image->rgba[i]) * 0x100000001b3;
    return hash;
}

static struct image *recorded(struct image *image, const struct renderer *renderer)
{
    static int n_pictures;
    const char *path = getenv("BEAMROOM_SAME");
    if (!path)
        return image;
    FILE *file = fopen(path, "a");
    assert_non_null(file);
    fprintf(file, "%s %s %d ", program_invocation_short_name,
            renderer ? render_back_end_word(renderer_facts(renderer)->back_end) : "-", n_pictures++);
    if (image)
        fprintf(file, "%dx%d %016" PRIx64 "\n", image->width_px, image->height_px, hash_of(image));
    else
        fprintf(file, "none\n");
    assert_int_equal(fclose(file), 0);
    return image;
}

struct image *__wrap_render_snapshot(struct renderer *renderer, const struct snapshot *snapshot,
                                     const struct render_options *options, struct camera *camera,
                                     struct render_timing *timing, struct error *err)
{
    return recorded(__real_render_snapshot(renderer, snapshot, options, camera, timing, err), renderer);
}

struct image *__wrap_render_end(struct render_picture *picture, struct camera *camera, struct render_timing *timing)
{
    return recorded(__real_render_end(picture, camera, timing), shots_renderer);
}
