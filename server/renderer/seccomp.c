#define _GNU_SOURCE
#include "server/renderer/seccomp.h"

#include <errno.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#if defined(__x86_64__)
#define OUR_ARCH AUDIT_ARCH_X86_64
#elif defined(__aarch64__)
#define OUR_ARCH AUDIT_ARCH_AARCH64
#endif

#ifdef OUR_ARCH

/* Denied with EPERM, so that a library that tries one sees a plain refusal. A graphics driver's own calls (memory, threads, ioctl,
 * files that Landlock allows) pass: the list names what is never needed here, which keeps new drivers and kernels working. */
static const int denied[] = {
    /* the network, and sockets of other programs on this machine; the pair to the daemon is open already */
    SYS_socket, SYS_connect, SYS_bind, SYS_listen, SYS_accept, SYS_accept4,
    /* other processes */
    SYS_kill, SYS_tkill, SYS_rt_sigqueueinfo, SYS_rt_tgsigqueueinfo, SYS_process_vm_readv, SYS_process_vm_writev, SYS_kcmp,
    SYS_pidfd_open, SYS_pidfd_send_signal, SYS_process_madvise,
#ifdef SYS_pidfd_getfd
    SYS_pidfd_getfd,
#endif
    /* the machine */
    SYS_mount, SYS_umount2, SYS_pivot_root, SYS_chroot, SYS_setns, SYS_unshare, SYS_swapon, SYS_swapoff, SYS_reboot, SYS_init_module,
    SYS_finit_module, SYS_delete_module, SYS_kexec_load, SYS_open_by_handle_at, SYS_name_to_handle_at, SYS_fanotify_init, SYS_quotactl,
    SYS_acct, SYS_settimeofday, SYS_clock_settime, SYS_clock_adjtime, SYS_adjtimex, SYS_sethostname, SYS_setdomainname, SYS_syslog,
    SYS_open_tree, SYS_move_mount, SYS_fsopen, SYS_fsconfig, SYS_fsmount, SYS_fspick, SYS_mknodat,
    /* parts of the kernel that are large and not needed */
    SYS_keyctl, SYS_add_key, SYS_request_key, SYS_bpf, SYS_perf_event_open, SYS_io_uring_setup, SYS_io_uring_enter, SYS_io_uring_register,
    SYS_userfaultfd, SYS_vmsplice, SYS_lookup_dcookie,
#ifdef SYS_mknod
    SYS_mknod, SYS_uselib, SYS_iopl, SYS_ioperm, SYS_modify_ldt,
#endif
#if !SECCOMP_IS_RELAXED
    SYS_execve, SYS_execveat, SYS_ptrace,
#ifdef SYS_fork
    SYS_fork, SYS_vfork,
#endif
#endif
};

enum { N_DENIED = sizeof denied / sizeof *denied, MAX_STEPS = 2 * N_DENIED + 32 };

struct program {
    struct sock_filter steps[MAX_STEPS];
    unsigned short n;
};

static void add(struct program *program, uint16_t code, uint32_t k, uint8_t on_true, uint8_t on_false)
{
    if (program->n < MAX_STEPS)
        program->steps[program->n++] = (struct sock_filter){ code, on_true, on_false, k };
}

static void load(struct program *program, size_t offset) { add(program, BPF_LD | BPF_W | BPF_ABS, (uint32_t)offset, 0, 0); }
static void give(struct program *program, uint32_t verdict) { add(program, BPF_RET | BPF_K, verdict, 0, 0); }

static void refuse_if(struct program *program, uint32_t number, uint32_t reason)
{
    add(program, BPF_JMP | BPF_JEQ | BPF_K, number, 0, 1);
    give(program, SECCOMP_RET_ERRNO | reason);
}

bool seccomp_restrict(void)
{
    static const size_t number = offsetof(struct seccomp_data, nr);
    static const size_t first = offsetof(struct seccomp_data, args); /* little-endian: the low half comes first */
    struct program program = { .n = 0 };
    load(&program, offsetof(struct seccomp_data, arch));
    add(&program, BPF_JMP | BPF_JEQ | BPF_K, OUR_ARCH, 1, 0);
    give(&program, SECCOMP_RET_KILL_PROCESS);
    load(&program, number);
#ifdef __x86_64__
    add(&program, BPF_JMP | BPF_JGE | BPF_K, 0x40000000u, 0, 1); /* the same calls by the numbers of x32 */
    give(&program, SECCOMP_RET_ERRNO | ENOSYS);
#endif
    for (int i = 0; i < N_DENIED; i++)
        refuse_if(&program, (uint32_t)denied[i], EPERM);
    if (!SECCOMP_IS_RELAXED) {
        refuse_if(&program, SYS_clone3, ENOSYS); /* its flags are in memory, where no filter sees them; libc then takes clone */
        add(&program, BPF_JMP | BPF_JEQ | BPF_K, SYS_clone, 0, 4);
        load(&program, first);
        add(&program, BPF_JMP | BPF_JSET | BPF_K, CLONE_THREAD, 1, 0);
        give(&program, SECCOMP_RET_ERRNO | EPERM);
        give(&program, SECCOMP_RET_ALLOW);
        /* a signal to a thread of our own, as abort sends it, and to nobody else */
        add(&program, BPF_JMP | BPF_JEQ | BPF_K, SYS_tgkill, 0, 4);
        load(&program, first);
        add(&program, BPF_JMP | BPF_JEQ | BPF_K, (uint32_t)getpid(), 1, 0);
        give(&program, SECCOMP_RET_ERRNO | EPERM);
        give(&program, SECCOMP_RET_ALLOW);
    }
    give(&program, SECCOMP_RET_ALLOW);
    struct sock_fprog filter = { program.n, program.steps };
    return program.n < MAX_STEPS && syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_TSYNC, &filter) == 0;
}

#else
bool seccomp_restrict(void) { return false; } /* the numbers of this machine's calls are not written down here */
#endif
