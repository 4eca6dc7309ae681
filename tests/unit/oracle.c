/* Runs a Python script of tests/oracle and reads its answer. */
#include "tests/unit/oracle.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/check.h"

extern char **environ;

char *oracle_python(void)
{
    static char debian[] = "/usr/bin/python3";
    char *chosen = getenv("PYTHON");
    return chosen ? chosen : debian;
}

int oracle_run(char *const *arguments, char *out, size_t out_size)
{
    int ends[2];
    assert_int_equal(pipe(ends), 0);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_addclose(&actions, ends[0]);
    pid_t pid;
    int failed = posix_spawnp(&pid, arguments[0], &actions, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    size_t length = 0;
    for (ssize_t got; !failed && length < out_size && (got = read(ends[0], out + length, out_size - length)) > 0;)
        length += (size_t)got;
    close(ends[0]);
    int status = 0;
    if (!failed)
        waitpid(pid, &status, 0);
    if (length == out_size)
        fail_msg("%s printed more than %zu bytes", arguments[1], out_size - 1);
    out[length] = 0;
    return failed ? ORACLE_MISSING : WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/* Whether a program can be started and ends well when asked for its version. */
static bool is_there(const char *program)
{
    char out[4096];
    if (oracle_run((char *[]){ (char *)(uintptr_t)program, "--version", NULL }, out, sizeof out) == 0)
        return true;
    print_message("no %s here\n", program);
    return false;
}

bool oracle_unpack(const char *archive, const char *folder)
{
    char out[4096];
    if (!is_there("tar") || !is_there("xz"))
        return false;
    if (oracle_run((char *[]){ "tar", "-C", (char *)(uintptr_t)folder, "-xJf", (char *)(uintptr_t)archive, NULL }, out,
                   sizeof out) != 0)
        fail_msg("%s cannot be unpacked", archive);
    return true;
}
