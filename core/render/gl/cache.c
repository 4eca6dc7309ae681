#include "core/render/gl/cache.h"

#include <stdlib.h>

#include "core/base/log.h"
#include "core/base/mem.h"
#include "core/render/gl/upload.h"
#include "core/render/visible/visible.h"

enum entry_kind { ENTRY_SHAPE, ENTRY_IMAGE, ENTRY_LAYER };

struct entry {
    const struct plan *plan;
    enum entry_kind kind;
    size_t index;
    struct shape_key key;
    enum surface_detail detail;
    struct gl_shape shape;
    uint64_t n_bytes, used; /* of shapes; used: the picture that drew it last */
    struct gl_grid grid;
    struct entry *next;
};

struct gl_cache {
    struct entry *first;
    uint64_t n_bytes, n_pictures;
};

struct gl_cache *gl_cache_create(void)
{
    return mem_new(sizeof(struct gl_cache));
}

static void entry_destroy(const struct gl *gl, struct entry *entry)
{
    if (entry->kind == ENTRY_SHAPE) {
        gl->DeleteVertexArrays(1, &entry->shape.vertex_array);
        gl->DeleteBuffers(1, &entry->shape.vertices);
        gl->DeleteBuffers(1, &entry->shape.indices);
    } else
        gl->DeleteTextures(1, &entry->grid.texture);
    free(entry);
}

void gl_cache_forget(const struct gl *gl, struct gl_cache *cache, const struct plan *plan)
{
    for (struct entry **at = &cache->first; *at;) {
        struct entry *entry = *at;
        if (plan && entry->plan != plan) {
            at = &entry->next;
            continue;
        }
        *at = entry->next;
        cache->n_bytes -= entry->n_bytes;
        entry_destroy(gl, entry);
    }
}

void gl_cache_destroy(const struct gl *gl, struct gl_cache *cache)
{
    if (!cache)
        return;
    gl_cache_forget(gl, cache, NULL);
    free(cache);
}

void gl_cache_trim(const struct gl *gl, struct gl_cache *cache)
{
    while (cache->n_bytes > GL_CACHE_BYTES) {
        struct entry **oldest = NULL;
        for (struct entry **at = &cache->first; *at; at = &(*at)->next)
            if ((*at)->n_bytes > 0 && (!oldest || (*at)->used < (*oldest)->used))
                oldest = at;
        struct entry *entry = *oldest;
        *oldest = entry->next;
        cache->n_bytes -= entry->n_bytes;
        entry_destroy(gl, entry);
    }
    cache->n_pictures++;
}

static struct entry *find(const struct gl_cache *cache, const struct plan *plan, enum entry_kind kind, size_t index)
{
    for (struct entry *entry = cache->first; entry; entry = entry->next)
        if (entry->plan == plan && entry->kind == kind && entry->index == index)
            return entry;
    return NULL;
}

static struct entry *find_shape(const struct gl_cache *cache, const struct plan *plan, size_t region,
                                const struct shape_key *key, enum surface_detail detail)
{
    for (struct entry *entry = cache->first; entry; entry = entry->next)
        if (entry->plan == plan && entry->kind == ENTRY_SHAPE && entry->index == region && entry->detail == detail &&
            shape_key_equal(&entry->key, key))
            return entry;
    return NULL;
}

static struct entry *keep(struct gl_cache *cache, struct entry entry)
{
    struct entry *kept = mem_new(sizeof *kept);
    *kept = entry;
    kept->next = cache->first;
    cache->first = kept;
    cache->n_bytes += kept->n_bytes;
    return kept;
}

const struct gl_shape *gl_cache_shape(const struct gl *gl, struct gl_cache *cache, struct derive *derived,
                                      size_t region, const struct shape_key *key, enum surface_detail detail,
                                      struct error *err)
{
    const struct plan *plan = derive_plan(derived);
    detail = key->representation == REPRESENTATION_SURFACE ? detail : SURFACE_FULL;
    struct entry *entry = find_shape(cache, plan, region, key, detail);
    if (entry) {
        entry->used = cache->n_pictures;
        return &entry->shape;
    }
    struct shape_facts facts = { 0 };
    struct error why = { 0 };
    struct entry made = { .plan = plan,
                          .kind = ENTRY_SHAPE,
                          .index = region,
                          .key = *key,
                          .detail = detail,
                          .n_bytes = sizeof made,
                          .used = cache->n_pictures };
    made.shape.bounds_lps_mm = box3_empty();
    struct shape *shape =
        derive_shape(derived, &(struct shape_want){ subject_region(region), *key, detail }, &facts, &why);
    bool is_good = shape ? gl_upload_shape(gl, shape, visible_shading_passes(key, facts.reduction), &made.shape,
                                           &made.n_bytes, &why)
                         : derive_is_refusal(why.code);
    if (!shape && is_good)
        log_info("region %s is not drawn: %s", plan->regions.regions[region].id, why.text);
    shape_unref(shape);
    made.shape.is_light = facts.reduction > 1;
    entry = keep(cache, made);
    if (is_good)
        return &entry->shape;
    if (err)
        *err = why;
    error_prefix(err, "region %s", plan->regions.regions[region].id);
    cache->first = entry->next;
    cache->n_bytes -= entry->n_bytes;
    entry_destroy(gl, entry);
    return NULL;
}

/* ---- grids ------------------------------------------------------------------------------------------------------ */

struct texel_format {
    GLenum internal, format, type;
    size_t size;
    double units; /* stored value at texture value 1 */
    double zero;  /* stored value at texture value 0 */
};

/* Signed 16 bit values travel as unsigned ones with 32768 added: exact, where signed normalised texels lose -32768. */
static const struct texel_format image_formats[] = {
    [VOXEL_U8] = { GL_R8, GL_RED, GL_UNSIGNED_BYTE, 1, 255, 0 },
    [VOXEL_I16] = { GL_R16, GL_RED, GL_UNSIGNED_SHORT, 2, 65535, -32768 },
    [VOXEL_U16] = { GL_R16, GL_RED, GL_UNSIGNED_SHORT, 2, 65535, 0 },
    [VOXEL_F32] = { GL_R32F, GL_RED, GL_FLOAT, 4, 1, 0 },
};
static const struct texel_format label_formats[] = {
    [VOXEL_U8] = { GL_R8UI, GL_RED_INTEGER, GL_UNSIGNED_BYTE, 1, 1, 0 },
    [VOXEL_U16] = { GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT, 2, 1, 0 },
    [VOXEL_I16] = { GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT, 2, 1, 0 }, /* labels are never negative */
    [VOXEL_F32] = { 0, 0, 0, 0, 0, 0 },
};

/* The driver's limits first, so that what does not fit is refused with numbers and not found out half way. */
static bool check_size(const struct gl *gl, const struct volume *volume, const struct texel_format *format,
                       struct error *err)
{
    const uint32_t *size = volume->grid.size;
    GLint most = 0, width = 0;
    gl->GetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &most);
    if ((GLint)size[0] > most || (GLint)size[1] > most || (GLint)size[2] > most)
        return error_set(err, ERROR_LIMIT,
                         "a grid of %u x %u x %u voxels: this graphics driver takes at most %d along a side", size[0],
                         size[1], size[2], most);
    gl->TexImage3D(GL_PROXY_TEXTURE_3D, 0, (GLint)format->internal, (GLsizei)size[0], (GLsizei)size[1],
                   (GLsizei)size[2], 0, format->format, format->type, NULL);
    gl->GetTexLevelParameteriv(GL_PROXY_TEXTURE_3D, 0, GL_TEXTURE_WIDTH, &width);
    if (width == 0)
        return error_set(err, ERROR_LIMIT,
                         "a grid of %u x %u x %u voxels of %zu bytes is more than this graphics driver takes", size[0],
                         size[1], size[2], format->size);
    return true;
}

static bool upload_slabs(const struct gl *gl, const struct volume *volume, const struct texel_format *format,
                         struct error *err)
{
    const uint32_t *size = volume->grid.size;
    size_t n_slab = (size_t)size[0] * size[1];
    uint16_t *shifted = volume->type == VOXEL_I16 && format->zero < 0 ? mem_array(n_slab, 2, UINT64_MAX, err) : NULL;
    if (volume->type == VOXEL_I16 && format->zero < 0 && !shifted)
        return false;
    if (!shifted)
        gl->TexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, 0, (GLsizei)size[0], (GLsizei)size[1], (GLsizei)size[2],
                          format->format, format->type, volume->voxels);
    for (uint32_t k = 0; shifted && k < size[2]; k++) {
        const uint16_t *from = (const uint16_t *)volume->voxels + k * n_slab;
        for (size_t i = 0; i < n_slab; i++)
            shifted[i] = (uint16_t)(from[i] ^ 0x8000u);
        gl->TexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, (GLint)k, (GLsizei)size[0], (GLsizei)size[1], 1, format->format,
                          format->type, shifted);
    }
    free(shifted);
    return true;
}

static bool upload_grid(const struct gl *gl, const struct volume *volume, const struct texel_format *format,
                        struct gl_grid *grid, struct error *err)
{
    if (!format->size)
        return error_set(err, ERROR_UNSUPPORTED, "a label layer of real numbers");
    if (!check_size(gl, volume, format, err))
        return false;
    const uint32_t *size = volume->grid.size;
    gl->GenTextures(1, &grid->texture);
    gl->BindTexture(GL_TEXTURE_3D, grid->texture);
    gl->TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl->TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl->TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAX_LEVEL, 0);
    gl->TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl->TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    gl->TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_WRAP_R, GL_CLAMP_TO_EDGE);
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    gl->TexImage3D(GL_TEXTURE_3D, 0, (GLint)format->internal, (GLsizei)size[0], (GLsizei)size[1], (GLsizei)size[2], 0,
                   format->format, format->type, NULL);
    bool is_good = gl_check(gl, "uploading a grid", err) && upload_slabs(gl, volume, format, err) &&
                   gl_check(gl, "uploading a grid", err);
    gl->BindTexture(GL_TEXTURE_3D, 0);
    if (is_good)
        return true;
    gl->DeleteTextures(1, &grid->texture);
    error_prefix(err, "%u x %u x %u voxels of %zu bytes", size[0], size[1], size[2], format->size);
    return false;
}

const struct gl_grid *gl_cache_image(const struct gl *gl, struct gl_cache *cache, const struct plan *plan, size_t image,
                                     struct error *err)
{
    struct entry *entry = find(cache, plan, ENTRY_IMAGE, image);
    if (entry)
        return &entry->grid;
    const struct volume *volume = plan->images[image].volume;
    const struct texel_format *format = &image_formats[volume->type];
    struct entry made = { .plan = plan, .kind = ENTRY_IMAGE, .index = image };
    if (!upload_grid(gl, volume, format, &made.grid, err)) {
        error_prefix(err, "image %s", plan->images[image].id);
        return NULL;
    }
    made.grid.value_per_unit = format->units * volume->slope;
    made.grid.value_at_zero = format->zero * volume->slope + volume->offset;
    return &keep(cache, made)->grid;
}

const struct gl_grid *gl_cache_layer(const struct gl *gl, struct gl_cache *cache, const struct plan *plan, size_t layer,
                                     struct error *err)
{
    struct entry *entry = find(cache, plan, ENTRY_LAYER, layer);
    if (entry)
        return &entry->grid;
    const struct volume *volume = plan->regions.layers[layer];
    struct entry made = { .plan = plan, .kind = ENTRY_LAYER, .index = layer };
    if (!upload_grid(gl, volume, &label_formats[volume->type], &made.grid, err)) {
        error_prefix(err, "label layer %zu", layer);
        return NULL;
    }
    return &keep(cache, made)->grid;
}
