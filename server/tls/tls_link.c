#define _GNU_SOURCE
/* Advances one link. The library decrypts and waits; what is sent goes through OpenSSL directly, because the library
 * reads nothing from a client while bytes for it wait. */
#include "server/tls/tls_link.h"

#include <errno.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/base/gate.h"
#include "core/base/mem.h"
#include "server/ws/library.h"

enum { RECORD_OF_HANDSHAKE = 22 }; /* the first byte of a connection of TLS (RFC 8446 5.1) */

static bool would_block(void)
{
    return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
}

/* ---- stages ----------------------------------------------------------------------------------------------------- */

static atomic_size_t *counter_of(struct tls *tls, enum tls_stage stage)
{
    switch (stage) {
    case TLS_SILENT:
    case TLS_HANDSHAKE: return &tls->n_waiting;
    case TLS_ENDING:
    case TLS_LEFT: return &tls->n_ending;
    case TLS_OPEN: break;
    }
    return NULL;
}

static void count(struct tls *tls, enum tls_stage stage, bool is_more)
{
    atomic_size_t *counter = counter_of(tls, stage);
    if (counter)
        (void)(is_more ? atomic_fetch_add(counter, 1) : atomic_fetch_sub(counter, 1));
}

static void set_stage(struct tls_link *link, enum tls_stage stage, int64_t within_ms)
{
    count(link->tls, link->stage, false);
    link->stage = stage;
    count(link->tls, stage, true);
    link->late_us = clock_now_us() + within_ms * 1000;
    if (counter_of(link->tls, stage) && !ev_is_active(&link->tls->tick))
        ev_timer_again(link->tls->loop, &link->tls->tick);
}

/* The library has closed the client's socket, or never had it. */
static void free_link(struct tls_link *link)
{
    struct tls *tls = link->tls;
    ev_io_stop(tls->loop, &link->down);
    ev_io_stop(tls->loop, &link->up);
    if (link->pair >= 0)
        (void)close(link->pair);
    count(tls, link->stage, false);
    (void)atomic_fetch_sub(&tls->n_links, 1);
    if (link->previous)
        link->previous->next = link->next;
    else
        tls->links = link->next;
    if (link->next)
        link->next->previous = link->previous;
    free(link->to_client);
    free(link->to_pair);
    free(link);
}

static void unwatch_silent(const struct tls_link *link)
{
    (void)epoll_ctl(link->tls->silent, EPOLL_CTL_DEL, link->client, NULL);
}

void tls_link_end(struct tls_link *link)
{
    struct lws *lws = link->lws;
    link->is_pair_gone = true; /* nothing is passed on any more */
    if (lws) {
        lws_set_timeout(lws, PENDING_TIMEOUT_CLOSE_SEND, LWS_TO_KILL_SYNC); /* reports the end, which frees the link */
        return;
    }
    if (link->stage == TLS_SILENT)
        unwatch_silent(link); /* a child process that is being started may hold a copy of the socket */
    if (link->stage != TLS_LEFT)
        (void)close(link->client);
    free_link(link);
}

/* ---- to the client ---------------------------------------------------------------------------------------------- */

/* Tells the client that no more comes: in TLS, and below it. Where the socket is full, once it takes more: an end below
 * TLS alone is to the client an answer that was cut off. */
static void tell_end(struct tls_link *link)
{
    if (link->is_told)
        return;
    SSL *ssl = lws_get_ssl(link->lws);
    ERR_clear_error();
    int told = SSL_shutdown(ssl), reason = told < 0 ? SSL_get_error(ssl, told) : SSL_ERROR_NONE;
    ERR_clear_error();
    if (reason == SSL_ERROR_WANT_WRITE) {
        (void)lws_callback_on_writable(link->lws);
        return;
    }
    link->is_told = true;
    (void)shutdown(link->client, SHUT_WR);
    link->late_us = clock_now_us() + TLS_LINGER_MS * INT64_C(1000);
}

/* Encrypts and sends what the client takes now. Returns the bytes that were taken, -1 when the connection has failed.
 */
static ssize_t send_to_client(struct tls_link *link, const char *bytes, size_t n)
{
    SSL *ssl = lws_get_ssl(link->lws);
    size_t n_taken = 0;
    while (n_taken < n) {
        ERR_clear_error();
        int n_now = SSL_write(ssl, bytes + n_taken, (int)(n - n_taken));
        if (n_now > 0) {
            n_taken += (size_t)n_now;
            continue;
        }
        int reason = SSL_get_error(ssl, n_now);
        ERR_clear_error();
        return reason == SSL_ERROR_WANT_WRITE || reason == SSL_ERROR_WANT_READ ? (ssize_t)n_taken : -1;
    }
    return (ssize_t)n_taken;
}

/* Keeps bytes that were not taken. They are never more than were read at once. */
static bool keep(char **kept, size_t *n_kept, const char *bytes, size_t n)
{
    char *larger = realloc(*kept, *n_kept + n);
    if (!larger)
        return false;
    memcpy(larger + *n_kept, bytes, n);
    *kept = larger;
    *n_kept += n;
    return true;
}

static void drop(char **kept, size_t *n_kept)
{
    free(*kept);
    *kept = NULL;
    *n_kept = 0;
}

static bool is_hung_up(int socket)
{
    struct pollfd polled = { .fd = socket };
    return poll(&polled, 1, 0) == 1 && (polled.revents & (POLLHUP | POLLERR));
}

/* The server has ended its stream; it may still read what the client sends. */
static void begin_ending(struct tls_link *link)
{
    struct tls *tls = link->tls;
    ev_io_stop(tls->loop, &link->down);
    if (atomic_load(&tls->n_ending) >= TLS_MAX_ENDING) {
        tls_link_end(link);
        return;
    }
    set_stage(link, TLS_ENDING, TLS_ENDING_MS);
    if (link->n_to_client == 0)
        tell_end(link);
}

/* libev's: the pair has bytes for the client, or its other end was closed. */
static void pass_down(struct ev_loop *loop, struct ev_io *watcher, int events)
{
    struct tls_link *link = watcher->data;
    struct tls *tls = link->tls;
    ssize_t n = recv(link->pair, tls->bytes, sizeof tls->bytes, MSG_DONTWAIT);
    (void)events;
    if (n < 0 && would_block())
        return;
    if (n <= 0) {
        begin_ending(link);
        return;
    }
    ssize_t n_taken = send_to_client(link, tls->bytes, (size_t)n);
    if (n_taken < 0 ||
        (n_taken < n && !keep(&link->to_client, &link->n_to_client, tls->bytes + n_taken, (size_t)(n - n_taken)))) {
        tls_link_end(link);
        return;
    }
    if (link->n_to_client > 0) {
        ev_io_stop(loop, watcher);
        (void)lws_callback_on_writable(link->lws);
    }
}

/* The client takes more. Returns non-zero when the socket is to be closed. */
static int pass_kept_down(struct tls_link *link)
{
    if (link->n_to_client == 0) {
        if (link->stage == TLS_ENDING)
            tell_end(link);
        return 0;
    }
    ssize_t n_taken = send_to_client(link, link->to_client, link->n_to_client);
    if (n_taken < 0)
        return -1;
    link->n_to_client -= (size_t)n_taken;
    if (link->n_to_client > 0) {
        memmove(link->to_client, link->to_client + n_taken, link->n_to_client);
        (void)lws_callback_on_writable(link->lws);
        return 0;
    }
    drop(&link->to_client, &link->n_to_client);
    if (link->stage == TLS_ENDING)
        tell_end(link);
    else
        ev_io_start(link->tls->loop, &link->down);
    return 0;
}

/* ---- from the client -------------------------------------------------------------------------------------------- */

/* Sends what the pair takes now. Bytes for an end that was closed are dropped. */
static size_t send_to_pair(struct tls_link *link, const char *bytes, size_t n)
{
    if (link->is_pair_gone)
        return n;
    ssize_t n_taken = send(link->pair, bytes, n, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (n_taken >= 0)
        return (size_t)n_taken;
    link->is_pair_gone = !would_block();
    return link->is_pair_gone ? n : 0;
}

/* libev's: the pair takes more. */
static void pass_up(struct ev_loop *loop, struct ev_io *watcher, int events)
{
    struct tls_link *link = watcher->data;
    (void)events;
    size_t n_taken = send_to_pair(link, link->to_pair, link->n_to_pair);
    link->n_to_pair -= n_taken;
    if (link->n_to_pair > 0) {
        memmove(link->to_pair, link->to_pair + n_taken, link->n_to_pair);
        return;
    }
    drop(&link->to_pair, &link->n_to_pair);
    ev_io_stop(loop, watcher);
    if (link->stage == TLS_LEFT)
        free_link(link);
    else
        lws_rx_flow_control(link->lws, 1);
}

/* The first decrypted byte has come: makes the pair, and hands one end on. */
static bool open_pair(struct tls_link *link)
{
    struct tls *tls = link->tls;
    int ends[2];
    if (!gate_enter(tls->taking))
        return false;
    const bool is_made = socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends) == 0;
    if (is_made) {
        link->pair = ends[0];
        ev_io_init(&link->down, pass_down, link->pair, EV_READ);
        ev_io_init(&link->up, pass_up, link->pair, EV_WRITE);
        link->down.data = link->up.data = link;
        set_stage(link, TLS_OPEN, 0);
        ev_io_start(tls->loop, &link->down);
        tls->options.take(tls->options.context, ends[1], &link->peer);
    }
    gate_leave(tls->taking);
    return is_made;
}

static int received(struct tls_link *link, const char *bytes, size_t n)
{
    lws_set_timeout(link->lws, NO_PENDING_TIMEOUT, 0); /* the library set one when the handshake ended */
    if (link->stage == TLS_HANDSHAKE && !open_pair(link))
        return -1;
    size_t n_taken = link->n_to_pair > 0 ? 0 : send_to_pair(link, bytes, n);
    if (n_taken == n)
        return 0;
    if (!keep(&link->to_pair, &link->n_to_pair, bytes + n_taken, n - n_taken))
        return -1;
    lws_rx_flow_control(link->lws, 0);
    ev_io_start(link->tls->loop, &link->up);
    return 0;
}

/* The client, or tls_link_end, has ended the connection: the library closes the socket. */
static void left(struct tls_link *link)
{
    link->lws = NULL;
    ev_io_stop(link->tls->loop, &link->down);
    if (link->n_to_pair == 0 || link->is_pair_gone)
        free_link(link);
    else
        set_stage(link, TLS_LEFT, TLS_ENDING_MS);
}

int tls_link_handle(struct lws *lws, enum lws_callback_reasons reason, void *owner, void *bytes, size_t n)
{
    struct tls_link *link = owner;
    switch ((int)reason) {
    case LWS_CALLBACK_RAW_RX: return link ? received(link, bytes, n) : -1;
    case LWS_CALLBACK_RAW_WRITEABLE: return link ? pass_kept_down(link) : 0;
    case LWS_CALLBACK_RAW_CLOSE:
    case LWS_CALLBACK_WSI_DESTROY: /* alone where the handshake failed */
        lws_set_wsi_user(lws, NULL);
        if (link)
            left(link);
        return 0;
    default: return 0;
    }
}

/* ---- begin ------------------------------------------------------------------------------------------------------ */

/* Gives the socket to the library. */
static void begin_handshake(struct tls_link *link)
{
    struct tls *tls = link->tls;
    struct lws *lws = library_adopt(tls->vhost, tls->n_places, LWS_ADOPT_SOCKET | LWS_ADOPT_ALLOW_SSL, link->client,
                                    tls->protocols[0].name);
    if (!lws) { /* closed */
        free_link(link);
        return;
    }
    lws_set_timeout(lws, NO_PENDING_TIMEOUT, 0);
    lws_set_wsi_user(lws, link);
    link->lws = lws;
    link->stage = TLS_HANDSHAKE; /* counted like TLS_SILENT, and late at the same time */
}

/* The first byte has come, or the client has gone. */
static void look(struct tls_link *link)
{
    struct tls *tls = link->tls;
    unsigned char byte;
    ssize_t n = recv(link->client, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
    if (n < 0 && would_block())
        return;
    if (n == 1 && byte == RECORD_OF_HANDSHAKE) {
        unwatch_silent(link);
        begin_handshake(link);
        return;
    }
    if (n == 1 && gate_enter(tls->taking)) {
        unwatch_silent(link);
        tls->options.take_plain(tls->options.context, link->client, &link->peer);
        gate_leave(tls->taking);
        free_link(link);
        return;
    }
    tls_link_end(link);
}

void tls_link_look(struct ev_loop *loop, struct ev_io *watcher, int events)
{
    struct tls *tls = watcher->data;
    struct epoll_event found[64];
    (void)loop;
    (void)events;
    int n = epoll_wait(tls->silent, found, 64, 0);
    for (int i = 0; i < n; i++)
        look(found[i].data.ptr);
}

static bool may_wait(const struct tls *tls, const struct address *peer)
{
    const struct address counted = address_counted(peer);
    size_t n_same = 0;
    if (atomic_load(&tls->n_waiting) >= TLS_MAX_WAITING || atomic_load(&tls->is_closed))
        return false;
    if (address_is_in(peer, tls->options.trusted, tls->options.n_trusted))
        return true;
    for (const struct tls_link *link = tls->links; link; link = link->next) {
        if (link->stage != TLS_SILENT && link->stage != TLS_HANDSHAKE)
            continue;
        struct address other = address_counted(&link->peer);
        n_same += address_is_equal(&other, &counted);
    }
    return n_same < TLS_MAX_WAITING_PER_ADDRESS;
}

void tls_link_begin(struct tls *tls, int socket, const struct address *peer)
{
    int on = 1, unsent = TLS_UNSENT_AT_MOST;
    if (!may_wait(tls, peer)) {
        (void)close(socket);
        return;
    }
    struct tls_link *link = mem_new(sizeof *link);
    *link = (struct tls_link){ .next = tls->links, .tls = tls, .peer = *peer, .client = socket, .pair = -1 };
    if (tls->links)
        tls->links->previous = link;
    tls->links = link;
    (void)atomic_fetch_add(&tls->n_links, 1);
    count(tls, link->stage, true);
    set_stage(link, TLS_SILENT, TLS_FIRST_MS);
    /* these fail on other sockets than TCP, where they are not needed */
    (void)setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    (void)setsockopt(socket, IPPROTO_TCP, TCP_NOTSENT_LOWAT, &unsent, sizeof unsent);
    struct epoll_event event = { .events = EPOLLIN, .data.ptr = link };
    if (epoll_ctl(tls->silent, EPOLL_CTL_ADD, socket, &event) != 0)
        tls_link_end(link);
}

void tls_link_check(struct tls_link *link, int64_t now_us)
{
    if (link->stage == TLS_OPEN)
        return;
    if (link->stage == TLS_ENDING && link->is_told && !link->is_pair_gone) {
        /* the server reads and drops what the client still sends, and ends that by limits of its own */
        link->is_pair_gone = is_hung_up(link->pair);
        link->late_us = now_us + TLS_LINGER_MS * INT64_C(1000);
    }
    if (now_us >= link->late_us)
        tls_link_end(link);
}
