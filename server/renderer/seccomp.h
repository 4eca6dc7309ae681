#pragma once
/* The filter on system calls. Allowed are calls on the process's own open files, memory and threads. Refused are
 * sockets, other programs, access to other processes, and changes of modes, owners, times or links of files. */
#include <stdbool.h>

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define SECCOMP_IS_RELAXED 1
#endif
#endif
#if !defined(SECCOMP_IS_RELAXED) && (defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__))
#define SECCOMP_IS_RELAXED 1
#endif
#ifndef SECCOMP_IS_RELAXED
#define SECCOMP_IS_RELAXED \
    0 /* sanitizers start a symbolizer and trace themselves: those calls stay allowed in such builds */
#endif

struct seccomp_options {
    bool has_gpu; /* ioctl on device files of graphics drivers is allowed */
};

/* Installs the filter for this thread and the threads it starts. Needs PR_SET_NO_NEW_PRIVS. False when the kernel has
 * no filters. */
bool seccomp_restrict(const struct seccomp_options *options);
