/* Sessions of people who gave a password. A session is found by the hash of its cookie, name and all: a cookie that was
 * given for TLS counts under that name alone. */
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/auth/auth_state.h"
#include "server/auth/secret.h"
#include "server/auth/words.h"
#include "server/wire/random.h"

enum { SEEN_STEP_MS = 60000, ID_BYTES = 8 };

static const char secure_name[] = "__Host-beamroom", plain_name[] = "beamroom";

static size_t bucket_of(const unsigned char *hash)
{
    return ((size_t)hash[0] << 8 | hash[1]) % AUTH_BUCKETS;
}

static void hash_cookie(const char *name, const char *secret, unsigned char hash[STORE_HASH_BYTES])
{
    char text[sizeof secure_name + AUTH_SECRET_TEXT + 1];
    (void)snprintf(text, sizeof text, "%s=%s", name, secret);
    secret_hash(text, hash);
    sodium_memzero(text, sizeof text);
}

void auth_session_fill(struct session *session, const struct store_session *row)
{
    *session = (struct session){ .row = *row, .written_ms = row->seen_ms };
    (void)sodium_bin2hex(session->id, sizeof session->id, row->hash, ID_BYTES);
}

void auth_session_add(struct auth *auth, struct session *session)
{
    struct session **bucket = &auth->sessions[bucket_of(session->row.hash)];
    session->next = *bucket;
    *bucket = session;
    auth->n_sessions++;
}

bool auth_session_is_alive(const struct auth *auth, const struct session *session, int64_t now_ms)
{
    return now_ms < session->row.seen_ms + auth->options.idle_ms &&
           now_ms < session->row.created_ms + auth->options.total_ms;
}

/* Ends the session at this place. */
static void end_at(struct auth *auth, struct session **at)
{
    struct session *session = *at;
    *at = session->next;
    session->row.is_deleted = true;
    auth_write_session(auth, &session->row);
    auth->n_sessions--;
    sodium_memzero(session, sizeof *session);
    free(session);
}

/* The place of a session with this id. */
static struct session **place_of(struct auth *auth, const char *id)
{
    static struct session *none;
    unsigned char begin[ID_BYTES] = { 0 };
    size_t n = 0;
    if (strlen(id) != 2 * ID_BYTES || sodium_hex2bin(begin, sizeof begin, id, 2 * ID_BYTES, NULL, &n, NULL) != 0)
        return &none;
    struct session **at = &auth->sessions[bucket_of(begin)];
    while (*at && strcmp((*at)->id, id) != 0)
        at = &(*at)->next;
    return at;
}

struct session *auth_find_session(struct auth *auth, const char *id)
{
    return *place_of(auth, id);
}

/* The secret under this name in a Cookie header; false: it has none. */
static bool read_cookie(const char *cookies, const char *name, char secret[AUTH_SECRET_TEXT])
{
    const size_t n_name = strlen(name);
    for (const char *at = cookies; *at;) {
        at += strspn(at, " ;");
        const size_t n = strcspn(at, ";");
        if (n == n_name + AUTH_SECRET_TEXT && strncmp(at, name, n_name) == 0 && at[n_name] == '=') {
            memcpy(secret, at + n_name + 1, AUTH_SECRET_TEXT - 1);
            secret[AUTH_SECRET_TEXT - 1] = 0;
            return strspn(secret, "0123456789abcdef") == AUTH_SECRET_TEXT - 1;
        }
        at += n;
    }
    return false;
}

static struct session *find_by_secret(struct auth *auth, const char *name, const char *secret)
{
    unsigned char hash[STORE_HASH_BYTES];
    hash_cookie(name, secret, hash);
    struct session *session = auth->sessions[bucket_of(hash)];
    while (session && sodium_memcmp(session->row.hash, hash, sizeof hash) != 0)
        session = session->next;
    return session;
}

struct session *auth_session_of_cookie(struct auth *auth, const char *cookies, bool is_https)
{
    char secret[AUTH_SECRET_TEXT] = "";
    struct session *session = NULL;
    if (read_cookie(cookies, secure_name, secret))
        session = find_by_secret(auth, secure_name, secret);
    if (!session && !is_https && read_cookie(cookies, plain_name, secret))
        session = find_by_secret(auth, plain_name, secret);
    sodium_memzero(secret, sizeof secret);
    return session && auth_session_is_alive(auth, session, auth_now_ms(auth)) &&
                   !auth_user_is_disabled(auth, session->row.user)
               ? session
               : NULL;
}

/* Ends the session longest without input, of this user or, with NULL, of all. */
static void end_oldest(struct auth *auth, const char *user)
{
    struct session **oldest = NULL;
    for (size_t i = 0; i < AUTH_BUCKETS; i++)
        for (struct session **at = &auth->sessions[i]; *at; at = &(*at)->next)
            if ((!user || strcmp((*at)->row.user, user) == 0) &&
                (!oldest || (*at)->row.seen_ms < (*oldest)->row.seen_ms))
                oldest = at;
    if (oldest)
        end_at(auth, oldest);
}

static size_t count_of(const struct auth *auth, const char *user)
{
    size_t n = 0;
    for (size_t i = 0; i < AUTH_BUCKETS; i++)
        for (const struct session *session = auth->sessions[i]; session; session = session->next)
            n += strcmp(session->row.user, user) == 0;
    return n;
}

struct session *auth_session_begin(struct auth *auth, const struct user *user, const char *address,
                                   bool is_secure_cookie, char secret[AUTH_SECRET_TEXT])
{
    struct session *session = mem_new(sizeof *session);
    struct store_session row = { .source = "password" };
    if (count_of(auth, user->row.id) >= AUTH_MAX_SESSIONS_OF_USER)
        end_oldest(auth, user->row.id);
    if (auth->n_sessions >= AUTH_MAX_SESSIONS)
        end_oldest(auth, NULL);
    random_hex(secret, (AUTH_SECRET_TEXT - 1) / 2);
    hash_cookie(is_secure_cookie ? secure_name : plain_name, secret, row.hash);
    mem_put_text(row.user, sizeof row.user, user->row.id);
    mem_put_text(row.name, sizeof row.name, user->row.name);
    mem_put_text(row.groups, sizeof row.groups, user->row.groups);
    mem_put_text(row.address, sizeof row.address, address);
    row.created_ms = row.seen_ms = row.proved_ms = auth_now_ms(auth);
    auth_session_fill(session, &row);
    auth_session_add(auth, session);
    auth_write_session(auth, &session->row);
    return session;
}

void auth_session_identity(struct auth *auth, const struct session *session, struct identity *identity)
{
    const struct user *user = auth_find_user(auth, session->row.user);
    identity->source = IDENTITY_PASSWORD;
    identity->scopes = IDENTITY_SCOPE_ALL;
    identity->is_admin = auth_user_is_admin(auth, session->row.user);
    mem_put_text(identity->user, sizeof identity->user, session->row.user);
    words_cut(identity->name, user ? user->row.name : session->row.name, IDENTITY_MAX_NAME);
    words_copy_groups(user ? user->row.groups : session->row.groups, identity);
    memcpy(identity->session, session->id, sizeof identity->session);
    identity->proved_ms = session->row.proved_ms;
    identity->ends_ms = session->row.created_ms + auth->options.total_ms;
}

void auth_session_times(struct auth *auth, const struct identity *identity, struct auth_times *times)
{
    *times = (struct auth_times){ .ends_ms = identity->ends_ms };
    lock_hold(auth->lock);
    const struct session *session =
        identity->source == IDENTITY_PASSWORD ? auth_find_session(auth, identity->session) : NULL;
    if (session)
        times->idle_ends_ms = session->row.seen_ms + auth->options.idle_ms;
    lock_release(auth->lock);
}

void auth_session_used(struct auth *auth, const char *id)
{
    lock_hold(auth->lock);
    struct session *session = auth_find_session(auth, id);
    const int64_t now_ms = auth_now_ms(auth);
    if (session && auth_session_is_alive(auth, session, now_ms)) {
        session->row.seen_ms = now_ms;
        if (now_ms >= session->written_ms + SEEN_STEP_MS) {
            session->written_ms = now_ms;
            auth_write_session(auth, &session->row);
        }
    }
    lock_release(auth->lock);
}

void auth_session_end(struct auth *auth, const char *id)
{
    lock_hold(auth->lock);
    struct session **at = place_of(auth, id);
    if (*at)
        end_at(auth, at);
    lock_release(auth->lock);
}

void auth_sessions_end_of(struct auth *auth, const char *user)
{
    for (size_t i = 0; i < AUTH_BUCKETS; i++)
        for (struct session **at = &auth->sessions[i]; *at;) {
            if (strcmp((*at)->row.user, user) == 0)
                end_at(auth, at);
            else
                at = &(*at)->next;
        }
}

void auth_sessions_tick(struct auth *auth, int64_t now_ms)
{
    for (size_t i = 0; i < AUTH_BUCKETS; i++)
        for (struct session **at = &auth->sessions[i]; *at;) {
            if (!auth_session_is_alive(auth, *at, now_ms))
                end_at(auth, at);
            else
                at = &(*at)->next;
        }
}

void auth_cookie(const char *secret, bool is_secure, char text[AUTH_MAX_COOKIE])
{
    (void)snprintf(text, AUTH_MAX_COOKIE, "%s=%s; Path=/; HttpOnly; SameSite=Strict%s%s",
                   is_secure ? secure_name : plain_name, secret, is_secure ? "; Secure" : "",
                   secret[0] ? "" : "; Max-Age=0");
}
