/* libwebsockets with libev as its loop. Times are those of an own timerfd: the library's timers fire late in this loop
 * when an earlier one is set, and would be one for each connection. */
#include "server/ws/sockets.h"

#include <ev.h>
#include <libwebsockets.h>
#include <stdlib.h>
#include <string.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "server/ws/library.h"

/* Between two looks at the sockets pass at least so many seconds: what came meanwhile is handled together. The first
 * look after a rest is at once. Followers acknowledge a picture one after the other within a millisecond; each by
 * itself would take two calls of epoll_wait, as the library's plugin has one more for what is idle. */
#define COLLECT_S 0.0002

struct sockets {
    const struct sockets_calls *calls;
    struct lws_protocols protocols[2];
    struct ev_loop *loop;
    struct lws_context *context;
    struct lws_vhost *vhost;
    int timer_fd;
    int n_places;     /* descriptors below have one in the library's table */
    int64_t armed_us; /* when timer_fd fires; INT64_MAX: never */
    bool is_woken;
};

static struct sockets *sockets_of(struct lws *lws)
{
    return lws_context_user(lws_get_context(lws));
}

static void drain_timer(struct sockets *sockets)
{
    uint64_t n_times;
    sockets->armed_us = INT64_MAX;
    if (read(sockets->timer_fd, &n_times, sizeof n_times) < 0) {
        /* nothing: it was read already */
    }
}

/* The library's one callback. owner: a struct socket, or NULL. Non-zero closes the socket. */
static int handle(struct lws *lws, enum lws_callback_reasons reason, void *owner, void *bytes, size_t n)
{
    struct socket *socket = owner;
    switch ((int)reason) {
    case LWS_CALLBACK_RAW_RX: return socket ? socket->calls->received(socket, bytes, n) : -1;
    case LWS_CALLBACK_RAW_WRITEABLE: return socket ? socket->calls->takes_more(socket) : 0;
    case LWS_CALLBACK_RAW_CLOSE:
        lws_set_wsi_user(lws, NULL);
        if (socket)
            socket->calls->ended(socket);
        return 0;
    case LWS_CALLBACK_RAW_RX_FILE: drain_timer(sockets_of(lws)); return 0;
    case LWS_CALLBACK_EVENT_WAIT_CANCELLED: sockets_of(lws)->is_woken = true; return 0; /* may come more than once */
    default: return 0;
    }
}

static bool start_library(struct sockets *sockets)
{
    void *loops[1] = { sockets->loop };
    struct lws_context_creation_info info = {
        .port = CONTEXT_PORT_NO_LISTEN_SERVER,
        .protocols = sockets->protocols,
        .vhost_name = "rooms",
        .user = sockets,
        .count_threads = 1,
        .options = LWS_SERVER_OPTION_EXPLICIT_VHOSTS | LWS_SERVER_OPTION_LIBEV,
        .foreign_loops = loops,
        .pt_serv_buf_size = LWS_PRE + SOCKETS_READ_AT_ONCE,
        .fd_limit_per_thread = 0 /* as many as the process may have: with less, each event searches a table */
    };
    sockets->context = lws_create_context(&info);
    sockets->vhost = sockets->context ? lws_create_vhost(sockets->context, &info) : NULL;
    return sockets->vhost != NULL;
}

static bool add_timer(struct sockets *sockets)
{
    sockets->timer_fd = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
    return sockets->timer_fd >= 0 && library_adopt(sockets->vhost, sockets->n_places, LWS_ADOPT_RAW_FILE_DESC,
                                                   sockets->timer_fd, sockets->protocols[0].name);
}

struct sockets *sockets_create(const struct sockets_calls *calls, struct error *err)
{
    struct sockets *sockets = mem_new(sizeof *sockets);
    sockets->calls = calls;
    sockets->n_places = library_places();
    sockets->protocols[0] = (struct lws_protocols){ .name = "raw", .callback = handle };
    sockets->armed_us = INT64_MAX;
    library_log_start();
    sockets->loop = ev_loop_new(EVBACKEND_EPOLL | EVFLAG_NOENV);
    if (sockets->loop)
        ev_set_io_collect_interval(sockets->loop, COLLECT_S);
    if (sockets->loop && start_library(sockets) && add_timer(sockets))
        return sockets;
    error_set(err, ERROR_IO, "the net thread has no loop: libwebsockets or its libev plugin cannot be started");
    sockets_destroy(sockets);
    return NULL;
}

void sockets_destroy(struct sockets *sockets)
{
    if (!sockets)
        return;
    if (sockets->context)
        lws_context_destroy(sockets->context); /* closes the timer */
    if (sockets->loop)
        ev_loop_destroy(sockets->loop);
    free(sockets);
}

bool sockets_add(struct sockets *sockets, struct socket *socket, int fd)
{
    struct lws *lws =
        library_adopt(sockets->vhost, sockets->n_places, LWS_ADOPT_SOCKET, fd, sockets->protocols[0].name);
    if (!lws)
        return false;
    lws_set_timeout(lws, NO_PENDING_TIMEOUT, 0); /* or it is cut after some seconds */
    lws_set_wsi_user(lws, socket);
    *socket = (struct socket){ sockets->calls, lws, fd };
    return true;
}

void sockets_ask_room(struct socket *socket)
{
    (void)lws_callback_on_writable(socket->lws);
}

void sockets_close(struct socket *socket)
{
    lws_set_timeout(socket->lws, PENDING_TIMEOUT_CLOSE_SEND, LWS_TO_KILL_SYNC);
}

void sockets_wake(struct sockets *sockets)
{
    lws_cancel_service(sockets->context);
}

/* The timer is set only to fire earlier: a time that moves away, as with each picture, costs no call. */
static void arm(struct sockets *sockets, int64_t until_us)
{
    struct itimerspec when = { .it_value = { until_us / 1000000, until_us % 1000000 * 1000 } };
    if (until_us >= sockets->armed_us)
        return;
    sockets->armed_us = until_us;
    (void)timerfd_settime(sockets->timer_fd, TFD_TIMER_ABSTIME, &when, NULL);
}

bool sockets_wait(struct sockets *sockets, int64_t until_us)
{
    const bool is_due = until_us <= clock_now_us();
    if (!is_due)
        arm(sockets, until_us);
    sockets->is_woken = false;
    (void)ev_run(sockets->loop, is_due ? EVRUN_NOWAIT : EVRUN_ONCE);
    return sockets->is_woken;
}
