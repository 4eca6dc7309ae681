#define _GNU_SOURCE
/* The thread: its loop, new connections, renewed certificates, late links, the end. */
#include "server/tls/tls.h"

#include <openssl/ssl.h>
#include <stdlib.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/base/gate.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "core/base/queue.h"
#include "server/tls/policy.h"
#include "server/tls/tls_link.h"
#include "server/ws/library.h"

#define TICK_S 0.5

struct accepted { /* a socket of tls_accept that the thread has not taken yet */
    int socket;
    struct address peer;
};

static void accepted_drop(void *item)
{
    struct accepted *accepted = item;
    (void)close(accepted->socket);
    free(accepted);
}

/* ---- the thread ------------------------------------------------------------------------------------------------- */

static void take_accepted(struct tls *tls)
{
    for (struct accepted *accepted; (accepted = queue_try_take(tls->accepted)); free(accepted))
        tls_link_begin(tls, accepted->socket, &accepted->peer);
}

static void end_waiting(struct tls *tls)
{
    for (struct tls_link *link = tls->links, *next; link; link = next) {
        next = link->next;
        if (link->stage == TLS_SILENT || link->stage == TLS_HANDSHAKE)
            tls_link_end(link);
    }
}

static void check_links(struct tls *tls)
{
    const int64_t now_us = clock_now_us();
    for (struct tls_link *link = tls->links, *next; link; link = next) {
        next = link->next;
        tls_link_check(link, now_us);
    }
}

/* libev's: another thread has something to say. */
static void wake_up(struct ev_loop *loop, struct ev_async *watcher, int events)
{
    struct tls *tls = watcher->data;
    (void)events;
    take_accepted(tls);
    struct certificate *renewed = atomic_exchange(&tls->renewed, NULL);
    if (renewed) { /* standing connections keep theirs */
        certificate_destroy(tls->certificate);
        tls->certificate = renewed;
    }
    atomic_bool *pinged = atomic_exchange(&tls->pinged, NULL);
    if (pinged)
        atomic_store(pinged, true);
    if (atomic_load(&tls->is_closed))
        end_waiting(tls);
    if (!atomic_load(&tls->is_stopping))
        return;
    tls->stop_us = clock_now_us() + TLS_STOP_MS * INT64_C(1000);
    if (!ev_is_active(&tls->tick))
        ev_timer_again(loop, &tls->tick);
    if (!tls->links)
        ev_break(loop, EVBREAK_ALL);
}

/* libev's */
static void tick(struct ev_loop *loop, struct ev_timer *timer, int events)
{
    struct tls *tls = timer->data;
    (void)events;
    check_links(tls);
    if (tls->stop_us && (!tls->links || clock_now_us() >= tls->stop_us))
        ev_break(loop, EVBREAK_ALL);
    else if (!tls->stop_us && atomic_load(&tls->n_waiting) == 0 && atomic_load(&tls->n_ending) == 0)
        ev_timer_stop(loop, timer);
}

static void *work(void *argument)
{
    struct tls *tls = argument;
    (void)pthread_setname_np(pthread_self(), "tls");
    (void)ev_run(tls->loop, 0);
    while (tls->links)
        tls_link_end(tls->links);
    return NULL;
}

/* ---- start and stop --------------------------------------------------------------------------------------------- */

/* OpenSSL's: a client has said hello. Returns 1 on success. */
static int give_certificate(SSL *ssl, void *context)
{
    return certificate_use(((struct tls *)context)->certificate, ssl) ? 1 : 0;
}

static int handle(struct lws *lws, enum lws_callback_reasons reason, void *owner, void *bytes, size_t n)
{
    if (reason != LWS_CALLBACK_OPENSSL_LOAD_EXTRA_SERVER_VERIFY_CERTS)
        return tls_link_handle(lws, reason, owner, bytes, n);
    struct tls *tls = lws_context_user(lws_get_context(lws)); /* the context of OpenSSL is made: it comes as owner */
    tls->ssl_ctx = owner;
    SSL_CTX_set_cert_cb(tls->ssl_ctx, give_certificate, tls);
    return 0;
}

static bool start_library(struct tls *tls)
{
    void *loops[1] = { tls->loop };
    struct lws_context_creation_info info = {
        .port = CONTEXT_PORT_NO_LISTEN_SERVER,
        .protocols = tls->protocols,
        .vhost_name = "tls",
        .user = tls,
        .count_threads = 1,
        .options = LWS_SERVER_OPTION_EXPLICIT_VHOSTS | LWS_SERVER_OPTION_LIBEV | LWS_SERVER_OPTION_DO_SSL_GLOBAL_INIT |
                   LWS_SERVER_OPTION_CREATE_VHOST_SSL_CTX,
        .foreign_loops = loops,
        .alpn = "http/1.1",
        .pt_serv_buf_size = LWS_PRE + TLS_READ_AT_ONCE,
        .fd_limit_per_thread = 0 /* as many as the process may have: with less, each event searches a table */
    };
    tls->n_places = library_places();
    tls->context = lws_create_context(&info);
    tls->vhost = tls->context ? lws_create_vhost(tls->context, &info) : NULL;
    return tls->vhost && tls->ssl_ctx && policy_set(tls->ssl_ctx);
}

static void describe(const struct certificate *certificate)
{
    char text[CERTIFICATE_TEXT];
    certificate_describe(certificate, text);
    if (certificate_is_out_of_date(certificate))
        log_warn("TLS: the certificate is not valid today: %s", text);
    else
        log_info("TLS: certificate of %s", text);
}

static bool start(struct tls *tls, struct error *err)
{
    tls->certificate = certificate_read(tls->options.cert_file, tls->options.key_file, err);
    if (!tls->certificate)
        return false;
    library_log_start();
    tls->loop = ev_loop_new(EVBACKEND_EPOLL | EVFLAG_NOENV);
    tls->silent = epoll_create1(EPOLL_CLOEXEC);
    if (!tls->loop || tls->silent < 0 || !start_library(tls))
        return error_set(err, ERROR_IO, "TLS has no loop: libwebsockets or its libev plugin cannot be started");
    ev_async_init(&tls->woken, wake_up);
    ev_init(&tls->tick, tick);
    tls->woken.data = tls->tick.data = tls;
    tls->tick.repeat = TICK_S;
    ev_async_start(tls->loop, &tls->woken);
    ev_io_init(&tls->heard, tls_link_look, tls->silent, EV_READ);
    tls->heard.data = tls;
    ev_io_start(tls->loop, &tls->heard);
    tls->has_thread = pthread_create(&tls->thread, NULL, work, tls) == 0;
    if (!tls->has_thread)
        return error_set(err, ERROR_IO, "the thread of TLS did not start");
    describe(tls->certificate);
    return true;
}

struct tls *tls_create(const struct tls_options *options, struct error *err)
{
    struct tls *tls = mem_new(sizeof *tls);
    tls->options = *options;
    tls->protocols[0] = (struct lws_protocols){ .name = "tls", .callback = handle };
    tls->silent = -1;
    atomic_init(&tls->renewed, NULL);
    atomic_init(&tls->pinged, NULL);
    atomic_init(&tls->is_closed, false);
    atomic_init(&tls->is_stopping, false);
    atomic_init(&tls->n_links, 0);
    atomic_init(&tls->n_waiting, 0);
    atomic_init(&tls->n_ending, 0);
    tls->accepted = queue_create(TLS_MAX_QUEUED, accepted_drop);
    tls->taking = gate_create();
    if (start(tls, err))
        return tls;
    tls_destroy(tls);
    return NULL;
}

static void wake(struct tls *tls)
{
    ev_async_send(tls->loop, &tls->woken);
}

void tls_accept(struct tls *tls, int socket, const struct address *peer)
{
    struct accepted *accepted = mem_new(sizeof *accepted);
    *accepted = (struct accepted){ socket, *peer };
    if (queue_try_put(tls->accepted, accepted))
        wake(tls);
    else
        accepted_drop(accepted);
}

bool tls_reload(struct tls *tls, struct error *err)
{
    struct certificate *renewed = certificate_read(tls->options.cert_file, tls->options.key_file, err);
    if (!renewed)
        return false;
    describe(renewed);
    certificate_destroy(atomic_exchange(&tls->renewed, renewed));
    wake(tls);
    return true;
}

void tls_ping(struct tls *tls, atomic_bool *beat)
{
    atomic_store(&tls->pinged, beat);
    wake(tls);
}

struct tls_counts tls_count(struct tls *tls)
{
    return (struct tls_counts){ atomic_load(&tls->n_links), atomic_load(&tls->n_waiting), atomic_load(&tls->n_ending) };
}

void tls_close(struct tls *tls)
{
    atomic_store(&tls->is_closed, true);
    wake(tls);
    gate_close(tls->taking);
}

void tls_destroy(struct tls *tls)
{
    if (!tls)
        return;
    if (tls->has_thread) {
        atomic_store(&tls->is_stopping, true);
        wake(tls);
        (void)pthread_join(tls->thread, NULL);
    }
    if (tls->context)
        lws_context_destroy(tls->context);
    if (tls->loop)
        ev_loop_destroy(tls->loop);
    if (tls->silent >= 0)
        (void)close(tls->silent);
    certificate_destroy(tls->certificate);
    certificate_destroy(atomic_load(&tls->renewed));
    queue_destroy(tls->accepted);
    gate_destroy(tls->taking);
    free(tls);
}
