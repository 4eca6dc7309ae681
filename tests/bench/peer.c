/* Starts the other program of a benchmark, sends it lines and reads its answers. */
#include "tests/bench/peer.h"

#include <spawn.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/clock.h"

extern char **environ;

const char *peer_python(void)
{
    const char *python = getenv("PYTHON");
    return python ? python : "/usr/bin/python3";
}

static bool read_line(struct peer *peer, char *line, int size)
{
    line[0] = 0;
    return fgets(line, size, peer->from) != NULL;
}

bool peer_start(struct peer *peer, const char *const *arguments, char *line, int size)
{
    int in[2], out[2];
    *peer = (struct peer){ 0 };
    line[0] = 0;
    if (pipe(in) != 0)
        return false;
    if (pipe(out) != 0) {
        close(in[0]);
        close(in[1]);
        return false;
    }
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, in[0], STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
    posix_spawn_file_actions_addclose(&actions, in[1]);
    posix_spawn_file_actions_addclose(&actions, out[0]);
    int failed = posix_spawnp(&peer->pid, arguments[0], &actions, NULL, (char *const *)(uintptr_t)arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    close(in[0]);
    close(out[1]);
    peer->to = fdopen(in[1], "w");
    peer->from = fdopen(out[0], "r");
    if (failed)
        peer->pid = 0;
    else
        (void)read_line(peer, line, size);
    return !failed;
}

bool peer_ask(struct peer *peer, const char *question, char *line, int size)
{
    return fputs(question, peer->to) != EOF && fflush(peer->to) == 0 && read_line(peer, line, size);
}

int peer_end(struct peer *peer)
{
    int status = -1;
    if (peer->to)
        fclose(peer->to);
    for (char rest[256]; peer->from && fgets(rest, sizeof rest, peer->from);) {
    }
    if (peer->from)
        fclose(peer->from);
    bool is_over = peer->pid > 0 && waitpid(peer->pid, &status, 0) == peer->pid && WIFEXITED(status);
    *peer = (struct peer){ 0 };
    return is_over ? WEXITSTATUS(status) : -1;
}

double peer_run_ms(const char *const *arguments, char *line, int size)
{
    struct peer peer;
    int64_t began_us = clock_now_us();
    (void)peer_start(&peer, arguments, line, size);
    return peer_end(&peer) == 0 ? (double)(clock_now_us() - began_us) / 1e3 : -1;
}

bool peer_write_file(char *path, const void *bytes, size_t n)
{
    snprintf(path, PEER_PATH_SIZE, "/tmp/beamroom-bench-XXXXXX");
    int file = mkstemp(path);
    FILE *copy = file < 0 ? NULL : fdopen(file, "w");
    if (!copy)
        return false;
    bool is_written = fwrite(bytes, 1, n, copy) == n;
    return fclose(copy) == 0 && is_written;
}
