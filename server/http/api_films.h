#pragma once
/* Films: jobs of which the renderer draws and compresses picture after picture, at turns with everything else it draws.
 * The film stays in the daemon's memory, where the job's maker gets it. Internal to server/http; net thread. */
#include "server/http/api_state.h"

enum {
    API_MAX_FILMS_AT_WORK = 2,         /* on the server; further ones wait */
    API_MAX_FILMS_WAITING = 8,         /* then PROBLEM_LIMIT */
    API_MAX_FILMS_OF_ONE = 2,          /* not yet ended, of one person */
    API_MAX_FILM_S = 60,               /* length of a turn */
    API_MAX_FILM_FPS = 30,             /* pictures a second */
    API_MAX_FILM_SIDE_PX = 1920,       /* of a picture without its caption ... */
    API_MAX_FILM_PIXELS = 1920 * 1080, /* ... and its pixels */
    API_MIN_FILM_SIDE_PX = 240,
    API_MAX_FILM_BYTES = 32 << 20,  /* of one, as server/renderer/films.h */
    API_KEPT_FILM_BYTES = 128 << 20 /* of all that are kept; then the oldest is forgotten */
};

/* Begins films that wait and could be begun. */
void api_films_go_on(struct api *api);
struct film_meeting;
/* How a film is made, of what, and for whom. */
struct film_order {
    double degrees, seconds, fps, quality;
    bool is_named;                        /* the caption has the patient in full */
    const char *plan_id, *room_id, *user; /* room_id, user: "": none; borrowed, as acceptances */
    cJSON *scene, *view;                  /* complete documents; NULL for a film of a meeting */
    struct film_meeting *meeting;         /* NULL: a turn */
    const cJSON *acceptances;             /* NULL: none */
};
/* False with problem: too many films wait, or are of this person. */
NODISCARD bool api_films_have_place(const struct api *api, const char *user, struct problem *problem);
/* Makes a film, at once or after others. Takes scene, view and meeting. Returns its number. */
uint64_t api_film_make(struct api *api, const struct film_order *order);
/* A film; what it points to is borrowed until the next call. */
struct api_film_state {
    enum api_job_state state;
    int n_pictures, n_done; /* n_pictures 0: not known */
    double percent;
    const struct problem *problem; /* when failed */
    const char *plan_id, *room_id;
    bool is_named, is_of_meeting;
    struct call_bytes *bytes; /* when done; NULL: it is not kept any more */
};
/* False: the film is forgotten. */
bool api_film_find(const struct api *api, uint64_t number, struct api_film_state *state);
void api_film_cancel(struct api *api, uint64_t number);
void api_film_forget(struct api *api, uint64_t number);
/* No film of the plan is kept or made any more; their jobs stay. */
void api_films_erase(struct api *api, const char *plan_id);
/* Helpers of orders: a member of the body between two bounds, absent: *value stays; the film's size; whether the body
 * has no other field than the known ones, NULL at their end. False with problem. */
NODISCARD bool film_read_number(const cJSON *body, const char *name, const double range[2], bool is_whole,
                                double *value, struct problem *problem);
NODISCARD bool film_check_size(double width, double height, const char *pointer, struct problem *problem);
NODISCARD bool film_check_fields(const cJSON *body, const char *const *known, struct problem *problem);
/* Makes the film and its job, and answers the call. Takes what order owns. */
void film_order(struct api *api, struct call *call, struct film_order *order);
void api_films_destroy(struct api *api);
