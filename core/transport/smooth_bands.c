/* Wider cells that hold matter, and the weights that smooth along their lines. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/transport/smooth.h"

#define LEAST_CM3 .005   /* of matter in a wider cell */
#define LEAST_SPREAD .05 /* of the cells about one, squared, in cells, for a line instead of a mean */
enum { REACH = 4, PARTS = 3 };

static void add_block(struct smooth_cells *cells, const struct geometry *geometry, const int32_t ijk[3])
{
    size_t block = ((size_t)ijk[2] * (size_t)geometry->n_blocks[1] + (size_t)ijk[1]) * (size_t)geometry->n_blocks[0] +
                   (size_t)ijk[0];
    double volume = (double)geometry->matter[block] * pow(GEOMETRY_BLOCK_CM, 3);
    size_t cell = 0;
    for (int axis = 0; axis < 3; axis++)
        cell += (size_t)(ijk[axis] / 2) * cells->step[axis];
    cells->volume[cell] += (float)volume;
    for (int axis = 0; axis < 3; axis++)
        cells->middle[axis][cell] += (float)(volume * (ijk[axis] % 2 ? .25 : -.25));
}

bool smooth_cells_init(struct smooth_cells *cells, const struct geometry *geometry, struct error *err)
{
    *cells = (struct smooth_cells){ .n_cells = 1 };
    for (int axis = 0; axis < 3; axis++) {
        cells->n[axis] = smooth_n(geometry, axis);
        cells->step[axis] = cells->n_cells;
        cells->n_cells *= (size_t)cells->n[axis];
    }
    float **arrays[] = { &cells->volume, &cells->middle[0], &cells->middle[1], &cells->middle[2] };
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        if (!(*arrays[i] = mem_array(cells->n_cells, sizeof **arrays[i], UINT64_MAX, err)))
            return false;
    if (!(cells->held = mem_array(cells->n_cells, sizeof *cells->held, UINT64_MAX, err)))
        return false;
    for (int32_t k = 0; k < geometry->n_blocks[2]; k++)
        for (int32_t j = 0; j < geometry->n_blocks[1]; j++)
            for (int32_t i = 0; i < geometry->n_blocks[0]; i++)
                add_block(cells, geometry, (const int32_t[]){ i, j, k });
    for (size_t cell = 0; cell < cells->n_cells; cell++) {
        for (int axis = 0; axis < 3 && cells->volume[cell] > 0; axis++)
            cells->middle[axis][cell] /= cells->volume[cell];
        if ((double)cells->volume[cell] < LEAST_CM3)
            cells->volume[cell] = 0;
        else
            cells->held[cells->n_held++] = (uint32_t)cell;
    }
    return true;
}

void smooth_cells_finish(struct smooth_cells *cells)
{
    free(cells->held);
    free(cells->volume);
    for (int axis = 0; axis < 3; axis++)
        free(cells->middle[axis]);
    *cells = (struct smooth_cells){ 0 };
}

/* A line of cells: where their matter is, and how much. */
struct line {
    int32_t n;
    const float *volume, *middle;
    size_t step;
    double sigma; /* in cells */
};

static double place(const struct line *line, int32_t i)
{
    return i + (double)line->middle[(size_t)i * line->step];
}

/* Weights of the cells of a line in the value at a place of a line fitted to them. */
static void fit(const struct line *line, int32_t about, double at, double *weights)
{
    double sum = 0, first = 0, second = 0;
    int32_t from = about < REACH ? 0 : about - REACH, to = about + REACH < line->n ? about + REACH : line->n - 1;
    for (int32_t j = from; j <= to; j++) {
        double volume = (double)line->volume[(size_t)j * line->step], way = place(line, j) - at;
        weights[j] = volume > 0 ? volume * exp(-.5 * way * way / (line->sigma * line->sigma)) : 0;
        sum += weights[j];
        first += weights[j] * way;
        second += weights[j] * way * way;
    }
    double spread = sum * second - first * first;
    for (int32_t j = from; j <= to; j++) {
        double way = place(line, j) - at;
        weights[j] *= spread > LEAST_SPREAD * sum * sum ? (second - first * way) / spread : 1 / sum;
    }
}

/* rows = what the fit at each cell's matter leaves: 1 less the fit. Nothing farther from the diagonal than REACH. */
static void lack(const struct line *line, double *rows)
{
    for (int32_t i = 0; i < line->n; i++) {
        if (!(line->volume[(size_t)i * line->step] > 0))
            continue;
        double *row = rows + (ptrdiff_t)i * line->n;
        fit(line, i, place(line, i), row);
        for (int32_t j = 0; j < line->n; j++)
            row[j] = (i == j) - row[j];
    }
}

/* Fit at the middle of a cell of f + (1 - S) f + (1 - S)^2 f.
 *
 *   parts  of n zeros each */
static void compose(const struct line *line, int32_t i, const double *lacks, double *parts[PARTS], smooth_band band)
{
    const int32_t n = line->n;
    fit(line, i, i, parts[0]);
    for (int part = 1; part < PARTS; part++)
        for (int32_t j = 0; j < n; j++) {
            int32_t from = j < REACH ? 0 : j - REACH, to = j + REACH < n ? j + REACH : n - 1;
            for (int32_t k = from; k <= to && parts[part - 1][j] != 0; k++)
                parts[part][k] += parts[part - 1][j] * lacks[(ptrdiff_t)j * n + k];
        }
    double sum = 0;
    for (int32_t j = i < SMOOTH_BAND ? 0 : i - SMOOTH_BAND; j < n && j <= i + SMOOTH_BAND; j++)
        sum += parts[0][j] + parts[1][j] + parts[2][j];
    for (int32_t j = i < SMOOTH_BAND ? 0 : i - SMOOTH_BAND; j < n && j <= i + SMOOTH_BAND; j++)
        band[j - i + SMOOTH_BAND] = (float)((parts[0][j] + parts[1][j] + parts[2][j]) / sum);
}

/* room: n * (n + PARTS) */
static void make_line(const struct line *line, smooth_band *bands, const uint32_t *index, double *room)
{
    size_t n = (size_t)line->n;
    double *lacks = room, *parts[PARTS] = { room + n * n, room + n * n + n, room + n * n + 2 * n };
    memset(room, 0, n * n * sizeof *room);
    lack(line, lacks);
    for (int32_t i = 0; i < line->n; i++) {
        if (!(line->volume[(size_t)i * line->step] > 0))
            continue;
        memset(parts[0], 0, PARTS * n * sizeof *room);
        compose(line, i, lacks, parts, bands[index[(size_t)i * line->step]]);
    }
}

static bool make_axis(struct smoothing *smoothing, const struct smooth_cells *cells, double sigma, int axis,
                      const uint32_t *index, struct error *err)
{
    size_t n = (size_t)cells->n[axis];
    smoothing->bands[axis] = mem_array(cells->n_held, sizeof *smoothing->bands[axis], UINT64_MAX, err);
    double *room = smoothing->bands[axis] ? mem_array(n * (n + PARTS), sizeof *room, UINT64_MAX, err) : NULL;
    for (size_t cell = 0; room && cell < cells->n_cells; cell++)
        if (cell / cells->step[axis] % n == 0) {
            struct line line = { cells->n[axis], cells->volume + cell, cells->middle[axis] + cell, cells->step[axis],
                                 sigma };
            make_line(&line, smoothing->bands[axis], index + cell, room);
        }
    free(room);
    return room != NULL;
}

bool smoothing_init(struct smoothing *smoothing, const struct smooth_cells *cells, double sigma_cm, struct error *err)
{
    *smoothing = (struct smoothing){ 0 };
    uint32_t *index = mem_array(cells->n_cells, sizeof *index, UINT64_MAX, err);
    for (size_t i = 0; index && i < cells->n_held; i++)
        index[cells->held[i]] = (uint32_t)i;
    bool is_made = index != NULL;
    for (int axis = 0; axis < 3 && is_made; axis++)
        is_made = make_axis(smoothing, cells, sigma_cm / SMOOTH_CELL_CM, axis, index, err);
    free(index);
    if (!is_made)
        smoothing_finish(smoothing);
    return is_made;
}

void smoothing_finish(struct smoothing *smoothing)
{
    for (int axis = 0; axis < 3; axis++)
        free(smoothing->bands[axis]);
    *smoothing = (struct smoothing){ 0 };
}
