/* Confines a child process and lets it try what a test says. */
#include "tests/unit/confined.h"

#include <fcntl.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "server/renderer/confine.h"
#include "tests/check.h"

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

/* Asked of the kernel and not of confine(): what that fails to set up is no reason to skip a test of it. */
static bool kernel_has(const char *needed)
{
    uint32_t action = SECCOMP_RET_ERRNO;
    if (strcmp(needed, "landlock") == 0)
        return syscall(SYS_landlock_create_ruleset, NULL, 0, LANDLOCK_CREATE_RULESET_VERSION) > 0;
    return strcmp(needed, "seccomp") != 0 || syscall(SYS_seccomp, SECCOMP_GET_ACTION_AVAIL, 0, &action) == 0;
}

enum { NOT_BEGUN = 77 };

/* Returns the result of the attempt in a confined child. */
static int confined(struct places *at, bool is_bare, int (*attempt)(const struct places *at))
{
    int pair[2];
    char got[128];
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        if (socketpair(AF_UNIX, SOCK_STREAM, 0, pair) != 0)
            _exit(NOT_BEGUN);
        at->socket = pair[0];
        at->other_end = pair[1];
        if (is_bare)
            _exit(prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 ? attempt(at) : NOT_BEGUN);
        confine(&(struct confine_options){ .plan_folder = at->plan,
                                           .cache_folder = at->cache,
                                           .needs_gpu = true,
                                           .max_file_bytes = 1 << 20 },
                got);
        _exit(attempt(at));
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

static void check(const char *needed, bool is_bare, int (*attempt)(const struct places *at))
{
    struct places at;
    if (!kernel_has(needed))
        skip();
    begin(&at);
    int result = confined(&at, is_bare, attempt);
    end(&at);
    assert_int_equal(result, 0);
}

void confined_check(const char *needed, int (*attempt)(const struct places *at))
{
    check(needed, false, attempt);
}

void confined_check_bare(int (*attempt)(const struct places *at))
{
    check("seccomp", true, attempt);
}

bool can_open(const char *path, int flags)
{
    int file = open(path, flags, 0600);
    if (file >= 0)
        close(file);
    return file >= 0;
}
