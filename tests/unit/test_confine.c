/* What a renderer can no longer do once it is confined. Each test tries it in a child process of its own. */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <linux/fs.h>
#include <linux/openat2.h>
#include <netinet/in.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <sys/xattr.h>
#include <unistd.h>

#include "core/formats/folder.h"
#include "server/renderer/confine.h"
#include "server/renderer/seccomp.h"
#include "tests/check.h"

static int given_socket, given_other_end; /* open before a child is confined, as the socket to the daemon is */

struct places {
    char folder[64], plan[80], cache[80], elsewhere[80], plan_file[128], cache_file[128], secret[128], link[128];
};

static void write_file(const char *path)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs("something", file);
    fclose(file);
}

static void begin(struct places *at)
{
    snprintf(at->folder, sizeof at->folder, "/tmp/beamroom-confine-XXXXXX");
    assert_non_null(mkdtemp(at->folder));
    snprintf(at->plan, sizeof at->plan, "%s/plan", at->folder);
    snprintf(at->cache, sizeof at->cache, "%s/cache", at->folder);
    snprintf(at->elsewhere, sizeof at->elsewhere, "%s/elsewhere", at->folder);
    assert_int_equal(mkdir(at->plan, 0700) | mkdir(at->cache, 0700) | mkdir(at->elsewhere, 0700), 0);
    snprintf(at->plan_file, sizeof at->plan_file, "%s/ct", at->plan);
    snprintf(at->cache_file, sizeof at->cache_file, "%s/shader", at->cache);
    snprintf(at->secret, sizeof at->secret, "%s/secret", at->elsewhere);
    snprintf(at->link, sizeof at->link, "%s/link", at->plan);
    write_file(at->plan_file);
    write_file(at->secret);
    assert_int_equal(symlink(at->secret, at->link), 0);
}

static void end(const struct places *at)
{
    unlink(at->link);
    unlink(at->plan_file);
    unlink(at->secret);
    unlink(at->cache_file);
    rmdir(at->plan);
    rmdir(at->cache);
    rmdir(at->elsewhere);
    rmdir(at->folder);
}

/* Runs attempt in a confined child. 0: all as it should be; else the number it gave; 77: the kernel lacks what is
 * tested. */
static int confined(const struct places *at, const char *needed, bool is_bare, int (*attempt)(const struct places *at))
{
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        char got[128];
        int pair[2];
        if (socketpair(AF_UNIX, SOCK_STREAM, 0, pair) != 0)
            _exit(99);
        given_socket = pair[0];
        given_other_end = pair[1];
        if (is_bare) /* the attempt confines itself */
            _exit(prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 ? attempt(at) : 98);
        confine(&(struct confine_options){ .plan_folder = at->plan,
                                           .cache_folder = at->cache,
                                           .needs_gpu = true,
                                           .max_file_bytes = 1 << 20 },
                got);
        bool is_missing =
            strstr(got, "landlock not") ? strcmp(needed, "landlock") == 0 : strstr(got, "no seccomp") != NULL;
        _exit(is_missing ? 77 : attempt(at));
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

static void check_with(const char *needed, bool is_bare, int (*attempt)(const struct places *at))
{
    struct places at;
    begin(&at);
    int result = confined(&at, needed, is_bare, attempt);
    end(&at);
    if (result == 77)
        skip();
    assert_int_equal(result, 0);
}

static void check(const char *needed, int (*attempt)(const struct places *at))
{
    check_with(needed, false, attempt);
}

static bool can_open(const char *path, int flags)
{
    int file = open(path, flags, 0600);
    if (file >= 0)
        close(file);
    return file >= 0;
}

static int try_files(const struct places *at)
{
    if (!can_open(at->plan_file, O_RDONLY))
        return 1;
    if (can_open(at->plan_file, O_WRONLY))
        return 2;
    if (can_open(at->secret, O_RDONLY))
        return 3;
    if (can_open(at->link, O_RDONLY)) /* a plan's link leads nowhere */
        return 4;
    if (!can_open(at->cache_file, O_RDWR | O_CREAT))
        return 5;
    if (can_open("/etc/passwd", O_RDONLY) || can_open("/root", O_RDONLY | O_DIRECTORY) ||
        can_open("/home", O_RDONLY | O_DIRECTORY))
        return 6;
    char escape[96];
    snprintf(escape, sizeof escape, "%s/new", at->elsewhere);
    if (unlink(at->plan_file) == 0 || mkdir(escape, 0700) == 0)
        return 7;
    if (!can_open("/usr/share", O_RDONLY | O_DIRECTORY) || !can_open("/proc/self/maps", O_RDONLY) ||
        !can_open("/dev/null", O_RDWR))
        return 8;
    return 0;
}

static void only_the_plan_is_read_and_only_the_cache_written(void **state)
{
    (void)state;
    check("landlock", try_files);
}

static int try_network(const struct places *at)
{
    (void)at;
    int families[] = { AF_INET, AF_INET6, AF_UNIX, 16 /* netlink */, 40 /* vsock */ };
    for (int i = 0; i < 5; i++)
        if (socket(families[i], SOCK_STREAM, 0) >= 0 || errno != EPERM)
            return i + 1;
    /* a datagram socket of a pair reaches every socket of the file system by sendto and sendmsg */
    int pair[2];
    if (!SECCOMP_IS_RELAXED && (socketpair(AF_UNIX, SOCK_DGRAM, 0, pair) == 0 || errno != EPERM))
        return 6;
    struct sockaddr_in to = { .sin_family = AF_INET, .sin_port = htons(80) };
    if (connect(given_socket, (struct sockaddr *)&to, sizeof to) == 0 || errno != EPERM)
        return 7;
    struct sockaddr_un name = { .sun_family = AF_UNIX, .sun_path = "/dev/log" };
    if (sendto(given_socket, "x", 1, MSG_NOSIGNAL, (struct sockaddr *)&name, sizeof name) >= 0 || errno != EPERM)
        return 8;
    struct msghdr message = { .msg_name = &name, .msg_namelen = sizeof name };
    if (sendmsg(given_socket, &message, MSG_NOSIGNAL) >= 0 || errno != EPERM)
        return 9;
    char byte;
    if (send(given_socket, "x", 1, MSG_NOSIGNAL) != 1 || recv(given_other_end, &byte, 1, 0) != 1 || byte != 'x')
        return 10; /* as it speaks with the daemon */
    return 0;
}

static void no_network_is_left(void **state)
{
    (void)state;
    check("seccomp", try_network);
}

static int try_processes(const struct places *at)
{
    (void)at;
    if (kill(getppid(), 0) == 0 || errno != EPERM)
        return 1;
    if (SECCOMP_IS_RELAXED)
        return 0;
    if (fork() >= 0 || errno != EPERM)
        return 2;
    char *arguments[] = { "/bin/true", NULL };
    if (execv("/bin/true", arguments) == 0 || (errno != EPERM && errno != EACCES))
        return 3;
    struct rlimit core;
    if (getrlimit(RLIMIT_CORE, &core) != 0 || core.rlim_max != 0)
        return 4;
    return 0;
}

static void no_other_process_is_started_or_reached(void **state)
{
    (void)state;
    check("seccomp", try_processes);
}

static void *mark(void *argument)
{
    *(int *)argument = 1;
    return NULL;
}

static int try_threads(const struct places *at)
{
    (void)at;
    pthread_t thread;
    int is_marked = 0;
    return pthread_create(&thread, NULL, mark, &is_marked) == 0 && pthread_join(thread, NULL) == 0 && is_marked ? 0 : 1;
}

static void threads_still_start(void **state)
{
    (void)state;
    check("seccomp", try_threads);
}

static int try_abort(const struct places *at)
{
    (void)at;
    signal(SIGABRT, SIG_DFL);
    return raise(SIGCONT) == 0 ? 0 : 1; /* as abort sends its own: tgkill to itself */
}

static void a_signal_to_oneself_still_works(void **state)
{
    (void)state;
    check("seccomp", try_abort);
}

/* ---- other processes -------------------------------------------------------------------------------------------- */

static int try_other_processes(const struct places *at)
{
    (void)at;
    pid_t daemon = getppid();
    struct rlimit limit;
    if (prlimit(daemon, RLIMIT_NOFILE, NULL, &limit) == 0 || errno != EPERM)
        return 1;
    limit = (struct rlimit){ 16, 16 };
    if (prlimit(daemon, RLIMIT_NOFILE, &limit, NULL) == 0 || errno != EPERM)
        return 2;
    if (setpriority(PRIO_PROCESS, (id_t)daemon, 10) == 0 || errno != EPERM)
        return 3;
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(0, &one);
    if (sched_setaffinity(daemon, sizeof one, &one) == 0 || errno != EPERM)
        return 4;
    struct sched_param idle = { 0 };
    if (sched_setscheduler(daemon, SCHED_IDLE, &idle) == 0 || errno != EPERM)
        return 5;
    if (syscall(SYS_ioprio_set, 1 /* a process */, daemon, 3 << 13 /* idle */) == 0 || errno != EPERM)
        return 6;
    if (syscall(SYS_tgkill, daemon, daemon, 0) == 0 || errno != EPERM)
        return 7;
    if (syscall(SYS_tkill, daemon, 0) == 0 || errno != EPERM)
        return 8;
    if (syscall(SYS_pidfd_open, daemon, 0) >= 0 || errno != EPERM)
        return 9;
    /* the kernel would send it the signal when the socket becomes readable */
    if (fcntl(given_socket, F_SETOWN, daemon) == 0 || errno != EPERM)
        return 10;
    int owner = daemon;
    if (ioctl(given_socket, 0x8901 /* FIOSETOWN */, &owner) == 0 || errno != EPERM)
        return 11;
    if (fcntl(given_socket, F_SETSIG, SIGKILL) == 0 || errno != EPERM)
        return 12;
    if (setpgid(0, getpgid(daemon)) == 0 || errno != EPERM) /* out of the group that the daemon ends */
        return 13;
    /* of its own it may know the limits, and set them lower */
    if (prlimit(0, RLIMIT_STACK, NULL, &limit) != 0 || prlimit(getpid(), RLIMIT_STACK, &limit, NULL) != 0)
        return 14;
    return 0;
}

static void limits_priorities_and_signals_of_other_processes_are_out_of_reach(void **state)
{
    (void)state;
    check("seccomp", try_other_processes);
}

/* ---- what belongs to files, and is not in them ------------------------------------------------------------------ */

static int try_attributes(const struct places *at)
{
    int file = open(at->plan_file, O_RDONLY | O_CLOEXEC);
    struct timespec times[2] = { { .tv_sec = 1 }, { .tv_sec = 1 } };
    char link_name[160];
    snprintf(link_name, sizeof link_name, "%s/second", at->cache);
    if (file < 0)
        return 1;
    if (chmod(at->plan_file, 0777) == 0 || errno != EPERM || chmod(at->secret, 0777) == 0 || errno != EPERM)
        return 2;
    if (fchmod(file, 0777) == 0 || errno != EPERM || fchmodat(AT_FDCWD, at->secret, 0777, 0) == 0 || errno != EPERM)
        return 3;
    if (chown(at->secret, getuid(), getgid()) == 0 || errno != EPERM || fchown(file, getuid(), getgid()) == 0 ||
        errno != EPERM)
        return 4;
    if (lchown(at->secret, getuid(), getgid()) == 0 || errno != EPERM ||
        fchownat(AT_FDCWD, at->secret, getuid(), getgid(), 0) == 0 || errno != EPERM)
        return 5;
    if (setxattr(at->secret, "user.mark", "x", 1, 0) == 0 || errno != EPERM ||
        fsetxattr(file, "user.mark", "x", 1, 0) == 0 || errno != EPERM)
        return 6;
    if (lsetxattr(at->secret, "user.mark", "x", 1, 0) == 0 || errno != EPERM ||
        removexattr(at->secret, "user.mark") == 0 || errno != EPERM)
        return 7;
    if (utimensat(AT_FDCWD, at->secret, times, 0) == 0 || errno != EPERM || futimens(file, times) == 0 ||
        errno != EPERM)
        return 8;
    if (utimes(at->secret, NULL) == 0 || errno != EPERM)
        return 9;
    if (link(at->plan_file, link_name) == 0 || errno != EPERM || symlink(at->secret, link_name) == 0 ||
        errno != EPERM || mkfifo(link_name, 0600) == 0 || errno != EPERM)
        return 10;
    int flags = FS_NOATIME_FL;
    if (ioctl(file, FS_IOC_SETFLAGS, &flags) == 0 || errno != EPERM)
        return 11;
    if (fcntl(file, F_SETLEASE, F_RDLCK) == 0 || errno != EPERM)
        return 12;
    if (ioctl(file, TIOCSTI, "x") == 0 ||
        errno != EPERM) /* a key, as if pressed at the terminal the daemon was started from */
        return 13;
    return close(file);
}

static void modes_owners_times_and_links_of_files_cannot_be_changed(void **state)
{
    (void)state;
    check("seccomp", try_attributes);
}

/* Older Landlocks know no right to cut a file short: the ways that pass them by are closed. */
static int try_truncation(const struct places *at)
{
    struct stat facts;
    if (truncate(at->secret, 0) == 0 || errno != EPERM || truncate(at->plan_file, 0) == 0 || errno != EPERM)
        return 1;
    if (open(at->plan_file, O_RDONLY | O_TRUNC) >= 0 || errno != EPERM ||
        openat(AT_FDCWD, at->secret, O_ACCMODE | O_TRUNC) >= 0 || errno != EPERM)
        return 2;
    if (creat(at->secret, 0600) >= 0)
        return 3;
    if (stat(at->plan_file, &facts) != 0 || facts.st_size == 0)
        return 4;
    int own = open(at->cache_file, O_RDWR | O_CREAT | O_TRUNC, 0600); /* in its cache it may */
    return own >= 0 && write(own, "abc", 3) == 3 && ftruncate(own, 1) == 0 ? close(own) : 5;
}

static void a_file_that_may_only_be_read_cannot_be_cut_short(void **state)
{
    (void)state;
    check("seccomp", try_truncation);
}

static int try_flags_in_memory(const struct places *at)
{
    struct open_how how = { .flags = O_ACCMODE | O_CLOEXEC };
    if (syscall(SYS_openat2, AT_FDCWD, at->plan_file, &how, sizeof how) != -1)
        return 1;
    return errno == ENOSYS ? 0 : 2;
}

static void the_call_whose_open_flags_no_filter_sees_is_missing(void **state)
{
    (void)state;
    check("seccomp", try_flags_in_memory);
}

/* The call that opens beneath a folder is refused: its flags cannot be seen. Folders of plans are read without it. */
static int try_folders(const struct places *at)
{
    struct error err = { 0 };
    struct folder folder;
    struct bytes bytes;
    if (!seccomp_restrict(&(struct seccomp_options){ .has_gpu = false }) ||
        syscall(SYS_openat2, -1L, -1L, -1L, -1L) != -1 || errno != ENOSYS)
        return 1;
    if (!folder_open(&folder, at->folder, &err))
        return 2;
    static const char *const good[] = { "plan/ct", "plan//ct", "plan/./ct",
                                        "plan/link" /* leads elsewhere in the folder */ };
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        if (!folder_read(&folder, good[i], 100, 100, &bytes, &err) || bytes.size != 9)
            return 10 + (int)i;
        bytes_free(&bytes);
    }
    if (folder_look(&folder, "plan", NULL) != FOLDER_DIRECTORY ||
        folder_look(&folder, "plan/none", NULL) != FOLDER_ABSENT ||
        folder_look(&folder, "plan/ct/x", NULL) != FOLDER_ABSENT)
        return 3;
    folder_close(&folder);
    if (!folder_open(&folder, at->plan, &err))
        return 4;
    if (folder_read(&folder, "link", 100, 100, &bytes, &err) || folder_look(&folder, "link", NULL) != FOLDER_OTHER)
        return 5;
    folder_close(&folder);
    return 0;
}

static void a_plan_is_read_without_the_call_that_opens_beneath_a_folder(void **state)
{
    (void)state;
    check_with("seccomp", true, try_folders);
}

/* ---- the kernel ------------------------------------------------------------------------------------------------- */

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
    check("seccomp", try_needless);
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
    check("", try_capabilities);
}

/* What libraries and drivers do all day. */
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
    check("", try_large_file);
}

static void what_libraries_and_drivers_need_still_works(void **state)
{
    (void)state;
    check("seccomp", try_needed);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(only_the_plan_is_read_and_only_the_cache_written),
        cmocka_unit_test(no_network_is_left),
        cmocka_unit_test(no_other_process_is_started_or_reached),
        cmocka_unit_test(threads_still_start),
        cmocka_unit_test(a_signal_to_oneself_still_works),
        cmocka_unit_test(limits_priorities_and_signals_of_other_processes_are_out_of_reach),
        cmocka_unit_test(modes_owners_times_and_links_of_files_cannot_be_changed),
        cmocka_unit_test(a_file_that_may_only_be_read_cannot_be_cut_short),
        cmocka_unit_test(the_call_whose_open_flags_no_filter_sees_is_missing),
        cmocka_unit_test(a_plan_is_read_without_the_call_that_opens_beneath_a_folder),
        cmocka_unit_test(calls_that_nobody_here_needs_are_refused),
        cmocka_unit_test(no_capability_is_left_to_root_either),
        cmocka_unit_test(no_file_grows_beyond_the_limit),
        cmocka_unit_test(what_libraries_and_drivers_need_still_works),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
