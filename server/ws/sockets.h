#pragma once
/* The sockets of the net thread, in the raw role of libwebsockets: it waits for them, reads, and reports; it frames
 * nothing, and what is sent goes to the socket directly. Knows nothing of what the sockets carry. Net thread, but for
 * sockets_wake. Internal to server/ws. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/base/error.h"

enum { SOCKETS_READ_AT_ONCE = 32 << 10 };

struct sockets;
struct sockets_calls;

struct socket { /* in the caller's storage; filled by sockets_add */
    const struct sockets_calls *calls;
    struct lws *lws; /* the library's */
    int fd;          /* to send */
};

struct sockets_calls {
    /* Bytes that were received. Returns non-zero when the socket is to be closed. */
    int (*received)(struct socket *socket, const uint8_t *bytes, size_t n);
    /* After sockets_ask_room: the socket takes more. Returns non-zero when the socket is to be closed. */
    int (*takes_more)(struct socket *socket);
    /* Once for each socket: it has ended, or was asked to, and is closed when this returns. */
    void (*ended)(struct socket *socket);
};

/* Opens a plugin of the library. calls: used until the last socket has ended. errors ERROR_IO */
NODISCARD struct sockets *sockets_create(const struct sockets_calls *calls, struct error *err);
void sockets_destroy(struct sockets *sockets); /* all sockets were closed */
/* Takes fd, on failure too. Returns false without memory, or with too many descriptors. */
NODISCARD bool sockets_add(struct sockets *sockets, struct socket *socket, int fd);
void sockets_ask_room(struct socket *socket); /* takes_more is called once */
void sockets_close(struct socket *socket);    /* not from within a call about this socket */
void sockets_wake(struct sockets *sockets);   /* any thread: ends the wait */
/* Waits until something was reported, at most until until_us on clock_now_us; it may return earlier, with nothing.
 * Returns whether it was woken. */
bool sockets_wait(struct sockets *sockets, int64_t until_us);
