/* Many people: what a further follower costs the daemon, what one who does not read costs the others, how eight cameras
 * share a renderer, memory of a member, rooms at rest, and sending the same bytes to many beside the npm package ws. */
#define _GNU_SOURCE /* nftw */
#include <ftw.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "tests/bench/crowd.h"
#include "tests/bench/floor.h"
#include "tests/bench/peer.h"

enum {
    PAINT_US = 8000,
    TURN_EVERY_US = 30000,
    N_CROWD = 64,
    WIDTH = 1024,
    HEIGHT = 768,
    RATE = 1000000 / TURN_EVERY_US
};
#define S INT64_C(1000000)

static struct peer daemon_peer;
static int port;
static char data_folder[] = "/tmp/beamroom-crowd-XXXXXX";

static void print(const char *name, double value, const char *unit, const char *note)
{
    printf("{\"name\":\"%s\",\"value\":%.3f,\"unit\":\"%s\",\"note\":\"%s\"}\n", name, value, unit, note);
    (void)fflush(stdout);
}

static void fail(const char *what)
{
    fprintf(stderr, "bench_crowd: %s\n", what);
    exit(1);
}

/* ---- the daemon ------------------------------------------------------------------------------------------------- */

static const char *from_environment(const char *name, const char *otherwise)
{
    const char *value = getenv(name);
    return value ? value : otherwise;
}

static void start_daemon(void)
{
    char program[512], line[256] = "";
    if (!mkdtemp(data_folder))
        fail("no folder for the daemon");
    (void)snprintf(program, sizeof program, "%s/beamroomd", from_environment("BEAMROOM_BIN", "build/release"));
    const char *arguments[] = {
        program,  "--listen",  "127.0.0.1:0", "--plans", from_environment("BEAMROOM_DEMO", "build/demo/plans"),
        "--data", data_folder, "--gl",        "soft",    "--max-members",
        "200",    NULL
    };
    if (!peer_start(&daemon_peer, arguments, line, sizeof line) ||
        sscanf(line, "ready http://127.0.0.1:%d", &port) != 1)
        fail("beamroomd did not start");
}

static int remove_one(const char *path, const struct stat *status, int type, struct FTW *place)
{
    (void)status;
    (void)type;
    (void)place;
    return remove(path);
}

static void stop_daemon(void)
{
    if (daemon_peer.pid)
        (void)kill(daemon_peer.pid, SIGTERM);
    (void)peer_end(&daemon_peer);
    if (nftw(data_folder, remove_one, 16, FTW_DEPTH | FTW_PHYS) != 0)
        fprintf(stderr, "bench_crowd: %s is left\n", data_folder);
}

static void new_room(char path[80])
{
    char answer[8192], id[64] = "";
    int status = 0;
    for (int64_t end_us = clock_now_us() + 20 * S; status != 201 && clock_now_us() < end_us; (void)usleep(50000))
        status = crowd_http(port, "POST", "/api/v1/rooms", "{\"plan\":\"phantom\"}", answer, sizeof answer);
    const char *at = strstr(answer, "\"id\":\"");
    if (status != 201 || !at || sscanf(at, "\"id\":\"%63[^\"]", id) != 1)
        fail("no room");
    (void)snprintf(path, 80, "/api/v1/rooms/%s/ws", id);
}

static const char hello[] = "{\"type\":\"hello\",\"protocol\":2}";

static void open_view(struct crowd_client *client, bool follow)
{
    crowd_say(client,
              "{\"type\":\"view.open\",\"view\":1,\"follow\":%s,\"document\":{\"kind\":\"3d\",\"size_px\":[%d,%d]}}",
              follow ? "true" : "false", WIDTH, HEIGHT);
}

static bool has_frames(void *context)
{
    const struct crowd *crowd = context;
    for (size_t i = 0; i < crowd->n_clients; i++)
        if (crowd->clients[i]->n_frames == 0)
            return false;
    return true;
}

/* n members of a room, all following the first one's view. */
static void gather(struct crowd *crowd, const char *path, int n)
{
    for (int i = 0; i < n; i++) {
        struct crowd_client *client = crowd_join(crowd, path, 2 + (int)crowd->n_clients / 100, hello);
        crowd_wait_ready(crowd);
        open_view(client, true);
    }
    if (!crowd_serve(crowd, clock_now_us() + 60 * S, has_frames, crowd))
        fail("no frames");
}

static void turn(struct crowd_client *client, int step)
{
    const double angle = step * 0.05, x = 900 * (angle - 6.2832 * (int)(angle / 6.2832)) / 6.2832 - 450;
    crowd_say(
        client,
        "{\"type\":\"view.patch\",\"view\":1,\"input\":%d,\"patch\":{\"camera\":{\"position_mm\":[%.1f,-800,%.1f],"
        "\"target_mm\":[0,0,0],\"up\":[0,0,1]}}}",
        step + 1, x, x / 5);
}

static int n_steps; /* inputs count up over all measurements */

/* n_movers turn their views for a while. */
static void move(struct crowd *crowd, size_t n_movers, int64_t for_us)
{
    crowd_count_from_now(crowd);
    for (int64_t end_us = clock_now_us() + for_us, next_us = clock_now_us(); next_us < end_us;
         next_us += TURN_EVERY_US) {
        for (size_t i = 0; i < n_movers; i++)
            turn(crowd->clients[i], n_steps + (int)i * 20);
        n_steps++;
        (void)crowd_serve(crowd, next_us + TURN_EVERY_US, NULL, NULL);
    }
}

/* ---- followers of one view -------------------------------------------------------------------------------------- */

static int compare(const void *a, const void *b)
{
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

static double median_encode_us(struct crowd_client *client)
{
    uint32_t values[CROWD_MAX_INTERVALS];
    size_t n = client->n_frames < CROWD_MAX_INTERVALS ? (size_t)client->n_frames : CROWD_MAX_INTERVALS;
    memcpy(values, client->encode_us, n * sizeof values[0]);
    qsort(values, n, sizeof values[0], compare);
    return n ? values[n / 2] : 0;
}

/* Processor time of the daemon for each frame that the presenter is shown, in us; n_bytes: sent to all. */
static double measure_us(struct crowd *crowd, int64_t for_us, double *n_bytes, double *cpu_s)
{
    int64_t before_us = crowd_cpu_us(daemon_peer.pid);
    move(crowd, 1, for_us);
    double us = (double)(crowd_cpu_us(daemon_peer.pid) - before_us);
    *n_bytes = 0;
    for (size_t i = 0; i < crowd->n_clients; i++)
        *n_bytes += (double)crowd->clients[i]->n_bytes;
    *cpu_s = us / 1e6;
    return us / (double)(crowd->clients[0]->n_frames ? crowd->clients[0]->n_frames : 1);
}

/* Bytes per microsecond of processor time that a server of the same bytes sends to 65. */
static double rate_of(int pid, int server_port, struct peer *peer, uint32_t n_picture)
{
    struct crowd crowd;
    char question[64], line[64];
    crowd_init(&crowd, server_port, PAINT_US);
    for (int i = 0; i <= N_CROWD; i++)
        (void)crowd_join(&crowd, "/", 2, NULL);
    (void)snprintf(question, sizeof question, "%u %d\n", n_picture, RATE);
    if (peer)
        (void)peer_ask(peer, question, line, sizeof line);
    (void)crowd_serve(&crowd, clock_now_us() + 2 * S, NULL, NULL); /* compiled by now */
    crowd_count_from_now(&crowd);
    int64_t before_us = crowd_cpu_us(pid);
    (void)crowd_serve(&crowd, clock_now_us() + 4 * S, NULL, NULL);
    double n_us = (double)(crowd_cpu_us(pid) - before_us), n_bytes = 0;
    for (size_t i = 0; i < crowd.n_clients; i++)
        n_bytes += (double)crowd.clients[i]->n_bytes;
    crowd_finish(&crowd);
    return n_bytes / n_us;
}

static double peer_rate(uint32_t n_picture)
{
    char script[512], line[64];
    struct peer peer;
    int peer_port = 0;
    (void)snprintf(script, sizeof script, "%s/ws_peer.mjs", from_environment("BENCH_FOLDER", "tests/bench"));
    bool has_peer = peer_start(&peer, (const char *const[]){ "node", script, NULL }, line, sizeof line) &&
                    sscanf(line, "%d", &peer_port) == 1;
    double rate = has_peer ? rate_of(peer.pid, peer_port, &peer, n_picture) : 0;
    (void)peer_end(&peer);
    return rate;
}

static double floor_rate(uint32_t n_picture)
{
    int floor_port = 0;
    pid_t floor = floor_start(N_CROWD + 1, n_picture, RATE, &floor_port);
    if (floor <= 0)
        return 0;
    double rate = rate_of(floor, floor_port, NULL, n_picture);
    (void)kill(floor, SIGKILL);
    (void)waitpid(floor, NULL, 0);
    return rate;
}

enum { ROUNDS = 3 };

static double median(double values[ROUNDS])
{
    double low = values[0] < values[1] ? values[0] : values[1], high = values[0] < values[1] ? values[1] : values[0];
    return values[2] < low ? low : values[2] > high ? high : values[2];
}

static void print_beside(const char *name, double ours, double theirs, const char *note)
{
    if (theirs > 0)
        printf("{\"name\":\"%s\",\"value\":%.1f,\"unit\":\"MB per CPU second\",\"peer\":\"npm ws\","
               "\"peer_value\":%.1f,\"ratio\":%.3f,\"note\":\"%s\"}\n",
               name, ours, theirs, ours / theirs, note);
    else
        print(name, ours, "MB per CPU second", note);
    (void)fflush(stdout);
}

static void print_rates(const struct crowd *crowd, int64_t for_us)
{
    double least = 1e9, sum = 0;
    for (size_t i = 1; i < crowd->n_clients; i++) {
        double rate = (double)crowd->clients[i]->n_frames * 1e6 / (double)for_us;
        sum += rate;
        least = rate < least ? rate : least;
    }
    print("64 followers, frames of each", sum / N_CROWD, "1/s", "mean; 1024 x 768, all of one view that turns");
    print("64 followers, frames of the slowest", least, "1/s", "");
    print("64 followers, 99 % of frame intervals", crowd_interval_ms(crowd->clients + 1, N_CROWD, 0.99), "ms", "");
}

static void followers(void)
{
    char path[80];
    struct crowd crowd;
    double few_us[ROUNDS], further_us[ROUNDS], whole[ROUNDS], further[ROUNDS], theirs[ROUNDS], least[ROUNDS];
    double n_bytes, cpu_s;
    new_room(path);
    crowd_init(&crowd, port, PAINT_US);
    gather(&crowd, path, 2);
    (void)measure_us(&crowd, 1 * S, &n_bytes, &cpu_s); /* quality has settled */
    for (int i = 0; i < ROUNDS; i++)
        few_us[i] = measure_us(&crowd, 2 * S, &n_bytes, &cpu_s);
    double encode_us = median_encode_us(crowd.clients[0]);
    gather(&crowd, path, N_CROWD - 1); /* the presenter, and 64 who follow */
    (void)measure_us(&crowd, 1 * S, &n_bytes, &cpu_s);
    for (int i = 0; i < ROUNDS; i++) {
        double many_us = measure_us(&crowd, 4 * S, &n_bytes, &cpu_s);
        double n_frames = (double)crowd.clients[0]->n_frames, of_further = n_bytes * (N_CROWD - 1) / (N_CROWD + 1);
        uint32_t n_picture = (uint32_t)(n_bytes / (N_CROWD + 1) / (n_frames > 0 ? n_frames : 1));
        if (i == 0)
            print_rates(&crowd, 4 * S);
        further_us[i] = (many_us - median(few_us)) / (double)(N_CROWD - 1);
        whole[i] = n_bytes / cpu_s / 1e6;
        further[i] = of_further / (n_frames * (many_us - median(few_us)));
        theirs[i] = peer_rate(n_picture);
        least[i] = floor_rate(n_picture);
    }
    crowd_finish(&crowd);
    print("processor time for a further follower", median(further_us), "us a frame", "of the daemon; median of 3");
    print("a further follower as a share of one encode", 100 * median(further_us) / encode_us, "%",
          "at most 3 asked for");
    print("processor time of a frame for the presenter and one follower", median(few_us), "us a frame",
          "of the daemon: the change of the view, the renderer's picture, what is kept");
    print_beside("the same bytes to 65, the fan-out alone", median(further), median(theirs),
                 "what 63 further followers add; medians of 3 rounds of all, at 33 a second");
    print_beside("the same bytes to 65, the whole daemon", median(whole), median(theirs),
                 "with the changes of the view, the renderer's pictures and what is kept, which the peer has not");
    print_beside("the same bytes to 65 by a loop of writev", median(least), median(theirs),
                 "reads answers without looking at them: the most that the kernel lets anybody reach");
}

/* ---- one who does not read -------------------------------------------------------------------------------------- */

static void stalled(void)
{
    enum { N = 12 };
    char path[80];
    struct crowd crowd;
    double without[ROUNDS], with[ROUNDS], best_without = 1e9, best_with = 1e9;
    new_room(path);
    crowd_init(&crowd, port, PAINT_US);
    gather(&crowd, path, N);
    move(&crowd, 1, 1 * S);
    int n_held = 0;
    for (int round = 0; round < ROUNDS; round++) {
        move(&crowd, 1, 3 * S);
        without[round] = crowd_interval_ms(crowd.clients, N, 0.99);
        struct crowd_client *stalled = crowd_join(&crowd, path, 4, hello);
        crowd_wait_ready(&crowd);
        open_view(stalled, true);
        (void)crowd_serve(&crowd, clock_now_us() + S / 5, NULL, NULL);
        stalled->reads = false;
        move(&crowd, 1, 3 * S);
        with[round] = crowd_interval_ms(crowd.clients, N, 0.99);
        int held = crowd_drain(stalled);
        n_held = held > n_held ? held : n_held;
        crowd_leave(stalled);
    }
    for (int round = 0; round < ROUNDS; round++) {
        best_without = without[round] < best_without ? without[round] : best_without;
        best_with = with[round] < best_with ? with[round] : best_with;
    }
    print("99 % of frame intervals beside one who reads nothing, longer by", best_with - best_without, "ms",
          "best of 3 rounds each; at most 5 asked for");
    print("frames held for one who reads nothing", n_held, "frames", "at most 2 asked for");
    crowd_finish(&crowd);
}

/* ---- eight cameras ---------------------------------------------------------------------------------------------- */

static void eight_cameras(void)
{
    enum { N = 8 };
    char path[80];
    struct crowd crowd;
    new_room(path);
    crowd_init(&crowd, port, PAINT_US);
    for (int i = 0; i < N; i++) {
        struct crowd_client *client = crowd_join(&crowd, path, 2, hello);
        crowd_wait_ready(&crowd);
        open_view(client, false);
    }
    if (!crowd_serve(&crowd, clock_now_us() + 60 * S, has_frames, &crowd))
        fail("no frames");
    move(&crowd, N, 2 * S);
    move(&crowd, N, 8 * S);
    double least = 1e9, sum = 0;
    for (int i = 0; i < N; i++) {
        double rate = (double)crowd.clients[i]->n_frames / 8;
        sum += rate;
        least = rate < least ? rate : least;
    }
    print("eight own cameras on one plan, frames of each", sum / N, "1/s", "mean");
    print("the slowest of eight against the mean", 100 * least * N / sum, "%", "at least 33 asked for");
    crowd_finish(&crowd);
}

/* ---- memory, and rest ------------------------------------------------------------------------------------------- */

static void memory(void)
{
    enum { N = 199 };
    char path[80];
    struct crowd crowd;
    new_room(path);
    crowd_init(&crowd, port, PAINT_US);
    gather(&crowd, path, 1);
    move(&crowd, 1, 1 * S);
    double before_mib = crowd_memory_mib(daemon_peer.pid);
    gather(&crowd, path, N);
    move(&crowd, 1, 3 * S);
    print("memory of a further member", (crowd_memory_mib(daemon_peer.pid) - before_mib) / N, "MiB",
          "of the daemon, 200 members; at most 1 asked for");
    crowd_finish(&crowd);
}

static void at_rest(void)
{
    enum { N = 190 };
    char path[80];
    struct crowd crowd;
    crowd_init(&crowd, port, PAINT_US);
    for (int i = 0; i < N; i++) {
        new_room(path);
        if (i % 4 == 0)
            gather(&crowd, path, 1);
    }
    (void)crowd_serve(&crowd, clock_now_us() + 6 * S, NULL, NULL); /* calm by now */
    int64_t before_us = crowd_cpu_us(daemon_peer.pid);
    (void)crowd_serve(&crowd, clock_now_us() + 5 * S, NULL, NULL);
    print("processor time of 195 rooms at rest", (double)(crowd_cpu_us(daemon_peer.pid) - before_us) / 5000,
          "ms a second", "a member with a picture in every fourth; none asked for");
    crowd_finish(&crowd);
}

/* An argument names the one part to run. */
int main(int argc, char **argv)
{
    static const struct {
        const char *name;
        void (*run)(void);
    } parts[] = { { "followers", followers },
                  { "stalled", stalled },
                  { "cameras", eight_cameras },
                  { "memory", memory },
                  { "rest", at_rest } };
    start_daemon();
    (void)atexit(stop_daemon);
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++)
        if (argc < 2 || strcmp(argv[1], parts[i].name) == 0)
            parts[i].run();
    return 0;
}
