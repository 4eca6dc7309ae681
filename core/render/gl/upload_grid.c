/* Uploads images and label layers to the graphics card, as 3-D textures. */
#include "core/render/gl/upload.h"

#include <stdlib.h>

#include "core/base/mem.h"

struct texel_format {
    GLenum internal, format, type;
    size_t size;
    double units; /* stored value at texture value 1 */
    double zero;  /* stored value at texture value 0 */
};

/* Signed 16-bit values are uploaded as unsigned ones with 32768 added, which is exact: signed normalised texels map
 * -32768 and -32767 to the same value. */
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

/* Checks the driver's limits before anything is uploaded, so that the error can name the sizes. */
static bool check_size(const struct gl *gl, const uint32_t size[3], const struct texel_format *format,
                       struct error *err)
{
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

/* Makes and binds a texture without values. errors leave nothing to delete */
static bool make_texture(const struct gl *gl, const uint32_t size[3], const struct texel_format *format,
                         GLuint *texture, struct error *err)
{
    if (!check_size(gl, size, format, err))
        return false;
    gl->GenTextures(1, texture);
    gl->BindTexture(GL_TEXTURE_3D, *texture);
    gl->TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl->TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl->TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAX_LEVEL, 0);
    gl->TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl->TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    gl->TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_WRAP_R, GL_CLAMP_TO_EDGE);
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    gl->TexImage3D(GL_TEXTURE_3D, 0, (GLint)format->internal, (GLsizei)size[0], (GLsizei)size[1], (GLsizei)size[2], 0,
                   format->format, format->type, NULL);
    if (gl_check(gl, "uploading a grid", err))
        return true;
    gl->BindTexture(GL_TEXTURE_3D, 0);
    gl->DeleteTextures(1, texture);
    error_prefix(err, "%u x %u x %u voxels of %zu bytes", size[0], size[1], size[2], format->size);
    return false;
}

/* After the values: unbinds the texture, and deletes it after an error. */
static bool end_texture(const struct gl *gl, bool is_good, const uint32_t size[3], const struct texel_format *format,
                        GLuint *texture, struct error *err)
{
    is_good = is_good && gl_check(gl, "uploading a grid", err);
    gl->BindTexture(GL_TEXTURE_3D, 0);
    if (is_good)
        return true;
    gl->DeleteTextures(1, texture);
    error_prefix(err, "%u x %u x %u voxels of %zu bytes", size[0], size[1], size[2], format->size);
    return false;
}

bool gl_upload_grid(const struct gl *gl, const struct volume *volume, bool is_labels, struct gl_grid *grid,
                    struct error *err)
{
    const struct texel_format *format = is_labels ? &label_formats[volume->type] : &image_formats[volume->type];
    const uint32_t *size = volume->grid.size;
    if (!format->size)
        return error_set(err, ERROR_UNSUPPORTED, "a label layer of real numbers");
    if (!make_texture(gl, size, format, &grid->texture, err) ||
        !end_texture(gl, upload_slabs(gl, volume, format, err), size, format, &grid->texture, err))
        return false;
    grid->n_along_z = 1;
    grid->value_per_unit = format->units * volume->slope;
    grid->value_at_zero = format->zero * volume->slope + volume->offset;
    return true;
}

bool gl_upload_stack(const struct gl *gl, const struct volume *const *volumes, size_t n, struct gl_grid *grid,
                     struct error *err)
{
    const struct texel_format *format = &image_formats[VOXEL_F32];
    const uint32_t *size = volumes[0]->grid.size;
    GLint most = 0;
    gl->GetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &most);
    uint32_t n_high = (uint32_t)n, n_fit = (uint32_t)most / size[2], n_along = n_fit < n_high ? n_fit : n_high;
    n_along = n_along > 0 ? n_along : 1;
    const uint32_t all[3] = { size[0], size[1] * ((n_high + n_along - 1) / n_along), size[2] * n_along };
    if (!make_texture(gl, all, format, &grid->texture, err))
        return false;
    for (uint32_t v = 0; v < n_high; v++)
        gl->TexSubImage3D(GL_TEXTURE_3D, 0, 0, (GLint)(size[1] * (v / n_along)), (GLint)(size[2] * (v % n_along)),
                          (GLsizei)size[0], (GLsizei)size[1], (GLsizei)size[2], format->format, format->type,
                          volumes[v]->voxels);
    grid->n_along_z = (int)n_along;
    grid->value_per_unit = 1;
    grid->value_at_zero = 0;
    return end_texture(gl, true, all, format, &grid->texture, err);
}
