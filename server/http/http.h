#pragma once
/* The HTTP server: libmicrohttpd behind the relay, on one thread; the page's files are answered there, everything of
 * the API on the net thread while the connection is suspended. */
#include <stdatomic.h>

#include "server/http/address.h"
#include "server/http/hosts.h"
#include "server/net/net.h"

enum {
    HTTP_MIN_ARCHIVE_DROPPED =
        1 << 30 /* bytes of a refused archive that are read: these, or as many as one may have if that is more */
};

struct http;

struct http_options {
    const char *web_folder;    /* the page; NULL: the API alone */
    const char *upload_folder; /* where archives are received; NULL: they are not */
    uint64_t max_upload_bytes;
    uint64_t disk_reserve_bytes;         /* stay free on its disk */
    const struct hosts *hosts;           /* what the server is called; outlives it */
    const struct address_range *trusted; /* proxies whose X-Forwarded-For is believed; outlives it */
    size_t n_trusted;
};

/* errors ERROR_IO, ERROR_LIMIT, ERROR_NOT_FOUND. net outlives it. */
NODISCARD struct http *http_create(struct net *net, const struct http_options *options, struct error *err);
/* Stopping, in this order: http_stop_posting (from then on calls are answered with 503), net_destroy (which answers the
 * calls it has),
 * http_destroy. */
void http_stop_posting(struct http *http);
void http_destroy(struct http *http);
/* Takes an accepted socket with a whole head in it, nothing read from it yet; answers 429 and closes it when there are
 * too many. client: whom it is counted for. The acceptor's thread. */
void http_add_connection(struct http *http, int socket, const struct address *peer, const struct address *client);
/* Any thread: *beat is set soon, by the HTTP thread. One at a time. */
void http_ping(struct http *http, atomic_bool *beat);
void http_hang(struct http *http); /* for tests: its thread does nothing more */
