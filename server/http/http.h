#pragma once
/* The HTTP server: libmicrohttpd behind the front, on one thread. The page's files are answered there; calls of the API
 * are answered on the net thread, while the connection is suspended. */
#include <stdatomic.h>

#include "server/front/address.h"
#include "server/front/hosts.h"
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
    uint64_t disk_reserve_bytes;         /* left free on the disk of upload_folder */
    const struct hosts *hosts;           /* names of the server; outlives it */
    const struct address_range *trusted; /* proxies whose X-Forwarded-For is believed; outlives it */
    size_t n_trusted;
    bool is_alone; /* only this machine reaches the server: a listener on loopback, and no public name */
};

/* errors ERROR_IO, ERROR_LIMIT, ERROR_NOT_FOUND. net outlives it. */
NODISCARD struct http *http_create(struct net *net, const struct http_options *options, struct error *err);
/* Stopping, in this order: http_stop_posting (from then on calls are answered with 503), net_destroy (which answers the
 * calls it has),
 * http_destroy. */
void http_stop_posting(struct http *http);
void http_destroy(struct http *http);
/* Takes an accepted socket that holds a whole head, of which nothing was read; answers 429 when there are too many.
 * client: the address it is counted for. The acceptor's thread. */
void http_add_connection(struct http *http, int socket, const struct address *peer, const struct address *client);
/* Has the HTTP thread set *beat. Any thread; one call at a time. */
void http_ping(struct http *http, atomic_bool *beat);
void http_hang(struct http *http); /* for tests: the thread hangs */
