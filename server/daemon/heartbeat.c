/* Has each serving thread set a mark, and reports to the service manager when all have. */
#include "server/daemon/heartbeat.h"

#include <stdatomic.h>
#include <stdlib.h>

#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/daemon/notify.h"
#include "server/front/front.h"
#include "server/net/net.h"
#include "server/tls/tls.h"

enum { NET, FRONT, TLS, N_THREADS };

struct heartbeat {
    struct net *net;
    struct front *front;
    struct tls *tls;
    atomic_bool has_moved[N_THREADS]; /* since the last round began */
    bool is_late;                     /* a late thread was logged in the last round */
};

static void mark(struct net *net, void *moved)
{
    (void)net;
    atomic_store((atomic_bool *)moved, true);
}

static void begin_round(struct heartbeat *heartbeat)
{
    for (int i = 0; i < N_THREADS; i++)
        atomic_store(&heartbeat->has_moved[i], false);
    net_post(heartbeat->net, mark, &heartbeat->has_moved[NET]);
    front_ping(heartbeat->front, &heartbeat->has_moved[FRONT]);
    if (heartbeat->tls)
        tls_ping(heartbeat->tls, &heartbeat->has_moved[TLS]);
    else
        atomic_store(&heartbeat->has_moved[TLS], true);
}

struct heartbeat *heartbeat_create(struct net *net, struct front *front, struct tls *tls)
{
    struct heartbeat *heartbeat = mem_new(sizeof *heartbeat);
    heartbeat->net = net;
    heartbeat->front = front;
    heartbeat->tls = tls;
    if (notify_watchdog_us() > 0)
        begin_round(heartbeat);
    return heartbeat;
}

void heartbeat_destroy(struct heartbeat *heartbeat)
{
    free(heartbeat);
}

int64_t heartbeat_wait_us(const struct heartbeat *heartbeat)
{
    (void)heartbeat;
    return notify_watchdog_us() > 0 ? notify_watchdog_us() / HEARTBEAT_PARTS : -1;
}

void heartbeat_beat(struct heartbeat *heartbeat)
{
    static const char *const names[N_THREADS] = { "net", "front", "tls" };
    bool have_all_moved = true;
    for (int i = 0; i < N_THREADS; i++) {
        bool has_moved = atomic_load(&heartbeat->has_moved[i]);
        if (!has_moved && !heartbeat->is_late)
            log_warn("the %s thread has not moved for %lld ms", names[i],
                     (long long)(heartbeat_wait_us(heartbeat) / 1000));
        have_all_moved = have_all_moved && has_moved;
    }
    heartbeat->is_late = !have_all_moved;
    if (!have_all_moved)
        return; /* no new round: it would fill the queue of the thread that hangs */
    notify_send("WATCHDOG=1");
    begin_round(heartbeat);
}
