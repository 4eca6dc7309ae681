/* Limits of a confined renderer: files, the network, processes. The calls of the kernel: test_confine_calls.c. */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <linux/fs.h>
#include <linux/openat2.h>
#include <netinet/in.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/un.h>
#include <sys/xattr.h>
#include <unistd.h>

#include "core/formats/folder.h"
#include "server/renderer/seccomp.h"
#include "tests/check.h"
#include "tests/unit/confined.h"

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
    confined_check("landlock", try_files);
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
    if (connect(at->socket, (struct sockaddr *)&to, sizeof to) == 0 || errno != EPERM)
        return 7;
    struct sockaddr_un name = { .sun_family = AF_UNIX, .sun_path = "/dev/log" };
    if (sendto(at->socket, "x", 1, MSG_NOSIGNAL, (struct sockaddr *)&name, sizeof name) >= 0 || errno != EPERM)
        return 8;
    struct msghdr message = { .msg_name = &name, .msg_namelen = sizeof name };
    if (sendmsg(at->socket, &message, MSG_NOSIGNAL) >= 0 || errno != EPERM)
        return 9;
    char byte;
    if (send(at->socket, "x", 1, MSG_NOSIGNAL) != 1 || recv(at->other_end, &byte, 1, 0) != 1 || byte != 'x')
        return 10; /* as it speaks with the daemon */
    return 0;
}

static void no_network_is_left(void **state)
{
    (void)state;
    confined_check("seccomp", try_network);
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
    confined_check("seccomp", try_processes);
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
    confined_check("seccomp", try_threads);
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
    confined_check("seccomp", try_abort);
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
    if (fcntl(at->socket, F_SETOWN, daemon) == 0 || errno != EPERM)
        return 10;
    int owner = daemon;
    if (ioctl(at->socket, 0x8901 /* FIOSETOWN */, &owner) == 0 || errno != EPERM)
        return 11;
    if (fcntl(at->socket, F_SETSIG, SIGKILL) == 0 || errno != EPERM)
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
    confined_check("seccomp", try_other_processes);
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
    confined_check("seccomp", try_attributes);
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
    confined_check("seccomp", try_truncation);
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
    confined_check("seccomp", try_flags_in_memory);
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
    confined_check_bare(try_folders);
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
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
