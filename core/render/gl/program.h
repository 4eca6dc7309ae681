#pragma once
/* The shader programs, compiled once, and the locations of their uniforms. A uniform is named in a shader alone. */
#include "core/render/gl/table.h"
#include "gl_shaders.h" /* generated from core/render/gl/shaders */

struct gl_program {
    GLuint name;
    /* locations of uniforms; -1 where the program has none of that name */
#define UNIFORM_LOCATION(uniform) GLint uniform;
    GL_UNIFORMS(UNIFORM_LOCATION)
#undef UNIFORM_LOCATION
};

struct gl_programs {
    struct gl_program smooth;  /* surface, a normal a vertex */
    struct gl_program faceted; /* surface, a normal a triangle */
    struct gl_program lines;
    struct gl_program points;
    struct gl_program compose; /* a triangle over everything: translucent layers */
    struct gl_program image;   /* slice of an image: window and level */
    struct gl_program labels;  /* slice of a label layer: one colour a label */
    struct gl_program test;    /* a triangle over everything, in a texture's colour */
};

/* errors ERROR_GL with the compiler's words */
NODISCARD bool gl_programs_create(const struct gl *gl, struct gl_programs *programs, struct error *err);
void gl_programs_destroy(const struct gl *gl, struct gl_programs *programs);
