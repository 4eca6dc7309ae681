#pragma once
/* The HTTP server: libmicrohttpd's own thread for connections that the acceptor hands over; the page's files are answered there,
 * everything of the API on the net thread while the connection is suspended. */
#include <sys/socket.h>

#include "server/http/hosts.h"
#include "server/net/net.h"

enum {
    HTTP_MAX_CONNECTIONS = 500,
    HTTP_MAX_PER_ADDRESS = 200,
    HTTP_RETRY_MS = 5000,
    HTTP_TIMEOUT_S = 60,               /* without a byte either way */
    HTTP_MAX_DROPPED = 64 << 20,       /* bytes of a body beyond the limit that are read before the connection is cut */
    HTTP_MIN_ARCHIVE_DROPPED = 1 << 30 /* of an archive: these, or as many as one may have if that is more */
};

struct http;

struct http_options {
    const char *web_folder;    /* the page; NULL: the API alone */
    const char *upload_folder; /* where archives are received; NULL: they are not */
    uint64_t max_upload_bytes;
    uint64_t disk_reserve_bytes; /* stay free on its disk */
    const struct hosts *hosts;   /* what the server is called; outlives it */
};

/* errors ERROR_IO, ERROR_LIMIT, ERROR_NOT_FOUND. net outlives it. */
NODISCARD struct http *http_create(struct net *net, const struct http_options *options, struct error *err);
/* Stopping: http_stop_asking (from then on the API answers 503 by itself), net_destroy (which answers what was asked), http_destroy. */
void http_stop_asking(struct http *http);
void http_destroy(struct http *http);
/* Takes an accepted socket, nothing read from it yet; says so and closes it when it cannot be served. The acceptor's thread. */
void http_add_connection(struct http *http, int socket, const struct sockaddr *address, socklen_t n_address);
