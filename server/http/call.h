#pragma once
/* One HTTP call: its request, filled in by the HTTP thread; its answer, made on the net thread and sent by the HTTP
 * thread. Knows nothing of libmicrohttpd. */
#include <stddef.h>
#include <stdint.h>

#include "server/wire/identity.h"
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

struct api_act;
struct feed;
struct call_bytes; /* what several answers are made of, counted */

struct call {
    /* the request */
    enum call_method method;
    char path[CALL_MAX_PATH];          /* decoded */
    char *segments[CALL_MAX_SEGMENTS]; /* path, split at '/' */
    size_t n_segments;
    const char *ids[CALL_MAX_SEGMENTS]; /* the segments that stand for {...} in the route, in order */
    struct call_pair query[CALL_MAX_QUERY];
    size_t n_query;
    char *if_match, *if_none_match, *content_type, *origin, *host, *fetch_site, *member, *key,
        *last_event;          /* NULL when not sent */
    bool is_secure;           /* it came by TLS, which was decrypted here */
    bool is_https;            /* likewise, or by a proxy at a Unix socket */
    char client[46];          /* address of the client, behind trusted proxies; "": not known */
    struct identity identity; /* who makes it */
    char *body;
    size_t n_body;
    char *upload_path; /* the file that holds the body when it is an archive; removed with the call unless it is set to
                          NULL */
    uint64_t n_upload;
    struct problem early; /* a problem found while the request was received: answered without running the route */

    /* the answer */
    int status;
    char media_type[64];
    struct feed *feed; /* NULL, or the reader's side of the feed that the answer is made of, without an end */
    uint8_t *bytes;
    size_t n_bytes;
    struct call_bytes *shared; /* NULL, or whose bytes these are: a reference */
    struct call_pair headers[CALL_MAX_HEADERS];
    size_t n_headers;

    bool is_counted;                      /* in the rates of its caller */
    bool has_listed;                      /* the plan folders were listed for it */
    bool is_of_wall;                      /* allowed at the crosshair of its caller's wall alone */
    void *api;                            /* the struct api that handles the call */
    void *context;                        /* for the handler, while it waits for the fleet */
    void (*answering)(struct call *call); /* NULL, or called with the answer before finished, on the net thread */
    const char *exported;                 /* what the answer gives away (api_audit.h); NULL: nothing */
    void (*finished)(struct call *call); /* of the HTTP side: called once, on any thread, when the answer is complete */
    void *connection;                    /* of the HTTP side */
    void (*wake)(void *context);         /* for feed_create */
    void *wake_context;
    int64_t started_us;
    const struct api_act *act; /* of the route; NULL: its handler is its own */
    const char *route;         /* "GET /api/v1/plans/{plan}", for metrics; never an id */
};

/* One reference, the caller's. Takes bytes. */
struct call_bytes *call_bytes_create(uint8_t *bytes, size_t n);
struct call_bytes *call_bytes_ref(struct call_bytes *shared);
void call_bytes_unref(void *shared); /* a struct call_bytes; NULL is allowed; any thread */
size_t call_bytes_size(const struct call_bytes *shared);

struct call *call_create(void);
void call_destroy(struct call *call);
void call_set_path(struct call *call, const char *path);
const char *call_query(const struct call *call, const char *name); /* NULL when absent */

/* Each of these sets the answer and calls finished. The call must not be used afterwards. */
void call_answer_json(struct call *call, int status, cJSON *json); /* takes json */
void call_answer_problem(struct call *call, const struct problem *problem);
void call_answer_bytes(struct call *call, int status, const char *media_type, uint8_t *bytes,
                       size_t n); /* takes bytes */
/* Takes shared. */
void call_answer_shared(struct call *call, int status, const char *media_type, struct call_bytes *shared);
void call_answer_text(struct call *call, int status, const char *media_type, const char *text);
void call_answer_feed(struct call *call, const char *media_type, struct feed *feed); /* takes its reader's side */
void call_answer_nothing(struct call *call, int status);
void call_add_header(struct call *call, const char *name, const char *value); /* before the answer */

/* True if its Content-Type is media_type, without regard to parameters. */
bool call_media_type_is(const struct call *call, const char *media_type);
/* Returns false with problem for a request that would change something and that a page of another origin makes with the
 * user's browser. */
NODISCARD bool call_origin_is_own(const struct call *call, struct problem *problem);
/* Reads the body as a JSON object. media_types: the accepted ones, NULL-terminated. Returns false when the call was
 * answered with the problem. */
NODISCARD bool call_read_object(struct call *call, const char *const *media_types, cJSON **object);
/* A query parameter as a finite number; *value is unchanged when it is absent. */
NODISCARD bool call_query_number(const struct call *call, const char *name, bool is_required, double *value,
                                 struct problem *problem);
