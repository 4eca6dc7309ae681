/* Tokens of scripts: br_ID_SECRET, of which the hash is kept. */
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "core/base/mem.h"
#include "server/auth/auth_state.h"
#include "server/auth/secret.h"
#include "server/auth/words.h"
#include "server/wire/random.h"

enum { ID_BYTES = 6, SECRET_BYTES = 32, USED_STEP_MS = 60000 };
#define FORGET_MS (INT64_C(90) * 24 * 60 * 60 * 1000) /* after its end it is listed for so long */

static const struct {
    const char *word;
    unsigned scope;
} scope_words[] = { { "read", IDENTITY_SCOPE_READ },
                    { "plan", IDENTITY_SCOPE_PLAN },
                    { "pull", IDENTITY_SCOPE_PULL },
                    { "admin", IDENTITY_SCOPE_ADMIN } };
enum { N_SCOPES = sizeof scope_words / sizeof scope_words[0] };

bool auth_scopes_read(const char *words, unsigned *scopes)
{
    *scopes = 0;
    while (*words) {
        const size_t n = strcspn(words, " ,");
        size_t i = 0;
        while (i < N_SCOPES && (strlen(scope_words[i].word) != n || strncmp(scope_words[i].word, words, n) != 0))
            i++;
        if (n && i == N_SCOPES)
            return false;
        if (n)
            *scopes |= scope_words[i].scope;
        words += n + (words[n] != 0);
    }
    return *scopes != 0;
}

static void write_scopes(unsigned scopes, char *text, size_t size)
{
    size_t used = 0;
    text[0] = 0;
    for (size_t i = 0; i < N_SCOPES; i++)
        if (scopes & scope_words[i].scope)
            used += (size_t)snprintf(text + used, size - used, "%s%s", used ? " " : "", scope_words[i].word);
}

void auth_token_add(struct auth *auth, struct token *token)
{
    struct token **bucket = &auth->tokens[auth_bucket(token->row.id)];
    token->next = *bucket;
    *bucket = token;
    auth->n_tokens++;
}

struct token *auth_find_token(struct auth *auth, const char *id)
{
    struct token *token = auth->tokens[auth_bucket(id)];
    while (token && strcmp(token->row.id, id) != 0)
        token = token->next;
    return token;
}

bool auth_token_is_alive(struct auth *auth, const struct token *token, int64_t now_ms)
{
    return !token->row.revoked_ms && now_ms < token->row.expires_ms && !auth_user_is_disabled(auth, token->row.user);
}

static void fill_identity(struct auth *auth, const struct token *token, struct identity *identity)
{
    const struct user *user = auth_find_user(auth, token->row.user);
    identity->source = IDENTITY_TOKEN;
    (void)auth_scopes_read(token->row.scope, &identity->scopes);
    identity->is_admin = (identity->scopes & IDENTITY_SCOPE_ADMIN) && auth_user_is_admin(auth, token->row.user);
    mem_put_text(identity->user, sizeof identity->user, token->row.user);
    words_cut(identity->name, token->row.name, IDENTITY_MAX_NAME);
    if (user)
        words_copy_groups(user->row.groups, identity);
    mem_put_text(identity->session, sizeof identity->session, token->row.id);
    mem_put_text(identity->folders, sizeof identity->folders, token->row.folders);
    identity->ends_ms = token->row.expires_ms;
}

static bool is_wrong(struct problem *problem)
{
    return problem_set(problem, PROBLEM_SIGN_IN, "", "token", "this token is not known, has expired or was revoked");
}

int auth_token_of_header(struct auth *auth, const char *authorization, struct identity *identity,
                         struct problem *problem)
{
    static const char scheme[] = "Bearer ", mark[] = "br_";
    char id[2 * ID_BYTES + 1], secret[2 * SECRET_BYTES + 1];
    if (strncasecmp(authorization, scheme, sizeof scheme - 1) != 0)
        return 0;
    const char *text = authorization + sizeof scheme - 1;
    text += strspn(text, " ");
    if (strncmp(text, mark, sizeof mark - 1) != 0)
        return 0;
    text += sizeof mark - 1;
    if (strlen(text) != 2 * ID_BYTES + 1 + 2 * SECRET_BYTES || text[2 * ID_BYTES] != '_')
        return is_wrong(problem) ? 1 : -1;
    memcpy(id, text, sizeof id - 1);
    id[sizeof id - 1] = 0;
    memcpy(secret, text + sizeof id, sizeof secret);
    static const unsigned char no_hash[STORE_HASH_BYTES];
    struct token *token = auth_find_token(auth, id);
    const bool matches = secret_matches(secret, token ? token->row.hash : no_hash) && token;
    const int64_t now_ms = auth_now_ms(auth);
    sodium_memzero(secret, sizeof secret);
    if (!matches || !auth_token_is_alive(auth, token, now_ms))
        return is_wrong(problem) ? 1 : -1;
    if (now_ms >= token->row.used_ms + USED_STEP_MS) {
        token->row.used_ms = now_ms;
        auth_write_token(auth, &token->row);
    }
    fill_identity(auth, token, identity);
    return 1;
}

void auth_tokens_tick(struct auth *auth, int64_t now_ms)
{
    for (size_t i = 0; i < AUTH_BUCKETS; i++)
        for (struct token **at = &auth->tokens[i]; *at;) {
            struct token *token = *at;
            const int64_t end_ms = token->row.revoked_ms && token->row.revoked_ms < token->row.expires_ms
                                       ? token->row.revoked_ms
                                       : token->row.expires_ms;
            if (now_ms < end_ms + FORGET_MS) {
                at = &token->next;
                continue;
            }
            *at = token->next;
            token->row.is_deleted = true;
            auth_write_token(auth, &token->row);
            auth->n_tokens--;
            free(token);
        }
}

static bool check_wanted(const struct auth_token_wanted *wanted, struct problem *problem)
{
    if (!words_are_id(wanted->user))
        return problem_set(problem, PROBLEM_VALIDATION, "/user", "pattern",
                           "a user has 1 to %d bytes of UTF-8, without spaces and , ; \" \\, and does not begin with @ "
                           "or -",
                           IDENTITY_MAX_USER);
    if (!words_are_printable(wanted->name, IDENTITY_MAX_NAME))
        return problem_set(problem, PROBLEM_VALIDATION, "/name", "pattern",
                           "a name is one line of 1 to %d bytes of UTF-8", IDENTITY_MAX_NAME);
    if (!wanted->scopes)
        return problem_set(problem, PROBLEM_VALIDATION, "/scope", "enum", "a scope is read, plan, pull or admin");
    if (wanted->lasts_ms <= 0 || wanted->lasts_ms > AUTH_MAX_TOKEN_MS)
        return problem_set(problem, PROBLEM_VALIDATION, "/days", "range", "a token lasts 1 to 366 days");
    struct store_token row;
    return strlen(wanted->folders) < sizeof row.folders ||
           problem_set(problem, PROBLEM_VALIDATION, "/folders", "length",
                       "the folders of a token have at most %d bytes in all", (int)sizeof row.folders - 1);
}

bool auth_token_create(struct auth *auth, const struct auth_token_wanted *wanted, char token[AUTH_TOKEN_TEXT],
                       struct store_token *made, struct problem *problem)
{
    char secret[2 * SECRET_BYTES + 1];
    if (!check_wanted(wanted, problem))
        return false;
    lock_hold(auth->lock);
    bool ok = auth_can_keep(auth, problem);
    if (ok && auth->n_tokens >= AUTH_MAX_TOKENS)
        ok = problem_set(problem, PROBLEM_LIMIT, "", "",
                         "there are %d tokens already; those that ended are forgotten "
                         "after 90 days",
                         AUTH_MAX_TOKENS);
    if (ok) {
        struct token *entry = mem_new(sizeof *entry);
        random_hex(entry->row.id, ID_BYTES);
        random_hex(secret, SECRET_BYTES);
        secret_hash(secret, entry->row.hash);
        mem_put_text(entry->row.user, sizeof entry->row.user, wanted->user);
        mem_put_text(entry->row.name, sizeof entry->row.name, wanted->name);
        mem_put_text(entry->row.folders, sizeof entry->row.folders, wanted->folders);
        write_scopes(wanted->scopes, entry->row.scope, sizeof entry->row.scope);
        entry->row.created_ms = auth_now_ms(auth);
        entry->row.expires_ms = entry->row.created_ms + wanted->lasts_ms;
        auth_token_add(auth, entry);
        auth_write_token(auth, &entry->row);
        (void)snprintf(token, AUTH_TOKEN_TEXT, "br_%.12s_%.64s", entry->row.id, secret);
        *made = entry->row;
        memset(made->hash, 0, sizeof made->hash);
        sodium_memzero(secret, sizeof secret);
    }
    lock_release(auth->lock);
    return ok;
}

bool auth_token_revoke(struct auth *auth, const char *id, struct problem *problem)
{
    lock_hold(auth->lock);
    struct token *token = auth_find_token(auth, id);
    if (token && !token->row.revoked_ms) {
        token->row.revoked_ms = auth_now_ms(auth);
        auth_write_token(auth, &token->row);
    }
    lock_release(auth->lock);
    return token || problem_set(problem, PROBLEM_NOT_FOUND, "", "", "there is no token \"%.20s\"", id);
}

static int newest_first(const void *a, const void *b)
{
    const struct store_token *one = a, *other = b;
    if (one->created_ms != other->created_ms)
        return one->created_ms < other->created_ms ? 1 : -1;
    return strcmp(one->id, other->id);
}

struct store_token *auth_tokens(struct auth *auth, size_t *n)
{
    *n = 0;
    lock_hold(auth->lock);
    struct store_token *list = mem_array(auth->n_tokens + 1, sizeof *list, 16 << 20, NULL);
    for (size_t i = 0; list && i < AUTH_BUCKETS; i++)
        for (const struct token *token = auth->tokens[i]; token; token = token->next) {
            list[*n] = token->row;
            memset(list[*n].hash, 0, sizeof list[*n].hash);
            ++*n;
        }
    lock_release(auth->lock);
    if (list)
        qsort(list, *n, sizeof *list, newest_first);
    return list;
}
