#pragma once
/* Many browsers in one process: WebSocket clients that say hello, show frames after a time of painting, and count what
 * comes. One thread; for benchmarks of a daemon on this machine. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    CROWD_MAX_INTERVALS = 4096, /* frame times kept of one client */
    CROWD_MAX_TEXT = 64 << 10,  /* of a text message; longer ones are cut */
    CROWD_MAX_UNSHOWN = 8
};

struct crowd_client {
    struct crowd *crowd;
    int fd;
    bool is_open, is_ready, is_closed; /* ready: welcome has come, and a renderer that draws */
    bool reads;                        /* false: stops reading, and so shows nothing */
    uint8_t *in;
    size_t n_in, size_in;
    struct {
        uint32_t view, sequence;
        int64_t due_us;
    } unshown[CROWD_MAX_UNSHOWN];
    int n_unshown, n_held; /* held: the most frames that were not shown */
    /* since crowd_count_from_now */
    uint64_t n_frames, n_bytes, n_stills;
    int64_t frame_us[CROWD_MAX_INTERVALS]; /* when frames came */
    uint32_t encode_us[CROWD_MAX_INTERVALS];
    uint32_t n_payload; /* bytes of the newest picture */
};

struct crowd {
    int port, epoll;
    int64_t paint_us; /* from a frame's last byte to frame.shown */
    struct crowd_client **clients;
    size_t n_clients, size_clients;
};

void crowd_init(struct crowd *crowd, int port, int64_t paint_us);
void crowd_finish(struct crowd *crowd);
/* Opens a WebSocket; from: last part of the address 127.0.0.from it comes from. hello: the first message; NULL: none.
 * Aborts when nothing listens. */
struct crowd_client *crowd_join(struct crowd *crowd, const char *path, int from, const char *hello);
void crowd_leave(struct crowd_client *client); /* cuts the connection; the client stays valid until crowd_finish */
void crowd_say(struct crowd_client *client, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Serves all until time_us (clock_now_us), or until is_done(context) is true; returns whether it was. */
bool crowd_serve(struct crowd *crowd, int64_t until_us, bool (*is_done)(void *context), void *context);
/* Serves until all clients are ready. Aborts when that takes more than a minute. */
void crowd_wait_ready(struct crowd *crowd);
/* Reads what waits for a client that does not read, without showing it; returns the frames that it was sent and has not
 * shown. */
int crowd_drain(struct crowd_client *client);
void crowd_count_from_now(struct crowd *crowd);
/* The p-th part (0 to 1) of the times between frames of n clients, in ms; 0: there are none. */
double crowd_interval_ms(struct crowd_client *const *clients, size_t n, double p);

/* An HTTP call; body NULL: none. Returns the status, and the answer's body as text. Aborts when nothing answers. */
int crowd_http(int port, const char *method, const char *path, const char *body, char *answer, size_t size);
/* Processor time of all threads of a process, in us; 0: unknown. */
int64_t crowd_cpu_us(int pid);
double crowd_memory_mib(int pid); /* not shared with files */
