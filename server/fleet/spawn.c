/* Starts a child process by posix_spawn with a socket or a pipe, a cut-down environment and nothing else open. */
#define _GNU_SOURCE
#include "server/fleet/spawn.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

extern char **environ;

enum { CHILD_SOCKET = 3 };

/* Environment variables that a child inherits; a prefix ends in '_'. Others may hold secrets. */
static const char *const passed_names[] = {
    "PATH=",
    "LANG=",
    "LC_",
    "TZ=",
    "LD_LIBRARY_PATH=",
    "LP_",
    "MESA_",
    "GALLIUM_",
    "EGL_",
    "LIBGL_",
    "__EGL_",
    "__GLX_",
    "__GL_",
    "NVIDIA_",
    "CUDA_VISIBLE_DEVICES=",
    "ASAN_OPTIONS=",
    "LSAN_OPTIONS=",
    "UBSAN_OPTIONS=",
    "TSAN_OPTIONS=",
};

static char **child_environment(void)
{
    size_t n = 0;
    while (environ[n])
        n++;
    char **kept = calloc(n + 1, sizeof *kept);
    if (!kept)
        return NULL;
    size_t n_kept = 0;
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < sizeof passed_names / sizeof *passed_names; k++)
            if (strncmp(environ[i], passed_names[k], strlen(passed_names[k])) == 0) {
                kept[n_kept++] = environ[i];
                break;
            }
    return kept;
}

static bool make_channel(enum spawn_channel channel, int *ours, int *theirs)
{
    int ends[2];
    if (channel == SPAWN_SOCKET ? socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0
                                : pipe2(ends, O_CLOEXEC) != 0)
        return false;
    *ours = ends[0];
    *theirs = ends[1];
    return fcntl(*ours, F_SETFL, O_NONBLOCK) == 0;
}

static int add_actions(posix_spawn_file_actions_t *actions, enum spawn_channel channel, int theirs)
{
    int failed = posix_spawn_file_actions_addopen(actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    if (channel == SPAWN_SOCKET) {
        if (!failed)
            failed = posix_spawn_file_actions_addopen(actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
        if (!failed)
            failed = posix_spawn_file_actions_adddup2(actions, theirs, CHILD_SOCKET);
        return failed ? failed : posix_spawn_file_actions_addclosefrom_np(actions, CHILD_SOCKET + 1);
    }
    if (!failed)
        failed = posix_spawn_file_actions_adddup2(actions, theirs, STDOUT_FILENO);
    return failed ? failed : posix_spawn_file_actions_addclosefrom_np(actions, STDERR_FILENO + 1);
}

bool spawn_child(char *const argv[], enum spawn_channel channel, struct child *child, struct error *err)
{
    *child = (struct child){ .pid = 0, .pid_file = -1, .channel = -1 };
    int theirs = -1;
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
    /* the daemon blocks the signals it waits for; a child starts with the defaults */
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &all);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);

    char **environment = child_environment();
    int failed = environment ? 0 : ENOMEM;
    if (!failed && !make_channel(channel, &child->channel, &theirs))
        failed = errno;
    if (!failed)
        failed = add_actions(&actions, channel, theirs);
    if (!failed)
        failed = posix_spawn(&child->pid, argv[0], &actions, &attributes, argv, environment);
    if (theirs >= 0)
        close(theirs);
    free(environment);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    if (failed) {
        if (child->channel >= 0)
            close(child->channel);
        child->channel = -1;
        child->pid = 0;
        return error_set(err, ERROR_IO, "%s cannot be started: %s", argv[0], strerror(failed));
    }
    child->pid_file = (int)syscall(SYS_pidfd_open, child->pid, 0);
    return true;
}
