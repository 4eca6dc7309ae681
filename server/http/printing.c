/* A PDF's way: written to the process, read from it, given to the call. */
#include "server/http/printing.h"

#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/fleet/spawn.h"
#include "server/printer/input.h"

enum { LOOK_MS = 100 }; /* how often a thread looks whether the server stops */

struct printing {
    struct api *api;
    struct call *call;
    struct printer_head head;
    uint8_t *pictures[PRINTER_PICTURES];
    uint8_t *input, *pdf; /* input: the head, the JSON and the pictures behind each other */
    size_t n_input, n_pdf, room;
    char name[80];
    struct problem problem; /* why there is no PDF */
};

struct printing *printing_create(const struct net_record *record, bool is_letter, struct problem *problem)
{
    struct printing *printing = mem_new(sizeof *printing);
    *printing = (struct printing){ .head = { .magic = PRINTER_MAGIC, .is_letter = is_letter } };
    (void)snprintf(printing->name, sizeof printing->name, "attachment; filename=\"record-%.40s.pdf\"", record->id);
    for (int i = 0; i < PRINTER_PICTURES && i < STORE_FIGURES; i++) {
        const struct store_figure *figure = &record->figures[i];
        if (!figure->bytes)
            continue;
        printing->pictures[i] = mem_array(figure->n_bytes, 1, PRINTER_MAX_PICTURE, NULL);
        if (!printing->pictures[i]) {
            printing_destroy(printing);
            problem_set(problem, PROBLEM_MEMORY, "", "", "there is no memory for the PDF");
            return NULL;
        }
        memcpy(printing->pictures[i], figure->bytes, figure->n_bytes);
        printing->head.n_pictures[i] = (uint32_t)figure->n_bytes;
    }
    return printing;
}

void printing_destroy(struct printing *printing)
{
    if (!printing)
        return;
    for (int i = 0; i < PRINTER_PICTURES; i++)
        free(printing->pictures[i]);
    free(printing->input);
    free(printing->pdf);
    free(printing);
}

/* ---- the thread --------------------------------------------------------------------------------------------------- */

/* Puts what has come behind what is there. False: it is too much, or there is no memory. */
static bool take(struct printing *printing, const uint8_t *bytes, size_t n)
{
    if (printing->n_pdf + n > printing->room) {
        const size_t room = 2 * (printing->n_pdf + n) + 65536;
        void *more = printing->n_pdf + n <= PRINTER_MAX_PDF ? realloc(printing->pdf, room) : NULL;
        if (!more)
            return false;
        printing->pdf = more;
        printing->room = room;
    }
    memcpy(printing->pdf + printing->n_pdf, bytes, n);
    printing->n_pdf += n;
    return true;
}

/* Sends what is left of the input. False: the process takes no more. */
static bool send_some(const struct printing *printing, int channel, size_t *sent)
{
    const ssize_t n = send(channel, printing->input + *sent, printing->n_input - *sent, MSG_NOSIGNAL);
    if (n < 0)
        return errno == EAGAIN || errno == EINTR;
    *sent += (size_t)n;
    if (*sent == printing->n_input)
        (void)shutdown(channel, SHUT_WR);
    return true;
}

/* Writes and reads until the process has ended its side. False with problem. */
static bool talk(struct printing *printing, int channel)
{
    static const char failed[] = "the record could not be drawn: the server's log says why";
    const int64_t until_us = clock_now_us() + PRINTING_S * INT64_C(1000000);
    size_t sent = 0;
    uint8_t bytes[65536];
    for (;;) {
        struct pollfd look = { .fd = channel, .events = (short)(POLLIN | (sent < printing->n_input ? POLLOUT : 0)) };
        if (atomic_load(&printing->api->is_printing_stopped))
            return problem_set(&printing->problem, PROBLEM_BUSY, "", "", "the server is stopping");
        if (clock_now_us() > until_us)
            return problem_set(&printing->problem, PROBLEM_TIMEOUT, "", "", "the record could not be drawn within %d s",
                               PRINTING_S);
        if (poll(&look, 1, LOOK_MS) <= 0)
            continue;
        if ((look.revents & POLLOUT) && !send_some(printing, channel, &sent))
            return problem_set(&printing->problem, PROBLEM_RENDERER, "", "", failed);
        if (!(look.revents & (POLLIN | POLLHUP | POLLERR)))
            continue;
        const ssize_t n = recv(channel, bytes, sizeof bytes, 0);
        if (n == 0)
            return true;
        if (n < 0 && errno != EAGAIN && errno != EINTR)
            return problem_set(&printing->problem, PROBLEM_RENDERER, "", "", failed);
        if (n > 0 && !take(printing, bytes, (size_t)n))
            return problem_set(&printing->problem, PROBLEM_MEMORY, "", "", "there is no memory for the PDF");
    }
}

static void give(struct net *net, void *context)
{
    struct printing *printing = context;
    struct call *call = printing->call;
    (void)net;
    if (printing->problem.type != PROBLEM_NONE) {
        call_answer_problem(call, &printing->problem);
    } else {
        call_add_header(call, "Content-Disposition", printing->name);
        call_answer_bytes(call, 200, "application/pdf", printing->pdf, printing->n_pdf);
        printing->pdf = NULL;
    }
    printing_destroy(printing);
}

/* The path of the program beside our own. */
static void find_program(char path[4096])
{
    const ssize_t n = readlink("/proc/self/exe", path, 4096 - sizeof "beamroom-paper");
    path[n > 0 ? n : 0] = 0;
    char *slash = strrchr(path, '/');
    (void)snprintf(slash ? slash + 1 : path, sizeof "beamroom-paper", "beamroom-paper");
}

static void draw(struct printing *printing)
{
    char path[4096], serve[] = "--serve";
    struct child child;
    struct error err = { 0 };
    int status = 0;
    find_program(path);
    if (!spawn_child((char *[]){ path, serve, NULL }, SPAWN_SOCKET, &child, &err)) {
        problem_set(&printing->problem, PROBLEM_RENDERER, "", "", "the record could not be drawn: %s", err.text);
        return;
    }
    const bool is_good = talk(printing, child.channel);
    (void)close(child.channel);
    if (!is_good)
        (void)kill(child.pid, SIGKILL);
    while (waitpid(child.pid, &status, 0) < 0 && errno == EINTR)
        ;
    if (child.pid_file >= 0)
        (void)close(child.pid_file);
    if (is_good && (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || printing->n_pdf < 5 ||
                    memcmp(printing->pdf, "%PDF-", 5) != 0)) {
        log_error("beamroom-paper ended with status %d after %zu bytes", status, printing->n_pdf);
        problem_set(&printing->problem, PROBLEM_RENDERER, "", "",
                    "the record could not be drawn: the server's log says why");
    }
}

static void *work(void *context)
{
    struct printing *printing = context;
    struct api *api = printing->api;
    draw(printing);
    net_post(api->net, give, printing);
    (void)atomic_fetch_sub(&api->n_printing, 1); /* the last that is done with api and net: http_stop_printing */
    return NULL;
}

/* ---- its beginning and its end ------------------------------------------------------------------------------------ */

static bool join_input(struct printing *printing, const cJSON *paper)
{
    char *json = json_print(paper);
    const size_t n_json = json ? strlen(json) : 0;
    size_t n = sizeof printing->head + n_json;
    for (int i = 0; i < PRINTER_PICTURES; i++)
        n += printing->head.n_pictures[i];
    if (json && n_json <= PRINTER_MAX_JSON)
        printing->input = mem_array(n, 1, UINT64_MAX, NULL);
    if (printing->input) {
        uint8_t *at = printing->input;
        printing->n_input = n;
        printing->head.n_json = (uint32_t)n_json;
        memcpy(at, &printing->head, sizeof printing->head);
        at += sizeof printing->head;
        memcpy(at, json, n_json);
        at += n_json;
        for (int i = 0; i < PRINTER_PICTURES; i++) {
            if (printing->pictures[i])
                memcpy(at, printing->pictures[i], printing->head.n_pictures[i]);
            at += printing->head.n_pictures[i];
            free(printing->pictures[i]);
            printing->pictures[i] = NULL;
        }
    }
    free(json);
    return printing->input != NULL;
}

static bool start(struct printing *printing)
{
    pthread_t thread;
    pthread_attr_t attributes;
    bool is_started = pthread_attr_init(&attributes) == 0;
    if (is_started) {
        (void)pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
        is_started = pthread_create(&thread, &attributes, work, printing) == 0;
        (void)pthread_attr_destroy(&attributes);
    }
    return is_started;
}

void printing_start(struct api *api, struct call *call, struct printing *printing, const cJSON *paper)
{
    struct problem problem = { 0 };
    printing->api = api;
    printing->call = call;
    if (!join_input(printing, paper)) {
        problem_set(&problem, PROBLEM_MEMORY, "", "", "there is no memory for the PDF");
    } else if (atomic_fetch_add(&api->n_printing, 1) >= PRINTING_AT_ONCE || atomic_load(&api->is_printing_stopped)) {
        (void)atomic_fetch_sub(&api->n_printing, 1);
        problem_set(&problem, PROBLEM_BUSY, "", "", "two records are being drawn already");
        problem.retry_after_ms = 1000;
    } else if (start(printing)) {
        return;
    } else {
        (void)atomic_fetch_sub(&api->n_printing, 1);
        problem_set(&problem, PROBLEM_MEMORY, "", "", "there is no memory for the PDF");
    }
    printing_destroy(printing);
    call_answer_problem(call, &problem);
}

void api_stop_printing(struct api *api)
{
    atomic_store(&api->is_printing_stopped, true);
    while (atomic_load(&api->n_printing))
        (void)poll(NULL, 0, LOOK_MS / 10);
}
