#pragma once
/* Makes and frees OpenGL's drawables, which draw_cache.h keeps. */
#include "core/render/gl/upload.h"

/* The maker of struct gl_shape and struct gl_grid. gl is borrowed and outlives the cache. */
struct drawable_maker gl_drawable_maker(const struct gl *gl);
