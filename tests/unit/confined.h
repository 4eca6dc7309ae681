#pragma once
/* Tries something in a child process that is confined as a renderer is. */
#include <stdbool.h>

struct places {
    char folder[64], plan[80], cache[80], elsewhere[80], plan_file[128], cache_file[128], secret[128], link[128];
    int socket, other_end; /* open before the child is confined, as the socket to the daemon is */
};

/* attempt: 0, or a number below 77 that says what is not as it should be. Skips the test where the kernel lacks what is
 * needed: "landlock", "seccomp" or "". */
void confined_check(const char *needed, int (*attempt)(const struct places *at));
/* The child is left as it is, but can gain no privileges: the attempt confines itself. */
void confined_check_bare(int (*attempt)(const struct places *at));
bool can_open(const char *path, int flags);
