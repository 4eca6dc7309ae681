/* The filter program: the list of allowed calls, and rules for calls that are allowed with some arguments. */
#define _GNU_SOURCE
#include "server/renderer/seccomp.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#if defined(__x86_64__)
#define OUR_ARCH AUDIT_ARCH_X86_64
#elif defined(__aarch64__)
#define OUR_ARCH AUDIT_ARCH_AARCH64
#endif

#ifdef OUR_ARCH

/* Calls that are allowed with any arguments. Linux 5.11 and later caches these and does not run the filter for them.
 * Every call that is neither here nor in a rule of add_rules is refused. Each of these calls acts on the process
 * itself, on its open files, or on files that Landlock restricts. */
static const int allowed[] = {
    /* open files */
    SYS_read,
    SYS_write,
    SYS_readv,
    SYS_writev,
    SYS_pread64,
    SYS_pwrite64,
    SYS_preadv,
    SYS_pwritev,
    SYS_preadv2,
    SYS_pwritev2,
    SYS_lseek,
    SYS_close,
    SYS_close_range,
    SYS_dup,
    SYS_dup3,
    SYS_flock,
    SYS_fsync,
    SYS_fdatasync,
    SYS_ftruncate,
    SYS_fallocate,
    SYS_fadvise64,
    SYS_readahead,
    SYS_sync_file_range,
    SYS_pipe2,
    SYS_eventfd2,
    SYS_memfd_create,
    SYS_ppoll,
    SYS_pselect6,
    SYS_epoll_create1,
    SYS_epoll_ctl,
    SYS_epoll_pwait,
    SYS_timerfd_create,
    SYS_timerfd_settime,
    SYS_timerfd_gettime,
    SYS_recvfrom,
    SYS_shutdown,
    /* paths; not modes, owners, times, attributes or links of files */
    SYS_newfstatat,
    SYS_fstat,
    SYS_statx,
    SYS_statfs,
    SYS_fstatfs,
    SYS_faccessat,
    SYS_faccessat2,
    SYS_readlinkat,
    SYS_getdents64,
    SYS_getcwd,
    SYS_mkdirat,
    SYS_unlinkat,
    SYS_renameat,
    SYS_renameat2,
    SYS_umask,
    /* memory */
    SYS_mmap,
    SYS_munmap,
    SYS_mprotect,
    SYS_mremap,
    SYS_madvise,
    SYS_brk,
    SYS_mincore,
    SYS_msync,
    SYS_mlock,
    SYS_mlock2,
    SYS_munlock,
    SYS_membarrier,
    SYS_mbind,
    SYS_get_mempolicy,
    SYS_set_mempolicy,
    /* the own threads and signals, and time */
    SYS_futex,
    SYS_set_robust_list,
    SYS_set_tid_address,
    SYS_rseq,
    SYS_exit,
    SYS_exit_group,
    SYS_restart_syscall,
    SYS_sched_yield,
    SYS_sched_getaffinity,
    SYS_sched_getparam,
    SYS_sched_getscheduler,
    SYS_sched_get_priority_max,
    SYS_sched_get_priority_min,
    SYS_getcpu,
    SYS_rt_sigaction,
    SYS_rt_sigprocmask,
    SYS_rt_sigreturn,
    SYS_rt_sigpending,
    SYS_rt_sigsuspend,
    SYS_rt_sigtimedwait,
    SYS_sigaltstack,
    SYS_nanosleep,
    SYS_clock_nanosleep,
    SYS_clock_gettime,
    SYS_clock_getres,
    SYS_gettimeofday,
    SYS_getitimer,
    SYS_setitimer,
    SYS_timer_create,
    SYS_timer_settime,
    SYS_timer_gettime,
    SYS_timer_delete,
    /* facts about the process and the machine */
    SYS_getpid,
    SYS_gettid,
    SYS_getppid,
    SYS_getuid,
    SYS_geteuid,
    SYS_getgid,
    SYS_getegid,
    SYS_getresuid,
    SYS_getresgid,
    SYS_getgroups,
    SYS_uname,
    SYS_sysinfo,
    SYS_times,
    SYS_getrusage,
    SYS_getrandom,
#ifdef SYS_epoll_pwait2
    SYS_epoll_pwait2,
#endif
#ifdef SYS_futex_waitv
    SYS_futex_waitv,
#endif
#ifdef __x86_64__ /* older forms of the calls above, which only x86-64 has */
    SYS_stat,
    SYS_lstat,
    SYS_access,
    SYS_readlink,
    SYS_mkdir,
    SYS_rmdir,
    SYS_unlink,
    SYS_rename,
    SYS_getdents,
    SYS_poll,
    SYS_select,
    SYS_epoll_create,
    SYS_epoll_wait,
    SYS_eventfd,
    SYS_pipe,
    SYS_dup2,
    SYS_alarm,
    SYS_pause,
    SYS_time,
    SYS_getrlimit,
    SYS_arch_prctl,
#else
    SYS_getrlimit,
#endif
#if SECCOMP_IS_RELAXED
    SYS_execve,
    SYS_execveat,
    SYS_ptrace,
    SYS_clone,
    SYS_clone3,
    SYS_wait4,
    SYS_waitid,
    SYS_prctl,
    SYS_personality,
    SYS_socketpair,
#ifdef SYS_fork
    SYS_fork,
    SYS_vfork,
#endif
#endif
};

enum {
    N_ALLOWED = sizeof allowed / sizeof *allowed,
    MAX_STEPS = 2 * N_ALLOWED + 160,
    NEWEST_KNOWN = 449 /* futex_waitv, Linux 5.16 */
};

#define NEW_NAMESPACES \
    (CLONE_NEWNS | CLONE_NEWCGROUP | CLONE_NEWUTS | CLONE_NEWIPC | CLONE_NEWUSER | CLONE_NEWPID | CLONE_NEWNET)
#define SET_VMA 0x53564d41 /* PR_SET_VMA: names one of its own mappings */

struct program {
    struct sock_filter steps[MAX_STEPS];
    unsigned short n;
};

static void add(struct program *program, uint16_t code, uint32_t k, uint8_t on_true, uint8_t on_false)
{
    if (program->n < MAX_STEPS)
        program->steps[program->n++] = (struct sock_filter){ code, on_true, on_false, k };
}

static void load(struct program *program, size_t offset)
{
    add(program, BPF_LD | BPF_W | BPF_ABS, (uint32_t)offset, 0, 0);
}
static void end_with(struct program *program, uint32_t verdict)
{
    add(program, BPF_RET | BPF_K, verdict, 0, 0);
}
static void allow(struct program *program)
{
    end_with(program, SECCOMP_RET_ALLOW);
}
static void refuse(struct program *program, uint32_t reason)
{
    end_with(program, SECCOMP_RET_ERRNO | reason);
}

static void allow_if(struct program *program, uint32_t value)
{
    add(program, BPF_JMP | BPF_JEQ | BPF_K, value, 0, 1);
    allow(program);
}

static void refuse_if(struct program *program, uint32_t value, uint32_t reason)
{
    add(program, BPF_JMP | BPF_JEQ | BPF_K, value, 0, 1);
    refuse(program, reason);
}

static void refuse_if_any_bit(struct program *program, uint32_t bits)
{
    add(program, BPF_JMP | BPF_JSET | BPF_K, bits, 0, 1);
    refuse(program, EPERM);
}

static void keep_bits(struct program *program, uint32_t bits)
{
    add(program, BPF_ALU | BPF_AND | BPF_K, bits, 0, 0);
}

/* Loads the low 32 bits of argument i (both machines are little-endian): all that the kernel reads of an int. */
static void load_argument(struct program *program, int i)
{
    load(program, offsetof(struct seccomp_data, args) + (size_t)i * sizeof(uint64_t));
}
static void load_high_half(struct program *program, int i)
{
    load(program, offsetof(struct seccomp_data, args) + (size_t)i * sizeof(uint64_t) + 4);
}

/* The steps between begin_rule and end_rule run for one call only, and decide on it. */
static unsigned short begin_rule(struct program *program, uint32_t number)
{
    add(program, BPF_JMP | BPF_JEQ | BPF_K, number, 0, 0);
    return program->n;
}

static void end_rule(struct program *program, unsigned short body)
{
    if (program->n < MAX_STEPS)
        program->steps[body - 1].jf = (uint8_t)(program->n - body);
}

/* Refuses O_TRUNC without write access, for which Landlock before version 3 needs no right, and both bits of the access
 * mode together, for which no version needs one. */
static void add_open_rule(struct program *program, uint32_t number, int flags_at)
{
    unsigned short body = begin_rule(program, number);
    load_argument(program, flags_at);
    keep_bits(program, O_ACCMODE | O_TRUNC);
    refuse_if(program, O_RDONLY | O_TRUNC, EPERM);
    refuse_if(program, O_ACCMODE, EPERM);
    refuse_if(program, O_ACCMODE | O_TRUNC, EPERM);
    allow(program);
    end_rule(program, body);
}

/* Allows fcntl, but not the owner, signal and lease of a file: with these the kernel sends signals to other processes
 * and stops them. */
static void add_fcntl_rule(struct program *program)
{
    static const uint32_t commands[] = { F_DUPFD,     F_DUPFD_CLOEXEC, F_GETFD,      F_SETFD,
                                         F_GETFL,     F_SETFL,         F_GETLK,      F_SETLK,
                                         F_SETLKW,    F_OFD_GETLK,     F_OFD_SETLK,  F_OFD_SETLKW,
                                         F_ADD_SEALS, F_GET_SEALS,     F_GETPIPE_SZ, F_SETPIPE_SZ };
    unsigned short body = begin_rule(program, SYS_fcntl);
    load_argument(program, 1);
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        allow_if(program, commands[i]);
    refuse(program, EPERM);
    end_rule(program, body);
}

/* The second byte of an ioctl request is its kind. Always allowed are a few requests that only read or set
 * flags of the descriptor. Refused are those of terminals, file systems, disks and sockets, which change attributes of
 * files, type into terminals or choose receivers of signals. All others are for graphics drivers, whose device files
 * are the only ones that can be opened. */
static void add_ioctl_rule(struct program *program, bool has_gpu)
{
    static const uint32_t plain_requests[] = { TCGETS, TIOCGWINSZ, FIONREAD, FIONBIO, FIOCLEX, FIONCLEX };
    static const uint32_t other_kinds[] = { 'T', 'f', 'v', 'X', 0x12, 0x89, 0x94 };
    unsigned short body = begin_rule(program, SYS_ioctl);
    load_argument(program, 1);
    for (size_t i = 0; i < sizeof plain_requests / sizeof *plain_requests; i++)
        allow_if(program, plain_requests[i]);
    keep_bits(program, 0xff00);
    for (size_t i = 0; i < sizeof other_kinds / sizeof *other_kinds && has_gpu; i++)
        refuse_if(program, other_kinds[i] << 8, EPERM);
    if (has_gpu)
        allow(program);
    else
        refuse(program, EPERM);
    end_rule(program, body);
}

/* Allows threads, but no processes and no namespaces; limits and signals only for the process itself. */
static void add_process_rules(struct program *program)
{
    static const uint32_t options[] = { PR_SET_NAME, PR_GET_NAME, PR_GET_DUMPABLE, PR_GET_NO_NEW_PRIVS, SET_VMA };
    unsigned short body;
    if (!SECCOMP_IS_RELAXED) {
        refuse_if(program, SYS_clone3,
                  ENOSYS); /* its flags are in memory, where no filter sees them; libc falls back to clone */
        body = begin_rule(program, SYS_clone);
        load_argument(program, 0);
        refuse_if_any_bit(program, NEW_NAMESPACES);
        keep_bits(program, CLONE_THREAD);
        allow_if(program, CLONE_THREAD);
        refuse(program, EPERM);
        end_rule(program, body);

        body = begin_rule(program, SYS_prctl);
        load_argument(program, 0);
        for (size_t i = 0; i < sizeof options / sizeof *options; i++)
            allow_if(program, options[i]);
        refuse(program, EPERM);
        end_rule(program, body);
    }
    /* libc reads and sets limits with prlimit64; abort sends its signal with tgkill */
    static const uint32_t of_a_process[] = { SYS_prlimit64, SYS_tgkill };
    for (size_t i = 0; i < 2; i++) {
        body = begin_rule(program, of_a_process[i]);
        load_argument(program, 0);
        if (of_a_process[i] == SYS_prlimit64)
            allow_if(program, 0);
        allow_if(program, (uint32_t)getpid());
        refuse(program, EPERM);
        end_rule(program, body);
    }
}

static void add_rules(struct program *program, const struct seccomp_options *options)
{
    add_open_rule(program, SYS_openat, 2);
#ifdef SYS_open
    add_open_rule(program, SYS_open, 1);
#endif
    refuse_if(program, SYS_openat2,
              ENOSYS); /* its flags are in memory, where no filter sees them; folder.c falls back to openat */
    add_fcntl_rule(program);
    add_ioctl_rule(program, options->has_gpu);
    add_process_rules(program);
    /* sendto only without an address: a datagram could go to any socket of the machine. sendmsg is refused: its address
     * is in memory, where no filter sees it */
    unsigned short body = begin_rule(program, SYS_sendto);
    load_argument(program, 4);
    add(program, BPF_JMP | BPF_JEQ | BPF_K, 0, 1, 0);
    refuse(program, EPERM);
    load_high_half(program, 4);
    allow_if(program, 0);
    refuse(program, EPERM);
    end_rule(program, body);
}

bool seccomp_restrict(const struct seccomp_options *options)
{
    struct program program = { .n = 0 };
    load(&program, offsetof(struct seccomp_data, arch));
    add(&program, BPF_JMP | BPF_JEQ | BPF_K, OUR_ARCH, 1, 0);
    end_with(&program, SECCOMP_RET_KILL_PROCESS);
    load(&program, offsetof(struct seccomp_data, nr));
    for (int i = 0; i < N_ALLOWED; i++)
        allow_if(&program, (uint32_t)allowed[i]);
    add_rules(&program, options);
    /* Refused calls fail with EPERM. Calls newer than this list fail with ENOSYS, so that libraries fall back to older
     * ones; so do the calls of x32, whose numbers begin at 0x40000000. */
    add(&program, BPF_JMP | BPF_JGT | BPF_K, NEWEST_KNOWN, 0, 1);
    refuse(&program, ENOSYS);
    refuse(&program, EPERM);
    struct sock_fprog filter = { program.n, program.steps };
    return program.n < MAX_STEPS &&
           syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_TSYNC, &filter) == 0;
}

#else
bool seccomp_restrict(const struct seccomp_options *options) /* this file has no call numbers for this architecture */
{
    (void)options;
    return false;
}
#endif
