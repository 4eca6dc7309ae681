#pragma once
/* What the surface call asks for, read once for API, renderer and command line: which shape, with which normals, as
 * what. */
#include "core/surface/mesh_export.h"
#include "core/surface/shape.h"
#include "server/wire/json.h"

enum { SHAPE_QUERY_MAX_FRAMES = 50 };

struct shape_query {
    struct shape_key key; /* normalised */
    bool is_faceted;      /* normals "face" */
    bool is_file;         /* as a file of this format, not as figures */
    enum mesh_format format;
    int n_frames; /* pictures to time; 0: none */
};

/* Words as a URL has them: {"representation": "nurbs", "order": "3"}. What is absent has the scene's default; what the
 * representation does not use is checked all the same. problem: validation, its pointer names the word. */
NODISCARD bool shape_query_read(const cJSON *json, struct shape_query *query, struct problem *problem);
/* The names shape_query_read knows, NULL at the end. */
extern const char *const shape_query_names[];
/* Whether a representation is made of triangles, which is what the files hold. */
bool shape_query_has_triangles(const struct shape_query *query);
/* The patch on a scene that shows this shape of one region and nothing else; regions: the ids of all. */
NODISCARD cJSON *shape_query_scene(const struct shape_query *query, const char *region, const cJSON *scene);
