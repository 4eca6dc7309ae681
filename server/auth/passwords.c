/* Passwords, checked and set one after the other on a thread of their own: argon2id is slow by design. */
#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/auth/auth_state.h"
#include "server/auth/secret.h"
#include "server/auth/words.h"
#include "server/wire/random.h"

enum {
    PASSES = 2,
    MEMORY_BYTES = 19 << 20,
    NICE = 15 /* pictures come first */
};

/* The hash of a password that nobody knows is checked where there is no user, so that the answer takes as long. */
static const char hash_of_nobody[] =
    "$argon2id$v=19$m=19456,t=2,p=1$H+afxnRDAwWvvzAXYzkBRg$07KgWzl2d5InuRNKQ/SqNKL/zQkjAEJ1fs7GllYwtsA";

enum job_kind { JOB_SIGN_IN, JOB_CONFIRM, JOB_ADD, JOB_SET, JOB_FIRST };

struct job {
    enum job_kind kind;
    struct identity identity; /* of JOB_CONFIRM */
    char user[STORE_USER], name[STORE_PERSON], groups[STORE_GROUPS], address[46];
    char secret[AUTH_SECRET_TEXT]; /* of JOB_FIRST */
    char password[AUTH_MAX_PASSWORD + 1];
    bool is_secure_cookie;
    auth_done *done;
    void *context;
};

static void job_free(void *item)
{
    struct job *job = item;
    sodium_memzero(job, sizeof *job);
    free(job);
}

/* 0 with the hash. */
static int make_hash(const struct auth *auth, const char *password, char hash[crypto_pwhash_STRBYTES])
{
    const bool is_cheap = auth->options.is_cheap;
    return crypto_pwhash_str(hash, password, strlen(password), is_cheap ? crypto_pwhash_OPSLIMIT_MIN : PASSES,
                             is_cheap ? crypto_pwhash_MEMLIMIT_MIN : MEMORY_BYTES);
}

/* ---- checking --------------------------------------------------------------------------------------------------- */

static bool refuse_busy(struct problem *problem)
{
    problem_set(problem, PROBLEM_BUSY, "", "", "passwords cannot be checked at the moment");
    problem->retry_after_ms = AUTH_RETRY_MS;
    return false;
}

static bool refuse_paused(const struct throttle_state *state, struct problem *problem)
{
    problem_set(problem, PROBLEM_LIMIT, "", "pause", "too many passwords were wrong: the next is read in %d s",
                (int)((state->waits_ms + 999) / 1000));
    problem->retry_after_ms = (int)state->waits_ms;
    return false;
}

static struct throttle_state stricter(const struct throttle_state *a, const struct throttle_state *b)
{
    if (a->waits_ms != b->waits_ms)
        return a->waits_ms > b->waits_ms ? *a : *b;
    return a->tries_left < b->tries_left ? *a : *b;
}

/* The pause of a user at an address, or, of who signs in, of the network. Who confirms has proved before who they are,
 * and is not kept from signing by strangers of the same network. Under the lock. */
static struct throttle_state look_for_pause(struct auth *auth, enum job_kind kind, const char *user,
                                            const char *address)
{
    const int64_t now_ms = auth_now_ms(auth);
    const struct throttle_state own = throttle_look(auth->throttle, user, address, now_ms);
    if (kind == JOB_CONFIRM)
        return own;
    const struct throttle_state network = throttle_look(auth->throttle, NULL, address, now_ms);
    return stricter(&own, &network);
}

/* The answer to a wrong password, counted. Under the lock. */
static void count_wrong(struct auth *auth, const struct job *job, struct auth_answer *answer)
{
    const int64_t now_ms = auth_now_ms(auth);
    const struct throttle_state own = throttle_fail(auth->throttle, job->user, job->address, now_ms);
    struct throttle_state state = own;
    struct user *user = auth_find_user(auth, job->user);
    if (job->kind != JOB_CONFIRM) {
        const struct throttle_state network = throttle_fail(auth->throttle, NULL, job->address, now_ms);
        state = stricter(&own, &network);
    }
    answer->is_wrong = true;
    answer->tries_left = state.tries_left;
    answer->pause_s = (int)((state.waits_ms ? state.waits_ms : state.pause_ms) / 1000);
    problem_set(&answer->problem, PROBLEM_SIGN_IN, "", "password",
                "user and password do not match; %d tries are left before a pause of %d s", answer->tries_left,
                answer->pause_s);
    answer->problem.retry_after_ms = (int)state.waits_ms;
    if (user) {
        user->row.n_failed++;
        user->row.locked_until_ms = own.waits_ms ? now_ms + own.waits_ms : 0;
        auth_write_user(auth, user);
    }
}

/* A right password: the session begins, or is confirmed. Under the lock. */
static void accept(struct auth *auth, const struct job *job, struct user *user, struct auth_answer *answer)
{
    throttle_forget(auth->throttle, job->user, job->address, auth_now_ms(auth));
    if (user->row.n_failed) {
        user->row.n_failed = user->row.locked_until_ms = 0;
        auth_write_user(auth, user);
    }
    struct session *session = job->kind == JOB_CONFIRM
                                  ? auth_find_session(auth, job->identity.session)
                                  : auth_session_begin(auth, user, job->address, job->is_secure_cookie, answer->secret);
    if (!session || !auth_session_is_alive(auth, session, auth_now_ms(auth))) {
        problem_set(&answer->problem, PROBLEM_SIGN_IN, "", "", "this sign-in has ended");
        return;
    }
    if (job->kind == JOB_CONFIRM) {
        session->row.proved_ms = session->row.seen_ms = auth_now_ms(auth);
        auth_write_session(auth, &session->row);
    }
    auth_session_identity(auth, session, &answer->identity);
    mem_put_text(answer->identity.address, sizeof answer->identity.address, job->address);
}

static void check_password(struct auth *auth, const struct job *job, struct auth_answer *answer)
{
    char hash[sizeof((struct store_user *)NULL)->password];
    lock_hold(auth->lock);
    const struct throttle_state state = look_for_pause(auth, job->kind, job->user, job->address);
    struct user *user = auth_find_user(auth, job->user);
    const bool can_sign_in = user && !user->row.is_disabled && user->row.password[0];
    (void)snprintf(hash, sizeof hash, "%s", can_sign_in ? user->row.password : auth->no_user);
    lock_release(auth->lock);
    if (state.waits_ms) {
        (void)refuse_paused(&state, &answer->problem);
        return;
    }
    errno = 0;
    const bool matches = crypto_pwhash_str_verify(hash, job->password, strlen(job->password)) == 0;
    if (!matches && errno != EINVAL) { /* no memory, and not a wrong password */
        log_error("a password could not be checked: %s", strerror(errno));
        (void)refuse_busy(&answer->problem);
        return;
    }
    lock_hold(auth->lock);
    user = auth_find_user(auth, job->user);
    if (matches && can_sign_in && !user->row.is_disabled && strcmp(user->row.password, hash) == 0)
        accept(auth, job, user, answer);
    else
        count_wrong(auth, job, answer);
    lock_release(auth->lock);
    sodium_memzero(hash, sizeof hash);
}

/* ---- setting ---------------------------------------------------------------------------------------------------- */

static bool is_first(const struct auth *auth, const char *secret)
{
    return auth->first_until_ms && auth_now_ms(auth) < auth->first_until_ms && auth->n_users == 0 &&
           secret_matches(secret, auth->first_hash);
}

/* Whether the user of the job may be made or changed now. Under the lock. */
static bool may_set(struct auth *auth, const struct job *job, struct problem *problem)
{
    const struct user *user = auth_find_user(auth, job->user);
    if (!auth_can_keep(auth, problem))
        return false;
    if (job->kind == JOB_FIRST && !is_first(auth, job->secret))
        return problem_set(problem, PROBLEM_SIGN_IN, "", "first",
                           "this address makes no user any more: start the server anew, whose log then has another");
    if (job->kind == JOB_SET)
        return user || problem_set(problem, PROBLEM_NOT_FOUND, "", "", "there is no user \"%.64s\"", job->user);
    if (user)
        return problem_set(problem, PROBLEM_VALIDATION, "/user", "duplicate", "there is a user \"%.64s\" already",
                           job->user);
    return auth->n_users < AUTH_MAX_USERS ||
           problem_set(problem, PROBLEM_LIMIT, "", "", "there are %d users already", AUTH_MAX_USERS);
}

/* Under the lock. */
static void set(struct auth *auth, const struct job *job, const char *hash)
{
    if (!auth_find_user(auth, job->user)) {
        struct store_user row = { .created_ms = auth_now_ms(auth) };
        mem_put_text(row.id, sizeof row.id, job->user);
        mem_put_text(row.name, sizeof row.name, job->name);
        mem_put_text(row.groups, sizeof row.groups, job->groups);
        auth_user_put(auth, &row);
    }
    struct user *user = auth_find_user(auth, job->user);
    mem_put_text(user->row.password, sizeof user->row.password, hash);
    auth_sessions_end_of(auth, job->user);
    auth_write_user(auth, user);
    if (job->kind == JOB_FIRST)
        auth->first_until_ms = 0;
}

static void set_password(struct auth *auth, const struct job *job, struct auth_answer *answer)
{
    char hash[crypto_pwhash_STRBYTES];
    lock_hold(auth->lock);
    bool may = may_set(auth, job, &answer->problem);
    lock_release(auth->lock);
    if (!may)
        return;
    if (make_hash(auth, job->password, hash) != 0) {
        (void)refuse_busy(&answer->problem);
        return;
    }
    lock_hold(auth->lock);
    if (may_set(auth, job, &answer->problem))
        set(auth, job, hash);
    lock_release(auth->lock);
    sodium_memzero(hash, sizeof hash);
}

/* ---- the thread ------------------------------------------------------------------------------------------------- */

/* A sign-in that waited does not any more, or was not taken. */
static void leave(struct auth *auth, const struct job *job)
{
    if (job->kind != JOB_SIGN_IN)
        return;
    lock_hold(auth->lock);
    throttle_leave(auth->throttle, job->address);
    lock_release(auth->lock);
}

static void run(struct auth *auth, struct job *job)
{
    struct auth_answer answer = { .problem = { .type = PROBLEM_NONE } };
    if (job->kind == JOB_SIGN_IN || job->kind == JOB_CONFIRM)
        check_password(auth, job, &answer);
    else
        set_password(auth, job, &answer);
    sodium_memzero(job->password, sizeof job->password);
    leave(auth, job);
    job->done(job->context, &answer);
    sodium_memzero(&answer, sizeof answer);
}

static void *work(void *context)
{
    struct auth *auth = context;
    (void)setpriority(PRIO_PROCESS, 0, NICE); /* on Linux, of this thread alone */
    for (struct job *job; (job = queue_take(auth->jobs, -1));) {
        run(auth, job);
        job_free(job);
    }
    return NULL;
}

bool auth_passwords_start(struct auth *auth, struct error *err)
{
    (void)snprintf(auth->no_user, sizeof auth->no_user, "%s", hash_of_nobody);
    if (auth->options.is_cheap && make_hash(auth, hash_of_nobody, auth->no_user) != 0)
        return error_set(err, ERROR_MEMORY, "no memory for passwords");
    auth->jobs = queue_create(AUTH_QUEUE, job_free);
    auth->has_thread = pthread_create(&auth->thread, NULL, work, auth) == 0;
    return auth->has_thread || error_set(err, ERROR_MEMORY, "no thread could be started for passwords");
}

void auth_close(struct auth *auth)
{
    struct problem stopping = { 0 };
    if (auth->is_closed)
        return;
    auth->is_closed = true;
    problem_set(&stopping, PROBLEM_BUSY, "", "", "the server is stopping");
    if (auth->jobs)
        queue_close(auth->jobs);
    for (struct job *job; auth->jobs && (job = queue_try_take(auth->jobs));) {
        job->done(job->context, &(struct auth_answer){ .problem = stopping });
        job_free(job);
    }
    if (auth->has_thread)
        (void)pthread_join(auth->thread, NULL);
}

/* ---- asking ----------------------------------------------------------------------------------------------------- */

static struct job *make_job(enum job_kind kind, const char *user, const char *password, auth_done *done, void *context)
{
    struct job *job = mem_new(sizeof *job);
    job->kind = kind;
    job->done = done;
    job->context = context;
    mem_put_text(job->user, sizeof job->user, user);
    mem_put_text(job->password, sizeof job->password, password);
    return job;
}

static bool refuse_full(int n, struct problem *problem)
{
    problem_set(problem, PROBLEM_LIMIT, "", "", "%d passwords are being checked already", n);
    problem->retry_after_ms = AUTH_RETRY_MS;
    return false;
}

/* Takes job. */
static bool hand_over(struct auth *auth, struct job *job, struct problem *problem)
{
    if (queue_try_put(auth->jobs, job))
        return true;
    leave(auth, job);
    job_free(job);
    return refuse_full(AUTH_QUEUE, problem);
}

/* Whether another sign-in from this address may wait; then it does. */
static bool enter(struct auth *auth, const char *address, struct problem *problem)
{
    lock_hold(auth->lock);
    const bool may = throttle_enter(auth->throttle, address, auth_now_ms(auth));
    lock_release(auth->lock);
    return may || refuse_full(THROTTLE_NETWORK_WAITING, problem);
}

/* A password that is checked may be any text that fits; one that cannot be right is wrong like others. */
static bool is_paused(struct auth *auth, enum job_kind kind, const char *user, const char *address,
                      struct problem *problem)
{
    lock_hold(auth->lock);
    const struct throttle_state state = look_for_pause(auth, kind, user, address);
    lock_release(auth->lock);
    return state.waits_ms && !refuse_paused(&state, problem);
}

/* False: the database could not be opened since the start, so nobody is known. */
static bool is_read(struct auth *auth, struct problem *problem)
{
    lock_hold(auth->lock);
    const bool is_loaded = auth->is_loaded;
    lock_release(auth->lock);
    return is_loaded || refuse_busy(problem);
}

bool auth_sign_in(struct auth *auth, const char *user, const char *password, const char *address, bool is_secure_cookie,
                  auth_done *done, void *context, struct problem *problem)
{
    if (!auth->options.is_local)
        return problem_set(problem, PROBLEM_NOT_FOUND, "", "", "nobody signs in with a password here");
    if (strlen(user) > IDENTITY_MAX_USER || strlen(password) > AUTH_MAX_PASSWORD)
        return problem_set(problem, PROBLEM_VALIDATION, "", "length",
                           "a user has at most %d bytes, a password at most %d", IDENTITY_MAX_USER, AUTH_MAX_PASSWORD);
    if (!is_read(auth, problem) || is_paused(auth, JOB_SIGN_IN, user, address, problem) ||
        !enter(auth, address, problem))
        return false;
    struct job *job = make_job(JOB_SIGN_IN, user, password, done, context);
    mem_put_text(job->address, sizeof job->address, address);
    job->is_secure_cookie = is_secure_cookie;
    return hand_over(auth, job, problem);
}

bool auth_confirm(struct auth *auth, const struct identity *identity, const char *password, auth_done *done,
                  void *context, struct problem *problem)
{
    if (identity->source != IDENTITY_PASSWORD)
        return problem_set(problem, PROBLEM_CONFLICT, "", "source",
                           "only who signed in with a password confirms with one");
    if (strlen(password) > AUTH_MAX_PASSWORD)
        return problem_set(problem, PROBLEM_VALIDATION, "/password", "length", "a password has at most %d bytes",
                           AUTH_MAX_PASSWORD);
    if (is_paused(auth, JOB_CONFIRM, identity->user, identity->address, problem))
        return false;
    struct job *job = make_job(JOB_CONFIRM, identity->user, password, done, context);
    job->identity = *identity;
    mem_put_text(job->address, sizeof job->address, identity->address);
    return hand_over(auth, job, problem);
}

/* Characters of UTF-8 text. */
static size_t characters_of(const char *text)
{
    size_t n = 0;
    for (; *text; text++)
        n += ((unsigned char)*text & 0xc0) != 0x80;
    return n;
}

static bool password_will_do(const char *password, struct problem *problem)
{
    const size_t n = strlen(password);
    return (n <= AUTH_MAX_PASSWORD && characters_of(password) >= AUTH_MIN_PASSWORD) ||
           problem_set(problem, PROBLEM_VALIDATION, "/password", "length",
                       "a password has %d characters at least and %d bytes at most", AUTH_MIN_PASSWORD,
                       AUTH_MAX_PASSWORD);
}

static bool user_will_do(const char *user, const char *name, struct problem *problem)
{
    if (!words_are_id(user))
        return problem_set(problem, PROBLEM_VALIDATION, "/user", "pattern",
                           "a user has 1 to %d bytes of UTF-8, without spaces and , ; \" \\, and does not begin with @ "
                           "or -",
                           IDENTITY_MAX_USER);
    return words_are_printable(name, IDENTITY_MAX_NAME) ||
           problem_set(problem, PROBLEM_VALIDATION, "/name", "pattern", "a name is one line of 1 to %d bytes of UTF-8",
                       IDENTITY_MAX_NAME);
}

static bool add(struct auth *auth, enum job_kind kind, const char *secret, const char *user, const char *name,
                const char *groups, const char *password, auth_done *done, void *context, struct problem *problem)
{
    struct identity checked = { .n_groups = 0 };
    if (!user_will_do(user, name, problem) || !words_read_groups(groups, &checked, problem) ||
        !password_will_do(password, problem))
        return false;
    struct job *job = make_job(kind, user, password, done, context);
    size_t used = 0;
    for (size_t i = 0; i < checked.n_groups; i++)
        used += (size_t)snprintf(job->groups + used, sizeof job->groups - used, "%s\n", checked.groups[i]);
    mem_put_text(job->name, sizeof job->name, name);
    mem_put_text(job->secret, sizeof job->secret, secret);
    return hand_over(auth, job, problem);
}

bool auth_user_add(struct auth *auth, const char *user, const char *name, const char *groups, const char *password,
                   auth_done *done, void *context, struct problem *problem)
{
    return add(auth, JOB_ADD, "", user, name, groups, password, done, context, problem);
}

bool auth_user_first(struct auth *auth, const char *secret, const char *user, const char *name, const char *password,
                     auth_done *done, void *context, struct problem *problem)
{
    lock_hold(auth->lock);
    const bool is_right = is_first(auth, secret);
    lock_release(auth->lock);
    if (!is_right)
        return problem_set(problem, PROBLEM_SIGN_IN, "", "first",
                           "this address makes no user any more: start the server anew, whose log then has another");
    return add(auth, JOB_FIRST, secret, user, name, AUTH_ADMIN_GROUP "\n", password, done, context, problem);
}

bool auth_user_password(struct auth *auth, const char *user, const char *password, auth_done *done, void *context,
                        struct problem *problem)
{
    return password_will_do(password, problem) &&
           hand_over(auth, make_job(JOB_SET, user, password, done, context), problem);
}

bool auth_first(struct auth *auth, char secret[AUTH_SECRET_TEXT])
{
    lock_hold(auth->lock);
    const bool is_wanted = auth->options.is_local && auth->is_loaded && auth->n_users == 0;
    if (is_wanted) {
        random_hex(secret, (AUTH_SECRET_TEXT - 1) / 2);
        secret_hash(secret, auth->first_hash);
        auth->first_until_ms = auth_now_ms(auth) + AUTH_FIRST_MS;
    }
    lock_release(auth->lock);
    return is_wanted;
}
