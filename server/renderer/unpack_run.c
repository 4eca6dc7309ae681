/* The command --unpack: limits, signals, and lines of JSON. */
#define _GNU_SOURCE
#include "server/renderer/unpack_run.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/log.h"
#include "server/renderer/confine.h"
#include "server/renderer/unpack.h"
#include "server/wire/json.h"

enum { EXIT_REFUSED = 3 };

static volatile sig_atomic_t is_stop_signalled;
static bool is_output_closed; /* standard output cannot be written */

static void stop(int signal_number)
{
    (void)signal_number;
    is_stop_signalled = 1;
}

static bool is_cancelled(void *context)
{
    (void)context;
    return is_stop_signalled || is_output_closed;
}

static void print_line(cJSON *json)
{
    char *text = json_write(json);
    if (puts(text) < 0 || fflush(stdout) != 0)
        is_output_closed = true;
    free(text);
    cJSON_Delete(json);
}

static void print_percent(void *context, double percent)
{
    (void)context;
    cJSON *json = cJSON_CreateObject();
    cJSON_AddNumberToObject(json, "percent", (double)(int)(percent * 10.0) / 10.0);
    print_line(json);
}

static int print_problem(const struct problem *problem)
{
    cJSON *json = cJSON_CreateObject();
    cJSON_AddItemToObject(json, "problem", problem_to_json(problem));
    print_line(json);
    return is_output_closed ? EXIT_FAILURE : EXIT_REFUSED;
}

static void handle_signals(void)
{
    struct sigaction action = { .sa_handler = stop }; /* without SA_RESTART: a blocking call returns EINTR */
    (void)sigemptyset(&action.sa_mask);
    (void)sigaction(SIGTERM, &action, NULL);
    (void)sigaction(SIGINT, &action, NULL);
    (void)sigaction(SIGHUP, &action, NULL);
}

int unpack_run(const char *archive, const char *folder, uint64_t max_unpacked_bytes, uint64_t max_bytes)
{
    struct problem problem = { 0 };
    struct stat facts;
    struct unpack_result result;
    char confined[128];
    handle_signals();
    int from = open(archive, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY),
        into = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (from < 0 || into < 0 || fstat(from, &facts) != 0) {
        (void)problem_set(&problem, PROBLEM_INTERNAL, "", "", "%s cannot be opened: %s",
                          from < 0 ? "the archive" : "the folder to unpack into", strerror(errno));
        return print_problem(&problem);
    }
    struct confine_options limits = {
        .unpack_folder = folder,
        .max_bytes = max_bytes > 0 ? max_bytes : UNPACK_MEMORY_BYTES,
        .cpu_seconds =
            unpack_cpu_seconds(facts.st_size > 0 ? (uint64_t)facts.st_size : 0, max_unpacked_bytes) + UNPACK_CPU_S,
    };
    confine(&limits, confined);
    log_info("unpacking %llu bytes; %s", (unsigned long long)facts.st_size, confined);
    struct unpack_options options = { .max_bytes = max_unpacked_bytes,
                                      .is_cancelled = is_cancelled,
                                      .progress = print_percent };
    if (!unpack(from, into, &options, &result, &problem))
        return print_problem(&problem);
    cJSON *json = cJSON_CreateObject();
    cJSON_AddBoolToObject(json, "done", true);
    cJSON_AddNumberToObject(json, "n_files", (double)result.n_files);
    cJSON_AddNumberToObject(json, "n_bytes", (double)result.n_bytes);
    print_line(json);
    return is_output_closed ? EXIT_FAILURE : EXIT_SUCCESS;
}
