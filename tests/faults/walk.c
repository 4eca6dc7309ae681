#define _GNU_SOURCE
/* Runs a piece of work once for each fault in a child process, and compares memory, descriptors, files and result. */
#include "tests/faults/walk.h"

#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <execinfo.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/clock.h"

/* Every n up to here; then each is larger than the one before by a share of it, so that a walk of a hundred thousand
 * calls ends. FAULTS=whole walks further and closer. */
enum {
    EVERY = 40,
    EVERY_WHOLE = 400,
    SHARE = 4,
    SHARE_WHOLE = 40,
    MAX_FINDINGS = 12,
    SECONDS_A_RUN = 60,
    SETTLE_MS = 100
};

enum { MS_A_WALK = 150, MS_A_WALK_WHOLE = 20000 };

static int n_failed;

/* Progress of a walking child, shared with the parent. */
struct progress {
    atomic_size_t n;      /* that it is at */
    atomic_bool is_ended; /* a run had no fault left */
    atomic_size_t n_faults;
};

void outcome_add(struct outcome *outcome, const void *bytes, size_t n)
{
    const unsigned char *at = bytes;
    uint64_t h = outcome->digest ? outcome->digest : UINT64_C(0xcbf29ce484222325); /* FNV-1a */
    for (size_t i = 0; i < n; i++)
        h = (h ^ at[i]) * UINT64_C(0x100000001b3);
    outcome->digest = h;
}

void outcome_add_text(struct outcome *outcome, const char *text)
{
    outcome_add(outcome, text, strlen(text) + 1);
}

void outcome_add_number(struct outcome *outcome, double number)
{
    outcome_add(outcome, &number, sizeof number);
}

void outcome_note(struct outcome *outcome, const char *text)
{
    size_t n = strlen(outcome->notes);
    snprintf(outcome->notes + n, sizeof outcome->notes - n, "%s%s", n ? " | " : "", text);
}

static size_t count_names(const char *path)
{
    size_t n = 0;
    DIR *folder = opendir(path);
    if (!folder)
        return 0;
    while (readdir(folder))
        n++;
    closedir(folder);
    return n;
}

static size_t count_files(void)
{
    return count_names("/proc/self/fd");
}

/* Names below a folder, and how long each file is. */
static uint64_t digest_of_names(const char *folder)
{
    struct outcome sum = { 0 };
    uint64_t all = 0;
    DIR *names = folder ? opendir(folder) : NULL;
    if (!names)
        return 0;
    for (struct dirent *entry; (entry = readdir(names));) {
        char path[1024];
        if (entry->d_name[0] == '.' && (!entry->d_name[1] || entry->d_name[1] == '.'))
            continue;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        sum.digest = 0;
        outcome_add_text(&sum, entry->d_name);
        all += sum.digest + (entry->d_type == DT_DIR ? 3 * digest_of_names(path) : 0); /* in any order */
    }
    closedir(names);
    return all;
}

struct walking {
    const struct walk *walk;
    enum fault_kind kind;
    bool is_lasting;
    struct outcome clean;
    size_t n_files;
    uint64_t names;
    const char *why; /* what is wrong with the last run; NULL: nothing */
    size_t n_kept;
    struct progress *progress;
};

static bool run_once(struct walking *walking, size_t n, struct outcome *outcome)
{
    *outcome = (struct outcome){ 0 };
    faults_arm(walking->kind, n, walking->is_lasting);
    walking->walk->run(walking->walk->context, outcome);
    return faults_disarm();
}

/* A lack of memory is said as one, and so may be a lack of descriptors; else an error of the disk, or a sentence that
 * ends in what the system said. */
static bool is_right_code(const struct walking *walking, const struct outcome *outcome)
{
    const char *text = outcome->err.text;
    if (outcome->problem.type)
        return outcome->problem.type == PROBLEM_INTERNAL || outcome->problem.type == PROBLEM_STORAGE ||
               outcome->problem.type == PROBLEM_MEMORY || outcome->problem.type == PROBLEM_RENDERER;
    if (outcome->err.code == ERROR_MEMORY)
        return walking->kind != FAULT_READ && walking->kind != FAULT_WRITE;
    if (walking->kind == FAULT_MEMORY)
        return strstr(text, strerror(ENOMEM)) != NULL;
    return outcome->err.code == ERROR_IO || strstr(text, strerror(EIO)) || strstr(text, strerror(EMFILE));
}

static const char *judge(const struct walking *walking, const struct outcome *outcome, bool has_fired)
{
    const char *text = outcome->problem.type ? outcome->problem.detail : outcome->err.text;
    if (outcome->is_done && outcome->digest != walking->clean.digest && !outcome->is_told)
        return "done, and the result is another one";
    if (!outcome->is_done && !has_fired)
        return "failed, and no call had failed";
    if (!outcome->is_done && (strlen(text) < 10 || (!outcome->err.code && !outcome->problem.type)))
        return "failed without a sentence";
    if (!outcome->is_done && !is_right_code(walking, outcome))
        return "failed with a code that says something else";
    return NULL;
}

/* Waits until threads of the run that nobody joins have given back all they hold. */
static void settle(const struct walking *walking)
{
    for (int i = 0; i < SETTLE_MS &&
                    (faults_n_kept_blocks(walking->walk->is_library_leaky, false) || count_files() != walking->n_files);
         i++)
        usleep(1000);
}

/* Judges the n-th run. What stays in memory counts when it stays again: libraries keep some things for ever. */
static bool is_good(struct walking *walking, size_t n, bool *has_fired)
{
    struct outcome outcome = { 0 };
    size_t n_kept = 0;
    for (int again = 0; again < 3; again++) {
        *has_fired = run_once(walking, n, &outcome);
        settle(walking);
        n_kept = faults_n_kept_blocks(walking->walk->is_library_leaky, false);
        walking->why = judge(walking, &outcome, *has_fired);
        if (walking->why || n_kept == 0)
            break;
    }
    if (!walking->why && n_kept) {
        walking->why = "memory was not given back";
        (void)faults_n_kept_blocks(walking->walk->is_library_leaky, true);
    }
    if (!walking->why && count_files() != walking->n_files)
        walking->why = "a descriptor was left open";
    if (!walking->why && walking->walk->folder && digest_of_names(walking->walk->folder) != walking->names)
        walking->why = "files were left behind";
    if (!walking->why)
        return true;
    printf("%s: %s %zu%s: %s\n  result: %s%d \"%s%s\" %s\n", walking->walk->name, fault_words[walking->kind], n,
           walking->is_lasting ? " and all later ones" : "", walking->why, outcome.is_done ? "done " : "",
           outcome.problem.type ? (int)outcome.problem.type : (int)outcome.err.code, outcome.err.text,
           outcome.problem.detail, outcome.notes);
    faults_print_stack();
    return false;
}

static bool is_whole(void)
{
    const char *wish = getenv("FAULTS");
    return wish && strcmp(wish, "whole") == 0;
}

static size_t step_of(size_t n)
{
    size_t every = is_whole() ? EVERY_WHOLE : EVERY, share = is_whole() ? SHARE_WHOLE : SHARE;
    return n < every ? 1 : 1 + (n - every) / share;
}

enum { EXIT_OF_LIBRARY = 1, EXIT_FOUND = 8, EXIT_DIED, EXIT_DIED_IN_LIBRARY };

static const char *may_die_in;

static void die(int signal_number)
{
    void *stack[24];
    int n = backtrace(stack, 24), code = EXIT_DIED;
    for (int i = 0; may_die_in && i < n; i++) {
        Dl_info about;
        if (dladdr(stack[i], &about) && about.dli_fname && strstr(about.dli_fname, may_die_in))
            code = EXIT_DIED_IN_LIBRARY;
    }
    if (code == EXIT_DIED) {
        printf("  died of signal %d at:\n", signal_number);
        fflush(stdout);
        backtrace_symbols_fd(stack, n, STDOUT_FILENO);
    }
    _exit(code);
}

/* In a child: from n on until a run has no fault left, or one is not good. */
static void child(struct walking *walking, size_t n, int64_t until_us)
{
    struct outcome again;
    may_die_in = walking->walk->may_die_in;
    signal(SIGSEGV, die);
    signal(SIGBUS, die);
    signal(SIGABRT, die);
    walking->names = digest_of_names(walking->walk->folder); /* a finding may have left something */
    for (;; n += step_of(n)) {
        bool has_fired;
        atomic_store(&walking->progress->n, n);
        alarm(SECONDS_A_RUN);
        if (!is_good(walking, n, &has_fired)) {
            fflush(stdout);
            _exit(EXIT_FOUND);
        }
        if (!has_fired || clock_now_us() > until_us)
            break;
        atomic_fetch_add(&walking->progress->n_faults, 1);
    }
    (void)run_once(walking, SIZE_MAX, &again);
    if (!again.is_done || again.digest != walking->clean.digest) {
        printf("%s: %s: a run without faults after all others is another one: %s%s\n", walking->walk->name,
               fault_words[walking->kind], again.err.text, again.problem.detail);
        fflush(stdout);
        _exit(EXIT_FOUND);
    }
    atomic_store(&walking->progress->is_ended, true);
    _exit(0);
}

static int walk_kind(struct walking *walking)
{
    int n_findings = 0;
    int64_t until_us = clock_now_us() + (int64_t)(is_whole() ? MS_A_WALK_WHOLE : MS_A_WALK) * 1000;
    size_t n = 1;
    atomic_store(&walking->progress->is_ended, false);
    atomic_store(&walking->progress->n_faults, 0);
    const char *first = getenv("FAULTS_FIRST");
    if (first)
        n = strtoul(first, NULL, 10);
    while (!atomic_load(&walking->progress->is_ended) && n_findings < MAX_FINDINGS) {
        fflush(stdout);
        pid_t process = fork();
        if (process == 0)
            child(walking, n, until_us);
        int status = 0;
        if (process < 0 || waitpid(process, &status, 0) < 0)
            abort();
        if (WIFEXITED(status) && WEXITSTATUS(status) == 0)
            break;
        n = atomic_load(&walking->progress->n);
        if (WIFEXITED(status) && (WEXITSTATUS(status) == EXIT_DIED_IN_LIBRARY ||
                                  (walking->walk->may_die_in && WEXITSTATUS(status) == EXIT_OF_LIBRARY))) {
            n += step_of(n);
            continue;
        }
        if (WIFSIGNALED(status) || WEXITSTATUS(status) != EXIT_FOUND)
            printf("%s: %s %zu%s: the program died (%s %d)\n", walking->walk->name, fault_words[walking->kind], n,
                   walking->is_lasting ? " and all later ones" : "", WIFSIGNALED(status) ? "signal" : "exit",
                   WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status));
        n_findings++;
        n += step_of(n);
    }
    return n_findings;
}

void walk_run(const struct walk *walk)
{
    const char *only = getenv("FAULTS_ONLY");
    if (only && !strstr(walk->name, only))
        return;
    struct walking walking = { .walk = walk, .kind = FAULT_MEMORY };
    walking.progress = mmap(NULL, sizeof *walking.progress, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    for (int i = 0; i < 2; i++) { /* what libraries take once and keep is taken now */
        (void)run_once(&walking, SIZE_MAX, &walking.clean);
        usleep(SETTLE_MS * 1000);
    }
    if (!walking.clean.is_done) {
        printf("[  FAILED  ] %s: fails without a fault: %s%s\n", walk->name, walking.clean.err.text,
               walking.clean.problem.detail);
        n_failed++;
        return;
    }
    walking.n_files = count_files();
    for (int kind = 0; kind < FAULT_N_KINDS; kind++)
        for (int lasting = 0; lasting < 2; lasting++) {
            const char *only_kind = getenv("FAULTS_KIND");
            if (!walk->kinds[kind] || (lasting && walk->is_short) ||
                (only_kind && strcmp(only_kind, fault_words[kind]) != 0))
                continue;
            walking.kind = (enum fault_kind)kind;
            walking.is_lasting = lasting;
            (void)run_once(&walking, SIZE_MAX, &walking.clean);
            size_t n_calls = faults_count(walking.kind);
            settle(&walking);
            for (int i = 0; i < 1000 && count_names("/proc/self/task") > 3; i++)
                usleep(1000); /* until this thread is the only one: another one would be gone in the child, with its
                                 locks */
            int64_t began_us = clock_now_us();
            int n_findings = walk_kind(&walking);
            n_failed += n_findings > 0;
            printf("[  %s ] %s: %s%s (%zu of %zu calls, %.1f s%s)\n", n_findings ? "FAILED " : "     OK", walk->name,
                   fault_words[kind], lasting ? ", and all later ones" : "", atomic_load(&walking.progress->n_faults),
                   n_calls, 1e-6 * (double)(clock_now_us() - began_us), n_findings ? "; findings above" : "");
            fflush(stdout);
        }
    munmap(walking.progress, sizeof *walking.progress);
}

int walks_end(void)
{
    if (n_failed)
        printf("[  FAILED  ] %d test(s).\n", n_failed);
    return n_failed != 0;
}
