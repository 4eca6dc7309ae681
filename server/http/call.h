#pragma once
/* One HTTP request on its way through: filled by the HTTP thread, answered on the net thread, sent by the HTTP thread.
 * Knows nothing of libmicrohttpd. */
#include <stddef.h>
#include <stdint.h>

#include "server/wire/json.h"

enum {
    CALL_MAX_PATH = 1024,
    CALL_MAX_SEGMENTS = 8,
    CALL_MAX_QUERY = 16,       /* parameters */
    CALL_MAX_VALUE = 16 << 10, /* bytes of one parameter or header */
    CALL_MAX_BODY = 1 << 20,
    CALL_MAX_HEADERS = 8
};

enum call_method { CALL_GET, CALL_HEAD, CALL_POST, CALL_PATCH, CALL_DELETE, CALL_OTHER };

struct call_pair {
    char *name, *value;
};

struct call {
    /* the request */
    enum call_method method;
    char path[CALL_MAX_PATH];          /* decoded */
    char *segments[CALL_MAX_SEGMENTS]; /* of path, split at '/' */
    size_t n_segments;
    const char *ids[CALL_MAX_SEGMENTS]; /* those that stand for {...} in the route, in order */
    struct call_pair query[CALL_MAX_QUERY];
    size_t n_query;
    char *if_match, *if_none_match, *content_type, *origin, *host, *fetch_site; /* NULL when not sent */
    char *body;
    size_t n_body;
    char *upload_path; /* an archive's body lies here instead; whoever keeps the file sets it to NULL */
    uint64_t n_upload;
    struct problem early; /* found while reading the request: answered instead of the route */

    /* the answer */
    int status;
    char media_type[64];
    uint8_t *bytes;
    size_t n_bytes;
    struct call_pair headers[CALL_MAX_HEADERS];
    size_t n_headers;

    void *api;                           /* whose tables the handlers use */
    void *context;                       /* the handler's own while it waits */
    void (*finished)(struct call *call); /* set by the HTTP side: the answer is complete; any thread, exactly once */
    void *connection;                    /* the HTTP side's */
    int64_t started_us;
    const char *route; /* "GET /api/v1/plans/{plan}", for metrics; never an id */
};

struct call *call_create(void);
void call_destroy(struct call *call);
void call_set_path(struct call *call, const char *path);
const char *call_query(const struct call *call, const char *name); /* NULL when absent */

/* Each sets the answer and calls finished: the call must not be touched after it. */
void call_answer_json(struct call *call, int status, cJSON *json); /* takes json */
void call_answer_problem(struct call *call, const struct problem *problem);
void call_answer_bytes(struct call *call, int status, const char *media_type, uint8_t *bytes,
                       size_t n); /* takes bytes */
void call_answer_text(struct call *call, int status, const char *media_type, const char *text);
void call_answer_nothing(struct call *call, int status);
void call_add_header(struct call *call, const char *name, const char *value); /* before the answer */

/* Whether its Content-Type is media_type, parameters aside. */
bool call_media_type_is(const struct call *call, const char *media_type);
/* A page of another origin must not change anything here with the person's own browser. False with problem. */
NODISCARD bool call_origin_is_own(const struct call *call, struct problem *problem);
/* The body as a JSON object. media_types: NULL-terminated, which are read. false: the call has been answered with the
 * problem. */
NODISCARD bool call_read_object(struct call *call, const char *const *media_types, cJSON **object);
/* A query parameter as a finite number. NULL text: *value unchanged. */
NODISCARD bool call_query_number(const struct call *call, const char *name, bool is_required, double *value,
                                 struct problem *problem);
