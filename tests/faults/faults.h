#pragma once
/* Faults on demand: the n-th allocation, open, read, write, mapping or start of a process or thread fails as it does in
 * life. faults.c defines malloc, open, read, ... in the test program itself, so that every library of the process binds
 * to them; what libc does within itself (the open within fopen) is covered by defining the outer call as well.
 * mem_new and mem_copy_text never fail: they abort by design (core/base/mem.h). Any thread. */
#include <stdbool.h>
#include <stddef.h>

enum fault_kind {
    FAULT_MEMORY, /* malloc, calloc, realloc, posix_memalign, strdup, operator new: ENOMEM */
    FAULT_OPEN,   /* open, openat, fopen, opendir, pipe, socketpair, dup: EMFILE */
    FAULT_READ,   /* read, pread, readv, recv, fread, readdir: EIO; of a socket ECONNRESET */
    FAULT_WRITE,  /* write, pwrite, fwrite, rename, mkdir, fsync, ftruncate: ENOSPC; of a socket EPIPE */
    FAULT_MAP,    /* mmap: ENOMEM */
    FAULT_START,  /* fork, posix_spawn, pthread_create: EAGAIN */
    FAULT_N_KINDS
};
extern const char *const fault_words[FAULT_N_KINDS];

/* Starts counting calls; the n-th of the kind fails (n >= 1), and with is_lasting every later one too. */
void faults_arm(enum fault_kind kind, size_t n, bool is_lasting);
/* Between them no call is counted and none fails: for what a test itself does. On one thread; may be nested. */
void faults_pause(void);
void faults_go_on(void);
/* Ends it. Returns true when a call has failed. */
bool faults_disarm(void);
/* Calls of the kind since faults_arm. */
size_t faults_count(enum fault_kind kind);
/* Prints the stack of the call that failed first. */
void faults_print_stack(void);

/* Blocks of memory taken since faults_arm and not given back; with print each one's stack (the first few).
 * is_library_leaky: without those that DCMTK or libjpeg-turbo lost themselves; only the address sanitizer tells them,
 * else 0 is given. */
size_t faults_n_kept_blocks(bool is_library_leaky, bool print);
/* The largest block that mem_new gave since the program began. */
size_t faults_largest_small(void);
