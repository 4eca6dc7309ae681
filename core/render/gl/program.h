#pragma once
/* The shader programs, compiled once, and the places of their uniforms. */
#include "core/render/gl/table.h"

struct gl_program {
    GLuint name;
    /* places of uniforms; -1 where the program has none of that name */
    GLint clip_from_lps, eye_from_lps, viewer, color, opacity, is_rim, source, palette, grey, ends, cull, scale, depths,
        before, n_layers, rank_depth, is_two_sided, rounding, is_baked, is_covering, half_size, half_view, cue, edges;
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
