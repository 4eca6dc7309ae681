/* Which calls of the kernel a confined renderer has left, and that they are enough. */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <sched.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "server/renderer/seccomp.h"
#include "tests/check.h"
#include "tests/unit/confined.h"

/* Calls nobody here needs, with arguments no kernel accepts: only a filter answers EPERM, or ENOSYS for what is newer
 * than it. */
static const struct {
    const char *name;
    long number;
} needless[] = {
    { "mount", SYS_mount },
    { "umount2", SYS_umount2 },
    { "pivot_root", SYS_pivot_root },
    { "chroot", SYS_chroot },
    { "setns", SYS_setns },
    { "unshare", SYS_unshare },
    { "open_tree", SYS_open_tree },
    { "move_mount", SYS_move_mount },
    { "fsopen", SYS_fsopen },
    { "fsconfig", SYS_fsconfig },
    { "fsmount", SYS_fsmount },
    { "fspick", SYS_fspick },
    { "mount_setattr", SYS_mount_setattr },
    { "keyctl", SYS_keyctl },
    { "add_key", SYS_add_key },
    { "request_key", SYS_request_key },
    { "bpf", SYS_bpf },
    { "perf_event_open", SYS_perf_event_open },
    { "io_uring_setup", SYS_io_uring_setup },
    { "io_uring_enter", SYS_io_uring_enter },
    { "io_uring_register", SYS_io_uring_register },
    { "userfaultfd", SYS_userfaultfd },
    { "vmsplice", SYS_vmsplice },
    { "process_vm_readv", SYS_process_vm_readv },
    { "process_vm_writev", SYS_process_vm_writev },
    { "process_madvise", SYS_process_madvise },
    { "process_mrelease", SYS_process_mrelease },
    { "pidfd_getfd", SYS_pidfd_getfd },
    { "pidfd_send_signal", SYS_pidfd_send_signal },
    { "kcmp", SYS_kcmp },
    { "rt_sigqueueinfo", SYS_rt_sigqueueinfo },
    { "rt_tgsigqueueinfo", SYS_rt_tgsigqueueinfo },
    { "sched_setparam", SYS_sched_setparam },
    { "sched_setattr", SYS_sched_setattr },
    { "migrate_pages", SYS_migrate_pages },
    { "move_pages", SYS_move_pages },
    { "get_robust_list", SYS_get_robust_list },
    { "setxattr", SYS_setxattr },
    { "fremovexattr", SYS_fremovexattr },
    { "mknodat", SYS_mknodat },
    { "linkat", SYS_linkat },
    { "symlinkat", SYS_symlinkat },
    { "fchmodat2", 452 },
    { "quotactl", SYS_quotactl },
    { "quotactl_fd", SYS_quotactl_fd },
    { "swapon", SYS_swapon },
    { "swapoff", SYS_swapoff },
    { "acct", SYS_acct },
    { "syslog", SYS_syslog },
    { "init_module", SYS_init_module },
    { "delete_module", SYS_delete_module },
    { "finit_module", SYS_finit_module },
    { "kexec_load", SYS_kexec_load },
    { "settimeofday", SYS_settimeofday },
    { "clock_settime", SYS_clock_settime },
    { "adjtimex", SYS_adjtimex },
    { "sethostname", SYS_sethostname },
    { "setdomainname", SYS_setdomainname },
    { "setuid", SYS_setuid },
    { "setgid", SYS_setgid },
    { "setresuid", SYS_setresuid },
    { "setgroups", SYS_setgroups },
    { "capset", SYS_capset },
    { "setsid", SYS_setsid },
    { "name_to_handle_at", SYS_name_to_handle_at },
    { "open_by_handle_at", SYS_open_by_handle_at },
    { "fanotify_init", SYS_fanotify_init },
    { "inotify_init1", SYS_inotify_init1 },
    { "shmget", SYS_shmget },
    { "semget", SYS_semget },
    { "msgget", SYS_msgget },
    { "mq_open", SYS_mq_open },
    { "sync", SYS_sync },
    { "vhangup", SYS_vhangup },
    { "splice", SYS_splice },
    { "tee", SYS_tee },
    { "landlock_restrict_self", SYS_landlock_restrict_self },
    { "seccomp", SYS_seccomp },
    { "memfd_secret", 447 },
    { "a call of the future", 2000 },
};

static int try_needless(const struct places *at)
{
    (void)at;
    for (size_t i = 0; i < sizeof needless / sizeof *needless; i++) {
        errno = 0;
        if (syscall(needless[i].number, -1L, -1L, -1L, -1L, -1L, -1L) != -1 || (errno != EPERM && errno != ENOSYS)) {
            (void)fprintf(stderr, "%s: %s\n", needless[i].name, strerror(errno));
            return 1;
        }
    }
    if (!SECCOMP_IS_RELAXED &&
        (prctl(PR_SET_PDEATHSIG, 0) == 0 || errno != EPERM)) /* else it could outlive the daemon */
        return 2;
    return 0;
}

static void calls_that_nobody_here_needs_are_refused(void **state)
{
    (void)state;
    confined_check("seccomp", try_needless);
}

static int try_capabilities(const struct places *at)
{
    (void)at;
    static const char *const sets[] = { "CapInh:", "CapPrm:", "CapEff:", "CapAmb:", "CapBnd:" };
    FILE *file = fopen("/proc/self/status", "re");
    char line[256];
    size_t n_found = 0;
    while (file && fgets(line, sizeof line, file))
        for (size_t i = 0; i < 5; i++)
            if (strncmp(line, sets[i], 7) == 0) {
                n_found++;
                bool is_bounding =
                    i ==
                    4; /* only what had the right to can lower the bounding set; it then bounds what cannot be had */
                if (strtoull(line + 7, NULL, 16) != 0 && !(is_bounding && geteuid() != 0))
                    return (int)i + 1;
            }
    if (!file || n_found != 5)
        return 6;
    return fclose(file) == 0 && prctl(PR_GET_NO_NEW_PRIVS, 0, 0, 0, 0) == 1 ? 0 : 7;
}

static void no_capability_is_left_to_root_either(void **state)
{
    (void)state;
    confined_check("", try_capabilities);
}

/* Everyday calls of libraries and drivers. */
static int try_needed(const struct places *at)
{
    char folder[128], from[160], to[160];
    snprintf(folder, sizeof folder, "%s/d", at->cache);
    snprintf(from, sizeof from, "%s/from", folder);
    snprintf(to, sizeof to, "%s/to", folder);
    if (mkdir(folder, 0700) != 0 || !can_open(from, O_RDWR | O_CREAT | O_EXCL) || rename(from, to) != 0 ||
        unlink(to) != 0 || rmdir(folder) != 0)
        return 1;
    int memory = memfd_create("buffer", MFD_CLOEXEC);
    if (memory < 0 || ftruncate(memory, 4096) != 0)
        return 2;
    void *mapped = mmap(NULL, 4096, PROT_READ | PROT_WRITE, MAP_SHARED, memory, 0);
    if (mapped == MAP_FAILED || mprotect(mapped, 4096, PROT_READ) != 0 || munmap(mapped, 4096) != 0)
        return 3;
    void *code =
        mmap(NULL, 4096, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0); /* as shaders are compiled */
    if (code == MAP_FAILED || mprotect(code, 4096, PROT_READ | PROT_EXEC) != 0)
        return 4;
    int file = open(at->plan_file, O_RDONLY | O_CLOEXEC);
    struct stat facts;
    char byte;
    if (file < 0 || fstat(file, &facts) != 0 || pread(file, &byte, 1, 0) != 1 || flock(file, LOCK_SH) != 0 ||
        lseek(file, 0, SEEK_END) < 1)
        return 5;
    if (prctl(PR_SET_NAME, "worker") != 0 || sysconf(_SC_NPROCESSORS_ONLN) < 1 || sched_yield() != 0 ||
        isatty(file) != 0 || errno != ENOTTY)
        return 6;
    cpu_set_t cores;
    if (sched_getaffinity(0, sizeof cores, &cores) != 0 || fcntl(file, F_SETFD, FD_CLOEXEC) != 0 ||
        fcntl(file, F_DUPFD_CLOEXEC, 10) < 0)
        return 7;
    return 0;
}

/* More than it may write is an error of the write, and no signal. */
static int try_large_file(const struct places *at)
{
    char *block = calloc(1, 1 << 20);
    int file = open(at->cache_file, O_RDWR | O_CREAT, 0600), memory = memfd_create("buffer", MFD_CLOEXEC);
    if (!block || file < 0 || memory < 0 || write(file, block, 1 << 20) != 1 << 20)
        return 1;
    if (write(file, block, 1) != -1 || errno != EFBIG || ftruncate(file, (1 << 20) + 1) == 0 || errno != EFBIG)
        return 2;
    if (posix_fallocate(file, 1 << 20, 1) != EFBIG || ftruncate(memory, (1 << 20) + 1) == 0 || errno != EFBIG)
        return 3;
    free(block);
    return 0;
}

static void no_file_grows_beyond_the_limit(void **state)
{
    (void)state;
    confined_check("", try_large_file);
}

static void what_libraries_and_drivers_need_still_works(void **state)
{
    (void)state;
    confined_check("seccomp", try_needed);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(calls_that_nobody_here_needs_are_refused),
        cmocka_unit_test(no_capability_is_left_to_root_either),
        cmocka_unit_test(no_file_grows_beyond_the_limit),
        cmocka_unit_test(what_libraries_and_drivers_need_still_works),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
