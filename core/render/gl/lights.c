/* Sets the lights of a program. */
#include "core/render/gl/draw.h"

void gl_set_lights(const struct gl_frame *frame, const struct gl_program *program)
{
    const struct visible_lights *l = &frame->lights;
    frame->gl->Uniform4f(program->key_light, l->key[0], l->key[1], l->key[2], l->key_light);
    frame->gl->Uniform4f(program->lights, l->fill_light, l->gloss, l->ambient, l->ambient_translucent);
}
