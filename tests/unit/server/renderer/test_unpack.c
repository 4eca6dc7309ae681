/* Unpacking of archives that Python's zipfile and tarfile made (tests/oracle/archives.py): in this process, and as
 * beamroomd starts it. */
#define _GNU_SOURCE
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "server/renderer/unpack.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/oracle.h"

extern char **environ;
static char archives[256];
static bool has_archives;

static int make_archives(void **state)
{
    (void)state;
    char script[] = "tests/oracle/archives.py", out[256];
    folder_make(archives);
    has_archives = oracle_run((char *[]){ oracle_python(), script, archives, NULL }, out, sizeof out) == 0;
    return 0;
}

static int remove_archives(void **state)
{
    (void)state;
    folder_remove(archives);
    return 0;
}

struct run {
    char folder[256];
    struct unpack_result result;
    struct problem problem;
    bool is_done;
};

static void begin(struct run *run, const char *name, const struct unpack_options *options)
{
    static const struct unpack_options plenty = { .max_bytes = UINT64_C(1) << 40 };
    char path[512];
    if (!has_archives)
        skip();
    folder_make(run->folder);
    snprintf(path, sizeof path, "%s/%s", archives, name);
    int archive = open(path, O_RDONLY | O_CLOEXEC), folder = open(run->folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    assert_true(archive >= 0 && folder >= 0);
    run->problem = (struct problem){ 0 };
    run->is_done = unpack(archive, folder, options ? options : &plenty, &run->result, &run->problem);
    close(archive);
    close(folder);
}

static int count_names(const char *path)
{
    DIR *entries = opendir(path);
    assert_non_null(entries);
    int n = -2;
    while (readdir(entries))
        n++;
    closedir(entries);
    return n;
}

/* An entry's number, or bytes. */
static bool names_a_place(const char *detail)
{
    for (const char *at = detail; (at = strpbrk(at, "0123456789")); at++)
        if ((at - detail >= 6 && memcmp(at - 6, "entry ", 6) == 0) ||
            (at - detail >= 5 && memcmp(at - 5, "byte ", 5) == 0) ||
            strncmp(at + strspn(at, "0123456789"), " bytes", 6) == 0 ||
            strncmp(at + strspn(at, "0123456789"), " entries", 8) == 0)
            return true;
    return false;
}

static void assert_refused(const char *name, enum problem_type type, const char *words)
{
    struct run run;
    begin(&run, name, NULL);
    int n_left = count_names(run.folder);
    folder_remove(run.folder);
    if (!names_a_place(run.problem.detail))
        fail_msg("%s: \"%s\" says nowhere where", name, run.problem.detail);
    if (run.is_done || run.problem.type != type || !strstr(run.problem.detail, words) || n_left != 0)
        fail_msg("%s: done %d, type %d (expected %d), \"%s\" (expected \"%s\"), %d names left", name, run.is_done,
                 (int)run.problem.type, (int)type, run.problem.detail, words, n_left);
    assert_int_equal(run.result.n_files, 0);
}

static void assert_file(const struct run *run, const char *name, off_t bytes)
{
    char path[1024];
    struct stat facts;
    snprintf(path, sizeof path, "%s/%s", run->folder, name);
    if (lstat(path, &facts) != 0)
        fail_msg("%s is not there", name);
    assert_true(S_ISREG(facts.st_mode));
    assert_int_equal(facts.st_size, bytes);
    assert_int_equal(facts.st_mode & 07777 & ~0640u, 0);
}

static void every_kind_of_archive_gives_the_same_files(void **state)
{
    (void)state;
    static const char *const names[] = { "good.zip",    "stored.zip",     "pax.tar",      "ustar.tar",   "gnu.tar",
                                         "good.tar.gz", "members.tar.gz", "good.tar.bz2", "good.tar.xz", "good.tar.zst",
                                         "dots.tar",    "litter.zip",     "back.zip" };
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        struct run run;
        begin(&run, names[i], NULL);
        if (!run.is_done)
            fail_msg("%s: %s", names[i], run.problem.detail);
        assert_int_equal(run.result.n_files, 3);
        assert_int_equal(run.result.n_bytes, 2 + 3000 + 70000);
        assert_int_equal(count_names(run.folder), 2); /* the one top folder is gone, and so is litter */
        assert_file(&run, "plan.json", 2);
        assert_file(&run, "ct/1.dcm", 3000);
        assert_file(&run, "ct/2.dcm", 70000);
        char path[300], text[8] = "";
        snprintf(path, sizeof path, "%s/ct/1.dcm", run.folder);
        FILE *file = fopen(path, "rb");
        assert_non_null(file);
        assert_int_equal(fread(text, 1, 6, file), 6);
        fclose(file);
        assert_string_equal(text, "oneone");
        folder_remove(run.folder);
    }
}

struct expected {
    const char *archive, *file;
    off_t bytes;
    int n_top;
};

static void names_are_kept_or_made_safe(void **state)
{
    (void)state;
    static const struct expected list[] = {
        { "same-top.zip", "plan/a", 1, 2 },
        { "same-top.zip", "b", 2, 2 },
        { "two-tops.zip", "a/x", 1, 2 },
        { "latin.tar", "M_FCller", 1, 2 },
        { "latin.tar", "\xc3\x9c/\xc3\xa9", 2, 2 },
        { "utf8.zip",
          "Gr\xc3\xb6\xc3\x9f"
          "e/\xc3\xb1.txt",
          1, 2 },
        { "nested.zip", "b", 1, 2 },
        { "deep.tar", "a/b/c/d/e/f/g/h/i/j/k/l/m/n/o/p", 1, 2 },
        { "many.zip", "series6/19998", 1, 7 },
    };
    for (size_t i = 0; i < sizeof list / sizeof *list; i++) {
        struct run run;
        begin(&run, list[i].archive, NULL);
        if (!run.is_done)
            fail_msg("%s: %s", list[i].archive, run.problem.detail);
        assert_file(&run, list[i].file, list[i].bytes);
        assert_int_equal(count_names(run.folder), list[i].n_top);
        folder_remove(run.folder);
    }
}

struct refusal {
    const char *name;
    enum problem_type type;
    const char *words;
};

static void assert_all_refused(const struct refusal *list, size_t n)
{
    for (size_t i = 0; i < n; i++)
        assert_refused(list[i].name, list[i].type, list[i].words);
}
#define CHECK_ALL(list) assert_all_refused(list, sizeof(list) / sizeof *(list))

static void names_that_lead_astray_are_refused(void **state)
{
    (void)state;
    static const struct refusal list[] = {
        { "absolute", PROBLEM_VALIDATION, "\"/etc/passwd\": an absolute name" },
        { "dotdot", PROBLEM_VALIDATION, "\"a/../../b\": \"..\"" },
        { "dotdot-first", PROBLEM_VALIDATION, "\"../b\": \"..\"" },
        { "empty-part", PROBLEM_VALIDATION, "\"a//b\": an empty part" },
        { "control", PROBLEM_VALIDATION, "\"a?b\": a control character" },
        { "escape", PROBLEM_VALIDATION, "\"a?[2Jb\": a control character" },
        { "drive", PROBLEM_VALIDATION, "drive letter" },
        { "part", PROBLEM_VALIDATION, "longer than 255 bytes" },
        { "name", PROBLEM_VALIDATION, "a name of 602 bytes; at most 511" },
        { "deep", PROBLEM_VALIDATION, "more than 16 folders deep" },
    };
    for (size_t i = 0; i < sizeof list / sizeof *list; i++)
        for (int k = 0; k < 2; k++) {
            char name[64];
            snprintf(name, sizeof name, "name-%s.%s", list[i].name, k ? "zip" : "tar");
            assert_refused(name, list[i].type, list[i].words);
        }
    assert_refused("name-back.zip", PROBLEM_VALIDATION, "\"..\" in its name");
}

/* Python's zipfile and tarfile say which entry it is and where it begins. */
static void the_entry_that_is_refused_is_found_by_its_number_and_place(void **state)
{
    (void)state;
    char path[512], name[64];
    int number, n = 0;
    long offset;
    if (!has_archives)
        skip();
    snprintf(path, sizeof path, "%s/places.txt", archives);
    FILE *places = fopen(path, "r");
    assert_non_null(places);
    while (fscanf(places, "%63s %d %ld", name, &number, &offset) == 3) {
        struct run run;
        char expected[96];
        begin(&run, name, NULL);
        folder_remove(run.folder);
        if (offset < 0)
            snprintf(expected, sizeof expected, "entry %d, \"", number);
        else
            snprintf(expected, sizeof expected, "entry %d at byte %ld of the tar, \"", number, offset);
        if (run.is_done || strncmp(run.problem.detail, expected, strlen(expected)) != 0)
            fail_msg("%s: \"%s\" (expected \"%s\")", name, run.problem.detail, expected);
        n++;
    }
    fclose(places);
    assert_true(n >= 30);
}

static void a_name_is_there_once(void **state)
{
    (void)state;
    static const struct refusal list[] = {
        { "twice.tar", PROBLEM_VALIDATION, "\"a/x\": there twice" },
        { "twice.zip", PROBLEM_VALIDATION, "\"a/x\": there twice" },
        { "case.zip", PROBLEM_VALIDATION, "\"a/PLAN\": differs from \"a/plan\" only in upper and lower case" },
        { "case-folder.tar", PROBLEM_VALIDATION, "\"a\": differs from \"A\" only" },
        { "case-umlaut.tar", PROBLEM_VALIDATION, "only in upper and lower case" },
        { "both.tar", PROBLEM_VALIDATION, "\"a\": both a file and a folder" },
        { "both-back.tar", PROBLEM_VALIDATION, "\"a\": both a file and a folder" },
    };
    CHECK_ALL(list);
}

static void only_files_and_folders_come_out(void **state)
{
    (void)state;
    static const struct refusal list[] = {
        { "kind-symlink.tar", PROBLEM_VALIDATION, "\"bad\": a symbolic link" },
        { "kind-hardlink.tar", PROBLEM_VALIDATION, "\"bad\": a hard link" },
        { "kind-char.tar", PROBLEM_VALIDATION, "\"bad\": a device" },
        { "kind-block.tar", PROBLEM_VALIDATION, "\"bad\": a device" },
        { "kind-fifo.tar", PROBLEM_VALIDATION, "\"bad\": a named pipe" },
        { "socket.zip", PROBLEM_VALIDATION, "\"s\": a socket" },
        { "link-through.tar", PROBLEM_VALIDATION, "\"out\": a symbolic link" },
        { "link-through.zip", PROBLEM_VALIDATION, "\"out\": a symbolic link" },
        { "sparse.tar", PROBLEM_VALIDATION, "a file with holes" },
        { "encrypted.zip", PROBLEM_VALIDATION, "\"a\": encrypted" },
        { "deflate64.zip", PROBLEM_VALIDATION, "\"a\": compressed by Deflate64, which is not read" },
        { "imploded.zip", PROBLEM_VALIDATION, "method of compression (" },
    };
    CHECK_ALL(list);
    assert_int_equal(access("/tmp/beamroom-escaped", F_OK), -1);
}

static void damage_is_noticed(void **state)
{
    (void)state;
    static const struct refusal list[] = {
        { "crc.zip", PROBLEM_VALIDATION, "\"a\": damaged: ZIP bad CRC" },
        { "flip.zip", PROBLEM_VALIDATION, "\"plan/ct/2.dcm\": damaged" },
        { "cut.zip", PROBLEM_VALIDATION, "directory at its end is missing" },
        { "size.zip", PROBLEM_VALIDATION, "60 in central directory, 130 in" },
        { "size-both.zip", PROBLEM_VALIDATION, "(read 130, expected 60)" },
        { "overlap.zip", PROBLEM_VALIDATION, "says that it holds 200 entries; found are 1 that" },
        { "cut.tar", PROBLEM_VALIDATION, "Truncated" },
        { "cut-between.tar", PROBLEM_VALIDATION, "without its end mark" },
        { "header.tar", PROBLEM_MEDIA_TYPE, "found is something else" },
        { "crc.tar.gz", PROBLEM_VALIDATION, "incorrect data check" },
        { "cut.tar.gz", PROBLEM_VALIDATION, "gzip data end early" },
        { "no-sum.tar.gz", PROBLEM_VALIDATION, "gzip data end early" },
        { "junk.tar.gz", PROBLEM_VALIDATION, "gzip data are damaged" },
        { "cut.tar.bz2", PROBLEM_MEDIA_TYPE, "bzip2 data, damaged" },
        { "cut.tar.xz", PROBLEM_VALIDATION, "damaged" },
        { "cut.tar.zst", PROBLEM_MEDIA_TYPE, "zstd data, damaged" },
        { "flip.tar.bz2", PROBLEM_MEDIA_TYPE, "bzip2 data, damaged" },
        { "flip.tar.xz", PROBLEM_MEDIA_TYPE, "xz data, damaged" },
    };
    CHECK_ALL(list);
}

static void what_is_no_plan_in_an_archive_is_refused(void **state)
{
    (void)state;
    static const struct refusal list[] = {
        { "empty", PROBLEM_MEDIA_TYPE, "an empty file" },
        { "text", PROBLEM_MEDIA_TYPE, "found is something else" },
        { "some.rar", PROBLEM_MEDIA_TYPE, "a RAR archive" },
        { "cpio", PROBLEM_MEDIA_TYPE, "found is something else" },
        { "text.gz", PROBLEM_MEDIA_TYPE, "gzip data, of something else" },
        { "no-file.tar", PROBLEM_VALIDATION, "holds no file" },
        { "no-entry.zip", PROBLEM_VALIDATION, "holds no file" },
        { "only-litter.zip", PROBLEM_VALIDATION, "holds no file" },
        { "twice.tar.gz.xz", PROBLEM_MEDIA_TYPE, "xz data" },
        { "twice.tar.xz.gz", PROBLEM_MEDIA_TYPE, "compressed more than once" },
        { "twice.tar.xz.bz2", PROBLEM_MEDIA_TYPE, "compressed more than once" },
    };
    CHECK_ALL(list);
}

static void bombs_are_refused(void **state)
{
    (void)state;
    static const struct refusal list[] = {
        { "zeros.gz", PROBLEM_TOO_LARGE, "at most so many are allowed for it" },
        { "zeros.tar.gz", PROBLEM_TOO_LARGE, "\"zeros\": more than" },
        { "zeros.tar.bz2", PROBLEM_TOO_LARGE, "\"zeros\": more than 67108864 bytes come out of an archive of" },
        { "litter-bomb.zip", PROBLEM_TOO_LARGE, "at most 200 times its size" },
    };
    CHECK_ALL(list);
}

/* A hundred thousand folders are made and removed again: the longest of these tests, so `make test` leaves it out. */
static void a_bomb_of_names_is_refused(void **state)
{
    (void)state;
    static const struct refusal list[] = {
        { "entries.tar", PROBLEM_TOO_LARGE, "more than 100000 entries" },
        { "many-folders.tar", PROBLEM_TOO_LARGE, "more than 100000 files and folders" },
    };
    assert_all_refused(list, getenv("UNITS") ? 2 : 1);
}

static void the_limit_is_counted_to_the_byte(void **state)
{
    (void)state;
    struct run run;
    begin(&run, "good.tar.gz", &(struct unpack_options){ .max_bytes = 73002 });
    assert_true(run.is_done);
    folder_remove(run.folder);
    begin(&run, "good.tar.gz", &(struct unpack_options){ .max_bytes = 73001 });
    assert_false(run.is_done);
    assert_int_equal(run.problem.type, PROBLEM_TOO_LARGE);
    assert_non_null(strstr(run.problem.detail, "more than 73001 bytes"));
    assert_int_equal(count_names(run.folder), 0);
    folder_remove(run.folder);
}

static bool after_a_while(void *context)
{
    return ++*(int *)context > 20;
}

static void cancelling_leaves_nothing(void **state)
{
    (void)state;
    struct run run;
    int n_asked = 0;
    begin(&run, "many.zip",
          &(struct unpack_options){ .max_bytes = 1 << 30, .is_cancelled = after_a_while, .context = &n_asked });
    assert_false(run.is_done);
    assert_int_equal(run.problem.type, PROBLEM_CANCELLED);
    assert_int_equal(count_names(run.folder), 0);
    folder_remove(run.folder);
}

static void a_folder_with_something_in_it_is_left_alone(void **state)
{
    (void)state;
    if (!has_archives)
        skip();
    char folder[256], path[512];
    struct unpack_result result;
    struct problem problem = { 0 };
    folder_make(folder);
    folder_put(folder, "mine", "x", 1);
    snprintf(path, sizeof path, "%s/good.zip", archives);
    int archive = open(path, O_RDONLY), into = open(folder, O_RDONLY | O_DIRECTORY);
    assert_false(unpack(archive, into, &(struct unpack_options){ .max_bytes = 1 << 20 }, &result, &problem));
    assert_non_null(strstr(problem.detail, "not empty"));
    assert_int_equal(count_names(folder), 1);
    close(archive);
    close(into);
    folder_remove(folder);
}

/* ---- the confined program --------------------------------------------------------------------------------------- */

struct program {
    pid_t pid;
    int output;
    char folder[256];
};

static void start(struct program *program, const char *name)
{
    char self[400], path[512], archive[512];
    ssize_t n = readlink("/proc/self/exe", self, sizeof self - 1);
    assert_true(n > 0);
    self[n] = 0;
    *strrchr(self, '/') = 0;
    snprintf(path, sizeof path, "%s/../beamroom-render", self);
    if (!has_archives || access(path, X_OK) != 0)
        skip();
    snprintf(archive, sizeof archive, "%s/%s", archives, name);
    folder_make(program->folder);
    int ends[2];
    assert_int_equal(pipe2(ends, O_CLOEXEC), 0);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    char *arguments[] = { path,
                          (char *)"--unpack",
                          archive,
                          (char *)"--into",
                          program->folder,
                          (char *)"--max-unpacked-bytes",
                          (char *)"2000000000",
                          NULL };
    assert_int_equal(posix_spawn(&program->pid, path, &actions, NULL, arguments, environ), 0);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    program->output = ends[0];
}

/* Reads its output, and returns its exit status. */
static int finish(struct program *program, char said[4096])
{
    size_t length = 0;
    for (ssize_t n; length < 4095 && (n = read(program->output, said + length, 4095 - length)) > 0;)
        length += (size_t)n;
    said[length] = 0;
    close(program->output);
    int status;
    assert_int_equal(waitpid(program->pid, &status, 0), program->pid);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

static void the_confined_program_unpacks_each_kind(void **state)
{
    (void)state;
    static const char *const names[] = { "good.zip",     "pax.tar",     "good.tar.gz",
                                         "good.tar.bz2", "good.tar.xz", "good.tar.zst" };
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        struct program program;
        char said[4096];
        start(&program, names[i]);
        assert_int_equal(finish(&program, said), 0);
        const char *end = "{\"done\":true,\"n_files\":3,\"n_bytes\":73002}\n";
        assert_true(strlen(said) >= strlen(end));
        assert_string_equal(said + strlen(said) - strlen(end), end);
        assert_int_equal(count_names(program.folder), 2);
        folder_remove(program.folder);
    }
}

static void the_confined_program_says_why_it_refuses(void **state)
{
    (void)state;
    static const char *const names[] = { "link-through.tar", "name-dotdot.zip", "crc.tar.gz", "zeros.tar.gz",
                                         "zeros.gz" };
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        struct program program;
        char said[4096];
        start(&program, names[i]);
        assert_int_equal(finish(&program, said), 3);
        const char *last = strstr(said, "{\"problem\":{\"type\":\"/problems/");
        assert_non_null(last);
        assert_string_equal(strchr(last, '\n'), "\n");
        assert_int_equal(count_names(program.folder), 0);
        folder_remove(program.folder);
    }
}

static void ended_by_a_signal_it_leaves_nothing(void **state)
{
    (void)state;
    struct program program;
    char said[4096];
    start(&program, "many.zip");
    for (int64_t until_us = clock_now_us() + 60000000; count_names(program.folder) == 0 && clock_now_us() < until_us;)
        usleep(1000);
    assert_int_not_equal(count_names(program.folder), 0);
    assert_int_equal(kill(program.pid, SIGTERM), 0);
    assert_int_equal(finish(&program, said), 3);
    assert_non_null(strstr(said, "/problems/cancelled"));
    assert_int_equal(count_names(program.folder), 0);
    folder_remove(program.folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_kind_of_archive_gives_the_same_files),
        cmocka_unit_test(names_are_kept_or_made_safe),
        cmocka_unit_test(names_that_lead_astray_are_refused),
        cmocka_unit_test(the_entry_that_is_refused_is_found_by_its_number_and_place),
        cmocka_unit_test(a_name_is_there_once),
        cmocka_unit_test(only_files_and_folders_come_out),
        cmocka_unit_test(damage_is_noticed),
        cmocka_unit_test(what_is_no_plan_in_an_archive_is_refused),
        cmocka_unit_test(bombs_are_refused),
        cmocka_unit_test(a_bomb_of_names_is_refused),
        cmocka_unit_test(the_limit_is_counted_to_the_byte),
        cmocka_unit_test(cancelling_leaves_nothing),
        cmocka_unit_test(a_folder_with_something_in_it_is_left_alone),
        cmocka_unit_test(the_confined_program_unpacks_each_kind),
        cmocka_unit_test(the_confined_program_says_why_it_refuses),
        cmocka_unit_test(ended_by_a_signal_it_leaves_nothing),
    };
    return cmocka_run_group_tests(tests, make_archives, remove_archives);
}
