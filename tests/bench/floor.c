#include "tests/bench/floor.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <signal.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/timerfd.h>
#include <sys/uio.h>
#include <unistd.h>

enum { MOST = 256, AT_ONCE = 64, VIEW_AT = 12, SEQUENCE_AT = 16 };

struct client {
    int fd, n_unanswered;
};

static struct client clients[MOST];

static void must(int result)
{
    if (result < 0)
        _exit(1);
}

static void watch(int epoll, int fd, int at)
{
    struct epoll_event event = { .events = EPOLLIN, .data.fd = at };
    must(epoll_ctl(epoll, EPOLL_CTL_ADD, fd, &event));
}

/* Takes the request whatever it says. */
static int accept_one(int listener)
{
    static const char answer[] =
        "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\r\n";
    char bytes[4096];
    size_t n = 0;
    int fd = accept(listener, NULL, NULL), one = 1;
    must(fd);
    while (n < 4 || memcmp(bytes + n - 4, "\r\n\r\n", 4) != 0) {
        ssize_t more = n < sizeof bytes ? recv(fd, bytes + n, sizeof bytes - n, 0) : -1;
        must(more > 0 ? 0 : -1);
        n += (size_t)more;
    }
    must(send(fd, answer, sizeof answer - 1, MSG_NOSIGNAL) == (ssize_t)sizeof answer - 1 ? 0 : -1);
    must(setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one));
    return fd;
}

static void send_to_all(int n, uint8_t *bytes, size_t n_bytes, uint32_t sequence)
{
    uint8_t head[10] = { 0x82, 127 };
    for (int i = 0; i < 8; i++)
        head[2 + i] = (uint8_t)((uint64_t)n_bytes >> 8 * (7 - i));
    bytes[VIEW_AT] = 1;
    memcpy(bytes + SEQUENCE_AT, &sequence, sizeof sequence);
    for (int i = 0; i < n; i++) {
        struct iovec parts[] = { { head, sizeof head }, { bytes, n_bytes } };
        if (clients[i].n_unanswered >= 2)
            continue;
        clients[i].n_unanswered++;
        must(writev(clients[i].fd, parts, 2) == (ssize_t)(n_bytes + sizeof head) ? 0 : -1);
    }
}

/* Answers are shorter than 126 bytes, and masked. */
static void take_answers(struct client *client)
{
    uint8_t bytes[4096];
    ssize_t n = recv(client->fd, bytes, sizeof bytes, 0);
    if (n <= 0)
        _exit(0);
    for (ssize_t at = 0; at + 1 < n; at += 6 + (bytes[at + 1] & 0x7f))
        client->n_unanswered--;
}

static void serve(int listener, int n, size_t n_bytes, int rate)
{
    int epoll = epoll_create1(0), timer = timerfd_create(CLOCK_MONOTONIC, 0);
    uint8_t *bytes = calloc(1, n_bytes + SEQUENCE_AT + 4);
    const struct timespec every = { 0, 1000000000L / rate };
    must(bytes ? 0 : -1);
    for (int i = 0; i < n; i++) {
        clients[i].fd = accept_one(listener);
        watch(epoll, clients[i].fd, i);
    }
    must(timerfd_settime(timer, 0, &(struct itimerspec){ every, every }, NULL));
    watch(epoll, timer, -1);
    for (uint32_t sequence = 0;;) {
        struct epoll_event events[AT_ONCE];
        uint64_t n_times;
        int n_events = epoll_wait(epoll, events, AT_ONCE, -1);
        for (int i = 0; i < n_events; i++)
            if (events[i].data.fd >= 0)
                take_answers(&clients[events[i].data.fd]);
            else if (read(timer, &n_times, sizeof n_times) > 0)
                send_to_all(n, bytes, n_bytes, ++sequence);
    }
}

pid_t floor_start(int n, size_t n_bytes, int rate, int *port)
{
    struct sockaddr_in address = { .sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK) };
    socklen_t size = sizeof address;
    int listener = socket(AF_INET, SOCK_STREAM, 0);
    if (n > MOST || listener < 0 || bind(listener, (struct sockaddr *)&address, size) != 0 ||
        listen(listener, MOST) != 0 || getsockname(listener, (struct sockaddr *)&address, &size) != 0)
        return -1;
    *port = ntohs(address.sin_port);
    pid_t pid = fork();
    if (pid == 0) {
        (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
        serve(listener, n, n_bytes, rate);
    }
    (void)close(listener);
    return pid;
}
