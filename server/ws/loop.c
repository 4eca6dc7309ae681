/* Waits by epoll(7): the kernel reports the sockets that have something, whatever the number of those that have not. */
#include "server/ws/loop.h"

#include <errno.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/base/log.h"

static char wake_tag, timer_tag; /* their addresses mark the events of wake_fd and timer_fd */

bool loop_init(struct loop *loop, struct error *err)
{
    *loop = (struct loop){ .epoll = epoll_create1(EPOLL_CLOEXEC),
                           .wake_fd = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC),
                           .timer_fd = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC),
                           .armed_us = INT64_MAX };
    if (loop->epoll >= 0 && loop->wake_fd >= 0 && loop->timer_fd >= 0 && loop_add(loop, loop->wake_fd, &wake_tag) &&
        loop_add(loop, loop->timer_fd, &timer_tag))
        return true;
    return error_set(err, ERROR_IO, "the net thread has no descriptors: %s", strerror(errno));
}

void loop_finish(struct loop *loop)
{
    const int fds[] = { loop->epoll, loop->wake_fd, loop->timer_fd };
    for (size_t i = 0; i < sizeof fds / sizeof fds[0]; i++)
        if (fds[i] >= 0)
            (void)close(fds[i]);
}

bool loop_add(struct loop *loop, int fd, void *owner)
{
    struct epoll_event event = { .events = EPOLLIN, .data.ptr = owner };
    return epoll_ctl(loop->epoll, EPOLL_CTL_ADD, fd, &event) == 0;
}

void loop_set_wants_room(struct loop *loop, int fd, void *owner, bool wants_room)
{
    struct epoll_event event = { .events = EPOLLIN | (wants_room ? EPOLLOUT : 0), .data.ptr = owner };
    (void)epoll_ctl(loop->epoll, EPOLL_CTL_MOD, fd, &event); /* cannot fail for a socket that was added */
}

void loop_remove(struct loop *loop, int fd)
{
    /* A child process that is being started holds a copy of every descriptor for a moment: one that was only closed
     * would go on raising events. */
    (void)epoll_ctl(loop->epoll, EPOLL_CTL_DEL, fd, NULL);
}

void loop_wake(struct loop *loop)
{
    uint64_t one = 1;
    if (write(loop->wake_fd, &one, sizeof one) != sizeof one)
        log_debug("net: the thread is woken already"); /* the counter is full: the thread is about to run */
}

/* The timer is set only to fire earlier: a time that moves away, as with each picture, costs no call. */
static void arm(struct loop *loop, int64_t until_us)
{
    struct itimerspec when = { .it_value = { until_us / 1000000, until_us % 1000000 * 1000 } };
    if (until_us >= loop->armed_us)
        return;
    loop->armed_us = until_us;
    (void)timerfd_settime(loop->timer_fd, TFD_TIMER_ABSTIME, &when, NULL);
}

static void drain(int fd)
{
    uint64_t n_times;
    if (read(fd, &n_times, sizeof n_times) < 0) {
        /* nothing: it was read already */
    }
}

void loop_wait(struct loop *loop, int64_t until_us, struct loop_events *events)
{
    struct epoll_event found[LOOP_AT_ONCE];
    const bool is_due = until_us <= clock_now_us();
    if (!is_due)
        arm(loop, until_us);
    int n = epoll_wait(loop->epoll, found, LOOP_AT_ONCE, is_due ? 0 : -1);
    events->n = 0;
    events->is_woken = false;
    for (int i = 0; i < n; i++) {
        if (found[i].data.ptr == &wake_tag) {
            drain(loop->wake_fd);
            events->is_woken = true;
        } else if (found[i].data.ptr == &timer_tag) {
            drain(loop->timer_fd);
            loop->armed_us = INT64_MAX;
        } else {
            events->of[events->n++] = (struct loop_event){ .owner = found[i].data.ptr,
                                                           .is_readable = found[i].events & EPOLLIN,
                                                           .takes_more = found[i].events & EPOLLOUT,
                                                           .has_ended = found[i].events & (EPOLLHUP | EPOLLERR) };
        }
    }
}
