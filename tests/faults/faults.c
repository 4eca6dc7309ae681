#define _GNU_SOURCE
/* Replaces malloc, open, read, write, mmap, fork, pthread_create and their relatives in the test program, counts their
 * calls and lets chosen ones fail. */
#include "tests/faults/faults.h"

#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <execinfo.h>
#include <fcntl.h>
#include <pthread.h>
#include <spawn.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

const char *const fault_words[FAULT_N_KINDS] = { "memory", "open", "read", "write", "map", "start" };

/* The definition that would be used without this file: of libc, or of the address sanitizer. */
#define NEXT(name) \
    static __typeof__(&name) next; \
    if (!next) \
    *(void **)&next = dlsym(RTLD_NEXT, #name)

enum { MAX_STACK = 32, N_SLOTS = 1 << 21, MAX_PRINTED = 4 };

static atomic_bool is_armed, is_lasting_fault, has_fired;
static enum fault_kind armed_kind;
static size_t armed_n;
static atomic_size_t counts[FAULT_N_KINDS];
static void *stack[MAX_STACK];
static int n_stack;
static _Thread_local int exempt; /* > 0: calls of this thread are not counted and do not fail */
static _Thread_local int hidden; /* > 0: nor are its blocks: libc keeps them */

static bool fails(enum fault_kind kind)
{
    if (!atomic_load_explicit(&is_armed, memory_order_relaxed) || exempt || hidden)
        return false;
    size_t n = atomic_fetch_add(&counts[kind], 1) + 1;
    if (kind != armed_kind || n < armed_n || (n > armed_n && !atomic_load(&is_lasting_fault)))
        return false;
    if (!atomic_exchange(&has_fired, true)) {
        exempt++;
        n_stack = backtrace(stack, MAX_STACK);
        exempt--;
    }
    return true;
}

static bool fails_with(enum fault_kind kind, int code)
{
    if (!fails(kind))
        return false;
    errno = code;
    return true;
}

/* ---- blocks of memory taken while armed --------------------------------------------------------------------------- */

static void *slots[N_SLOTS]; /* open addressing; GONE where a block was given back */
static char gone;
#define GONE ((void *)&gone)
static pthread_mutex_t slots_mutex = PTHREAD_MUTEX_INITIALIZER;
static atomic_size_t n_kept;

static size_t slot_of(const void *block)
{
    return (size_t)(((uintptr_t)block >> 4) * UINT64_C(0x9e3779b97f4a7c15) >> 40) % N_SLOTS;
}

static void *keep(void *block)
{
    if (!block || !atomic_load_explicit(&is_armed, memory_order_relaxed) || hidden)
        return block;
    pthread_mutex_lock(&slots_mutex);
    size_t at = slot_of(block);
    for (size_t i = 0; i < N_SLOTS && slots[at] && slots[at] != GONE; i++)
        at = (at + 1) % N_SLOTS;
    slots[at] = block;
    atomic_fetch_add(&n_kept, 1);
    pthread_mutex_unlock(&slots_mutex);
    return block;
}

static void forget(void *block)
{
    if (!block || !atomic_load(&n_kept))
        return;
    pthread_mutex_lock(&slots_mutex);
    size_t at = slot_of(block);
    for (size_t i = 0; i < N_SLOTS && slots[at]; i++, at = (at + 1) % N_SLOTS)
        if (slots[at] == block) {
            slots[at] = GONE;
            atomic_fetch_sub(&n_kept, 1);
            break;
        }
    pthread_mutex_unlock(&slots_mutex);
}

void faults_arm(enum fault_kind kind, size_t n, bool is_lasting)
{
    void *first[4];
    (void)backtrace(first, 4); /* the first call loads a library */
    pthread_mutex_lock(&slots_mutex);
    memset(slots, 0, sizeof slots);
    atomic_store(&n_kept, 0);
    pthread_mutex_unlock(&slots_mutex);
    for (int i = 0; i < FAULT_N_KINDS; i++)
        atomic_store(&counts[i], 0);
    armed_kind = kind;
    armed_n = n;
    n_stack = 0;
    atomic_store(&is_lasting_fault, is_lasting);
    atomic_store(&has_fired, false);
    atomic_store(&is_armed, true);
}

static int n_pauses;
static bool was_armed;

void faults_pause(void)
{
    if (n_pauses++ == 0)
        was_armed = atomic_exchange(&is_armed, false);
}

void faults_go_on(void)
{
    if (--n_pauses == 0)
        atomic_store(&is_armed, was_armed);
}

bool faults_disarm(void)
{
    atomic_store(&is_armed, false);
    return atomic_load(&has_fired);
}

size_t faults_count(enum fault_kind kind)
{
    return atomic_load(&counts[kind]);
}

void faults_print_stack(void)
{
    fflush(stdout);
    backtrace_symbols_fd(stack, n_stack, STDOUT_FILENO);
}

#ifdef FAULTS_ADDRESS
extern size_t __asan_get_alloc_stack(void *address, void **trace, size_t size, int *thread_id);
static void print_block(void *block)
{
    void *trace[MAX_STACK];
    int thread;
    size_t n = __asan_get_alloc_stack(block, trace, MAX_STACK, &thread);
    backtrace_symbols_fd(trace, (int)n, STDOUT_FILENO);
}

/* The first caller that is neither libc nor this program's operator new: a library that loses blocks? */
static bool is_lost_by_library(void *block)
{
    static const char *const names[] = { "libdcm", "libofstd", "liboflog", "libijg", "libturbojpeg", "libjpeg" };
    void *trace[MAX_STACK];
    int thread;
    size_t n = __asan_get_alloc_stack(block, trace, MAX_STACK, &thread);
    for (size_t i = 0; i < n && i < 6; i++) {
        Dl_info about;
        if (!dladdr(trace[i], &about) || !about.dli_fname)
            continue;
        for (size_t name = 0; name < sizeof names / sizeof names[0]; name++)
            if (strstr(about.dli_fname, names[name]))
                return true;
    }
    return false;
}
#else
static bool is_lost_by_library(void *block)
{
    (void)block;
    return true; /* nothing says who took it */
}
static void print_block(void *block)
{
    printf("    %p (a build with SAN=address says where it was taken)\n", block);
}
#endif

size_t faults_n_kept_blocks(bool is_library_leaky, bool print)
{
    size_t n = 0;
    for (size_t at = 0; atomic_load(&n_kept) && at < N_SLOTS; at++)
        if (slots[at] && slots[at] != GONE && !(is_library_leaky && is_lost_by_library(slots[at])) &&
            n++ < MAX_PRINTED && print) {
            printf("  not given back, block %zu:\n", n);
            fflush(stdout);
            print_block(slots[at]);
        }
    return n;
}

/* Keeps the name of the time zone, and makes it anew now and then. */
time_t mktime(struct tm *broken_down)
{
    NEXT(mktime);
    hidden++;
    time_t seconds = next(broken_down);
    hidden--;
    return seconds;
}

/* Blocks of operator new are taken from malloc here; leaks are counted by us. */
const char *__asan_default_options(void);
const char *__asan_default_options(void)
{
    return "alloc_dealloc_mismatch=0:detect_leaks=0:handle_segv=0:handle_sigbus=0:handle_abort=0:exitcode=7";
}

/* Asked by the address sanitizer for each new thread, which stops the program without memory for the answer. */
int pthread_getattr_np(pthread_t thread, pthread_attr_t *attributes)
{
    NEXT(pthread_getattr_np);
    hidden++;
    int code = next(thread, attributes);
    hidden--;
    return code;
}

/* ---- memory ------------------------------------------------------------------------------------------------------- */

/* The allocator below; dlsym may allocate itself, so its functions are not looked up. */
#ifdef FAULTS_ADDRESS
#define BELOW(name) __interceptor_##name
#else
#define BELOW(name) __libc_##name
#endif
extern void *BELOW(malloc)(size_t size);
extern void *BELOW(calloc)(size_t n, size_t size);
extern void *BELOW(realloc)(void *block, size_t size);
extern void *BELOW(memalign)(size_t alignment, size_t size);
extern void BELOW(free)(void *block);

void *malloc(size_t size)
{
    return fails_with(FAULT_MEMORY, ENOMEM) ? NULL : keep(BELOW(malloc)(size));
}

void *calloc(size_t n, size_t size)
{
    return fails_with(FAULT_MEMORY, ENOMEM) ? NULL : keep(BELOW(calloc)(n, size));
}

void *realloc(void *block, size_t size)
{
    if (fails_with(FAULT_MEMORY, ENOMEM))
        return NULL;
    bool was_kept = atomic_load(&n_kept) > 0;
    if (was_kept)
        forget(block); /* before: another thread may get the same address at once */
    void *moved = BELOW(realloc)(block, size);
    return keep(moved ? moved : size ? block : NULL) == moved ? moved : NULL;
}

void *reallocarray(void *block, size_t n, size_t size)
{
    size_t bytes;
    if (__builtin_mul_overflow(n, size, &bytes)) {
        errno = ENOMEM;
        return NULL;
    }
    return realloc(block, bytes);
}

void *memalign(size_t alignment, size_t size)
{
    return fails_with(FAULT_MEMORY, ENOMEM) ? NULL : keep(BELOW(memalign)(alignment, size));
}

void *aligned_alloc(size_t alignment, size_t size)
{
    return memalign(alignment, size);
}

int posix_memalign(void **block, size_t alignment, size_t size)
{
    int before = errno;
    void *made = memalign(alignment, size);
    errno = before;
    if (made)
        *block = made;
    return made ? 0 : ENOMEM;
}

void free(void *block)
{
    forget(block);
    BELOW(free)(block);
}

char *strndup(const char *text, size_t most)
{
    size_t n = strnlen(text, most);
    char *copy = malloc(n + 1);
    if (copy) {
        memcpy(copy, text, n);
        copy[n] = 0;
    }
    return copy;
}

char *strdup(const char *text)
{
    return strndup(text, SIZE_MAX);
}

char *__strdup(const char *text); /* what libc's header may make of strdup */
char *__strdup(const char *text)
{
    return strdup(text);
}

/* operator new and delete, by the names that the ABI of C++ gives them; std::__throw_bad_alloc */
void cxx_throw_bad_alloc(void) __asm__("_ZSt17__throw_bad_allocv");
void *cxx_new(size_t size) __asm__("_Znwm");
void *cxx_new_array(size_t size) __asm__("_Znam");
void *cxx_new_nothrow(size_t size, const void *tag) __asm__("_ZnwmRKSt9nothrow_t");
void *cxx_new_array_nothrow(size_t size, const void *tag) __asm__("_ZnamRKSt9nothrow_t");
void cxx_delete(void *block) __asm__("_ZdlPv");
void cxx_delete_array(void *block) __asm__("_ZdaPv");
void cxx_delete_sized(void *block, size_t size) __asm__("_ZdlPvm");
void cxx_delete_array_sized(void *block, size_t size) __asm__("_ZdaPvm");
void cxx_delete_nothrow(void *block, const void *tag) __asm__("_ZdlPvRKSt9nothrow_t");
void cxx_delete_array_nothrow(void *block, const void *tag) __asm__("_ZdaPvRKSt9nothrow_t");

void *cxx_new(size_t size)
{
    void *block = malloc(size ? size : 1);
    if (!block)
        cxx_throw_bad_alloc();
    return block;
}

void *cxx_new_array(size_t size)
{
    void *block = malloc(size ? size : 1);
    if (!block)
        cxx_throw_bad_alloc();
    return block;
}

void *cxx_new_nothrow(size_t size, const void *tag)
{
    (void)tag;
    return malloc(size ? size : 1);
}

void *cxx_new_array_nothrow(size_t size, const void *tag)
{
    (void)tag;
    return malloc(size ? size : 1);
}

void cxx_delete(void *block)
{
    free(block);
}

void cxx_delete_array(void *block)
{
    free(block);
}

void cxx_delete_sized(void *block, size_t size)
{
    (void)size;
    free(block);
}

void cxx_delete_array_sized(void *block, size_t size)
{
    (void)size;
    free(block);
}

void cxx_delete_nothrow(void *block, const void *tag)
{
    (void)tag;
    free(block);
}

void cxx_delete_array_nothrow(void *block, const void *tag)
{
    (void)tag;
    free(block);
}

/* The linker leads every call of mem_new from another file here (--wrap). */
static atomic_size_t largest_small;
void *__real_mem_new(size_t size);
void *__wrap_mem_new(size_t size);
char *__real_mem_copy_text(const char *text);
char *__wrap_mem_copy_text(const char *text);

void *__wrap_mem_new(size_t size)
{
    if (size > atomic_load(&largest_small))
        atomic_store(&largest_small, size);
    const char *print = getenv("FAULTS_SMALL");
    if (print && size > strtoul(print, NULL, 10)) {
        exempt++;
        Dl_info about;
        if (dladdr(__builtin_return_address(0), &about))
            fprintf(stderr, "mem_new of %zu bytes by %s\n", size, about.dli_sname ? about.dli_sname : "?");
        exempt--;
    }
    exempt++;
    void *block = __real_mem_new(size);
    exempt--;
    return block;
}

char *__wrap_mem_copy_text(const char *text)
{
    exempt++;
    char *copy = __real_mem_copy_text(text);
    exempt--;
    return copy;
}

size_t faults_largest_small(void)
{
    return atomic_load(&largest_small);
}

/* ---- opening ------------------------------------------------------------------------------------------------------ */

static mode_t mode_of(int flags, va_list args)
{
    return flags & (O_CREAT | O_TMPFILE) ? va_arg(args, mode_t) : 0;
}

#define OPEN(name, parameters, ...) \
    int name parameters \
    { \
        NEXT(name); \
        va_list args; \
        va_start(args, flags); \
        mode_t mode = mode_of(flags, args); \
        va_end(args); \
        return fails_with(FAULT_OPEN, EMFILE) ? -1 : next(__VA_ARGS__, mode); \
    }
OPEN(open, (const char *path, int flags, ...), path, flags)
OPEN(open64, (const char *path, int flags, ...), path, flags)
OPEN(openat, (int folder, const char *path, int flags, ...), folder, path, flags)
OPEN(openat64, (int folder, const char *path, int flags, ...), folder, path, flags)

/* openat2, which libc has no function for */
long syscall(long number, ...)
{
    NEXT(syscall);
    long values[6];
    va_list args;
    va_start(args, number);
    for (int i = 0; i < 6; i++)
        values[i] = va_arg(args, long);
    va_end(args);
    if (number == SYS_openat2 && fails_with(FAULT_OPEN, EMFILE))
        return -1;
    return next(number, values[0], values[1], values[2], values[3], values[4], values[5]);
}

/* Without a fault: hands on to the next definition, with these arguments. */
#define CALL(kind, code, failed, type, name, parameters, ...) \
    type name parameters; \
    type name parameters \
    { \
        NEXT(name); \
        return fails_with(kind, code) ? (failed) : next(__VA_ARGS__); \
    }

CALL(FAULT_OPEN, EMFILE, -1, int, __open_2, (const char *path, int flags), path, flags)
CALL(FAULT_OPEN, EMFILE, -1, int, __open64_2, (const char *path, int flags), path, flags)
CALL(FAULT_OPEN, EMFILE, -1, int, __openat_2, (int folder, const char *path, int flags), folder, path, flags)
CALL(FAULT_OPEN, EMFILE, -1, int, __openat64_2, (int folder, const char *path, int flags), folder, path, flags)
CALL(FAULT_OPEN, EMFILE, NULL, FILE *, fopen, (const char *path, const char *mode), path, mode)
CALL(FAULT_OPEN, EMFILE, NULL, FILE *, fopen64, (const char *path, const char *mode), path, mode)
CALL(FAULT_OPEN, EMFILE, NULL, DIR *, opendir, (const char *path), path)
CALL(FAULT_OPEN, ENOMEM, NULL, DIR *, fdopendir, (int folder), folder)
CALL(FAULT_OPEN, EMFILE, -1, int, pipe, (int ends[2]), ends)
CALL(FAULT_OPEN, EMFILE, -1, int, pipe2, (int ends[2], int flags), ends, flags)
CALL(FAULT_OPEN, EMFILE, -1, int, socketpair, (int domain, int type, int protocol, int ends[2]), domain, type, protocol,
     ends)
CALL(FAULT_OPEN, EMFILE, -1, int, dup, (int file), file)

/* ---- reading and writing ------------------------------------------------------------------------------------------ */

static bool is_socket(int file)
{
    struct stat about;
    return fstat(file, &about) == 0 && S_ISSOCK(about.st_mode);
}

static bool read_fails(int file)
{
    return fails_with(FAULT_READ, EIO) && (errno = is_socket(file) ? ECONNRESET : EIO);
}

static bool write_fails(int file)
{
    if (file == STDOUT_FILENO || file == STDERR_FILENO || file < 0) /* a line of the log; a stream in memory */
        return false;
    return fails_with(FAULT_WRITE, ENOSPC) && (errno = is_socket(file) ? EPIPE : ENOSPC);
}

#define READ(name, parameters, ...) \
    ssize_t name parameters; \
    ssize_t name parameters \
    { \
        NEXT(name); \
        return read_fails(file) ? -1 : next(__VA_ARGS__); \
    }
READ(read, (int file, void *bytes, size_t n), file, bytes, n)
READ(pread, (int file, void *bytes, size_t n, off_t at), file, bytes, n, at)
READ(pread64, (int file, void *bytes, size_t n, off_t at), file, bytes, n, at)
READ(readv, (int file, const struct iovec *parts, int n), file, parts, n)
READ(recv, (int file, void *bytes, size_t n, int flags), file, bytes, n, flags)
READ(recvmsg, (int file, struct msghdr *message, int flags), file, message, flags)
READ(__read_chk, (int file, void *bytes, size_t n, size_t room), file, bytes, n, room)
READ(__pread_chk, (int file, void *bytes, size_t n, off_t at, size_t room), file, bytes, n, at, room)
READ(__recv_chk, (int file, void *bytes, size_t n, size_t room, int flags), file, bytes, n, room, flags)

#define WRITE(name, parameters, ...) \
    ssize_t name parameters; \
    ssize_t name parameters \
    { \
        NEXT(name); \
        return write_fails(file) ? -1 : next(__VA_ARGS__); \
    }
WRITE(write, (int file, const void *bytes, size_t n), file, bytes, n)
WRITE(pwrite, (int file, const void *bytes, size_t n, off_t at), file, bytes, n, at)
WRITE(pwrite64, (int file, const void *bytes, size_t n, off_t at), file, bytes, n, at)
WRITE(writev, (int file, const struct iovec *parts, int n), file, parts, n)
WRITE(send, (int file, const void *bytes, size_t n, int flags), file, bytes, n, flags)
WRITE(sendmsg, (int file, const struct msghdr *message, int flags), file, message, flags)

size_t fread(void *bytes, size_t size, size_t n, FILE *file)
{
    NEXT(fread);
    if (!read_fails(fileno(file)))
        return next(bytes, size, n, file);
    file->_flags |= 0x20; /* what ferror() asks for in this libc */
    return 0;
}

size_t fwrite(const void *bytes, size_t size, size_t n, FILE *file)
{
    NEXT(fwrite);
    return write_fails(fileno(file)) ? 0 : next(bytes, size, n, file);
}

CALL(FAULT_READ, EIO, NULL, struct dirent *, readdir, (DIR * folder), folder)
CALL(FAULT_READ, EIO, NULL, struct dirent64 *, readdir64, (DIR * folder), folder)
CALL(FAULT_WRITE, ENOSPC, -1, int, rename, (const char *from, const char *to), from, to)
CALL(FAULT_WRITE, ENOSPC, -1, int, renameat, (int from_in, const char *from, int to_in, const char *to), from_in, from,
     to_in, to)
CALL(FAULT_WRITE, ENOSPC, -1, int, mkdir, (const char *path, mode_t mode), path, mode)
CALL(FAULT_WRITE, ENOSPC, -1, int, mkdirat, (int folder, const char *path, mode_t mode), folder, path, mode)
CALL(FAULT_WRITE, EIO, -1, int, fsync, (int file), file)
CALL(FAULT_WRITE, EIO, -1, int, fdatasync, (int file), file)
CALL(FAULT_WRITE, ENOSPC, -1, int, ftruncate, (int file, off_t n), file, n)

/* ---- mapping, starting -------------------------------------------------------------------------------------------- */

CALL(FAULT_MAP, ENOMEM, MAP_FAILED, void *, mmap, (void *at, size_t n, int protection, int flags, int file, off_t from),
     at, n, protection, flags, file, from)
CALL(FAULT_MAP, ENOMEM, MAP_FAILED, void *, mmap64,
     (void *at, size_t n, int protection, int flags, int file, off_t from), at, n, protection, flags, file, from)
CALL(FAULT_START, EAGAIN, -1, pid_t, fork, (void), )
CALL(FAULT_START, EAGAIN, EAGAIN, int, posix_spawn,
     (pid_t * process, const char *path, const posix_spawn_file_actions_t *actions, const posix_spawnattr_t *attributes,
      char *const arguments[], char *const environment[]),
     process, path, actions, attributes, arguments, environment)
CALL(FAULT_START, EAGAIN, EAGAIN, int, pthread_create,
     (pthread_t * thread, const pthread_attr_t *attributes, void *(*run)(void *), void *argument), thread, attributes,
     run, argument)
