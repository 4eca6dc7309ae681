#pragma once
/* The shader programs and the locations of their uniforms. Their names come from the shaders, so a new uniform is named
 * there alone. Pictures are drawn upside down (the matrix of a band in renderer.c), so that reading them back gives row
 * 0 at the top. */
#include "core/render/gl/table.h"
#include "gl_shaders.h" /* generated from core/render/gl/shaders */

struct gl_program {
    GLuint name;
    /* locations of uniforms; -1: the program has none of that name */
#define UNIFORM_LOCATION(uniform) GLint uniform;
    GL_UNIFORMS(UNIFORM_LOCATION)
#undef UNIFORM_LOCATION
};

struct gl_programs {
    struct gl_program smooth;                            /* surface shaded by vertex normals */
    struct gl_program faceted;                           /* surface shaded by triangle normals */
    struct gl_program smooth_clipped, faceted_clipped;   /* the same, cut by clip planes */
    struct gl_program smooth_textured, faceted_textured; /* the same, with a texture: image or wash */
    struct gl_program lines;
    struct gl_program points;
    struct gl_program compose;       /* the translucent layers, by a triangle over the whole picture */
    struct gl_program volume;        /* a volume with the translucent layers, by a triangle over the whole picture */
    struct gl_program volume_washed; /* the same with a colourwash */
    struct gl_program volume_depth;  /* where a volume has absorbed half of the light, alike */
    struct gl_program image[2];      /* slice of an image, window and level: the nearest voxel, linear */
    struct gl_program colors[2];     /* the same in colours, or with a second image over it */
    struct gl_program labels;        /* slice of a label layer: one colour a label */
    struct gl_program wash;          /* a colourwash over a plane */
    struct gl_program tracks;        /* particle tracks */
    struct gl_program marks;         /* marked univels: stripes and an edge */
    struct gl_program fan;           /* the inside of outlines, for the stencil */
    struct gl_program plain;         /* a polygon in one colour */
    struct gl_program test;          /* a texture's colour, by a triangle over the whole picture */
};

/* errors ERROR_GL with the compiler's message */
NODISCARD bool gl_programs_create(const struct gl *gl, struct gl_programs *programs, struct error *err);
void gl_programs_destroy(const struct gl *gl, struct gl_programs *programs);
