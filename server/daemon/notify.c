/* Sends datagrams to the service manager. */
#define _GNU_SOURCE
#include "server/daemon/notify.h"

#include <errno.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "core/base/log.h"

static int sender = -1; /* -1: there is no service manager */
static int64_t watchdog_us;

void notify_open(void)
{
    const char *path = getenv("NOTIFY_SOCKET"), *usec = getenv("WATCHDOG_USEC"), *pid = getenv("WATCHDOG_PID");
    struct sockaddr_un manager = { .sun_family = AF_UNIX };
    size_t n = path ? strlen(path) : 0;
    if (n > 1 && n < sizeof manager.sun_path && (path[0] == '/' || path[0] == '@')) {
        memcpy(manager.sun_path, path, n);
        if (path[0] == '@')
            manager.sun_path[0] = 0; /* an abstract socket */
        sender = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
        if (sender >= 0 && connect(sender, (const struct sockaddr *)&manager,
                                   (socklen_t)(offsetof(struct sockaddr_un, sun_path) + n)) != 0) {
            log_warn("the service manager cannot be reached at NOTIFY_SOCKET: %s", strerror(errno));
            (void)close(sender);
            sender = -1;
        }
    } else if (n > 0) {
        log_warn("NOTIFY_SOCKET is \"%.120s\"; expected is a path or @name of at most %zu bytes", path,
                 sizeof manager.sun_path - 1);
    }
    if (usec && sender >= 0 && (!pid || strtoll(pid, NULL, 10) == (long long)getpid())) {
        long long given = strtoll(usec, NULL, 10);
        watchdog_us = given > 0 ? given : 0;
    }
    (void)unsetenv("NOTIFY_SOCKET");
    (void)unsetenv("WATCHDOG_USEC");
    (void)unsetenv("WATCHDOG_PID");
}

void notify_send(const char *state)
{
    if (sender >= 0 && send(sender, state, strlen(state), MSG_NOSIGNAL | MSG_DONTWAIT) < 0)
        log_warn("the service manager was not told %s: %s", state, strerror(errno));
}

int64_t notify_watchdog_us(void)
{
    return watchdog_us;
}
