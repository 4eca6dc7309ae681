/* Reads from, writes to, limits and ends one child process; on the watch's thread. */
#include "server/fleet/process.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/mem.h"

enum {
    READ_ROUND = 4 << 20, /* bytes read from one process before it is the next one's turn */
    MEMORY_EVERY_US = 1000000,
    STOP_GRACE_US = 1000000, /* to end by itself after its socket was closed */
    DRAIN_US = 500000,       /* to read the rest of the socket after the end */
    JSON_WEIGHT = 16         /* a parsed JSON document takes about this many times the bytes of its text */
};

struct chunk { /* a packet that waits to be sent */
    struct chunk *next;
    uint8_t *bytes;
    size_t n_bytes, n_sent;
};

struct process {
    uint64_t number;
    bool is_program; /* output to a pipe; else a renderer, packets over a socket */
    bool has_progress;
    int limit_ms;
    struct child child;
    struct process_events events;
    struct packet_reader *reader;
    struct event_backlog *backlog;
    struct chunk *outgoing, **last; /* oldest first */
    size_t n_outgoing;              /* bytes */
    char *output;                   /* a program's; PROCESS_MAX_OUTPUT + 1 bytes, NULL before the first */
    size_t n_output;
    uint64_t n_since_packet; /* bytes received since the last whole packet */
    int64_t heard_us;        /* when bytes last came */
    int64_t spoke_us;        /* when a packet last went either way, but for pings */
    int64_t kill_at_us;      /* when it is killed after its socket was closed; INT64_MAX: not planned */
    int64_t limit_at_us;     /* when a program's time is over */
    int64_t memory_at_us;    /* when its memory is measured next */
    int64_t drain_until_us;  /* after its end: its socket is read until then */
    int64_t pinged_us;       /* when the unanswered ping was sent; 0: there is none */
    bool has_ended, is_stopping, is_awaited;
    int status;
    char reason[240];
};

static struct watch_event *event_new(const struct process *process, enum watch_event_type type)
{
    return watch_event_create(type, process->number);
}

static void put_event(struct process *process, struct watch_event *event)
{
    process->events.put(process->events.context, event);
}

struct process *process_create(uint64_t number, char *const argv[], int limit_ms, bool has_progress,
                               const struct process_events *events, int64_t now_us)
{
    struct process *process = mem_new(sizeof *process);
    process->number = number;
    process->is_program = limit_ms > 0;
    process->has_progress = has_progress;
    process->limit_ms = limit_ms;
    process->events = *events;
    process->last = &process->outgoing;
    process->heard_us = process->spoke_us = now_us;
    process->memory_at_us = now_us;
    process->limit_at_us = limit_ms > 0 ? now_us + (int64_t)limit_ms * 1000 : INT64_MAX;
    process->kill_at_us = INT64_MAX;
    process->backlog = event_backlog_create();
    if (!process->is_program)
        process->reader = packet_reader_create(PACKET_TO_DAEMON);
    struct error err = { 0 };
    if (!spawn_child(argv, process->is_program ? SPAWN_OUTPUT : SPAWN_SOCKET, &process->child, &err)) {
        (void)snprintf(process->reason, sizeof process->reason, "%s", err.text);
        process->has_ended = true;
        process->drain_until_us = now_us;
        return process;
    }
    struct watch_event *event = event_new(process, WATCH_STARTED);
    event->pid = process->child.pid;
    put_event(process, event);
    return process;
}

static void close_channel(struct process *process)
{
    if (process->child.channel >= 0)
        close(process->child.channel);
    process->child.channel = -1;
    while (process->outgoing) {
        struct chunk *next = process->outgoing->next;
        free(process->outgoing->bytes);
        free(process->outgoing);
        process->outgoing = next;
    }
    process->last = &process->outgoing;
    process->n_outgoing = 0;
}

void process_destroy(struct process *process)
{
    if (!process)
        return;
    if (!process->has_ended) {
        kill(-process->child.pid, SIGKILL);
        while (waitpid(process->child.pid, NULL, 0) < 0 && errno == EINTR)
            continue;
    }
    close_channel(process);
    if (process->child.pid_file >= 0)
        close(process->child.pid_file);
    packet_reader_destroy(process->reader);
    event_backlog_unref(process->backlog);
    free(process->output);
    free(process);
}

uint64_t process_number(const struct process *process)
{
    return process->number;
}

static void set_reason(struct process *process, const char *reason)
{
    if (!process->reason[0])
        (void)snprintf(process->reason, sizeof process->reason, "%s", reason);
}

void process_stop(struct process *process, bool at_once, const char *reason, int64_t now_us)
{
    if (process->has_ended)
        return;
    set_reason(process, reason);
    process->is_stopping = true;
    close_channel(process);
    if (at_once || process->is_program) {
        kill(-process->child.pid, SIGKILL);
        process->kill_at_us = INT64_MAX;
    } else if (process->kill_at_us == INT64_MAX) {
        process->kill_at_us = now_us + STOP_GRACE_US;
    }
}

static bool is_resting(const struct process *process, int64_t now_us)
{
    return !process->is_program && !process->has_ended && !process->is_stopping && process->child.channel >= 0 &&
           !process->outgoing && !process->pinged_us && !process->is_awaited && !process_is_throttled(process) &&
           now_us - process->spoke_us >= PROCESS_RESTS_AFTER_MS * 1000LL;
}

int64_t process_rests_until_us(const struct process *process, int64_t now_us)
{
    return is_resting(process, now_us) ? process->heard_us + PROCESS_REST_MS * 1000LL : 0;
}

static void queue_bytes(struct process *process, uint8_t *bytes, size_t n_bytes, int64_t now_us)
{
    if (process->child.channel < 0 || process->is_program) {
        free(bytes);
        return;
    }
    if (n_bytes > PROCESS_MAX_OUTGOING || process->n_outgoing > PROCESS_MAX_OUTGOING - n_bytes) {
        free(bytes);
        process_stop(process, true, "did not read what it was sent", now_us);
        return;
    }
    struct chunk *chunk = mem_new(sizeof *chunk);
    chunk->bytes = bytes;
    chunk->n_bytes = n_bytes;
    *process->last = chunk;
    process->last = &chunk->next;
    process->n_outgoing += n_bytes;
}

void process_send(struct process *process, uint8_t *bytes, size_t n_bytes, int64_t now_us)
{
    process->spoke_us = now_us;
    queue_bytes(process, bytes, n_bytes, now_us);
}

void process_await(struct process *process, bool is_awaited)
{
    process->is_awaited = is_awaited;
}

bool process_is_awaited(const struct process *process)
{
    return process->is_awaited && !process->has_ended;
}

bool process_is_throttled(const struct process *process)
{
    return event_backlog_bytes(process->backlog) >=
           (process->has_progress ? PROCESS_MAX_PROGRESS : PROCESS_MAX_BACKLOG);
}

size_t process_poll(const struct process *process, struct pollfd polled[2])
{
    size_t n = 0;
    if (process->child.channel >= 0) {
        int events = (process_is_throttled(process) ? 0 : POLLIN) | (process->outgoing ? POLLOUT : 0);
        if (events)
            polled[n++] = (struct pollfd){ .fd = process->child.channel, .events = (short)events };
    }
    if (process->child.pid_file >= 0 && !process->has_ended)
        polled[n++] = (struct pollfd){ .fd = process->child.pid_file, .events = POLLIN };
    return n;
}

static void write_out(struct process *process)
{
    while (process->outgoing && process->child.channel >= 0) {
        struct chunk *chunk = process->outgoing;
        ssize_t n =
            send(process->child.channel, chunk->bytes + chunk->n_sent, chunk->n_bytes - chunk->n_sent, MSG_NOSIGNAL);
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0)
            return; /* full: poll wakes us; closed: reading notices */
        chunk->n_sent += (size_t)n;
        if (chunk->n_sent < chunk->n_bytes)
            continue;
        process->n_outgoing -= chunk->n_bytes;
        process->outgoing = chunk->next;
        if (!process->outgoing)
            process->last = &process->outgoing;
        free(chunk->bytes);
        free(chunk);
    }
}

static void stop_broken(struct process *process, const struct error *why, int64_t now_us)
{
    char reason[240];
    (void)snprintf(reason, sizeof reason, "was ended because it %s %.160s",
                   why->code == ERROR_RANGE ? "sent" : "said something that is no packet:", why->text);
    process_stop(process, true, reason, now_us);
}

static void put_packets(struct process *process, int64_t now_us)
{
    struct packet packet;
    struct error err = { 0 };
    int got;
    while (process->child.channel >= 0 && (got = packet_reader_take(process->reader, &packet, &err)) != 0) {
        if (got < 0) {
            stop_broken(process, &err, now_us);
            return;
        }
        uint64_t n_text = process->n_since_packet > packet.n_blob ? process->n_since_packet - packet.n_blob : 0;
        process->n_since_packet = 0;
        if (packet.type == PACKET_PONG) { /* only its arrival counts */
            packet_finish(&packet);
            continue;
        }
        process->spoke_us = now_us;
        struct watch_event *event = event_new(process, WATCH_PACKET);
        event->packet = packet;
        event_backlog_add(process->backlog, event, sizeof *event + packet.n_blob + JSON_WEIGHT * n_text);
        put_event(process, event);
    }
}

/* Returns false when there is nothing more to read now. */
static bool read_packets(struct process *process, size_t *n_read, int64_t now_us)
{
    size_t room = 0;
    struct error err = { 0 };
    uint8_t *space = packet_reader_space(process->reader, &room, &err);
    if (!space) {
        stop_broken(process, &err, now_us);
        return false;
    }
    ssize_t n = recv(process->child.channel, space, room, 0);
    if (n < 0 && errno == EINTR)
        return true;
    if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK))
        return false;
    if (n <= 0) {
        close_channel(process);
        if (!process->has_ended && process->kill_at_us == INT64_MAX)
            process->kill_at_us = now_us + STOP_GRACE_US;
        return false;
    }
    process->heard_us = now_us;
    process->pinged_us = 0;
    process->n_since_packet += (uint64_t)n;
    *n_read += (size_t)n;
    packet_reader_added(process->reader, (size_t)n);
    put_packets(process, now_us);
    return process->child.channel >= 0 && !process_is_throttled(process);
}

static const char *end_of_line(const struct process *process, size_t begin)
{
    return process->n_output > begin ? memchr(process->output + begin, '\n', process->n_output - begin) : NULL;
}

/* Reports the whole lines printed so far, one event each, until it is throttled: the rest stays in output. */
static void put_lines(struct process *process, int64_t now_us)
{
    size_t begin = 0;
    for (const char *end; !process_is_throttled(process) && (end = end_of_line(process, begin));) {
        size_t n = (size_t)(end - (process->output + begin));
        struct watch_event *event = event_new(process, WATCH_LINE);
        event->output = mem_new(n + 1);
        memcpy(event->output, process->output + begin, n);
        event->n_output = n;
        event_backlog_add(process->backlog, event, 1024 + JSON_WEIGHT * n);
        put_event(process, event);
        begin += n + 1;
    }
    if (begin == 0)
        return;
    process->limit_at_us = now_us + (int64_t)process->limit_ms * 1000;
    process->n_output -= begin;
    memmove(process->output, process->output + begin, process->n_output);
}

static bool read_output(struct process *process, size_t *n_read, int64_t now_us)
{
    if (!process->output)
        process->output = mem_new(PROCESS_MAX_OUTPUT + 1);
    if (process->n_output == PROCESS_MAX_OUTPUT) {
        process_stop(process, true, "printed more than it may", now_us);
        return false;
    }
    ssize_t n =
        read(process->child.channel, process->output + process->n_output, PROCESS_MAX_OUTPUT - process->n_output);
    if (n < 0 && errno == EINTR)
        return true;
    if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK))
        return false;
    if (n <= 0) {
        close_channel(process);
        return false;
    }
    process->n_output += (size_t)n;
    if (process->has_progress)
        put_lines(process, now_us);
    *n_read += (size_t)n;
    return true;
}

static void read_in(struct process *process, int64_t now_us)
{
    size_t n_read = 0;
    if (process->has_progress)
        put_lines(process, now_us); /* left by an earlier step */
    while (process->child.channel >= 0 && n_read < READ_ROUND && !process_is_throttled(process))
        if (!(process->is_program ? read_output(process, &n_read, now_us) : read_packets(process, &n_read, now_us)))
            return;
}

static void check_end(struct process *process, int64_t now_us)
{
    int status;
    if (process->has_ended || waitpid(process->child.pid, &status, WNOHANG) != process->child.pid)
        return;
    process->has_ended = true;
    process->status = status;
    process->drain_until_us = now_us + DRAIN_US;
}

static void report_memory(struct process *process, int64_t now_us)
{
    if (process->has_ended || process->is_program || now_us < process->memory_at_us || is_resting(process, now_us))
        return;
    process->memory_at_us = now_us + MEMORY_EVERY_US;
    char path[64], text[128];
    (void)snprintf(path, sizeof path, "/proc/%ld/status", (long)process->child.pid);
    FILE *file = fopen(path, "re");
    if (!file)
        return;
    unsigned long long resident = 0, own = 0, kib;
    while (fgets(text, sizeof text, file)) {
        if (sscanf(text, "VmRSS: %llu", &kib) == 1)
            resident = kib * 1024;
        else if (sscanf(text, "RssAnon: %llu", &kib) == 1 || sscanf(text, "RssShmem: %llu", &kib) == 1)
            own += kib * 1024;
    }
    if (resident > 0) {
        struct watch_event *event = event_new(process, WATCH_MEMORY);
        event->memory_bytes = resident;
        event->own_bytes = own;
        put_event(process, event);
    }
    fclose(file);
}

/* True if its main thread is stopped or asleep: then it is not waiting for a processor or a disk. */
static bool is_stopped_or_asleep(const struct process *process)
{
    char path[64], text[256];
    (void)snprintf(path, sizeof path, "/proc/%ld/stat", (long)process->child.pid);
    FILE *file = fopen(path, "re");
    if (!file)
        return false;
    size_t n = fread(text, 1, sizeof text - 1, file);
    fclose(file);
    text[n] = 0;
    const char *state = strrchr(text, ')'); /* "PID (NAME) STATE ...", proc(5); the name may hold anything */
    return state && state[1] == ' ' && state[2] && strchr("TtS", state[2]);
}

static void send_ping(struct process *process, int64_t now_us)
{
    process->pinged_us = now_us;
    struct packet ping;
    size_t n;
    packet_init(&ping, PACKET_PING);
    uint8_t *bytes = packet_encode(&ping, NULL, 0, &n, NULL);
    if (bytes)
        queue_bytes(process, bytes, n, now_us);
}

static void check_silence(struct process *process, const struct silence_limits *limits, int64_t now_us)
{
    if (process_is_throttled(process)) { /* it is not read from */
        process->heard_us = now_us;
        process->pinged_us = 0;
        return;
    }
    int64_t ping_ms = process->is_awaited           ? limits->awaited_ping_ms
                      : is_resting(process, now_us) ? PROCESS_REST_MS
                                                    : limits->ping_ms;
    if (!process->pinged_us) {
        if ((now_us - process->heard_us) / 1000 >= ping_ms)
            send_ping(process, now_us);
        return;
    }
    int64_t silent_ms = (now_us - process->pinged_us) / 1000;
    bool is_due = process->is_awaited && silent_ms >= limits->awaited_silent_ms && is_stopped_or_asleep(process);
    if (silent_ms >= limits->silent_ms || is_due) {
        char reason[80];
        (void)snprintf(reason, sizeof reason, "did not answer for %.1f s", (double)(now_us - process->heard_us) / 1e6);
        process_stop(process, true, reason, now_us);
    }
}

static void check_limits(struct process *process, const struct silence_limits *limits, int64_t now_us)
{
    if (process->has_ended)
        return;
    if (now_us >= process->kill_at_us) {
        process_stop(process, true, process->is_stopping ? "" : "closed its socket and went on", now_us);
        return;
    }
    if (process->has_progress && process_is_throttled(process)) /* it is not read from */
        process->limit_at_us = now_us + (int64_t)process->limit_ms * 1000;
    if (now_us >= process->limit_at_us && !process->is_stopping) {
        process_stop(process, true, "took longer than it may", now_us);
        return;
    }
    if (process->is_program || process->is_stopping || process->child.channel < 0)
        return;
    check_silence(process, limits, now_us);
}

static void report_end(struct process *process)
{
    struct watch_event *event = event_new(process, WATCH_ENDED);
    event->is_exit = process->child.pid > 0 && WIFEXITED(process->status);
    event->status = event->is_exit ? WEXITSTATUS(process->status) : 0;
    event->signal = process->child.pid > 0 && WIFSIGNALED(process->status) ? WTERMSIG(process->status) : 0;
    memcpy(event->reason, process->reason, sizeof event->reason);
    if (process->output)
        process->output[process->n_output] = 0; /* with progress: older lines stood there */
    event->output = process->output;
    event->n_output = process->n_output;
    process->output = NULL;
    put_event(process, event);
}

bool process_step(struct process *process, const struct silence_limits *limits, int64_t now_us)
{
    write_out(process);
    read_in(process, now_us);
    check_end(process, now_us);
    report_memory(process, now_us);
    check_limits(process, limits, now_us);
    if (!process->has_ended || (process->child.channel >= 0 && now_us < process->drain_until_us))
        return false;
    if (process->has_progress && !process->is_stopping && end_of_line(process, 0))
        return false; /* its last lines wait until earlier ones are handled */
    report_end(process);
    return true;
}
