#pragma once
/* TLS at the port: decrypts accepted connections by libwebsockets with OpenSSL, on a thread of its own, and hands on
 * each decrypted stream as one end of a pair of sockets. Knows nothing of HTTP, of the front, of rooms. */
#include <stdatomic.h>

#include "core/base/error.h"
#include "server/front/address.h"

enum {
    /* Connections that have not sent their first encrypted byte of a request, in all and from one address (trusted
     * proxies excepted). One more is closed. */
    TLS_MAX_WAITING = 256,
    TLS_MAX_WAITING_PER_ADDRESS = 64,
    TLS_FIRST_MS = 5000,   /* from the connection to that byte: the handshake is within this time */
    TLS_MAX_ENDING = 256,  /* whose server has ended, while its last bytes are passed on; one more is closed at once */
    TLS_ENDING_MS = 5000,  /* until the client has taken these bytes */
    TLS_LINGER_MS = 1000,  /* then until the client ends, too; what it sends is dropped */
    TLS_MAX_QUEUED = 1024, /* given to tls_accept, and not taken by the thread yet */
    TLS_STOP_MS = 500,     /* tls_destroy waits so long for last bytes */
    TLS_UNSENT_AT_MOST = 32 << 10 /* bytes left in the kernel's buffer when it takes more */
};

struct tls;

struct tls_options {
    const char *cert_file, *key_file; /* PEM; see certificate_read */
    const struct address_range *trusted;
    size_t n_trusted;
    /* Take a socket: take, the decrypted stream of a client, from its first byte; take_plain, the client's own, on
     * which it speaks no TLS. On the thread of TLS, not after tls_close. */
    void (*take)(void *context, int socket, const struct address *peer);
    void (*take_plain)(void *context, int socket, const struct address *peer);
    void *context;
};

struct tls_counts {
    size_t n_connections, n_waiting, n_ending;
};

/* Reads the certificate and starts the thread. Opens a plugin of the library. options and what it points to outlive it.
 * errors those of certificate_read; ERROR_IO */
NODISCARD struct tls *tls_create(const struct tls_options *options, struct error *err);
/* Takes a connected stream socket, of which nothing has been read. Any thread, until tls_destroy. */
void tls_accept(struct tls *tls, int socket, const struct address *peer);
/* Reads the certificate and its key again, for connections that begin from now on. On failure the ones in use stay.
 * One call at a time; waits for the disk. errors those of certificate_read */
NODISCARD bool tls_reload(struct tls *tls, struct error *err);
/* Has the thread set *beat. Any thread; one call at a time. */
void tls_ping(struct tls *tls, atomic_bool *beat);
struct tls_counts tls_count(struct tls *tls); /* any thread */
/* When it returns nothing is handed on any more, and connections that wait are closed; others go on. */
void tls_close(struct tls *tls);
/* After tls_close, and when the other ends of all pairs were closed: passes last bytes on and ends the thread. */
void tls_destroy(struct tls *tls);
