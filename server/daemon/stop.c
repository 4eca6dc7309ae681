/* Waits for SIGINT and SIGTERM on a thread of its own, and ends the process if it does not stop in time. */
#define _GNU_SOURCE
#include "server/daemon/stop.h"

#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <string.h>
#include <sys/eventfd.h>
#include <time.h>
#include <unistd.h>

#include "core/base/log.h"

static int stop_fd = -1; /* eventfd, readable from the first signal on */

static void *wait_for_signal(void *argument)
{
    sigset_t signals;
    int number = 0;
    uint64_t one = 1;
    (void)argument;
    sigemptyset(&signals);
    sigaddset(&signals, SIGINT);
    sigaddset(&signals, SIGTERM);
    while (sigwait(&signals, &number) != 0)
        ;
    (void)alarm(STOP_WITHIN_AT_MOST_S); /* the default action of SIGALRM ends the process */
    if (write(stop_fd, &one, sizeof one) != sizeof one)
        log_error("the main thread was not told of %s: %s", strsignal(number), strerror(errno));
    log_info("stopping: %s", strsignal(number));
    struct timespec left = { .tv_sec = STOP_WITHIN_S };
    while (nanosleep(&left, &left) != 0 && errno == EINTR)
        ;
    log_error("a thread has not ended within %d s of %s: the process ends without it", STOP_WITHIN_S,
              strsignal(number));
    _exit(1);
}

bool stop_watch(struct error *err)
{
    sigset_t signals, alarm_signal;
    pthread_t thread;
    stop_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (stop_fd < 0)
        return error_set(err, ERROR_IO, "no descriptor for signals: %s", strerror(errno));
    sigemptyset(&signals);
    sigaddset(&signals, SIGINT);
    sigaddset(&signals, SIGTERM);
    (void)pthread_sigmask(SIG_BLOCK, &signals, NULL);
    (void)signal(SIGALRM, SIG_DFL); /* the parent process may have ignored or blocked it */
    sigemptyset(&alarm_signal);
    sigaddset(&alarm_signal, SIGALRM);
    (void)pthread_sigmask(SIG_UNBLOCK, &alarm_signal, NULL);
    int failed = pthread_create(&thread, NULL, wait_for_signal, NULL);
    if (failed)
        return error_set(err, ERROR_IO, "no thread for signals: %s", strerror(failed));
    (void)pthread_detach(thread); /* it ends with the process */
    return true;
}

bool stop_wait(int64_t wait_us)
{
    struct pollfd polled = { .fd = stop_fd, .events = POLLIN };
    int wait_ms = wait_us < 0 ? -1 : wait_us / 1000 < 3600000 ? (int)(wait_us / 1000) : 3600000;
    return poll(&polled, 1, wait_ms) == 1;
}
