#define _GNU_SOURCE
/* Reads the address, binds, listens. */
#include "server/front/listener.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netdb.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { BACKLOG = 4096 }; /* of listen(2): a connection that does not fit is retried by its client a second later */

/* Splits "HOST:PORT" and removes brackets from the host. Returns the port's text, NULL with err on failure. */
static const char *split(const char *listen_at, char host[80], struct error *err)
{
    const char *colon = strrchr(listen_at, ':');
    size_t n = colon ? (size_t)(colon - listen_at) : 0;
    bool is_bracketed = n >= 2 && listen_at[0] == '[' && listen_at[n - 1] == ']';
    if (!colon || n == 0 || n >= 80) {
        (void)error_set(err, ERROR_FORMAT, "--listen %.80s: expected ADDRESS:PORT, as in 127.0.0.1:8080 or [::1]:8080",
                        listen_at);
        return NULL;
    }
    (void)snprintf(host, 80, "%.*s", (int)(is_bracketed ? n - 2 : n), listen_at + is_bracketed);
    if (colon[1 + strspn(colon + 1, "0123456789")] || strlen(colon + 1) - 1 >= 5 ||
        strtoul(colon + 1, NULL, 10) > 65535) { /* getaddrinfo uses only its low 16 bits */
        (void)error_set(err, ERROR_RANGE, "--listen %.80s: expected a port from 0 to 65535", listen_at);
        return NULL;
    }
    return colon + 1;
}

static bool bind_to(int listener, const struct addrinfo *found)
{
    int on = 1;
    return listener >= 0 && setsockopt(listener, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) == 0 &&
           bind(listener, found->ai_addr, found->ai_addrlen) == 0 && listen(listener, BACKLOG) == 0;
}

static bool write_url(int listener, const char *host, bool is_secure, char url[LISTENER_MAX_URL])
{
    struct sockaddr_storage bound;
    socklen_t n_bound = sizeof bound;
    if (getsockname(listener, (struct sockaddr *)&bound, &n_bound) != 0)
        return false;
    const bool is_six = bound.ss_family == AF_INET6;
    unsigned port =
        ntohs(is_six ? ((struct sockaddr_in6 *)&bound)->sin6_port : ((struct sockaddr_in *)&bound)->sin_port);
    (void)snprintf(url, LISTENER_MAX_URL, is_six ? "http%s://[%s]:%u" : "http%s://%s:%u", is_secure ? "s" : "", host,
                   port);
    return true;
}

int listener_open(const char *listen_at, bool is_secure, char url[LISTENER_MAX_URL], struct error *err)
{
    char host[80];
    const char *port = split(listen_at, host, err);
    if (!port)
        return -1;
    struct addrinfo hints = { .ai_flags = AI_NUMERICHOST | AI_NUMERICSERV | AI_PASSIVE, .ai_socktype = SOCK_STREAM },
                    *found = NULL;
    int failed = getaddrinfo(host, port, &hints, &found);
    if (failed) {
        (void)error_set(err, ERROR_FORMAT, "--listen %.80s: %s; expected a numeric address and port", listen_at,
                        gai_strerror(failed));
        return -1;
    }
    int listener = socket(found->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    bool ok = bind_to(listener, found);
    freeaddrinfo(found);
    if (ok && write_url(listener, host, is_secure, url))
        return listener;
    (void)error_set(err, ERROR_IO, "--listen %.80s: %s", listen_at, strerror(errno));
    if (listener >= 0)
        (void)close(listener);
    return -1;
}
