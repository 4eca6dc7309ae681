/* Waits for SIGINT, SIGTERM and SIGHUP on a thread of its own, and ends the process if it does not stop in time. */
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

static int stop_fd = -1;    /* eventfd, readable from the first signal to stop on */
static int reload_fd = -1;  /* eventfd, readable when a reload is due */
static bool is_of_terminal; /* at the start, standard error was a terminal */

static void fill(sigset_t *signals)
{
    sigemptyset(signals);
    sigaddset(signals, SIGINT);
    sigaddset(signals, SIGTERM);
    sigaddset(signals, SIGHUP);
}

/* Waits for a signal to stop. */
static int wait_to_stop(void)
{
    sigset_t signals;
    uint64_t one = 1;
    fill(&signals);
    for (int number = 0;;) {
        if (sigwait(&signals, &number) != 0)
            continue;
        if (number != SIGHUP || (is_of_terminal && !isatty(STDERR_FILENO)))
            return number;
        if (write(reload_fd, &one, sizeof one) != sizeof one)
            log_error("the main thread was not told of SIGHUP: %s", strerror(errno));
    }
}

static void *wait_for_signal(void *argument)
{
    uint64_t one = 1;
    (void)argument;
    int number = wait_to_stop();
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
    reload_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (stop_fd < 0 || reload_fd < 0)
        return error_set(err, ERROR_IO, "no descriptor for signals: %s", strerror(errno));
    is_of_terminal = isatty(STDERR_FILENO);
    fill(&signals);
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

static int to_ms(int64_t wait_us)
{
    return wait_us < 0 ? -1 : wait_us / 1000 < 3600000 ? (int)(wait_us / 1000) : 3600000;
}

bool stop_wait(int64_t wait_us)
{
    struct pollfd polled = { .fd = stop_fd, .events = POLLIN };
    return poll(&polled, 1, to_ms(wait_us)) == 1;
}

enum stop_signal stop_wait_or_reload(int64_t wait_us)
{
    uint64_t n;
    struct pollfd polled[2] = { { .fd = stop_fd, .events = POLLIN }, { .fd = reload_fd, .events = POLLIN } };
    (void)poll(polled, 2, to_ms(wait_us));
    if (stop_wait(0))
        return STOP_STOPS;
    return read(reload_fd, &n, sizeof n) == sizeof n ? STOP_RELOADS : STOP_NO_SIGNAL;
}
