/* What a renderer can no longer do once it is confined. Each test tries it in a child process of its own. */
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <pthread.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "server/renderer/confine.h"
#include "server/renderer/seccomp.h"
#include "tests/check.h"

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

/* Runs attempt in a confined child. 0: all as it should be; else the number it gave; 77: the kernel lacks what is tested. */
static int confined(const struct places *at, const char *needed, int (*attempt)(const struct places *at))
{
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        char got[128];
        confine(&(struct confine_options){ .plan_folder = at->plan, .cache_folder = at->cache, .needs_gpu = true }, got);
        bool is_missing = strstr(got, "landlock not") ? strcmp(needed, "landlock") == 0 : strstr(got, "no seccomp") != NULL;
        _exit(is_missing ? 77 : attempt(at));
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

static void check(const char *needed, int (*attempt)(const struct places *at))
{
    struct places at;
    begin(&at);
    int result = confined(&at, needed, attempt);
    end(&at);
    if (result == 77)
        skip();
    assert_int_equal(result, 0);
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
    if (can_open("/etc/passwd", O_RDONLY) || can_open("/root", O_RDONLY | O_DIRECTORY) || can_open("/home", O_RDONLY | O_DIRECTORY))
        return 6;
    char escape[96];
    snprintf(escape, sizeof escape, "%s/new", at->elsewhere);
    if (unlink(at->plan_file) == 0 || mkdir(escape, 0700) == 0)
        return 7;
    if (!can_open("/usr/share", O_RDONLY | O_DIRECTORY) || !can_open("/proc/self/maps", O_RDONLY) || !can_open("/dev/null", O_RDWR))
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
    int pair[2];
    if (socketpair(AF_UNIX, SOCK_STREAM, 0, pair) != 0)
        return 6; /* harmless: both ends are its own */
    struct sockaddr_in to = { .sin_family = AF_INET, .sin_port = htons(80) };
    if (connect(pair[0], (struct sockaddr *)&to, sizeof to) == 0 || errno != EPERM)
        return 7;
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(only_the_plan_is_read_and_only_the_cache_written),
        cmocka_unit_test(no_network_is_left),
        cmocka_unit_test(no_other_process_is_started_or_reached),
        cmocka_unit_test(threads_still_start),
        cmocka_unit_test(a_signal_to_oneself_still_works),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
