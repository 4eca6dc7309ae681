#pragma once
/* Confines the process before it reads the first byte of a plan: no network, no other files, no other programs, no
 * capabilities. Uses Landlock and seccomp where the kernel has them, and reports which it got. Linux only. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct confine_options {
    const char *plan_folder;   /* readable; NULL: none */
    const char *cache_folder;  /* readable and writable; NULL: none */
    uint64_t max_bytes;        /* writable memory of the process; 0: no limit */
    bool needs_gpu;            /* device files of graphics drivers can be opened */
    const char *unpack_folder; /* files and folders in it can be read, made, moved and removed; NULL: none */
    uint64_t max_file_bytes;   /* of one file it writes, also of one in memory; then the write fails; 0: no limit */
    uint64_t cpu_seconds;      /* of processor time, then the kernel ends the process; 0: no limit */
};

/* Call before any other thread starts. got: the protections in force, "landlock 3, seccomp, no-new-privs, no
 * capabilities"; missing ones are named with the reason. Never fails: renderers also run on a kernel without these. */
void confine(const struct confine_options *options, char got[128]);
