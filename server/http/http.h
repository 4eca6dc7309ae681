#pragma once
/* The HTTP server: libmicrohttpd behind the front, on one thread. The page's files are answered there; calls of the API
 * are answered on the net thread, while the connection is suspended. */
#include "server/front/front.h"
#include "server/http/api_doors.h"
#include "server/net/net.h"

enum {
    HTTP_MIN_ARCHIVE_DROPPED =
        1 << 30 /* bytes of a refused archive that are read and dropped; or max_upload_bytes, if that is more */
};

struct http;

struct http_options {
    const char *web_folder;    /* the page's files; NULL: only the API */
    const char *upload_folder; /* where archives are received; NULL: uploads are refused */
    uint64_t max_upload_bytes;
    uint64_t disk_reserve_bytes; /* left free on the disk of upload_folder */
    bool is_secure_alone;        /* browsers that came by TLS are to use nothing else for this name (RFC 6797) */
    struct auth *auth;           /* outlives the server */
    struct api_doors doors;
};

/* Serves the requests of front, which begins to listen and starts its thread (front_serve). net and front outlive it.
 * errors ERROR_IO, ERROR_LIMIT, ERROR_NOT_FOUND, and those of front_serve */
NODISCARD struct http *http_create(struct net *net, struct front *front, const struct http_options *options,
                                   struct error *err);
/* Stopping, in this order: front_close, http_stop_posting (from then on calls are answered with 503), net_destroy
 * (which answers the calls it has), http_destroy (which stops the front), front_destroy. */
void http_stop_posting(struct http *http);
void http_stop_printing(struct http *http); /* api_stop_printing; http may be NULL */
void http_destroy(struct http *http);
