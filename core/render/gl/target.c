/* The framebuffers that pictures and translucent layers are drawn into. */
#include "core/render/gl/target.h"

#include <stddef.h>

void gl_target_destroy(const struct gl *gl, struct gl_target *target)
{
    gl->DeleteFramebuffers(1, &target->framebuffer); /* GL ignores the name 0 */
    gl->DeleteFramebuffers(1, &target->over);
    gl->DeleteRenderbuffers(1, &target->color);
    gl->DeleteTextures(1, &target->depth);
    *target = (struct gl_target){ 0 };
}

static GLuint make_texture(const struct gl *gl, GLenum kind)
{
    GLuint name = 0;
    gl->GenTextures(1, &name);
    gl->BindTexture(kind, name);
    gl->TexParameteri(kind, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl->TexParameteri(kind, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl->TexParameteri(kind, GL_TEXTURE_MAX_LEVEL, 0);
    return name;
}

static GLenum make_framebuffers(const struct gl *gl, struct gl_target *target)
{
    GLenum status[2];
    gl->GenFramebuffers(1, &target->framebuffer);
    gl->BindFramebuffer(GL_FRAMEBUFFER, target->framebuffer);
    gl->FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, target->color);
    gl->FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_STENCIL_ATTACHMENT, GL_TEXTURE_2D, target->depth, 0);
    status[0] = gl->CheckFramebufferStatus(GL_FRAMEBUFFER);
    gl->GenFramebuffers(1, &target->over);
    gl->BindFramebuffer(GL_FRAMEBUFFER, target->over);
    gl->FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, target->color);
    status[1] = gl->CheckFramebufferStatus(GL_FRAMEBUFFER);
    return status[0] != GL_FRAMEBUFFER_COMPLETE ? status[0] : status[1];
}

bool gl_target_resize(const struct gl *gl, struct gl_target *target, int width_px, int height_px, struct error *err)
{
    if (target->framebuffer && target->width_px == width_px && target->height_px == height_px)
        return true;
    GLint renderbuffer = 0, texture = 0;
    gl->GetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &renderbuffer);
    gl->GetIntegerv(GL_MAX_TEXTURE_SIZE, &texture);
    GLint most = renderbuffer < texture ? renderbuffer : texture;
    if (width_px > most || height_px > most)
        return error_set(err, ERROR_LIMIT, "drawing %d x %d pixels: this graphics driver takes at most %d along a side",
                         width_px, height_px, most);
    gl_target_destroy(gl, target);
    target->width_px = width_px;
    target->height_px = height_px;
    gl->GenRenderbuffers(1, &target->color);
    gl->BindRenderbuffer(GL_RENDERBUFFER, target->color);
    gl->RenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width_px, height_px);
    target->depth = make_texture(gl, GL_TEXTURE_2D);
    gl->TexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH24_STENCIL8, width_px, height_px, 0, GL_DEPTH_STENCIL,
                   GL_UNSIGNED_INT_24_8, NULL);
    gl->BindTexture(GL_TEXTURE_2D, 0);
    GLenum status = make_framebuffers(gl, target);

    bool is_good = gl_check(gl, "making a framebuffer", err);
    if (is_good && status != GL_FRAMEBUFFER_COMPLETE)
        is_good = error_set(err, ERROR_GL, "making a framebuffer: incomplete (0x%04x)", status);
    if (is_good)
        return true;
    error_prefix(err, "%d x %d pixels", width_px, height_px);
    gl_target_destroy(gl, target);
    return false;
}

/* ---- layers ----------------------------------------------------------------------------------------------------- */

void gl_layers_destroy(const struct gl *gl, struct gl_layers *layers)
{
    gl->DeleteFramebuffers(1, &layers->framebuffer);
    gl->DeleteTextures(1, &layers->color);
    gl->DeleteTextures(1, &layers->depth);
    *layers = (struct gl_layers){ 0 };
}

void gl_layers_bind(const struct gl *gl, const struct gl_layers *layers, int i)
{
    gl->BindFramebuffer(GL_FRAMEBUFFER, layers->framebuffer);
    gl->FramebufferTextureLayer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, layers->color, 0, i);
    gl->FramebufferTextureLayer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, layers->depth, 0, i);
    gl->ClearColor(0, 0, 0, 0);
    gl->Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

bool gl_layers_resize(const struct gl *gl, struct gl_layers *layers, const struct gl_target *target, int n,
                      struct error *err)
{
    int width = target->width_px, height = target->height_px;
    if (layers->framebuffer && layers->width_px == width && layers->height_px == height && layers->n >= n)
        return true;
    gl_layers_destroy(gl, layers);
    layers->width_px = width;
    layers->height_px = height;
    layers->n = n;
    layers->color = make_texture(gl, GL_TEXTURE_2D_ARRAY);
    gl->TexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_RGBA8, width, height, n, 0, GL_RGBA, GL_UNSIGNED_BYTE, NULL);
    layers->depth = make_texture(gl, GL_TEXTURE_2D_ARRAY);
    gl->TexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_DEPTH_COMPONENT24, width, height, n, 0, GL_DEPTH_COMPONENT,
                   GL_UNSIGNED_INT, NULL);
    gl->BindTexture(GL_TEXTURE_2D_ARRAY, 0);
    gl->GenFramebuffers(1, &layers->framebuffer);
    gl_layers_bind(gl, layers, 0);
    GLenum status = gl->CheckFramebufferStatus(GL_FRAMEBUFFER);
    bool is_good = gl_check(gl, "making translucent layers", err);
    if (is_good && status != GL_FRAMEBUFFER_COMPLETE)
        is_good = error_set(err, ERROR_GL, "making translucent layers: incomplete (0x%04x)", status);
    if (is_good)
        return true;
    error_prefix(err, "%d layers of %d x %d pixels", n, width, height);
    gl_layers_destroy(gl, layers);
    return false;
}
