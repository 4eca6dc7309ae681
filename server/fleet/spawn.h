#pragma once
/* Starts a child process that inherits one channel and no other descriptor of ours. Knows nothing of plans and
 * packets. */
#include <sys/types.h>

#include "core/base/error.h"

enum spawn_channel {
    SPAWN_SOCKET, /* one end of a socket pair as file 3 */
    SPAWN_OUTPUT  /* a pipe as standard output */
};

struct child {
    pid_t pid;
    int pid_file; /* pidfd, readable when it has ended; -1 where the kernel has none */
    int channel;  /* our end of the channel, non-blocking */
};

/* argv[0] is the program's path. Standard input is /dev/null, standard error is ours; the environment is cut down to
 * what graphics drivers, locales and sanitizers read. The child leads its own process group. errors ERROR_IO with the
 * system's reason */
NODISCARD bool spawn_child(char *const argv[], enum spawn_channel channel, struct child *child, struct error *err);
