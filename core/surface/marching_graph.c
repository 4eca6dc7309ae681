/* Builds the graph of a marching cubes surface. The loops of a cell's case lead from crossed edge to crossed edge over
 * the faces of the cell. The cell on the other side of a face follows the loop in the opposite direction. So when each
 * of the four cells around a crossed edge writes the next edge of its loop, the vertex has all four links, each written
 * once. */
#include <pthread.h>
#include <stdbool.h>
#include <string.h>

#include "core/surface/marching_cubes.h"
#include "core/surface/marching_rows.h"

/* For a case: its crossed edges, the next edge of each in its loop, and which of the four cells around the edge this
 * cell is. */
struct steps {
    uint8_t n;
    struct {
        uint8_t edge, next, slot;
    } of[CUBE_EDGES];
};
static struct steps steps_of[256];
static pthread_once_t once = PTHREAD_ONCE_INIT;

/* Position of an edge's vertex in write_links. */
static uint8_t place_of(uint8_t edge)
{
    return edge < 8 ? edge : (uint8_t)(edge + 4);
}

static void make_steps(void)
{
    for (int inside = 0; inside < 256; inside++) {
        struct steps *steps = &steps_of[inside];
        int8_t next[CUBE_EDGES];
        cube_case_links(inside, next);
        for (uint8_t edge = 0; edge < CUBE_EDGES; edge++)
            if (next[edge] >= 0) {
                /* position of the edge along the two other axes, first the axis after its own: an edge along x has it
                 * in its number, other edges in their last bit (z for y, y for z) and in whether they are on the far
                 * face of x */
                unsigned last = edge & 1, far = edge >= 8;
                bool is_z = edge >= 4 && (edge & 2);
                unsigned slot = edge < 4 ? edge : is_z ? far | last << 1 : last | far << 1;
                steps->of[steps->n].edge = place_of(edge);
                steps->of[steps->n].next = place_of((uint8_t)next[edge]);
                steps->of[steps->n++].slot = (uint8_t)slot;
            }
    }
}

typedef uint32_t eight __attribute__((vector_size(32)));

INLINED void write_links(const struct marching_rows *grid, const struct row *row, const struct around *rows,
                         uint32_t (*links)[4])
{
    typedef uint8_t eight_bytes __attribute__((vector_size(8)));
    const uint32_t first[8] = FIRST_VERTICES(grid, row);
    union {
        eight of[2]; /* edges 0..7 of the cell, and of the next cell, whose edges 4..7 are this cell's 8..11 */
        uint32_t number[16];
    } vertex;
    memcpy(&vertex.of[1], first, sizeof first);
    for (uint32_t w = 0; w < grid->words; w++) {
        if (is_uniform(rows, w))
            continue;
        for (uint64_t cells = find_crossings(grid, rows, w).active; cells; cells &= cells - 1) {
            uint32_t inside = case_at(rows, w, __builtin_ctzll(cells));
            const struct steps *steps = &steps_of[inside];
            eight_bytes is_crossed;
            memcpy(&is_crossed, grid->cases[inside].is_crossed, sizeof is_crossed);
            eight here = vertex.of[1];
            vertex.of[0] = here;
            vertex.of[1] = here + __builtin_convertvector(is_crossed, eight);
            for (int i = 0; i < steps->n; i++)
                links[vertex.number[steps->of[i].edge]][steps->of[i].slot] = vertex.number[steps->of[i].next];
        }
    }
}

INLINED struct marching_point *put_points(struct marching_point *to, uint64_t crossed, uint64_t here, uint32_t first,
                                          uint32_t y, uint32_t z, uint8_t axis)
{
    for (uint64_t bits = crossed; bits; bits &= bits - 1) {
        int bit = __builtin_ctzll(bits);
        *to = (struct marching_point){ { (int16_t)(2 * (first + (uint32_t)bit)), (int16_t)(2 * y), (int16_t)(2 * z) },
                                       axis,
                                       here >> bit & 1 ? 1 : -1 };
        to++->at2[axis]++;
    }
    return to;
}

INLINED void write_points(const struct marching_rows *grid, const struct row *row, const struct around *rows,
                          uint32_t y, uint32_t z, struct marching_point *points)
{
    struct marching_point *x_at = points + row->x, *y_at = points + row->y, *z_at = points + row->z;
    for (uint32_t w = 0; w < grid->words; w++) {
        if (is_uniform(rows, w))
            continue;
        struct crossings found = find_crossings(grid, rows, w);
        x_at = put_points(x_at, found.x, rows->here[w], CELLS_A_WORD * w, y, z, 0);
        y_at = put_points(y_at, found.y, rows->here[w], CELLS_A_WORD * w, y, z, 1);
        z_at = put_points(z_at, found.z, rows->here[w], CELLS_A_WORD * w, y, z, 2);
    }
}

INLINED void write_graph(const struct marching_rows *grid, const struct marching_graph *graph, size_t from, size_t end)
{
    for (size_t at = from; at < end; at++) {
        const struct row *row = &grid->rows[at];
        uint32_t y = (uint32_t)(at % grid->size[1]), z = (uint32_t)(at / grid->size[1]);
        struct around rows = rows_around(grid, y, z);
        if (row[1].x > row->x)
            write_points(grid, row, &rows, y, z, graph->points);
        if (graph->links && rows.has_cells && row[1].triangles > row->triangles)
            write_links(grid, row, &rows, graph->links);
    }
}

#if defined(__x86_64__)
FAST static void write_graph_fast(const struct marching_rows *grid, const struct marching_graph *graph, size_t from,
                                  size_t end)
{
    write_graph(grid, graph, from, end);
}
#else
static void write_graph_fast(const struct marching_rows *grid, const struct marching_graph *graph, size_t from,
                             size_t end)
{
    write_graph(grid, graph, from, end);
}
#endif

void marching_graph_write(enum marching_cubes_code code, const struct marching_rows *grid, struct marching_graph *graph,
                          size_t from, size_t end)
{
    pthread_once(&once, make_steps);
    if (code == MARCHING_CUBES_PORTABLE)
        write_graph(grid, graph, from, end);
    else
        write_graph_fast(grid, graph, from, end);
}
