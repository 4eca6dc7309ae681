/* Writes binary STL, binary PLY and GLB files into memory. */
#include "core/surface/mesh_export.h"

#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "core/base/mem.h"

enum {
    STL_TITLE = 80,
    STL_HEAD = 84,
    STL_TRIANGLE = 50,
    PLY_FACE = 13,
    POINT = 12,
    GLB_HEAD = 12,
    GLB_CHUNK_HEAD = 8,
    FIELD_BYTES = 63
};

static const char *const words[] = { [MESH_STL] = "stl", [MESH_PLY] = "ply", [MESH_GLB] = "glb" };

bool mesh_format_from_word(const char *word, enum mesh_format *format)
{
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        if (strcmp(word, words[i]) == 0) {
            *format = (enum mesh_format)i;
            return true;
        }
    return false;
}

const char *mesh_format_word(enum mesh_format format)
{
    return words[format];
}

/* ---- bytes, little-endian on any machine ------------------------------------------------------------------------ */

static uint8_t *put_u32(uint8_t *at, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        at[i] = (uint8_t)(value >> (8 * i));
    return at + 4;
}

static uint8_t *put_floats(uint8_t *at, const float *values, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        uint32_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        at = put_u32(at, bits);
    }
    return at;
}

static uint8_t *put_indices(uint8_t *at, const uint32_t *indices, size_t n)
{
    for (size_t i = 0; i < n; i++)
        at = put_u32(at, indices[i]);
    return at;
}

/* Allocates n bytes after checking the limit. NULL with err. */
static uint8_t *make_room(enum mesh_format format, uint64_t n, uint64_t max_bytes, struct error *err)
{
    if (n <= max_bytes && n <= SIZE_MAX)
        return mem_large_array((size_t)n, 1, max_bytes, err);
    error_set(err, ERROR_LIMIT, "the surface as %s has %llu bytes, at most %llu are possible", words[format],
              (unsigned long long)n, (unsigned long long)max_bytes);
    return NULL;
}

/* ---- text headers ----------------------------------------------------------------------------------------------- */

struct text {
    char bytes[4096]; /* enough for all fields with every byte escaped */
    size_t n;
};

static void add(struct text *text, const char *format, ...) PRINTF_LIKE(2, 3);
static void add(struct text *text, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    int n = vsnprintf(text->bytes + text->n, sizeof text->bytes - text->n, format, args);
    va_end(args);
    assert(n >= 0 && (size_t)n < sizeof text->bytes - text->n);
    text->n += (size_t)n;
}

/* Adds a field without control characters, which would end the comment line. */
static void add_line_field(struct text *text, const char *field)
{
    for (size_t i = 0; i < FIELD_BYTES && field[i]; i++) {
        unsigned char c = (unsigned char)field[i];
        add(text, "%c", c < 0x20 || c == 0x7f ? '?' : c);
    }
}

/* Adds "name":"field" with JSON escapes. */
static void add_json_field(struct text *text, const char *name, const char *field)
{
    add(text, "\"%s\":\"", name);
    for (size_t i = 0; i < FIELD_BYTES && field[i]; i++) {
        unsigned char c = (unsigned char)field[i];
        if (c < 0x20)
            add(text, "\\u%04x", c);
        else
            add(text, c == '"' || c == '\\' ? "\\%c" : "%c", c);
    }
    add(text, "\"");
}

/* ---- STL -------------------------------------------------------------------------------------------------------- */

static void triangle_normal(const float corners[9], float normal[3])
{
    double u[3], v[3];
    for (int axis = 0; axis < 3; axis++) {
        u[axis] = (double)corners[3 + axis] - (double)corners[axis];
        v[axis] = (double)corners[6 + axis] - (double)corners[axis];
    }
    double n[3] = { u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0] };
    double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int axis = 0; axis < 3; axis++)
        normal[axis] = length > 0 ? (float)(n[axis] / length) : 0;
}

static uint8_t *export_stl(const struct mesh *mesh, const struct mesh_export_about *about, uint64_t max_bytes,
                           size_t *n_bytes, struct error *err)
{
    if (mesh->n_triangles > UINT32_MAX) {
        error_set(err, ERROR_LIMIT, "a surface of %zu triangles: STL counts to %u", mesh->n_triangles, UINT32_MAX);
        return NULL;
    }
    uint64_t n = STL_HEAD + (uint64_t)STL_TRIANGLE * mesh->n_triangles;
    uint8_t *bytes = make_room(MESH_STL, n, max_bytes, err);
    if (!bytes)
        return NULL;
    struct text title = { .n = 0 }; /* must not begin with "solid", or readers take the file for text */
    add(&title, "Beamroom mm LPS ");
    add_line_field(&title, about->region_id);
    memset(bytes, 0, STL_TITLE);
    memcpy(bytes, title.bytes, title.n < STL_TITLE ? title.n : STL_TITLE);
    uint8_t *at = put_u32(bytes + STL_TITLE, (uint32_t)mesh->n_triangles);
    for (size_t t = 0; t < mesh->n_triangles; t++) {
        float corners[9], normal[3];
        for (size_t c = 0; c < 3; c++)
            memcpy(corners + 3 * c, mesh->positions_lps_mm + 3 * (size_t)mesh->indices[3 * t + c], POINT);
        triangle_normal(corners, normal);
        at = put_floats(put_floats(at, normal, 3), corners, 9);
        *at++ = 0; /* attribute byte count */
        *at++ = 0;
    }
    *n_bytes = (size_t)n;
    return bytes;
}

/* ---- PLY -------------------------------------------------------------------------------------------------------- */

static void write_ply_head(const struct mesh *mesh, const struct mesh_export_about *about, struct text *head)
{
    add(head, "ply\nformat binary_little_endian 1.0\n"
              "comment Beamroom surface, for research and plan review, not for treatment\n");
    if (about->is_phantom)
        add(head, "comment a phantom, not a patient\n");
    add(head,
        "comment unit mm\ncomment space DICOM LPS: x to the patient's left, y to posterior, z to superior\ncomment plan ");
    add_line_field(head, about->plan_id);
    add(head, "\ncomment region ");
    add_line_field(head, about->region_id);
    add(head, "\ncomment algorithm ");
    add_line_field(head, about->algorithm);
    add(head, "\nelement vertex %zu\nproperty float x\nproperty float y\nproperty float z\n", mesh->n_vertices);
    if (!about->is_faceted)
        add(head, "property float nx\nproperty float ny\nproperty float nz\n");
    add(head, "element face %zu\nproperty list uchar int vertex_indices\nend_header\n", mesh->n_triangles);
}

static uint8_t *export_ply(const struct mesh *mesh, const struct mesh_export_about *about, uint64_t max_bytes,
                           size_t *n_bytes, struct error *err)
{
    if (mesh->n_vertices > INT32_MAX || mesh->n_triangles > INT32_MAX) {
        error_set(err, ERROR_LIMIT, "a surface of %zu vertices and %zu triangles: PLY readers count to %d",
                  mesh->n_vertices, mesh->n_triangles, INT32_MAX);
        return NULL;
    }
    struct text head = { .n = 0 };
    write_ply_head(mesh, about, &head);
    uint64_t n = head.n + (about->is_faceted ? 1 : 2) * (uint64_t)POINT * mesh->n_vertices +
                 (uint64_t)PLY_FACE * mesh->n_triangles;
    uint8_t *bytes = make_room(MESH_PLY, n, max_bytes, err);
    if (!bytes)
        return NULL;
    memcpy(bytes, head.bytes, head.n);
    uint8_t *at = bytes + head.n;
    for (size_t v = 0; v < mesh->n_vertices; v++) {
        at = put_floats(at, mesh->positions_lps_mm + 3 * v, 3);
        if (!about->is_faceted)
            at = put_floats(at, mesh->normals + 3 * v, 3);
    }
    for (size_t t = 0; t < mesh->n_triangles; t++) {
        *at++ = 3;
        at = put_indices(at, mesh->indices + 3 * t, 3);
    }
    *n_bytes = (size_t)n;
    return bytes;
}

/* ---- GLB -------------------------------------------------------------------------------------------------------- */

/* Adds the smallest and largest coordinates. Readers may refuse bounds that are not exact; nine digits keep a float
 * exactly. */
static void add_bounds(struct text *json, const struct mesh *mesh)
{
    float low[3], high[3];
    memcpy(low, mesh->positions_lps_mm, POINT);
    memcpy(high, mesh->positions_lps_mm, POINT);
    for (size_t v = 1; v < mesh->n_vertices; v++)
        for (size_t axis = 0; axis < 3; axis++) {
            float p = mesh->positions_lps_mm[3 * v + axis];
            low[axis] = p < low[axis] ? p : low[axis];
            high[axis] = p > high[axis] ? p : high[axis];
        }
    add(json, "\"min\":[%.9g,%.9g,%.9g],\"max\":[%.9g,%.9g,%.9g]", (double)low[0], (double)low[1], (double)low[2],
        (double)high[0], (double)high[1], (double)high[2]);
}

static double linear_from_srgb(uint8_t value)
{
    double v = value / 255.0;
    return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}

static void write_glb_json(const struct mesh *mesh, const struct mesh_export_about *about, struct text *json)
{
    bool has_normals = !about->is_faceted;
    uint64_t n_points = (uint64_t)POINT * mesh->n_vertices, n_indices = (uint64_t)POINT * mesh->n_triangles;
    add(json,
        "{\"asset\":{\"version\":\"2.0\",\"generator\":\"Beamroom\",\"extras\":{\"unit\":\"mm\",\"space\":\"DICOM LPS: x to the patient's "
        "left, y to posterior, z to superior\",\"node\":\"its matrix takes mm LPS to metres, x left, y superior, z anterior\",");
    add_json_field(json, "plan", about->plan_id);
    add(json, ",");
    add_json_field(json, "region", about->region_id);
    add(json, ",");
    add_json_field(json, "algorithm", about->algorithm);
    add(json, ",\"phantom\":%s,\"use\":\"for research and plan review, not for treatment\"}},",
        about->is_phantom ? "true" : "false");
    add(json, "\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,");
    add_json_field(json, "name", about->region_id);
    add(json, ",\"matrix\":[0.001,0,0,0,0,0,-0.001,0,0,0.001,0,0,0,0,0,1]}],");
    add(json,
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0%s},\"indices\":1,\"material\":0,\"mode\":4}]}],",
        has_normals ? ",\"NORMAL\":2" : "");
    add(json,
        "\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorFactor\":[%.4f,%.4f,%.4f,1],\"metallicFactor\":0,\"roughnessFactor\":0.8}}],",
        linear_from_srgb(about->rgb[0]), linear_from_srgb(about->rgb[1]), linear_from_srgb(about->rgb[2]));
    add(json, "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":%zu,\"type\":\"VEC3\",",
        mesh->n_vertices);
    add_bounds(json, mesh);
    add(json, "},{\"bufferView\":1,\"componentType\":5125,\"count\":%zu,\"type\":\"SCALAR\"}", 3 * mesh->n_triangles);
    if (has_normals)
        add(json, ",{\"bufferView\":2,\"componentType\":5126,\"count\":%zu,\"type\":\"VEC3\"}", mesh->n_vertices);
    add(json,
        "],\"bufferViews\":[{\"buffer\":0,\"byteOffset\":0,\"byteLength\":%llu,\"target\":34962},"
        "{\"buffer\":0,\"byteOffset\":%llu,\"byteLength\":%llu,\"target\":34963}",
        (unsigned long long)n_points, (unsigned long long)n_points, (unsigned long long)n_indices);
    if (has_normals)
        add(json, ",{\"buffer\":0,\"byteOffset\":%llu,\"byteLength\":%llu,\"target\":34962}",
            (unsigned long long)(n_points + n_indices), (unsigned long long)n_points);
    add(json, "],\"buffers\":[{\"byteLength\":%llu}]}",
        (unsigned long long)(n_indices + (has_normals ? 2 : 1) * n_points));
    while (json->n % 4)
        add(json, " "); /* chunks end at a multiple of four bytes */
}

static uint8_t *export_glb(const struct mesh *mesh, const struct mesh_export_about *about, uint64_t max_bytes,
                           size_t *n_bytes, struct error *err)
{
    bool has_normals = !about->is_faceted;
    struct text json = { .n = 0 };
    write_glb_json(mesh, about, &json);
    uint64_t n_data = (has_normals ? 2 : 1) * (uint64_t)POINT * mesh->n_vertices + (uint64_t)POINT * mesh->n_triangles;
    uint64_t n = GLB_HEAD + 2 * GLB_CHUNK_HEAD + json.n + n_data;
    uint8_t *bytes = make_room(MESH_GLB, n, max_bytes < UINT32_MAX ? max_bytes : UINT32_MAX, err);
    if (!bytes)
        return NULL;
    uint8_t *at = put_u32(put_u32(put_u32(bytes, 0x46546c67), 2), (uint32_t)n); /* "glTF" */
    at = put_u32(put_u32(at, (uint32_t)json.n), 0x4e4f534a);                    /* "JSON" */
    memcpy(at, json.bytes, json.n);
    at = put_u32(put_u32(at + json.n, (uint32_t)n_data), 0x004e4942); /* "BIN" */
    at = put_floats(at, mesh->positions_lps_mm, 3 * mesh->n_vertices);
    at = put_indices(at, mesh->indices, 3 * mesh->n_triangles);
    if (has_normals)
        put_floats(at, mesh->normals, 3 * mesh->n_vertices);
    *n_bytes = (size_t)n;
    return bytes;
}

uint8_t *mesh_export(const struct mesh *mesh, enum mesh_format format, const struct mesh_export_about *about,
                     uint64_t max_bytes, size_t *n_bytes, struct error *err)
{
    assert(mesh->normals || about->is_faceted || format == MESH_STL);
    if (mesh->n_triangles == 0) {
        error_set(err, ERROR_RANGE, "the surface has no triangle");
        return NULL;
    }
    switch (format) {
    case MESH_STL: return export_stl(mesh, about, max_bytes, n_bytes, err);
    case MESH_PLY: return export_ply(mesh, about, max_bytes, n_bytes, err);
    case MESH_GLB: break;
    }
    return export_glb(mesh, about, max_bytes, n_bytes, err);
}
