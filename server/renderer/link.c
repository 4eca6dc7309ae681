/* The socket to the daemon: a queue of bytes to write, a reader of packets. */
#include "server/renderer/link.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"

struct outgoing {
    struct outgoing *next;
    uint8_t *bytes;
    size_t n_bytes, n_sent;
};

struct link {
    int socket;
    struct packet_reader *reader;
    struct outgoing *first, **last;
    uint64_t max_bytes;
    bool is_broken;
};

struct link *link_create(int socket, uint64_t max_bytes)
{
    struct link *link = mem_new(sizeof *link);
    link->socket = socket;
    link->max_bytes = max_bytes;
    link->reader = packet_reader_create(PACKET_TO_RENDERER);
    link->last = &link->first;
    int flags = fcntl(socket, F_GETFL);
    link->is_broken = flags < 0 || fcntl(socket, F_SETFL, flags | O_NONBLOCK) != 0;
    return link;
}

static void drop_first(struct link *link)
{
    struct outgoing *first = link->first;
    link->first = first->next;
    if (!link->first)
        link->last = &link->first;
    free(first->bytes);
    free(first);
}

void link_destroy(struct link *link)
{
    if (!link)
        return;
    while (link->first)
        drop_first(link);
    packet_reader_destroy(link->reader);
    close(link->socket);
    free(link);
}

int link_file(const struct link *link)
{
    return link->socket;
}

bool link_has_outgoing(const struct link *link)
{
    return link->first != NULL;
}

void link_write(struct link *link)
{
    while (link->first) {
        struct outgoing *out = link->first;
        ssize_t n = send(link->socket, out->bytes + out->n_sent, out->n_bytes - out->n_sent, MSG_NOSIGNAL);
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0)
            return; /* the socket is full, or closed: link_read notices that */
        out->n_sent += (size_t)n;
        if (out->n_sent == out->n_bytes)
            drop_first(link);
    }
}

static bool put(struct link *link, const struct packet *packet, const uint8_t *blob, size_t n_blob,
                struct problem *problem)
{
    size_t n_bytes;
    uint8_t *bytes = packet_encode(packet, blob, n_blob, &n_bytes, problem);
    if (!bytes)
        return false;
    struct outgoing *out = mem_new(sizeof *out);
    *out = (struct outgoing){ .bytes = bytes, .n_bytes = n_bytes };
    *link->last = out;
    link->last = &out->next;
    link_write(link);
    return true;
}

void link_send(struct link *link, const struct packet *packet, const uint8_t *blob, size_t n_blob)
{
    struct problem problem = { 0 };
    if (put(link, packet, blob, n_blob, &problem))
        return;
    log_error("a packet \"%s\" cannot be sent: %s", packet_descriptions[packet->type].name, problem.detail);
    if (packet->type == PACKET_PROBLEM || packet->type == PACKET_FAILED)
        link->is_broken = true;
    else if (packet_id(packet) >= 0)
        link_send_problem(link, packet_id(packet), &problem);
    else
        link_send_failed(link, &problem);
}

/* Adds to a problem with memory how much memory the process may take. */
static void add_memory_limit(struct problem *problem, uint64_t max_bytes)
{
    char detail[sizeof problem->detail];
    if (problem->type != PROBLEM_MEMORY || max_bytes == 0)
        return;
    memcpy(detail, problem->detail, sizeof detail);
    (void)snprintf(problem->detail, sizeof problem->detail,
                   "%.*s; the renderer of a plan may take %llu MiB (max-renderer-mib)", (int)sizeof detail - 80, detail,
                   (unsigned long long)(max_bytes >> 20));
    problem->facts = (struct sentence_facts){ 0 }; /* it is another sentence now */
}

void link_send_problem(struct link *link, int64_t id, const struct problem *problem)
{
    struct packet packet;
    packet_init(&packet, PACKET_PROBLEM);
    packet.problem.id = id;
    packet.problem.problem = *problem;
    add_memory_limit(&packet.problem.problem, link->max_bytes);
    link_send(link, &packet, NULL, 0);
}

void link_send_failed(struct link *link, const struct problem *problem)
{
    struct packet packet;
    packet_init(&packet, PACKET_FAILED);
    packet.failed.problem = *problem;
    link_send(link, &packet, NULL, 0);
}

bool link_read(struct link *link)
{
    for (int round = 0; round < 16 && !link->is_broken; round++) {
        size_t room = 0;
        struct error err = { 0 };
        uint8_t *space = packet_reader_space(link->reader, &room, &err);
        if (!space) {
            log_error("%s", err.text);
            link->is_broken = true;
            break;
        }
        ssize_t n = recv(link->socket, space, room, 0);
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK))
            break;
        if (n <= 0)
            return false;
        packet_reader_added(link->reader, (size_t)n);
        if ((size_t)n < room)
            break;
    }
    return !link->is_broken;
}

int link_take(struct link *link, struct packet *packet)
{
    struct error err = { 0 };
    int got = packet_reader_take(link->reader, packet, &err);
    if (got < 0)
        log_error("the daemon sent what is no packet: %s", err.text);
    return got;
}

void link_flush(struct link *link, int timeout_ms)
{
    int64_t until_us = clock_now_us() + timeout_ms * 1000LL;
    while (link_has_outgoing(link) && clock_now_us() < until_us) {
        struct pollfd polled = { .fd = link->socket, .events = POLLOUT };
        if (poll(&polled, 1, 50) > 0 && (polled.revents & (POLLERR | POLLHUP)))
            return;
        link_write(link);
    }
}
