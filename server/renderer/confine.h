#pragma once
/* Gives up what a renderer never needs, before the first byte of a plan is read: the network, other files, other
 * programs, and root's capabilities. What the kernel offers is taken; what it got is said. Linux only. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct confine_options {
    const char *plan_folder;  /* may be read */
    const char *cache_folder; /* may be written; NULL: nothing may */
    uint64_t max_bytes;       /* writable memory of its own; 0: no limit */
    bool needs_gpu;           /* device files of graphics drivers stay open to it */
    const char *
        unpack_folder; /* files and folders may be made, moved and removed in it, and nothing else; NULL: nothing may */
    uint64_t
        max_file_bytes;   /* of one file it writes, also of one in memory; more is an error of the write; 0: no limit */
    uint64_t cpu_seconds; /* of processor time, then the kernel ends the process; 0: no limit */
};

/* Call before any other thread starts. got: what holds now, "landlock 3, seccomp, no-new-privs, no capabilities"; what
 * is missing is named with the reason. Never fails: a kernel without these still runs renderers, and says so. */
void confine(const struct confine_options *options, char got[128]);
