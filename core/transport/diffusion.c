/* Conjugate gradients over the blocks that hold matter or inner air. */
#include "core/transport/diffusion.h"

enum { WIDE = 8, MOST_ITERATIONS = 400 };
#define COARSE_TOLERANCE .1 /* what is wide there is slow to mend on fine blocks */
#define COARSE_LAST .05

/* Sum over a row in eight parts, which the compiler can keep in registers. */
static inline double sum_of(const float part[WIDE])
{
    return ((double)part[0] + (double)part[1]) + ((double)part[2] + (double)part[3]) +
           (((double)part[4] + (double)part[5]) + ((double)part[6] + (double)part[7]));
}

/* Neutrons that leave the blocks of a row of a fluence: absorbed, out of the surface, to their neighbours. */
static void balance_row(const struct diffusion_net *net, struct cell_row of, const float *restrict fluence,
                        float *restrict out)
{
    const ptrdiff_t row = net->step[1], plane = net->step[2], n = of.n;
    const float *restrict x = net->coupling[0] + of.begin, *restrict y = net->coupling[1] + of.begin,
                          *restrict z = net->coupling[2] + of.begin, *restrict diagonal = net->diagonal + of.begin,
                          *restrict at = fluence + of.begin;
    float *restrict to = out + of.begin;
    for (ptrdiff_t i = 0; i < n; i++)
        to[i] = diagonal[i] * at[i] - (x[i] * at[i + 1] + x[i - 1] * at[i - 1]) -
                (y[i] * at[i + row] + y[i - row] * at[i - row]) - (z[i] * at[i + plane] + z[i - plane] * at[i - plane]);
}

/* residual = source - balance; direction = inverse * residual; sums of residual * direction and of the source's. */
static double begin(const struct diffusion_net *net, const float *source, const float *fluence, float *residual,
                    float *direction, double *of_source)
{
    double sum = 0;
    *of_source = 0;
    for (size_t r = 0; r < net->n_rows; r++) {
        const struct cell_row row = net->rows[r];
        balance_row(net, row, fluence, residual);
        for (size_t i = row.begin; i < row.begin + row.n; i++) {
            float inverse = net->inverse[i], left = inverse > 0 ? source[i] - residual[i] : 0;
            residual[i] = left;
            direction[i] = left * inverse;
            sum += (double)(left * direction[i]);
            *of_source += (double)(source[i] * source[i] * inverse);
        }
    }
    return sum;
}

/* Sum of products along a row, in an order of its own that does not depend on anything else. */
static inline double along_row(size_t n, const float *restrict a, const float *restrict b, const float *restrict weight)
{
    float part[WIDE] = { 0 };
    size_t i = 0;
    for (; i + WIDE <= n; i += WIDE)
        for (size_t w = 0; w < WIDE; w++)
            part[w] += a[i + w] * b[i + w] * (weight ? weight[i + w] : 1);
    for (size_t w = 0; i < n; i++, w++)
        part[w] += a[i] * b[i] * (weight ? weight[i] : 1);
    return sum_of(part);
}

static double apply(const struct diffusion_net *net, const float *restrict direction, float *restrict product)
{
    double sum = 0;
    for (size_t r = 0; r < net->n_rows; r++) {
        const struct cell_row row = net->rows[r];
        balance_row(net, row, direction, product);
        sum += along_row(row.n, product + row.begin, direction + row.begin, NULL);
    }
    return sum;
}

static double advance(const struct diffusion_net *net, float length, const float *restrict direction,
                      const float *restrict product, float *restrict fluence, float *restrict residual)
{
    double sum = 0;
    for (size_t r = 0; r < net->n_rows; r++) {
        const struct cell_row row = net->rows[r];
        for (size_t i = row.begin, end = i + row.n; i < end; i++) {
            fluence[i] += length * direction[i];
            residual[i] -= length * product[i];
        }
        sum += along_row(row.n, residual + row.begin, residual + row.begin, net->inverse + row.begin);
    }
    return sum;
}

static int solve(const struct diffusion_net *net, const float *source, double tolerance, float *fluence,
                 float *scratch[DIFFUSION_N_SCRATCH])
{
    float *residual = scratch[0], *direction = scratch[1], *product = scratch[2];
    memset(direction, 0, net->n_blocks * sizeof *direction);
    double of_source, left = begin(net, source, fluence, residual, direction, &of_source);
    int n = 0;
    for (; n < MOST_ITERATIONS && left > tolerance * tolerance * of_source; n++) {
        double curve = apply(net, direction, product);
        if (!(curve > 0))
            break;
        double next = advance(net, (float)(left / curve), direction, product, fluence, residual);
        float keep = (float)(next / left);
        for (size_t r = 0; r < net->n_rows; r++)
            for (size_t i = net->rows[r].begin, end = i + net->rows[r].n; i < end; i++)
                direction[i] = net->inverse[i] * residual[i] + keep * direction[i];
        left = next;
    }
    return n;
}

/* The coarse block that holds the first block of a row, and which half of it. */
static size_t coarse_of(const struct diffusion *diffusion, size_t block, size_t *half)
{
    const int32_t *n = diffusion->fine.n, *m = diffusion->coarse.n;
    size_t i = block % (size_t)n[0], j = block / (size_t)n[0] % (size_t)n[1], k = block / (size_t)n[0] / (size_t)n[1];
    *half = i % 2;
    return (k / 2 * (size_t)m[1] + j / 2) * (size_t)m[0] + i / 2;
}

/* Solves on the coarse blocks what a source makes, and adds it to what each block has. */
static void add_coarse(const struct diffusion *diffusion, const float *source, double tolerance, float *fluence,
                       float *room)
{
    const struct diffusion_net *fine = &diffusion->fine, *coarse = &diffusion->coarse;
    float *coarse_source = room, *coarse_fluence = room + coarse->n_blocks,
          *scratch[DIFFUSION_N_SCRATCH] = { room + 2 * coarse->n_blocks, room + 3 * coarse->n_blocks,
                                            room + 4 * coarse->n_blocks };
    memset(room, 0, 2 * coarse->n_blocks * sizeof *room);
    size_t half;
    for (size_t r = 0; r < fine->n_rows; r++) {
        const struct cell_row row = fine->rows[r];
        size_t first = coarse_of(diffusion, row.begin, &half);
        for (size_t i = 0; i < row.n; i++)
            coarse_source[first + (i + half) / 2] += fine->inverse[row.begin + i] > 0 ? source[row.begin + i] : 0;
    }
    solve(coarse, coarse_source, tolerance, coarse_fluence, scratch);
    for (size_t r = 0; r < fine->n_rows; r++) {
        const struct cell_row row = fine->rows[r];
        size_t first = coarse_of(diffusion, row.begin, &half);
        for (size_t i = 0; i < row.n; i++)
            fluence[row.begin + i] += fine->inverse[row.begin + i] > 0 ? coarse_fluence[first + (i + half) / 2] : 0;
    }
}

int diffusion_solve(const struct diffusion *diffusion, const float *source, double tolerance, float *fluence,
                    float *scratch[DIFFUSION_N_SCRATCH])
{
    memset(fluence, 0, diffusion->fine.n_blocks * sizeof *fluence);
    add_coarse(diffusion, source, tolerance * COARSE_TOLERANCE, fluence, scratch[2]);
    int n = solve(&diffusion->fine, source, tolerance, fluence, scratch);
    add_coarse(diffusion, scratch[0], COARSE_LAST, fluence, scratch[2]); /* what is left, of which much is wide */
    return n;
}
