#pragma once
/* How OpenGL makes and frees what draw_cache.h keeps. */
#include "core/render/gl/upload.h"

/* gl is borrowed and outlives the cache. Its drawables are struct gl_shape and struct gl_grid. */
struct drawable_maker gl_drawable_maker(const struct gl *gl);
