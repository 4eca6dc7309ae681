#pragma once
/* One connection of TLS, from its first byte to its end. Thread of TLS. Internal to server/tls. */
#include "server/tls/tls_state.h"

/* Takes the socket; closes it where there are too many. */
void tls_link_begin(struct tls *tls, int socket, const struct address *peer);
/* Called by libev: a client that was silent has sent its first byte, or has gone. */
void tls_link_look(struct ev_loop *loop, struct ev_io *watcher, int events);
/* The library's one callback. owner: a link, or NULL. Non-zero closes the socket. */
int tls_link_handle(struct lws *lws, enum lws_callback_reasons reason, void *owner, void *bytes, size_t n);
/* Ends the link if it is late. May free it. */
void tls_link_check(struct tls_link *link, int64_t now_us);
void tls_link_end(struct tls_link *link); /* at once; frees it */
