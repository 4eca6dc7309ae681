/* Clients on epoll: reads WebSocket messages, acknowledges frames when they are painted. */
#include "tests/bench/crowd.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/base/mem.h"

enum { FRAME_HEADER = 112, IN_SIZE = 256 << 10, ADDRESS = 0x7f000000 };

static void must(bool is_true, const char *what)
{
    if (is_true)
        return;
    perror(what);
    abort();
}

static int connect_from(int port, int from)
{
    struct sockaddr_in own = { .sin_family = AF_INET, .sin_addr.s_addr = htonl(ADDRESS + (uint32_t)from) }, server = {
        .sin_family = AF_INET, .sin_port = htons((uint16_t)port), .sin_addr.s_addr = htonl(ADDRESS + 1)
    };
    int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0), on = 1;
    must(fd >= 0 && bind(fd, (struct sockaddr *)&own, sizeof own) == 0 &&
             connect(fd, (struct sockaddr *)&server, sizeof server) == 0,
         "connect");
    (void)setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    return fd;
}

static void send_all(int fd, const void *bytes, size_t n)
{
    for (const char *at = bytes; n > 0;) {
        ssize_t sent = send(fd, at, n, MSG_NOSIGNAL);
        if (sent <= 0)
            return; /* the server has closed: seen when reading */
        at += sent;
        n -= (size_t)sent;
    }
}

/* ---- clients ---------------------------------------------------------------------------------------------------- */

void crowd_init(struct crowd *crowd, int port, int64_t paint_us)
{
    *crowd = (struct crowd){ .port = port, .paint_us = paint_us, .epoll = epoll_create1(EPOLL_CLOEXEC) };
    must(crowd->epoll >= 0, "epoll");
}

void crowd_leave(struct crowd_client *client)
{
    if (client->fd >= 0)
        (void)close(client->fd);
    client->fd = -1;
    client->is_closed = true;
    client->n_unshown = 0;
}

void crowd_finish(struct crowd *crowd)
{
    for (size_t i = 0; i < crowd->n_clients; i++) {
        crowd_leave(crowd->clients[i]);
        free(crowd->clients[i]->in);
        free(crowd->clients[i]);
    }
    free(crowd->clients);
    (void)close(crowd->epoll);
}

struct crowd_client *crowd_join(struct crowd *crowd, const char *path, int from, const char *hello)
{
    struct crowd_client *client = mem_new(sizeof *client);
    char head[512];
    *client = (struct crowd_client){
        .crowd = crowd, .fd = connect_from(crowd->port, from), .reads = true, .in = mem_new(IN_SIZE), .size_in = IN_SIZE
    };
    if (crowd->n_clients == crowd->size_clients) {
        crowd->size_clients = crowd->size_clients ? 2 * crowd->size_clients : 64;
        crowd->clients = realloc(crowd->clients, crowd->size_clients * sizeof(struct crowd_client *));
        must(crowd->clients != NULL, "memory");
    }
    crowd->clients[crowd->n_clients++] = client;
    int n = snprintf(head, sizeof head,
                     "GET %s HTTP/1.1\r\nHost: 127.0.0.1:%d\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
                     "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n",
                     path, crowd->port);
    send_all(client->fd, head, (size_t)n);
    struct epoll_event event = { .events = EPOLLIN, .data.ptr = client };
    must(epoll_ctl(crowd->epoll, EPOLL_CTL_ADD, client->fd, &event) == 0, "epoll");
    while (!client->is_open && !client->is_closed)
        (void)crowd_serve(crowd, clock_now_us() + 10000, NULL, NULL);
    if (hello)
        crowd_say(client, "%s", hello);
    return client;
}

void crowd_say(struct crowd_client *client, const char *format, ...)
{
    uint8_t bytes[8 + 4096] = { 0x81 };
    va_list args;
    va_start(args, format);
    int n = vsnprintf((char *)bytes + 8, sizeof bytes - 8, format, args);
    va_end(args);
    must(n >= 0 && n < 4096, "a message");
    uint8_t *from = bytes; /* a head of 6 or 8 bytes; its mask of zeros changes nothing */
    if (n < 126) {
        from[2] = 0x81;
        from[3] = (uint8_t)(0x80 | n);
        from += 2;
    } else {
        from[1] = 0x80 | 126;
        from[2] = (uint8_t)(n >> 8);
        from[3] = (uint8_t)n;
    }
    if (client->fd >= 0)
        send_all(client->fd, from, (size_t)(bytes + 8 - from) + (size_t)n);
}

static uint32_t u32(const uint8_t *at)
{
    return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static void take_frame(struct crowd_client *client, const uint8_t *bytes, size_t n)
{
    int64_t now_us = clock_now_us();
    size_t at = client->n_frames % CROWD_MAX_INTERVALS;
    if (n < FRAME_HEADER)
        return;
    client->frame_us[at] = now_us;
    client->encode_us[at] = u32(bytes + 36);
    client->n_payload = u32(bytes + 40);
    client->n_frames++;
    client->n_bytes += n;
    client->n_stills += bytes[9] & 1;
    must(client->n_unshown < CROWD_MAX_UNSHOWN, "more frames than may be held");
    client->unshown[client->n_unshown].view = u32(bytes + 12);
    client->unshown[client->n_unshown].sequence = u32(bytes + 16);
    client->unshown[client->n_unshown++].due_us = now_us + client->crowd->paint_us;
    client->n_held = client->n_unshown > client->n_held ? client->n_unshown : client->n_held;
}

static void take_text(struct crowd_client *client, const uint8_t *bytes, size_t n)
{
    char text[CROWD_MAX_TEXT + 1];
    client->n_bytes += n;
    n = n < CROWD_MAX_TEXT ? n : CROWD_MAX_TEXT;
    memcpy(text, bytes, n);
    text[n] = 0;
    client->is_ready = client->is_ready || (strstr(text, "\"type\":\"renderer\"") && strstr(text, "\"ready\""));
    if (strstr(text, "\"type\":\"problem\""))
        fprintf(stderr, "refused: %.300s\n", text);
}

/* Handles the first message in the buffer; returns its bytes, 0: it is not whole. */
static size_t take_message(struct crowd_client *client, const uint8_t *at, size_t n)
{
    size_t n_head = 2, n_body = n > 1 ? at[1] & 0x7f : 0;
    if (n < 4)
        return 0;
    if (n_body == 126) {
        n_body = (size_t)at[2] << 8 | at[3];
        n_head = 4;
    } else if (n_body == 127) {
        if (n < 10)
            return 0;
        n_body = (size_t)at[6] << 24 | (size_t)at[7] << 16 | (size_t)at[8] << 8 | at[9];
        n_head = 10;
    }
    if (n_head + n_body > client->size_in) {
        client->size_in = n_head + n_body + IN_SIZE;
        client->in = realloc(client->in, client->size_in);
        must(client->in != NULL, "memory");
        return 0;
    }
    if (n < n_head + n_body)
        return 0;
    int opcode = at[0] & 15;
    if (opcode == 2)
        take_frame(client, at + n_head, n_body);
    else if (opcode == 1)
        take_text(client, at + n_head, n_body);
    else if (opcode == 9)
        send_all(client->fd, (uint8_t[]){ 0x8a, 0x80, 0, 0, 0, 0 }, 6);
    return n_head + n_body;
}

static size_t take_answer(struct crowd_client *client)
{
    static const char end[] = "\r\n\r\n";
    for (size_t i = 0; i + 4 <= client->n_in; i++)
        if (memcmp(client->in + i, end, 4) == 0) {
            must(memcmp(client->in, "HTTP/1.1 101", 12) == 0, "a WebSocket was refused");
            client->is_open = true;
            return i + 4;
        }
    return 0;
}

static void read_some(struct crowd_client *client)
{
    ssize_t n = recv(client->fd, client->in + client->n_in, client->size_in - client->n_in, MSG_DONTWAIT);
    if (n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR)) {
        crowd_leave(client);
        return;
    }
    client->n_in += n > 0 ? (size_t)n : 0;
    size_t done = client->is_open ? 0 : take_answer(client);
    for (size_t taken; client->is_open && (taken = take_message(client, client->in + done, client->n_in - done));)
        done += taken;
    client->n_in -= done;
    memmove(client->in, client->in + done, client->n_in);
}

/* Shows what is painted; returns when the next frame is. */
static int64_t show_due(struct crowd_client *client, int64_t now_us)
{
    while (client->n_unshown && client->reads && client->unshown[0].due_us <= now_us) {
        crowd_say(client, "{\"type\":\"frame.shown\",\"view\":%u,\"sequence\":%u}", client->unshown[0].view,
                  client->unshown[0].sequence);
        client->n_unshown--;
        memmove(client->unshown, client->unshown + 1, (size_t)client->n_unshown * sizeof client->unshown[0]);
    }
    return client->n_unshown && client->reads ? client->unshown[0].due_us : INT64_MAX;
}

bool crowd_serve(struct crowd *crowd, int64_t until_us, bool (*is_done)(void *context), void *context)
{
    for (;;) {
        struct epoll_event events[256];
        int64_t now_us = clock_now_us(), next_us = until_us;
        for (size_t i = 0; i < crowd->n_clients; i++) {
            int64_t due_us = show_due(crowd->clients[i], now_us);
            next_us = due_us < next_us ? due_us : next_us;
        }
        if (is_done && is_done(context))
            return true;
        if (now_us >= until_us)
            return false;
        int64_t wait_ms = (next_us - now_us + 999) / 1000;
        int n = epoll_wait(crowd->epoll, events, 256, (int)(wait_ms < 100 ? wait_ms : 100));
        for (int i = 0; i < n; i++) {
            struct crowd_client *client = events[i].data.ptr;
            if (client->reads && client->fd >= 0)
                read_some(client);
            else if (!client->reads)
                (void)epoll_ctl(crowd->epoll, EPOLL_CTL_DEL, client->fd, NULL);
        }
    }
}

static bool all_are_ready(void *context)
{
    const struct crowd *crowd = context;
    for (size_t i = 0; i < crowd->n_clients; i++)
        if (!crowd->clients[i]->is_ready && !crowd->clients[i]->is_closed)
            return false;
    return true;
}

void crowd_wait_ready(struct crowd *crowd)
{
    must(crowd_serve(crowd, clock_now_us() + 60000000, all_are_ready, crowd), "no renderer is ready");
}

void crowd_count_from_now(struct crowd *crowd)
{
    for (size_t i = 0; i < crowd->n_clients; i++) {
        struct crowd_client *client = crowd->clients[i];
        client->n_frames = client->n_bytes = client->n_stills = 0;
        client->n_held = client->n_unshown;
    }
}

int crowd_drain(struct crowd_client *client)
{
    client->reads = false;
    for (int i = 0; i < 50 && client->fd >= 0; i++) {
        read_some(client);
        (void)usleep(4000);
    }
    return client->n_unshown;
}

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double crowd_interval_ms(struct crowd_client *const *clients, size_t n, double p)
{
    double *ms = mem_array(n * CROWD_MAX_INTERVALS, sizeof *ms, UINT64_MAX, NULL), answer;
    size_t n_ms = 0;
    must(ms != NULL, "memory");
    for (size_t i = 0; i < n; i++)
        for (size_t k = 1; k < clients[i]->n_frames && k < CROWD_MAX_INTERVALS; k++)
            ms[n_ms++] = (double)(clients[i]->frame_us[k] - clients[i]->frame_us[k - 1]) / 1000;
    qsort(ms, n_ms, sizeof *ms, compare);
    answer = n_ms ? ms[(size_t)(p * (double)(n_ms - 1))] : 0;
    free(ms);
    return answer;
}

/* ---- the daemon from outside ------------------------------------------------------------------------------------ */

int crowd_http(int port, const char *method, const char *path, const char *body, char *answer, size_t size)
{
    char head[512], *text = mem_new(1 << 20);
    size_t n_text = 0;
    int fd = connect_from(port, 1), status = 0;
    int n = snprintf(head, sizeof head,
                     "%s %s HTTP/1.1\r\nHost: 127.0.0.1:%d\r\nConnection: close\r\nContent-Type: application/json\r\n"
                     "Content-Length: %zu\r\n\r\n",
                     method, path, port, body ? strlen(body) : 0);
    send_all(fd, head, (size_t)n);
    if (body)
        send_all(fd, body, strlen(body));
    for (ssize_t got; (got = recv(fd, text + n_text, (1 << 20) - 1 - n_text, 0)) > 0;)
        n_text += (size_t)got;
    (void)close(fd);
    must(sscanf(text, "HTTP/1.1 %d", &status) == 1, "no answer over HTTP");
    const char *at = strstr(text, "\r\n\r\n");
    if (answer)
        (void)snprintf(answer, size, "%s", at ? at + 4 : "");
    free(text);
    return status;
}

int64_t crowd_cpu_us(int pid)
{
    char path[320];
    int64_t sum_ns = 0;
    (void)snprintf(path, sizeof path, "/proc/%d/task", pid);
    DIR *folder = opendir(path);
    for (struct dirent *entry; folder && (entry = readdir(folder));) {
        if (entry->d_name[0] == '.')
            continue;
        (void)snprintf(path, sizeof path, "/proc/%d/task/%.200s/schedstat", pid, entry->d_name);
        FILE *file = fopen(path, "re");
        long long ns = 0;
        if (file && fscanf(file, "%lld", &ns) == 1)
            sum_ns += ns;
        if (file)
            (void)fclose(file);
    }
    if (folder)
        (void)closedir(folder);
    return sum_ns / 1000;
}

double crowd_memory_mib(int pid)
{
    char path[64], line[256];
    double kib = 0;
    (void)snprintf(path, sizeof path, "/proc/%d/status", pid);
    FILE *file = fopen(path, "re");
    while (file && fgets(line, sizeof line, file))
        (void)sscanf(line, "RssAnon: %lf", &kib);
    if (file)
        (void)fclose(file);
    return kib / 1024;
}
