#include "core/render/gl/target.h"

void gl_target_destroy(const struct gl *gl, struct gl_target *target)
{
    gl->DeleteFramebuffers(1, &target->framebuffer); /* zero names are passed over by GL */
    gl->DeleteRenderbuffers(1, &target->color);
    gl->DeleteRenderbuffers(1, &target->depth);
    *target = (struct gl_target){ 0 };
}

static GLuint make_buffer(const struct gl *gl, GLenum format, int width_px, int height_px)
{
    GLuint name = 0;
    gl->GenRenderbuffers(1, &name);
    gl->BindRenderbuffer(GL_RENDERBUFFER, name);
    gl->RenderbufferStorage(GL_RENDERBUFFER, format, width_px, height_px);
    return name;
}

bool gl_target_resize(const struct gl *gl, struct gl_target *target, int width_px, int height_px, struct error *err)
{
    if (target->framebuffer && target->width_px == width_px && target->height_px == height_px)
        return true;
    GLint most = 0;
    gl->GetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &most);
    if (width_px > most || height_px > most)
        return error_set(err, ERROR_LIMIT, "drawing %d x %d pixels: this graphics driver takes at most %d along a side", width_px,
                         height_px, most);
    gl_target_destroy(gl, target);
    target->width_px = width_px;
    target->height_px = height_px;
    target->color = make_buffer(gl, GL_RGBA8, width_px, height_px);
    target->depth = make_buffer(gl, GL_DEPTH_COMPONENT24, width_px, height_px);

    gl->GenFramebuffers(1, &target->framebuffer);
    gl->BindFramebuffer(GL_FRAMEBUFFER, target->framebuffer);
    gl->FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, target->color);
    gl->FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, target->depth);
    GLenum status = gl->CheckFramebufferStatus(GL_FRAMEBUFFER);

    bool is_good = gl_check(gl, "making a framebuffer", err);
    if (is_good && status != GL_FRAMEBUFFER_COMPLETE)
        is_good = error_set(err, ERROR_GL, "making a framebuffer: incomplete (0x%04x)", status);
    if (is_good)
        return true;
    error_prefix(err, "%d x %d pixels", width_px, height_px);
    gl_target_destroy(gl, target);
    return false;
}
