/* Receiving archives: limits, and that no file stays behind. */
#define _GNU_SOURCE /* syscall */
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "core/base/mem.h"
#include "server/http/intake.h"
#include "tests/check.h"

static char folder[64];

static int make_folder(void **state)
{
    (void)state;
    snprintf(folder, sizeof folder, "/tmp/beamroom-intake-XXXXXX");
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state)
{
    (void)state;
    return rmdir(folder); /* fails where a test left a file */
}

static struct call *archive_call(const char *content_type)
{
    struct call *call = call_create();
    call->method = CALL_POST;
    call_set_path(call, "/api/v1/plans");
    call->content_type = content_type ? mem_copy_text(content_type) : NULL;
    return call;
}

/* The library's function, for all of this program: while the disk is stalled a write to a file waits. */
static pthread_mutex_t disk = PTHREAD_MUTEX_INITIALIZER;
static _Atomic size_t n_writes;

ssize_t write(int fd, const void *bytes, size_t n)
{
    struct stat facts;
    if (fstat(fd, &facts) == 0 && S_ISREG(facts.st_mode)) {
        n_writes++;
        pthread_mutex_lock(&disk);
        pthread_mutex_unlock(&disk);
    }
    return syscall(SYS_write, fd, bytes, n);
}

static void nothing(void *context)
{
    (void)context;
}

/* Gives all bytes, and waits for the disk. */
static bool add(struct intake *intake, struct intake_file *file, const char *bytes, size_t n, struct problem *problem)
{
    bool goes_on = true;
    for (size_t n_taken; goes_on && n > 0; bytes += n_taken, n -= n_taken) {
        goes_on = intake_add(file, bytes, n, &n_taken, problem);
        intake_wait(intake);
    }
    return goes_on;
}

/* intake_finish, once the disk has taken all. */
static char *finish(struct intake *intake, struct intake_file *file, uint64_t *n_bytes, struct problem *problem)
{
    while (!intake_end(file))
        intake_wait(intake);
    return intake_finish(file, n_bytes, problem);
}

static void only_a_post_to_the_plans_is_one(void **state)
{
    (void)state;
    static const struct {
        enum call_method method;
        const char *path;
        bool is_one;
    } cases[] = { { CALL_POST, "/api/v1/plans", true },  { CALL_POST, "/api/v1/plans/", true },
                  { CALL_GET, "/api/v1/plans", false },  { CALL_POST, "/api/v1/plans/x", false },
                  { CALL_POST, "/api/v1/rooms", false }, { CALL_POST, "/api/v2/plans", false } };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct call *call = call_create();
        call->method = cases[i].method;
        call_set_path(call, cases[i].path);
        assert_int_equal(intake_is_for(call), cases[i].is_one);
        call_destroy(call);
    }
}

static enum problem_type refusal(struct intake *intake, const char *content_type, const char *origin, int64_t length)
{
    struct call *call = archive_call(content_type);
    struct problem problem = { 0 };
    call->origin = origin ? mem_copy_text(origin) : NULL;
    call->host = mem_copy_text("here.example:8080");
    struct intake_file *file = intake_begin(intake, call, length, nothing, NULL, &problem);
    intake_drop(file);
    call_destroy(call);
    assert_int_equal(file == NULL, problem.type != PROBLEM_NONE);
    return problem.type;
}

static void what_may_not_come_is_refused_before_it_does(void **state)
{
    (void)state;
    struct intake *intake = intake_create(folder, 1000, 0, NULL), *none = intake_create(NULL, 1000, 0, NULL),
                  *lost = intake_create("/nowhere", 1000, 0, NULL);
    assert_int_equal(refusal(intake, "application/zip", NULL, 1000), PROBLEM_NONE);
    assert_int_equal(refusal(intake, "APPLICATION/X-TAR; x=y", NULL, -1), PROBLEM_NONE);
    assert_int_equal(refusal(intake, "application/gzip", "http://here.example:8080", 0), PROBLEM_NONE);
    assert_int_equal(refusal(intake, "application/octet-stream", NULL, 5), PROBLEM_NONE);
    assert_int_equal(refusal(intake, "application/zipper", NULL, 5), PROBLEM_MEDIA_TYPE);
    assert_int_equal(refusal(intake, "multipart/form-data", NULL, 5), PROBLEM_MEDIA_TYPE);
    assert_int_equal(refusal(intake, NULL, NULL, 5), PROBLEM_MEDIA_TYPE);
    assert_int_equal(refusal(intake, "application/zip", "http://elsewhere.example", 5), PROBLEM_FORBIDDEN);
    assert_int_equal(refusal(intake, "application/zip", NULL, 1001), PROBLEM_TOO_LARGE);
    assert_int_equal(refusal(intake, "application/zip", NULL, INT64_MAX), PROBLEM_TOO_LARGE);
    assert_int_equal(refusal(none, "application/zip", NULL, 5), PROBLEM_STORAGE);
    assert_int_equal(refusal(lost, "application/zip", NULL, 5), PROBLEM_STORAGE);
    intake_destroy(intake);
    intake_destroy(none);
    intake_destroy(lost);
}

static void more_than_the_disk_holds_is_refused_before_it_comes(void **state)
{
    (void)state;
    struct intake *intake = intake_create(folder, UINT64_MAX, 0, NULL);
    assert_int_equal(refusal(intake, "application/zip", NULL, INT64_C(1) << 60), PROBLEM_STORAGE);
    intake_destroy(intake);
}

static void it_ends_at_the_limit_and_not_before(void **state)
{
    (void)state;
    struct intake *intake = intake_create(folder, 10, 0, NULL);
    struct call *call = archive_call("application/zip");
    struct problem problem = { 0 };
    struct intake_file *file = intake_begin(intake, call, -1, nothing, NULL, &problem);
    assert_non_null(file);
    assert_true(add(intake, file, "01234", 5, &problem));
    assert_true(add(intake, file, "56789", 5, &problem));
    assert_false(add(intake, file, "x", 1, &problem));
    assert_int_equal(problem.type, PROBLEM_TOO_LARGE);
    intake_drop(file);
    call_destroy(call);
    intake_destroy(intake);
}

static void what_has_come_whole_is_ours_alone_to_read(void **state)
{
    (void)state;
    struct intake *intake = intake_create(folder, 10, 0, NULL);
    struct call *call = archive_call("application/zip");
    struct problem problem = { 0 };
    struct intake_file *file = intake_begin(intake, call, 5, nothing, NULL, &problem);
    uint64_t n_bytes = 0;
    assert_non_null(file);
    assert_true(add(intake, file, "01234", 5, &problem));
    char *path = finish(intake, file, &n_bytes, &problem);
    assert_non_null(path);
    assert_int_equal(n_bytes, 5);
    struct stat facts;
    assert_int_equal(stat(path, &facts), 0);
    assert_int_equal(facts.st_size, 5);
    assert_int_equal(facts.st_mode & 0777, 0600);
    call->upload_path = path;
    call_destroy(call); /* no handler kept the file */
    assert_int_equal(n_bytes, facts.st_size);
    intake_destroy(intake);
}

/* A limit on file sizes stands in for a full disk: the write fails in the same way. */
static void a_disk_that_takes_no_more_is_said(void **state)
{
    (void)state;
    struct intake *intake = intake_create(folder, 1 << 20, 0, NULL);
    struct call *call = archive_call("application/zip");
    struct problem problem = { 0 };
    struct rlimit before, low = { 0 };
    struct intake_file *file = intake_begin(intake, call, -1, nothing, NULL, &problem);
    assert_non_null(file);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    low = (struct rlimit){ .rlim_cur = 8, .rlim_max = before.rlim_max };
    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &low), 0);
    uint64_t n_bytes;
    assert_true(add(intake, file, "0123456789", 10, &problem));
    char *path = finish(intake, file, &n_bytes, &problem); /* eight are written, the rest is refused */
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
    assert_null(path);
    assert_int_equal(problem.type, PROBLEM_STORAGE);
    assert_true(strlen(problem.detail) > 20);
    call_destroy(call);
    intake_destroy(intake);
}

/* A simulated disk: free is its size less the files in the folder, less what others wrote. */
static uint64_t disk_bytes, taken_bytes;

static uint64_t free_bytes(void *context, int *failed)
{
    (void)context;
    uint64_t n = taken_bytes;
    for (int i = 1; i <= 8; i++) {
        char path[96];
        struct stat facts;
        snprintf(path, sizeof path, "%s/%d.part", folder, i);
        if (stat(path, &facts) == 0)
            n += (uint64_t)facts.st_size;
    }
    *failed = 0;
    return disk_bytes > n ? disk_bytes - n : 0;
}

static const char block[1 << 20];

/* An empty disk of 100 MiB with a reserve. */
static struct intake *intake_on_disk(uint64_t reserve)
{
    disk_bytes = 100 << 20;
    taken_bytes = 0;
    struct intake *intake = intake_create(folder, UINT64_C(1) << 32, reserve, NULL);
    intake_set_disk(intake, free_bytes, NULL);
    return intake;
}

/* Four senders without an announced length write in turn until all are refused. Returns what is free then. */
static void streams_that_come_together_leave_the_reserve(void **state)
{
    (void)state;
    const uint64_t reserve = 40 << 20;
    struct intake *intake = intake_on_disk(reserve);
    struct call *call = archive_call("application/zip");
    struct intake_file *files[INTAKE_MAX_FILES];
    struct problem problem = { 0 };
    bool goes_on[INTAKE_MAX_FILES];
    int n_going = INTAKE_MAX_FILES, n_blocks = 0, failed;
    for (int i = 0; i < INTAKE_MAX_FILES; i++) {
        files[i] = intake_begin(intake, call, -1, nothing, NULL, &problem);
        assert_non_null(files[i]);
        goes_on[i] = true;
    }
    for (int i = 0; n_going > 0; i = (i + 1) % INTAKE_MAX_FILES) {
        if (!goes_on[i])
            continue;
        goes_on[i] = add(intake, files[i], block, sizeof block, &problem);
        assert_true(free_bytes(NULL, &failed) >= reserve);
        n_blocks += goes_on[i];
        if (!goes_on[i]) {
            assert_int_equal(problem.type, PROBLEM_STORAGE);
            assert_non_null(strstr(problem.detail, "40 that stay free"));
            n_going--;
        }
    }
    assert_in_range(n_blocks, 60 - INTAKE_MAX_FILES * (INTAKE_STEP_BYTES >> 20),
                    60); /* MiB: the disk less the reserve, to a step each */
    for (int i = 0; i < INTAKE_MAX_FILES; i++)
        intake_drop(files[i]);
    intake_wait(intake);
    assert_int_equal(free_bytes(NULL, &failed), disk_bytes);
    call_destroy(call);
    intake_destroy(intake);
}

static void count_move(void *context)
{
    _Atomic int *n_moves = context;
    (*n_moves)++;
}

/* Gives bytes until the disk is behind by all that is held in memory. Returns how many were taken. */
static size_t fill(struct intake_file *file, const char *bytes, size_t n)
{
    struct problem problem = { 0 };
    size_t n_taken = 0;
    assert_true(intake_add(file, bytes, n, &n_taken, &problem));
    return n_taken;
}

static void a_disk_that_stalls_holds_up_nobody(void **state)
{
    (void)state;
    enum { N = 3 << 20 };
    struct intake *intake = intake_create(folder, N, 0, NULL);
    struct call *call = archive_call("application/zip");
    struct problem problem = { 0 };
    _Atomic int n_moves = 0;
    char *sent = mem_new(N), *kept = mem_new(N);
    for (size_t i = 0; i < N; i++)
        sent[i] = (char)(i * i / 7);
    struct intake_file *file = intake_begin(intake, call, N, count_move, (void *)&n_moves, &problem);
    assert_non_null(file);
    pthread_mutex_lock(&disk);
    n_writes = 0;
    size_t n = fill(file, sent, 300 << 10); /* more than a block: the thread has one to write, and waits */
    assert_int_equal(n, 300 << 10);
    while (n_writes == 0)
        usleep(100);
    n += fill(file, sent + n, N - n);
    assert_in_range(n, 300 << 10, 600 << 10); /* no more is held in memory */
    assert_int_equal(fill(file, sent + n, N - n), 0);
    assert_false(intake_end(file));
    assert_int_equal(n_moves, 0);
    pthread_mutex_unlock(&disk);
    intake_wait(intake);
    assert_int_equal(n_moves, 1); /* however often it was asked meanwhile */
    assert_true(add(intake, file, sent + n, N - n, &problem));
    uint64_t n_bytes;
    char *path = finish(intake, file, &n_bytes, &problem);
    assert_non_null(path);
    assert_int_equal(n_bytes, N);
    FILE *stream = fopen(path, "rb");
    assert_non_null(stream);
    assert_int_equal(fread(kept, 1, N, stream), N);
    assert_int_equal(fgetc(stream), EOF);
    assert_memory_equal(kept, sent, N);
    fclose(stream);
    unlink(path);
    free(path);
    free(sent);
    free(kept);
    call_destroy(call);
    intake_destroy(intake);
}

static void what_was_announced_is_kept_for_its_sender(void **state)
{
    (void)state;
    struct intake *intake = intake_on_disk(10 << 20);
    struct call *call = archive_call("application/zip");
    struct problem problem = { 0 };
    struct intake_file *large = intake_begin(intake, call, 60 << 20, nothing, NULL, &problem);
    assert_non_null(large);
    assert_null(intake_begin(intake, call, 31 << 20, nothing, NULL, &problem)); /* 100 - 10 - 60 are 30 */
    assert_int_equal(problem.type, PROBLEM_STORAGE);
    struct intake_file *other = intake_begin(intake, call, 30 << 20, nothing, NULL, &problem);
    assert_non_null(other);
    struct intake_file *stream = intake_begin(intake, call, -1, nothing, NULL, &problem);
    assert_non_null(stream);
    assert_false(add(intake, stream, block, sizeof block, &problem));
    assert_int_equal(problem.type, PROBLEM_STORAGE);
    intake_drop(stream);
    intake_drop(other); /* what it was granted is free again */
    intake_wait(intake);
    other = intake_begin(intake, call, 30 << 20, nothing, NULL, &problem);
    assert_non_null(other);
    for (int i = 0; i < 60; i++)
        assert_true(add(intake, large, block, sizeof block, &problem));
    intake_drop(other);
    intake_drop(large);
    call_destroy(call);
    intake_destroy(intake);
}

static void a_disk_that_others_fill_meanwhile_is_noticed(void **state)
{
    (void)state;
    struct intake *intake = intake_on_disk(10 << 20);
    struct call *call = archive_call("application/zip");
    struct problem problem = { 0 };
    struct intake_file *file = intake_begin(intake, call, 60 << 20, nothing, NULL, &problem);
    assert_non_null(file);
    taken_bytes = 80 << 20;
    int n = 0;
    while (n < 60 && add(intake, file, block, sizeof block, &problem))
        n++;
    assert_int_equal(n, INTAKE_STEP_BYTES >> 20); /* the disk is checked once per step */
    assert_int_equal(problem.type, PROBLEM_STORAGE);
    intake_drop(file);
    call_destroy(call);
    intake_destroy(intake);
}

static void who_trickles_gives_the_place_back(void **state)
{
    (void)state;
    struct intake *intake = intake_create(folder, 1 << 20, 0, NULL);
    struct call *call = archive_call("application/zip");
    static const char much[INTAKE_WINDOW_BYTES];
    for (int is_fast = 0; is_fast < 2; is_fast++) {
        struct problem problem = { 0 };
        intake_set_window_ms(intake, INTAKE_WINDOW_MS);
        struct intake_file *file = intake_begin(intake, call, -1, nothing, NULL, &problem);
        assert_non_null(file);
        assert_true(
            add(intake, file, much, is_fast ? sizeof much : 1, &problem)); /* within the window anything may come */
        intake_set_window_ms(intake, 1);
        usleep(2000);
        assert_int_equal(add(intake, file, "x", 1, &problem), is_fast);
        assert_int_equal(problem.type, is_fast ? PROBLEM_NONE : PROBLEM_TOO_SLOW);
        intake_drop(file);
    }
    call_destroy(call);
    intake_destroy(intake);
}

static void a_fifth_at_once_is_told_when_to_come_again(void **state)
{
    (void)state;
    struct intake *intake = intake_create(folder, 10, 0, NULL);
    struct call *call = archive_call("application/zip");
    struct intake_file *files[INTAKE_MAX_FILES];
    struct problem problem = { 0 };
    for (int i = 0; i < INTAKE_MAX_FILES; i++) {
        files[i] = intake_begin(intake, call, 5, nothing, NULL, &problem);
        assert_non_null(files[i]);
    }
    assert_null(intake_begin(intake, call, 5, nothing, NULL, &problem));
    assert_int_equal(problem.type, PROBLEM_LIMIT);
    assert_int_equal(problem_status(problem.type), 429);
    assert_true(problem.retry_after_ms > 0);
    for (int i = 0; i < INTAKE_MAX_FILES; i++)
        intake_drop(files[i]);
    assert_int_equal(refusal(intake, "application/zip", NULL, 5), PROBLEM_NONE);
    call_destroy(call);
    intake_destroy(intake);
}

/* Begins to receive an archive of this user. */
static struct intake_file *begin_of(struct intake *intake, const char *user, struct problem *problem)
{
    struct call *call = archive_call("application/zip");
    snprintf(call->identity.user, sizeof call->identity.user, "%s", user);
    struct intake_file *file = intake_begin(intake, call, 5, nothing, NULL, problem);
    call_destroy(call);
    return file;
}

static void one_user_leaves_places_to_others(void **state)
{
    (void)state;
    struct intake *intake = intake_create(folder, 10, 0, NULL);
    struct problem problem = { 0 };
    struct intake_file *first = begin_of(intake, "pat", &problem), *second = begin_of(intake, "pat", &problem);
    assert_true(first && second);
    assert_null(begin_of(intake, "pat", &problem));
    assert_int_equal(problem.type, PROBLEM_LIMIT);
    assert_true(problem.retry_after_ms > 0);
    struct intake_file *other = begin_of(intake, "rae", &problem);
    assert_non_null(other);
    intake_drop(first);
    first = begin_of(intake, "pat", &problem);
    assert_non_null(first);
    intake_drop(other);
    intake_drop(second);
    intake_drop(first);
    intake_destroy(intake);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(only_a_post_to_the_plans_is_one),
        cmocka_unit_test_setup_teardown(what_may_not_come_is_refused_before_it_does, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(more_than_the_disk_holds_is_refused_before_it_comes, make_folder,
                                        remove_folder),
        cmocka_unit_test_setup_teardown(it_ends_at_the_limit_and_not_before, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(what_has_come_whole_is_ours_alone_to_read, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_disk_that_takes_no_more_is_said, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(streams_that_come_together_leave_the_reserve, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_disk_that_stalls_holds_up_nobody, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(what_was_announced_is_kept_for_its_sender, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_disk_that_others_fill_meanwhile_is_noticed, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(who_trickles_gives_the_place_back, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_fifth_at_once_is_told_when_to_come_again, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(one_user_leaves_places_to_others, make_folder, remove_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
