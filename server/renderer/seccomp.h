#pragma once
/* The filter on system calls, a list of what is allowed: the process's own files, memory and threads. No sockets, no
 * other programs, no looking into other processes, none of the calls that change modes, owners, times or links of
 * files. */
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
    bool has_gpu; /* requests to device files of graphics drivers are allowed */
};

/* For this thread and those it will start; PR_SET_NO_NEW_PRIVS must be set. False where the kernel has no filters. */
bool seccomp_restrict(const struct seccomp_options *options);
