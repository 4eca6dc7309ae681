#pragma once
/* The parameters of the surface call: which shape of a region, with which normals, as figures or as which file. Read
 * here for the API, the renderer and the command line. Thread: any. */
#include "core/surface/mesh_export.h"
#include "core/surface/shape.h"
#include "server/wire/json.h"

enum { SHAPE_QUERY_MAX_FRAMES = 50 };

struct shape_query {
    struct shape_key key; /* normalised */
    bool is_faceted;      /* normals "face" */
    bool is_file;         /* a file in this format; false: figures as JSON */
    enum mesh_format format;
    int n_frames; /* pictures to draw for the timing; 0: none */
};

/* json has the parameters as texts, as in a URL: {"representation": "nurbs", "order": "3"}. Absent ones have the
 * scene's default. Those that the representation does not use are checked too. False: a validation problem whose
 * pointer names the parameter. */
NODISCARD bool shape_query_read(const cJSON *json, struct shape_query *query, struct problem *problem);
/* Names of all parameters, NULL at the end. */
extern const char *const shape_query_names[];
/* True if the representation consists of triangles: only those can be written to files. */
bool shape_query_has_triangles(const struct shape_query *query);
/* A new merge patch on scene that shows this shape of one region and nothing else. scene: a complete scene document,
 * for the ids of all regions. */
NODISCARD cJSON *shape_query_scene(const struct shape_query *query, const char *region, const cJSON *scene);
