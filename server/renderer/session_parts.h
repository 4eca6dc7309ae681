#pragma once
/* What the files of a session share: its state, what it says to the daemon, its pictures. All on the main thread;
 * nothing of this is for others. */
#include "server/renderer/link.h"
#include "server/renderer/loader.h"
#include "server/renderer/session.h"

enum { MAX_DRAWINGS = 2 * PIPELINE_MAX_WAITING };

struct room_scene {
    char id[64];
    uint32_t revision;
    cJSON *scene;
};

#define NO_DRAWING (UINT64_MAX - 1) /* never the id of a request */
struct drawing {                    /* a picture asked for and not yet delivered */
    _Atomic uint64_t id; /* NO_DRAWING: free. Written by the main thread alone; the thread that builds the shapes reads
                            whether it is still wanted */
    uint32_t revision;
    struct snapshot *snapshot; /* a reference */
    enum surface_detail detail;
};

struct session {
    const struct session_options *options;
    struct link *link;
    struct desk *desk;
    struct loader *loader;
    struct pipeline *pipeline;
    struct plan *plan;
    struct derive *derived; /* of the plan */
    struct room_scene *rooms;
    size_t n_rooms, room_capacity; /* at most SCENE_MAX_ROOMS */
    cJSON *default_scene;
    struct drawing drawings[MAX_DRAWINGS];
    struct built_shapes *built_shapes;
    bool is_built, has_gl, is_ready;
    struct problem gl_problem; /* when GL did not start */
    int64_t began_us;
    int status; /* -1: go on */
};

/* session.c: packets to the daemon */
NODISCARD cJSON *session_packet(const char *type);
void session_say(struct session *session, cJSON *json, const uint8_t *blob, size_t n_blob); /* takes json */
void session_say_problem(struct session *session, uint64_t id, const struct problem *problem);
/* Adds to a problem with memory how much the renderer may take. Leaves other problems as they are. */
void session_add_limit(const struct session *session, struct problem *problem);
/* A number of a request; where it is missing, value keeps its default. False after the problem was said: it is out of
 * range. */
NODISCARD bool session_read_number(struct session *session, uint64_t id, const cJSON *json, const char *name,
                                   double low, double high, double *value);

/* session_pictures.c: the rooms' scenes, and pictures from the request to the frame */
void pictures_begin(struct session *session);
void pictures_end(
    struct session *session); /* after the loader and the pipeline have ended: they read what this frees */
void pictures_take_scene(struct session *session, cJSON *json); /* detaches the scene from json */
void pictures_forget_room(struct session *session, const char *id);
/* What a request is to show, from {room | scene, view}. One reference, the caller's; NULL after the problem was said.
 */
NODISCARD struct snapshot *pictures_read_snapshot(struct session *session, uint64_t id, const cJSON *json,
                                                  uint32_t *revision);
/* Draws a tiny picture that is sent to nobody, so that shaders are compiled and light surfaces on the device before the
 * first one is asked for. */
void pictures_warm_up(struct session *session);
void pictures_draw(struct session *session, uint64_t id, const cJSON *json);
void pictures_drop(struct session *session, uint64_t id);
/* The shapes of a picture are built: hands it to the render thread. Takes waiting. */
void pictures_submit(struct session *session, struct waiting_request *waiting);
void pictures_take_frame(struct session *session, const struct pipeline_frame *frame);
