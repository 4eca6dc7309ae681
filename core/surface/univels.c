/* The faces between inside and outside voxels as a mesh, on bit rows: the geometry that a Monte Carlo code tracks
 * through.
 *
 * Corner (i, j, k) is at index i - 0.5, j - 0.5, k - 0.5. It is a vertex if the eight voxels around it are not all
 * alike; then it is on a face. Corners are numbered in sequence, and so are the faces of a row of voxels.
 *
 *   1. mark the corners that are vertices, one row of corners at a time, and count the faces of every row of voxels
 *   2. running totals
 *   3. every row writes its own; the number of a corner is its row's first plus the marks before it */
#include <stdatomic.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/surface/bit_rows.h"
#include "core/surface/shape_make.h"
#include "core/surface/shape_parts.h"

enum { FACES = 6 };

/* Corners of each face, counter-clockwise as seen from outside: bit 0 of a corner's number is x, bit 1 y, bit 2 z.
 * Faces in the sequence -x +x -y +y -z +z. */
static const uint8_t face_corners[FACES][4] = {
    { 0, 4, 6, 2 }, { 1, 3, 7, 5 }, { 0, 1, 5, 4 }, { 2, 6, 7, 3 }, { 0, 2, 3, 1 }, { 4, 5, 7, 6 },
};

struct univels_job {
    const struct mask *mask;
    uint32_t corner_words;  /* 64-bit words per row of size[0] + 1 corners */
    uint64_t *used;         /* [size[2] + 1][size[1] + 1][corner_words] */
    uint32_t *first_vertex; /* [size[2] + 1][size[1] + 1], and one more: counts of the rows, then running totals */
    uint32_t *first_face;   /* [size[2]][size[1]], and one more at the end */
    bool is_mirrored;
    struct mesh *mesh;
    atomic_uint next;
};

static const uint64_t *row_at(const struct mask *mask, int64_t j, int64_t k)
{
    if (j < 0 || k < 0 || j >= mask->size[1] || k >= mask->size[2])
        return NULL;
    return mask->bits + ((size_t)k * mask->size[1] + (size_t)j) * mask->words;
}

static size_t corner_row(const struct univels_job *job, size_t j, size_t k)
{
    return k * (job->mask->size[1] + 1) + j;
}

/* ---- marking and counting --------------------------------------------------------------------------------------- */

static uint32_t mark_corners(const struct univels_job *job, uint32_t j, uint32_t k)
{
    const uint64_t *rows[4];
    uint32_t n = 0, words = job->mask->words;
    uint64_t any_before = 0, all_before = 0; /* of the word before */
    uint64_t *out = job->used + corner_row(job, j, k) * job->corner_words;
    for (int r = 0; r < 4; r++)
        rows[r] = row_at(job->mask, (int64_t)j - (r & 1), (int64_t)k - (r >> 1));
    for (uint32_t w = 0; w < job->corner_words; w++) {
        uint64_t any = 0, all = ~(uint64_t)0;
        for (int r = 0; r < 4; r++) {
            uint64_t bits = rows[r] && w < words ? rows[r][w] : 0;
            any |= bits;
            all &= bits;
        }
        out[w] = (any | any << 1 | any_before >> 63) & ~(all & (all << 1 | all_before >> 63));
        n += (uint32_t)__builtin_popcountll(out[w]);
        any_before = any;
        all_before = all;
    }
    return n;
}

/* The voxels of word w of a row that have a face in each direction. */
static void faces_of_word(const struct univels_job *job, const uint64_t *row, const uint64_t *beside[4], uint32_t w,
                          uint64_t faces[FACES])
{
    uint64_t here = row[w];
    faces[0] = here & ~(here << 1 | (w > 0 ? row[w - 1] >> 63 : 0));
    faces[1] = here & ~(here >> 1 | (w + 1 < job->mask->words ? row[w + 1] << 63 : 0));
    for (int side = 0; side < 4; side++)
        faces[2 + side] = here & ~(beside[side] ? beside[side][w] : 0);
}

static void rows_beside(const struct mask *mask, uint32_t j, uint32_t k, const uint64_t *beside[4])
{
    beside[0] = row_at(mask, (int64_t)j - 1, k);
    beside[1] = row_at(mask, (int64_t)j + 1, k);
    beside[2] = row_at(mask, j, (int64_t)k - 1);
    beside[3] = row_at(mask, j, (int64_t)k + 1);
}

static uint32_t count_faces(const struct univels_job *job, uint32_t j, uint32_t k)
{
    const uint64_t *row = row_at(job->mask, j, k), *beside[4];
    uint64_t faces[FACES];
    uint32_t n = 0;
    rows_beside(job->mask, j, k, beside);
    for (uint32_t w = 0; w < job->mask->words; w++) {
        faces_of_word(job, row, beside, w, faces);
        for (int f = 0; f < FACES; f++)
            n += (uint32_t)__builtin_popcountll(faces[f]);
    }
    return n;
}

static void count_part(void *context, int part, int n_parts)
{
    (void)part;
    (void)n_parts;
    struct univels_job *job = context;
    const uint32_t *size = job->mask->size;
    for (uint32_t k; (k = atomic_fetch_add(&job->next, 1)) <= size[2];)
        for (uint32_t j = 0; j <= size[1]; j++) {
            job->first_vertex[corner_row(job, j, k)] = mark_corners(job, j, k);
            if (j < size[1] && k < size[2])
                job->first_face[(size_t)k * size[1] + j] = count_faces(job, j, k);
        }
}

/* ---- writing ---------------------------------------------------------------------------------------------------- */

static void write_corners(const struct univels_job *job, uint32_t j, uint32_t k)
{
    size_t row = corner_row(job, j, k);
    row_write_vertices(job->used + row * job->corner_words, job->corner_words, &job->mask->lps_mm_from_ijk,
                       vec3(-0.5, j - 0.5, k - 0.5), job->mesh->positions_lps_mm + 3 * (size_t)job->first_vertex[row]);
}

static uint32_t *write_face(uint32_t *out, const uint32_t vertices[8], int face, bool is_mirrored)
{
    const uint8_t *c = face_corners[face];
    int second = is_mirrored ? 3 : 1, fourth = is_mirrored ? 1 : 3;
    *out++ = vertices[c[0]];
    *out++ = vertices[c[second]];
    *out++ = vertices[c[2]];
    *out++ = vertices[c[0]];
    *out++ = vertices[c[2]];
    *out++ = vertices[c[fourth]];
    return out;
}

static void write_faces(const struct univels_job *job, uint32_t j, uint32_t k)
{
    const uint64_t *row = row_at(job->mask, j, k), *beside[4], *used[4];
    uint32_t number[4]; /* number of the first vertex of the word, in each row of corners */
    uint64_t faces[FACES];
    uint32_t *out = job->mesh->indices + 6 * (size_t)job->first_face[(size_t)k * job->mask->size[1] + j];
    rows_beside(job->mask, j, k, beside);
    for (uint32_t r = 0; r < 4; r++) {
        size_t corners = corner_row(job, j + (r & 1), k + (r >> 1));
        used[r] = job->used + corners * job->corner_words;
        number[r] = job->first_vertex[corners];
    }
    for (uint32_t w = 0; w < job->mask->words; w++) {
        faces_of_word(job, row, beside, w, faces);
        for (uint64_t left = faces[0] | faces[1] | faces[2] | faces[3] | faces[4] | faces[5]; left; left &= left - 1) {
            int bit = __builtin_ctzll(left);
            uint32_t vertices[8];
            for (int r = 0; r < 4;
                 r++) { /* increases after a corner that is a vertex; numbers of unused corners are never read */
                vertices[2 * r] = number[r] + (uint32_t)__builtin_popcountll(used[r][w] & (((uint64_t)1 << bit) - 1));
                vertices[2 * r + 1] = vertices[2 * r] + (uint32_t)(used[r][w] >> bit & 1);
            }
            for (int f = 0; f < FACES; f++)
                if (faces[f] >> bit & 1)
                    out = write_face(out, vertices, f, job->is_mirrored);
        }
        for (int r = 0; r < 4; r++)
            number[r] += (uint32_t)__builtin_popcountll(used[r][w]);
    }
}

static void write_part(void *context, int part, int n_parts)
{
    (void)part;
    (void)n_parts;
    struct univels_job *job = context;
    const uint32_t *size = job->mask->size;
    for (uint32_t k; (k = atomic_fetch_add(&job->next, 1)) <= size[2];)
        for (uint32_t j = 0; j <= size[1]; j++) {
            write_corners(job, j, k);
            if (j < size[1] && k < size[2])
                write_faces(job, j, k);
        }
}

/* ---- shape_univels ---------------------------------------------------------------------------------------------- */

static bool extract(struct univels_job *job, int n_threads, struct error *err)
{
    const uint32_t *size = job->mask->size;
    size_t n_corner_rows = ((size_t)size[1] + 1) * ((size_t)size[2] + 1), n_rows = (size_t)size[1] * size[2];
    job->used = mem_large_array(n_corner_rows, job->corner_words * sizeof *job->used, UINT64_MAX, err);
    job->first_vertex = job->used ? mem_array(n_corner_rows + 1, sizeof *job->first_vertex, UINT64_MAX, err) : NULL;
    job->first_face = job->first_vertex ? mem_array(n_rows + 1, sizeof *job->first_face, UINT64_MAX, err) : NULL;
    if (!job->first_face)
        return false;
    atomic_store(&job->next, 0);
    parallel_run(n_threads, count_part, job);
    uint64_t vertices = rows_number(job->first_vertex, n_corner_rows), faces = rows_number(job->first_face, n_rows);
    if (2 * faces > SHAPE_MAX_TRIANGLES) /* so their corners fit 32 bits too */
        return error_set(err, ERROR_LIMIT, "univels with %llu triangles: at most %d are allowed",
                         (unsigned long long)(2 * faces), SHAPE_MAX_TRIANGLES);
    job->mesh = mesh_create((size_t)vertices, (size_t)(2 * faces), err);
    if (!job->mesh)
        return false;
    atomic_store(&job->next, 0);
    parallel_run(n_threads, write_part, job);
    mesh_measure_bounds(job->mesh);
    return true;
}

struct mesh *shape_univels(const struct mask *mask, int n_threads, struct error *err)
{
    struct univels_job job = {
        .mask = mask,
        .corner_words = mask->size[0] / 64 + 1,
        .is_mirrored = affine_determinant(&mask->lps_mm_from_ijk) < 0,
    };
    (void)extract(&job, n_threads, err);
    free(job.used);
    free(job.first_vertex);
    free(job.first_face);
    return job.mesh;
}
