/* Laying the coefficients of diffusion over the blocks of a geometry. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/transport/diffusion.h"
#include "core/transport/inner_air.h"

#define LEAST_MATTER .06F /* of a block, to take part */
enum { POINTS = 5 };      /* along each side of a block, that are looked at */

struct laying {
    struct diffusion *diffusion;
    const struct geometry *geometry;
    const struct diffusion_medium *diffusing;
    const struct medium *media;
    struct inner_air air;
    float *share;       /* of the volume that neutrons diffuse in: matter, or all of it */
    float *coefficient; /* D, cm */
    float *extrapolation;
};

static size_t at_block(const struct geometry *geometry, const int32_t ijk[3])
{
    return ((size_t)ijk[2] * (size_t)geometry->n_blocks[1] + (size_t)ijk[1]) * (size_t)geometry->n_blocks[0] +
           (size_t)ijk[0];
}

static int material_at(const struct geometry *geometry, double x_cm, double y_cm, double z_cm)
{
    const float at[3] = { (float)x_cm, (float)y_cm, (float)z_cm };
    int material = geometry_material_in(geometry, geometry_block(geometry, at), at);
    return material < 0 ? 0 : material;
}

/* Means over the matter of a block; inner air resists as its mean chord says (Knudsen): D = chord / 3. */
static void lay_block(const struct laying *laying, const int32_t ijk[3])
{
    struct diffusion *diffusion = laying->diffusion;
    const struct geometry *geometry = laying->geometry;
    size_t block = at_block(geometry, ijk);
    double matter = (double)geometry->matter[block], n = 0, resistance = 0, extrapolation = 0, absorption = 0, slow = 0,
           thermal = 0, emitted = 0;
    float air_cm = laying->air.coefficient_cm[block];
    laying->share[block] = air_cm > 0 ? 1 : matter >= (double)LEAST_MATTER ? (float)matter : 0;
    if (laying->share[block] <= 0)
        return;
    const double h = GEOMETRY_BLOCK_CM, d = h / POINTS;
    bool is_pure = geometry->blocks[block] != GEOMETRY_MIXED;
    for (int s = 0; s < (is_pure ? 1 : POINTS * POINTS * POINTS); s++) {
        int material = is_pure ? geometry->blocks[block]
                               : material_at(geometry, ijk[0] * h + (s % POINTS + .5) * d,
                                             ijk[1] * h + (s / POINTS % POINTS + .5) * d,
                                             ijk[2] * h + (s / POINTS / POINTS + .5) * d);
        if (material == 0)
            continue;
        const struct diffusion_medium *of = &laying->diffusing[material - 1];
        n++;
        resistance += 1 / of->coefficient_cm;
        extrapolation += of->extrapolation;
        absorption += of->absorption_cm;
        slow += of->slow;
        thermal += of->thermal;
        emitted += of->absorption_cm * laying->media[material - 1].emitted_mev;
    }
    double volume = h * h * h, held = n > 0 ? matter * volume / n : 0;
    resistance = (n > 0 ? matter * resistance / n : 0) + (air_cm > 0 ? (1 - matter) / (double)air_cm : 0);
    laying->coefficient[block] = (float)(resistance > 0 ? (air_cm > 0 ? 1 : matter) / resistance : 0);
    laying->extrapolation[block] = (float)(n > 0 ? extrapolation / n : 0);
    diffusion->absorbed[block] = (float)(absorption * held);
    diffusion->thermal[block] = (float)(thermal * held);
    diffusion->slow[block] = (float)(slow * held);
    diffusion->emitted_mev[block] = (float)(emitted * held);
}

/* Share of the face on a block's high side along an axis that is matter; all of it next to inner air. */
static double face_share(const struct laying *laying, const int32_t ijk[3], int axis)
{
    const struct geometry *geometry = laying->geometry;
    size_t block = at_block(geometry, ijk), next = block + (size_t)laying->diffusion->fine.step[axis];
    if (laying->air.coefficient_cm[block] > 0 || laying->air.coefficient_cm[next] > 0)
        return 1;
    if (geometry->blocks[block] != GEOMETRY_MIXED && geometry->blocks[next] != GEOMETRY_MIXED)
        return geometry->blocks[block] > 0 && geometry->blocks[next] > 0;
    int n = 0;
    const double h = GEOMETRY_BLOCK_CM, d = h / POINTS;
    for (int s = 0; s < POINTS * POINTS; s++) {
        double at[3];
        at[axis] = (ijk[axis] + 1) * h;
        at[(axis + 1) % 3] = ijk[(axis + 1) % 3] * h + (s % POINTS + .5) * d;
        at[(axis + 2) % 3] = ijk[(axis + 2) % 3] * h + (s / POINTS + .5) * d;
        n += material_at(geometry, at[0], at[1], at[2]) > 0;
    }
    return n / (double)(POINTS * POINTS);
}

static bool is_inside(const struct geometry *geometry, const int32_t ijk[3], int axis, int step)
{
    return ijk[axis] + step >= 0 && ijk[axis] + step < geometry->n_blocks[axis];
}

/* Share of each face of a block, as coupling for now; 0 where one of the two holds nothing. */
static void lay_faces(const struct laying *laying, const int32_t ijk[3])
{
    size_t block = at_block(laying->geometry, ijk);
    for (int axis = 0; axis < 3; axis++) {
        size_t next = block + (size_t)laying->diffusion->fine.step[axis];
        bool is_there =
            is_inside(laying->geometry, ijk, axis, 1) && laying->share[block] > 0 && laying->share[next] > 0;
        laying->diffusion->fine.coupling[axis][block] = is_there ? (float)face_share(laying, ijk, axis) : 0;
    }
}

/* True fluence over that of diffusion at a depth in transport mean free paths below a free surface: (x + q(x)) / (x +
 * q(infinite)). Source: G. Placzek, W. Seidel, Phys. Rev. 72, 550 (1947). */
#define MILNE .7104 /* q(infinite) */
static double milne(double depth)
{
    static const double x[] = { 0, .01, .02, .05, .1, .2, .3, .5, 1, 2, 3 }, q[] = { .57735, .58824, .59537, .61130,
                                                                                     .62792, .64955, .66340, .67909,
                                                                                     .69850, .70792, .70996 };
    int i = 0;
    if (depth >= 3)
        return 1;
    while (depth > x[i + 1])
        i++;
    return (depth + q[i] + (q[i + 1] - q[i]) * (depth - x[i]) / (x[i + 1] - x[i])) / (depth + MILNE);
}

/* The surface of a block that is closed but for its faces has the area that its faces lack on one side. */
static void lay_surface(const struct laying *laying, const int32_t ijk[3])
{
    struct diffusion *diffusion = laying->diffusion;
    size_t block = at_block(laying->geometry, ijk);
    if (laying->share[block] <= 0)
        return;
    const double h = GEOMETRY_BLOCK_CM;
    double square = 0;
    for (int axis = 0; axis < 3; axis++) {
        double low = is_inside(laying->geometry, ijk, axis, -1)
                         ? (double)diffusion->fine.coupling[axis][block - (size_t)diffusion->fine.step[axis]]
                         : 0;
        square += pow((double)diffusion->fine.coupling[axis][block] - low, 2);
    }
    double area = sqrt(square) * h * h, coefficient = (double)laying->coefficient[block];
    if (area <= 0)
        return;
    double extrapolation_cm = (double)laying->extrapolation[block] * coefficient;
    double thickness = fmin(h, (double)laying->share[block] * h * h * h / area), mean = 0;
    enum { DEPTHS = 8 };
    for (int i = 0; i < DEPTHS; i++)
        mean += milne((i + .5) / DEPTHS * thickness * MILNE / extrapolation_cm) / DEPTHS;
    diffusion->leaked[block] = (float)(area * coefficient / (extrapolation_cm + .5 * thickness));
    diffusion->thermal[block] *= (float)mean;
    diffusion->slow[block] *= (float)mean;
    diffusion->emitted_mev[block] *= (float)mean;
}

/* Way from a face to the middle of what a block holds behind it: half a block, less where the surface cuts it off. */
static double half_way_cm(const struct laying *laying, size_t block, double face)
{
    return .5 * GEOMETRY_BLOCK_CM * fmin(1, (double)laying->share[block] / face);
}

static void couple(const struct laying *laying, const int32_t ijk[3])
{
    struct diffusion *diffusion = laying->diffusion;
    size_t block = at_block(laying->geometry, ijk);
    diffusion->fine.diagonal[block] += diffusion->absorbed[block] + diffusion->leaked[block];
    for (int axis = 0; axis < 3; axis++) {
        float *coupling = &diffusion->fine.coupling[axis][block];
        if (*coupling <= 0)
            continue;
        size_t next = block + (size_t)diffusion->fine.step[axis];
        double face = (double)*coupling,
               resistance = half_way_cm(laying, block, face) / (double)laying->coefficient[block] +
                            half_way_cm(laying, next, face) / (double)laying->coefficient[next];
        *coupling = (float)(face * GEOMETRY_BLOCK_CM * GEOMETRY_BLOCK_CM / resistance);
        diffusion->fine.diagonal[block] += *coupling;
        diffusion->fine.diagonal[next] += *coupling;
    }
}

/* All of it matter, and no block within DIFFUSION_SKIN_CM is mostly air. */
static bool is_deep(const struct geometry *geometry, const int32_t ijk[3])
{
    const int reach = (int)ceil(DIFFUSION_SKIN_CM / GEOMETRY_BLOCK_CM);
    if (geometry->matter[at_block(geometry, ijk)] < .999F)
        return false;
    for (int k = -reach; k <= reach; k++)
        for (int j = -reach; j <= reach; j++)
            for (int i = -reach; i <= reach; i++) {
                const int32_t at[3] = { ijk[0] + i, ijk[1] + j, ijk[2] + k };
                if (i * i + j * j + k * k > reach * reach)
                    continue;
                for (int axis = 0; axis < 3; axis++)
                    if (at[axis] < 0 || at[axis] >= geometry->n_blocks[axis])
                        return false;
                if (geometry->matter[at_block(geometry, at)] < .5F)
                    return false;
            }
    return true;
}

static bool for_each_block(const struct laying *laying, const atomic_bool *cancel,
                           void (*run)(const struct laying *, const int32_t ijk[3]), struct error *err)
{
    const int32_t *n = laying->geometry->n_blocks;
    for (int32_t k = 0; k < n[2]; k++) {
        if (cancel && atomic_load(cancel))
            return error_set(err, ERROR_CANCELLED, "the simulation was cancelled");
        for (int32_t j = 0; j < n[1]; j++)
            for (int32_t i = 0; i < n[0]; i++)
                run(laying, (const int32_t[]){ i, j, k });
    }
    return true;
}

static void mark_deep(const struct laying *laying, const int32_t ijk[3])
{
    laying->diffusion->is_deep[at_block(laying->geometry, ijk)] = is_deep(laying->geometry, ijk);
}

/* Spans along i that hold what takes part. */
static void make_rows(struct diffusion_net *net)
{
    size_t n = (size_t)net->n[0], n_rows = net->n_blocks / n;
    for (size_t row = 0; row < n_rows; row++) {
        size_t begin = row * n, end = begin + n;
        while (begin < end && !(net->diagonal[begin] > 0))
            begin++;
        while (end > begin && !(net->diagonal[end - 1] > 0))
            end--;
        if (begin < end)
            net->rows[net->n_rows++] = (struct cell_row){ (uint32_t)begin, (uint32_t)(end - begin) };
    }
    for (size_t i = 0; i < net->n_blocks; i++)
        net->inverse[i] = net->diagonal[i] > 0 ? 1 / net->diagonal[i] : 0;
}

/* Losses add up; so do couplings of the faces between coarse blocks, whose middles are twice as far apart. */
static void coarsen(struct diffusion *diffusion)
{
    const struct diffusion_net *fine = &diffusion->fine;
    struct diffusion_net *coarse = &diffusion->coarse;
    size_t block = 0;
    for (int32_t k = 0; k < fine->n[2]; k++)
        for (int32_t j = 0; j < fine->n[1]; j++)
            for (int32_t i = 0; i < fine->n[0]; i++, block++) {
                const int32_t ijk[3] = { i, j, k };
                size_t at =
                    ((size_t)(k / 2) * (size_t)coarse->n[1] + (size_t)(j / 2)) * (size_t)coarse->n[0] + (size_t)(i / 2);
                coarse->diagonal[at] += diffusion->absorbed[block] + diffusion->leaked[block];
                for (int axis = 0; axis < 3; axis++) {
                    float coupling = ijk[axis] % 2 ? fine->coupling[axis][block] / 2 : 0;
                    if (coupling <= 0)
                        continue;
                    coarse->coupling[axis][at] += coupling;
                    coarse->diagonal[at] += coupling;
                    coarse->diagonal[at + (size_t)coarse->step[axis]] += coupling;
                }
            }
    make_rows(coarse);
}

static bool make_net(struct diffusion_net *net, const int32_t n[3], struct error *err)
{
    *net = (struct diffusion_net){ .n_blocks = (size_t)n[0] * (size_t)n[1] * (size_t)n[2],
                                   .n = { n[0], n[1], n[2] },
                                   .step = { 1, n[0], (ptrdiff_t)n[0] * n[1] } };
    float **arrays[] = { &net->coupling[0], &net->coupling[1], &net->coupling[2], &net->diagonal, &net->inverse };
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        if (!(*arrays[i] = mem_array(net->n_blocks, sizeof **arrays[i], UINT64_MAX, err)))
            return false;
    net->rows = mem_array((size_t)n[1] * (size_t)n[2], sizeof *net->rows, UINT64_MAX, err);
    return net->rows != NULL;
}

static void drop_net(struct diffusion_net *net)
{
    float *arrays[] = { net->coupling[0], net->coupling[1], net->coupling[2], net->diagonal, net->inverse };
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        free(arrays[i]);
    free(net->rows);
}

static bool make_arrays(struct diffusion *diffusion, struct laying *laying, struct error *err)
{
    const int32_t *n = laying->geometry->n_blocks;
    if (!make_net(&diffusion->fine, n, err) ||
        !make_net(&diffusion->coarse, (const int32_t[]){ (n[0] + 1) / 2, (n[1] + 1) / 2, (n[2] + 1) / 2 }, err))
        return false;
    float **arrays[] = { &diffusion->absorbed,    &diffusion->leaked, &diffusion->thermal,  &diffusion->slow,
                         &diffusion->emitted_mev, &laying->share,     &laying->coefficient, &laying->extrapolation };
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        if (!(*arrays[i] = mem_array(diffusion->fine.n_blocks, sizeof **arrays[i], UINT64_MAX, err)))
            return false;
    diffusion->is_deep = mem_array(diffusion->fine.n_blocks, 1, UINT64_MAX, err);
    return diffusion->is_deep != NULL;
}

static bool lay(struct laying *laying, const atomic_bool *cancel, struct error *err)
{
    if (!make_arrays(laying->diffusion, laying, err) || !inner_air_init(&laying->air, laying->geometry, err) ||
        !for_each_block(laying, cancel, lay_block, err) || !for_each_block(laying, cancel, lay_faces, err) ||
        !for_each_block(laying, cancel, lay_surface, err) || !for_each_block(laying, cancel, couple, err) ||
        !for_each_block(laying, cancel, mark_deep, err))
        return false;
    make_rows(&laying->diffusion->fine);
    coarsen(laying->diffusion);
    return true;
}

bool diffusion_init(struct diffusion *diffusion, const struct geometry *geometry, const struct material *materials,
                    const struct medium *media, size_t n_media, const atomic_bool *cancel, struct error *err)
{
    struct diffusion_medium diffusing[MATERIAL_MAX];
    *diffusion = (struct diffusion){ 0 };
    for (size_t i = 0; i < n_media; i++)
        diffusion_medium_init(&diffusing[i], &materials[i], &media[i]);
    struct laying laying = { .diffusion = diffusion, .geometry = geometry, .diffusing = diffusing, .media = media };
    bool is_done = lay(&laying, cancel, err);
    inner_air_finish(&laying.air);
    free(laying.share);
    free(laying.coefficient);
    free(laying.extrapolation);
    if (!is_done)
        diffusion_finish(diffusion);
    return is_done;
}

void diffusion_finish(struct diffusion *diffusion)
{
    float *arrays[] = { diffusion->absorbed, diffusion->leaked, diffusion->thermal, diffusion->slow,
                        diffusion->emitted_mev };
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        free(arrays[i]);
    free(diffusion->is_deep);
    drop_net(&diffusion->fine);
    drop_net(&diffusion->coarse);
    *diffusion = (struct diffusion){ 0 };
}
