/* Finding cavities: where a ball fits, where it gets to from outside, and what is left. */
#include "core/transport/inner_air.h"

#include <stdlib.h>

#include "core/base/mem.h"

#define CUBES_OVER_SURFACE 1.5 /* faces of cubes over the area of a surface that has any direction */

enum state { FITS = 1, REACHED = 2, OUTSIDE = 4, SEEN = 8 };

struct search {
    const struct geometry *geometry;
    const int32_t *n;
    size_t n_blocks, n_stack;
    uint8_t *state;
    uint32_t *stack;
};

static bool is_air(const struct search *search, size_t block)
{
    return search->geometry->matter[block] < .5F;
}

/* True if any block within the ball round a block, in the box, satisfies what is asked. */
static bool any_in_ball(const struct search *search, size_t block, bool (*ask)(const struct search *, size_t block))
{
    const int32_t *n = search->n;
    const int32_t i = (int32_t)(block % (size_t)n[0]), j = (int32_t)(block / (size_t)n[0] % (size_t)n[1]),
                  k = (int32_t)(block / (size_t)n[0] / (size_t)n[1]);
    const int32_t reach = (int32_t)(INNER_AIR_BALL_CM / GEOMETRY_BLOCK_CM + .01);
    for (int32_t c = -reach; c <= reach; c++)
        for (int32_t b = -reach; b <= reach; b++)
            for (int32_t a = -reach; a <= reach; a++) {
                if (a * a + b * b + c * c > reach * reach || i + a < 0 || j + b < 0 || k + c < 0 || i + a >= n[0] ||
                    j + b >= n[1] || k + c >= n[2])
                    continue;
                if (ask(search, ((size_t)(k + c) * (size_t)n[1] + (size_t)(j + b)) * (size_t)n[0] + (size_t)(i + a)))
                    return true;
            }
    return false;
}

static bool is_matter(const struct search *search, size_t block)
{
    return !is_air(search, block);
}
static bool is_reached(const struct search *search, size_t block)
{
    return search->state[block] & REACHED;
}

/* The neighbour across one of six faces; the block itself at the box's side. */
static size_t neighbour(const struct search *search, size_t block, int face)
{
    const int32_t *n = search->n;
    const size_t step[3] = { 1, (size_t)n[0], (size_t)n[0] * (size_t)n[1] };
    int axis = face / 2;
    int32_t at = (int32_t)(block / step[axis] % (size_t)n[axis]);
    if (face % 2 ? at + 1 >= n[axis] : at == 0)
        return block;
    return face % 2 ? block + step[axis] : block - step[axis];
}

static void push(struct search *search, size_t block, uint8_t state)
{
    search->state[block] |= state;
    search->stack[search->n_stack++] = (uint32_t)block;
}

/* Spreads a state over what has another, face by face. */
static void spread(struct search *search, uint8_t state, uint8_t over)
{
    while (search->n_stack > 0) {
        size_t block = search->stack[--search->n_stack];
        for (int face = 0; face < 6; face++) {
            size_t next = neighbour(search, block, face);
            if ((search->state[next] & over) && !(search->state[next] & state))
                push(search, next, state);
        }
    }
}

static void find_outside(struct search *search)
{
    for (size_t block = 0; block < search->n_blocks; block++)
        if (is_air(search, block) && !any_in_ball(search, block, is_matter))
            search->state[block] |= FITS;
    for (size_t block = 0; block < search->n_blocks; block++)
        for (int face = 0; face < 6; face++)
            if ((search->state[block] & FITS) && !(search->state[block] & REACHED) &&
                neighbour(search, block, face) == block)
                push(search, block, REACHED);
    spread(search, REACHED, FITS);
    for (size_t block = 0; block < search->n_blocks; block++)
        if (is_air(search, block) && any_in_ball(search, block, is_reached))
            search->state[block] |= OUTSIDE;
}

/* Mean chord of a body: four times its volume over its surface. */
static float coefficient_cm(const struct search *search, size_t from, size_t to)
{
    double volume = 0, faces = 0;
    for (size_t i = from; i < to; i++) {
        size_t block = search->stack[i];
        volume += 1 - (double)search->geometry->matter[block];
        for (int face = 0; face < 6; face++) {
            size_t next = neighbour(search, block, face);
            if (is_air(search, next))
                continue;
            faces++;
            volume += (1 - (double)search->geometry->matter[next]) / 2; /* about two faces of a cut block are its own */
        }
    }
    return faces > 0 ? (float)(4 * volume * GEOMETRY_BLOCK_CM * CUBES_OVER_SURFACE / faces / 3) : 1;
}

/* A cavity: blocks of inner air that hang together; then the cut blocks at their sides. */
static void take_cavity(struct search *search, size_t first, float *coefficient)
{
    size_t n = 0, taken = 1;
    search->state[first] |= SEEN;
    search->stack[0] = (uint32_t)first;
    for (; n < taken; n++)
        for (int face = 0; face < 6; face++) {
            size_t next = neighbour(search, search->stack[n], face);
            if (is_air(search, next) && !(search->state[next] & (OUTSIDE | SEEN))) {
                search->state[next] |= SEEN;
                search->stack[taken++] = (uint32_t)next;
            }
        }
    float value = coefficient_cm(search, 0, taken);
    for (size_t i = 0; i < taken; i++) {
        coefficient[search->stack[i]] = value;
        for (int face = 0; face < 6; face++) {
            size_t next = neighbour(search, search->stack[i], face);
            float matter = search->geometry->matter[next];
            if (matter >= .5F && matter < .999F)
                coefficient[next] = value;
        }
    }
}

bool inner_air_init(struct inner_air *air, const struct geometry *geometry, struct error *err)
{
    const int32_t *n = geometry->n_blocks;
    struct search search = { .geometry = geometry, .n = n, .n_blocks = (size_t)n[0] * (size_t)n[1] * (size_t)n[2] };
    air->coefficient_cm = mem_array(search.n_blocks, sizeof *air->coefficient_cm, UINT64_MAX, err);
    search.state = air->coefficient_cm ? mem_array(search.n_blocks, 1, UINT64_MAX, err) : NULL;
    search.stack = search.state ? mem_array(search.n_blocks, sizeof *search.stack, UINT64_MAX, err) : NULL;
    bool is_made = search.stack != NULL;
    if (is_made) {
        find_outside(&search);
        for (size_t block = 0; block < search.n_blocks; block++)
            if (is_air(&search, block) && !(search.state[block] & (OUTSIDE | SEEN)))
                take_cavity(&search, block, air->coefficient_cm);
    }
    free(search.stack);
    free(search.state);
    return is_made;
}

void inner_air_finish(struct inner_air *air)
{
    free(air->coefficient_cm);
    air->coefficient_cm = NULL;
}
