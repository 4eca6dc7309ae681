#pragma once
/* Sign-in and its proofs: users with passwords, sessions, tokens of scripts, names that a proxy vouches
 * for. All of it lies in memory and is written through the store; secrets are kept as hashes. Must never know: rooms,
 * rights, HTTP beyond two headers. Thread: any, unless noted. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/base/error.h"
#include "server/store/store.h"
#include "server/wire/identity.h"
#include "server/wire/problem.h"

enum {
    AUTH_IDLE_MS = 30 * 60 * 1000,       /* without input */
    AUTH_TOTAL_MS = 12 * 60 * 60 * 1000, /* of a session */
    AUTH_FIRST_MS = 60 * 60 * 1000,      /* of the address that makes the first user */
    AUTH_MAX_USERS = 4096,
    AUTH_MAX_TOKENS = 1024,
    AUTH_MAX_SESSIONS = 4096,
    AUTH_MAX_SESSIONS_OF_USER = 32,        /* the one longest without input ends */
    AUTH_QUEUE = 16,                       /* passwords that wait to be checked */
    AUTH_RETRY_MS = 1000,                  /* then, and while that many wait */
    AUTH_MIN_PASSWORD = 8,                 /* characters */
    AUTH_MAX_PASSWORD = 256,               /* bytes */
    AUTH_SECRET_TEXT = 65,                 /* of a session, with the end */
    AUTH_TOKEN_TEXT = 3 + 12 + 1 + 64 + 1, /* br_ID_SECRET, with the end */
    AUTH_MAX_COOKIE = 400                  /* a Set-Cookie */
};
#define AUTH_MAX_TOKEN_MS (INT64_C(366) * 24 * 60 * 60 * 1000)

struct auth;

struct auth_options {
    bool is_local, is_proxied; /* who signs in how; neither: nobody does, and everybody is the machine's person */
    int64_t idle_ms, total_ms; /* 0: as above */
    int64_t (*now_ms)(void);   /* the wall clock; NULL: clock_wall_ms */
    bool is_cheap;             /* for tests: passwords cost hardly anything */
};

/* errors ERROR_MEMORY, ERROR_STATE (libsodium does not start) */
NODISCARD struct auth *auth_create(const struct auth_options *options, struct error *err);
/* Passwords that wait are answered with a problem. Afterwards no `done` is called. */
void auth_close(struct auth *auth);
void auth_destroy(struct auth *auth);

/* Takes over the contents of the database, copied. is_new: it was damaged and begun anew, so all of memory is written
 * again. */
void auth_load(struct auth *auth, const struct store_accounts *accounts, bool is_new);
/* Where changes are written from now on; NULL: nowhere. */
void auth_attach(struct auth *auth, struct store *store);
/* Tells whether changes reach the disk. While they do not, no user, password or token is made. */
void auth_store_fails(struct auth *auth, bool fails);
/* Forgets what has ended; to be called about once a minute. */
void auth_tick(struct auth *auth);

/* Finds out who makes a request. True: identity is filled, IDENTITY_NOBODY where nothing valid was brought. False with
 * problem: a token that is not valid, or names of a proxy that cannot be read. */
NODISCARD bool auth_identify(struct auth *auth, const struct credentials *credentials, struct identity *identity,
                             struct problem *problem);
/* False: its session has ended, its token was revoked, its user was disabled or has other groups now. proved_ms is
 * brought up to date: of a session by auth_confirm, of one who comes by a proxy by their newest request from there. */
bool auth_is_still(struct auth *auth, struct identity *identity);
bool auth_is_local(const struct auth *auth);
bool auth_is_proxied(const struct auth *auth);

/* ---- sessions --------------------------------------------------------------------------------------------------- */

struct auth_times { /* of a session, wall clock; 0: it does not end */
    int64_t idle_ends_ms, ends_ms;
};
void auth_session_times(struct auth *auth, const struct identity *identity, struct auth_times *times);
/* There was input, or somebody follows in a meeting. */
void auth_session_used(struct auth *auth, const char *session);
void auth_session_end(struct auth *auth, const char *session);
/* The Set-Cookie of a session; secret "": it ends. is_secure: browsers have to keep it to TLS. */
void auth_cookie(const char *secret, bool is_secure, char text[AUTH_MAX_COOKIE]);

/* ---- passwords -------------------------------------------------------------------------------------------------- */

struct auth_answer {               /* of a password that was checked or set */
    struct problem problem;        /* PROBLEM_NONE: it is right, or set */
    int tries_left, pause_s;       /* of a wrong one */
    bool is_wrong;                 /* tries_left and pause_s mean something */
    struct identity identity;      /* of a new session, or the one that was confirmed */
    char secret[AUTH_SECRET_TEXT]; /* of a new session */
};
/* Called once, on the thread that checks passwords. */
typedef void auth_done(void *context, const struct auth_answer *answer);

/* Each of these copies what it is given, wipes its copy of the password, and calls done later. False with problem: it
 * is refused at once and done is not called; retry_after_ms then says when to try again. */
NODISCARD bool auth_sign_in(struct auth *auth, const char *user, const char *password, const char *address,
                            bool is_secure_cookie, auth_done *done, void *context, struct problem *problem);
NODISCARD bool auth_confirm(struct auth *auth, const struct identity *identity, const char *password, auth_done *done,
                            void *context, struct problem *problem);
/* groups: each ended by '\n'. */
NODISCARD bool auth_user_add(struct auth *auth, const char *user, const char *name, const char *groups,
                             const char *password, auth_done *done, void *context, struct problem *problem);
/* Ends the user's sessions. */
NODISCARD bool auth_user_password(struct auth *auth, const char *user, const char *password, auth_done *done,
                                  void *context, struct problem *problem);
/* Makes the first user, an administrator, with the secret of auth_first. */
NODISCARD bool auth_user_first(struct auth *auth, const char *secret, const char *user, const char *name,
                               const char *password, auth_done *done, void *context, struct problem *problem);
/* True: nobody can sign in yet, and secret makes the first user within AUTH_FIRST_MS. */
bool auth_first(struct auth *auth, char secret[AUTH_SECRET_TEXT]);

void auth_wipe(void *secret, size_t n); /* so that it does not stay in memory */

/* ---- users and tokens ------------------------------------------------------------------------------------------- */

/* Disabling ends sessions and refuses tokens; of one who comes by a proxy, too, once a user of this name is disabled
 * here. False: not-found. */
NODISCARD bool auth_user_disable(struct auth *auth, const char *user, bool is_disabled, struct problem *problem);
bool auth_has_user(struct auth *auth, const char *user);
/* Copies without passwords; the caller's, for free(). NULL: no memory. */
struct store_user *auth_users(struct auth *auth, size_t *n);

struct auth_token_wanted {
    const char *user, *name, *folders; /* folders: each ended by '\n'; "": all that the user may see */
    unsigned scopes;                   /* enum identity_scope */
    int64_t lasts_ms;
};
/* The token is told once, here. */
NODISCARD bool auth_token_create(struct auth *auth, const struct auth_token_wanted *wanted, char token[AUTH_TOKEN_TEXT],
                                 struct store_token *made, struct problem *problem);
NODISCARD bool auth_token_revoke(struct auth *auth, const char *id, struct problem *problem);
/* Copies without hashes, the newest first; the caller's, for free(). NULL: no memory. */
struct store_token *auth_tokens(struct auth *auth, size_t *n);
/* Words of scopes, "read plan"; false: there is another word. */
bool auth_scopes_read(const char *words, unsigned *scopes);

/* ---- plans ------------------------------------------------------------------------------------------------------ */

/* The user who owns an uploaded plan; "": nobody. */
void auth_owner(struct auth *auth, const char *plan, char user[IDENTITY_MAX_USER + 1]);
void auth_set_owner(struct auth *auth, const char *plan, const char *user); /* user "": nobody's any more */

/* True: an address on this server that a sign-in may lead back to: it begins with one '/', without backslash or
 * control character. */
bool auth_return_is_own(const char *path);
