#pragma once
/* The state of server/auth, shared by its files. Internal. Everything under the lock, but for the options and the
 * queue. */
#include <pthread.h>

#include "core/base/lock.h"
#include "core/base/queue.h"
#include "server/auth/auth.h"
#include "server/auth/throttle.h"

enum { AUTH_BUCKETS = 1024 };
#define AUTH_ADMIN_GROUP "admin"

struct user {
    struct user *next; /* in its bucket */
    struct store_user row;
};

struct token {
    struct token *next;
    struct store_token row;
};

struct session {
    struct session *next;
    char id[17]; /* the first 16 digits of its hash */
    struct store_session row;
    int64_t written_ms; /* seen_ms on its way to the disk */
};

struct owner {
    struct owner *next;
    struct store_owner row;
};

struct proof { /* the newest sign-in at the proxy of a user at an address */
    char user[IDENTITY_MAX_USER + 1], address[46];
    int64_t proved_ms;
};

struct unwritten { /* the store was full */
    struct unwritten *next;
    struct store_accounts *accounts;
};

struct auth {
    struct auth_options options;
    struct lock *lock;
    struct user *users[AUTH_BUCKETS];
    struct token *tokens[AUTH_BUCKETS];
    struct session *sessions[AUTH_BUCKETS];
    struct owner *owners[AUTH_BUCKETS];
    struct proof proofs[AUTH_BUCKETS]; /* of several users in a bucket, the last */
    size_t n_users, n_tokens, n_sessions;
    bool is_loaded;
    struct throttle *throttle;
    struct store *store;
    bool store_fails;
    struct unwritten *unwritten, **last_unwritten;
    size_t n_unwritten;
    unsigned char first_hash[STORE_HASH_BYTES];
    int64_t first_until_ms; /* 0: there is no address for the first user */
    char no_user[129];      /* hash of a password that nobody knows */
    struct queue *jobs;
    pthread_t thread;
    bool has_thread, is_closed;
};

int64_t auth_now_ms(const struct auth *auth);
size_t auth_bucket(const char *id);

/* Each under the lock. */
struct user *auth_find_user(struct auth *auth, const char *id);
bool auth_user_is_disabled(struct auth *auth, const char *id);
bool auth_user_is_admin(struct auth *auth, const char *id);
/* A copy of the row. */
void auth_user_put(struct auth *auth, const struct store_user *row);
void auth_owner_put(struct auth *auth, const struct store_owner *row);
void auth_flush(struct auth *auth); /* hands the store what it could not take before */
void auth_write_user(struct auth *auth, const struct user *user);
void auth_write_token(struct auth *auth, const struct store_token *row);
void auth_write_session(struct auth *auth, const struct store_session *row);
void auth_write_owner(struct auth *auth, const struct store_owner *row);
/* False with problem: nothing new is kept while the disk cannot be written, or before it was read. */
bool auth_can_keep(const struct auth *auth, struct problem *problem);

struct session *auth_find_session(struct auth *auth, const char *id);
/* The session whose cookie this header has, and which has not ended; NULL: there is none. is_https: only the cookie
 * that no other host of the domain can set counts. */
struct session *auth_session_of_cookie(struct auth *auth, const char *cookies, bool is_https);
bool auth_session_is_alive(const struct auth *auth, const struct session *session, int64_t now_ms);
/* Begins one; the secret for the cookie is told here alone. NULL: no memory. */
struct session *auth_session_begin(struct auth *auth, const struct user *user, const char *address,
                                   bool is_secure_cookie, char secret[AUTH_SECRET_TEXT]);
void auth_session_identity(struct auth *auth, const struct session *session, struct identity *identity);
void auth_sessions_end_of(struct auth *auth, const char *user);
void auth_sessions_tick(struct auth *auth, int64_t now_ms);
void auth_session_add(struct auth *auth, struct session *session);
void auth_session_fill(struct session *session, const struct store_session *row);

/* The token of an Authorization header. 1: identity is filled; 0: the header has none of ours; -1 with problem. */
int auth_token_of_header(struct auth *auth, const char *authorization, struct identity *identity,
                         struct problem *problem);
struct token *auth_find_token(struct auth *auth, const char *id);
bool auth_token_is_alive(struct auth *auth, const struct token *token, int64_t now_ms);
void auth_tokens_tick(struct auth *auth, int64_t now_ms);
void auth_token_add(struct auth *auth, struct token *token);

bool auth_passwords_start(struct auth *auth, struct error *err);
