/* Chooses the first grey-level window of an image. */
#include "core/load/image_window.h"

#include <math.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/formats/text.h"
#include "core/volume/window.h"

enum { N_BINS = 4096, N_SAMPLES = 1 << 19 };

/* Returns the value below which this share of the n sampled voxels lies. */
static double percentile(const uint32_t *bins, uint64_t n, double low, double width, double share)
{
    uint64_t below = 0;
    uint64_t wanted = (uint64_t)(share * (double)n);
    for (int bin = 0; bin < N_BINS; bin++) {
        below += bins[bin];
        if (below > wanted)
            return low + (bin + 0.5) * width;
    }
    return low + N_BINS * width;
}

static void window_from_values(struct plan_image *image)
{
    const struct volume *volume = image->volume;
    const uint32_t *size = volume->grid.size;
    size_t n_voxels = grid_n_voxels(&volume->grid);
    size_t stride = n_voxels / N_SAMPLES + 1;
    if (stride % 2 == 0)
        stride++; /* sides are mostly even, and an even stride would sample a few columns only */
    double low = volume->low, width = (volume->high - volume->low) / N_BINS;
    uint32_t *bins = mem_new(N_BINS * sizeof *bins);
    uint64_t n = 0;
    for (size_t at = 0; width > 0 && at < n_voxels; at += stride) {
        double value = volume_value(volume, (uint32_t)(at % size[0]), (uint32_t)(at / size[0] % size[1]),
                                    (uint32_t)(at / size[0] / size[1]));
        if (!isfinite(value))
            continue;
        double bin = (value - low) / width;
        bins[bin < 0 ? 0 : bin > N_BINS - 1 ? N_BINS - 1 : (int)bin]++;
        n++;
    }
    double from = low, to = volume->high;
    if (n > 0) {
        from = percentile(bins, n, low, width, 0.001);
        to = percentile(bins, n, low, width, 0.999);
    }
    free(bins);
    image->window_center = (from + to) / 2;
    image->window_width = to - from > 0 ? to - from : 1;
}

void plan_image_window(struct plan_image *image)
{
    if (text_equal(image->modality, "CT")) {
        image->window_center = 40;
        image->window_width = 400;
        return;
    }
    window_from_values(image);
}

void plan_image_window_limit(struct plan_image *image)
{
    image->window_center = fmin(fmax(image->window_center, -WINDOW_CENTER_FARTHEST), WINDOW_CENTER_FARTHEST);
    image->window_width = fmin(fmax(image->window_width, WINDOW_NARROWEST), WINDOW_WIDEST);
}
