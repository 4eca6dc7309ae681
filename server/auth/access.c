/* Grants as they were read, and the check of a right against them. */
#include "server/auth/access.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/lock.h"
#include "core/base/mem.h"

enum { MAX_FOLDER = 4096 };

enum where { WHERE_ALL, WHERE_UPLOADS, WHERE_PULLS, WHERE_PATH };
enum who { WHO_ALL, WHO_USER, WHO_GROUP };

struct grant {
    enum where where;
    enum who who;
    enum access_role role;
    bool sees_identity;
    char name[IDENTITY_MAX_USER + 1]; /* of the user or group */
    uint32_t name_hash;
    char *folder; /* of WHERE_PATH */
    size_t n_folder;
};

struct access {
    struct lock *lock;
    struct grant *grants;
    size_t n_grants;
};

/* Tells names apart that differ, but for rare accidents: FNV-1a. */
static uint32_t hash_of(const char *name)
{
    uint32_t hash = 2166136261U;
    for (; *name; name++)
        hash = (hash ^ (unsigned char)*name) * 16777619U;
    return hash;
}

static void free_grants(struct grant *grants, size_t n)
{
    for (size_t i = 0; i < n; i++)
        free(grants[i].folder);
    free(grants);
}

struct access *access_create(void)
{
    struct access *access = mem_new(sizeof *access);
    access->lock = lock_create();
    return access;
}

void access_destroy(struct access *access)
{
    if (!access)
        return;
    free_grants(access->grants, access->n_grants);
    lock_destroy(access->lock);
    free(access);
}

/* The last word of text[0..*n), which is shortened by it and by the spaces before it. */
static const char *last_word(const char *text, size_t *n, size_t *n_word)
{
    size_t end = *n, begin;
    while (end > 0 && (text[end - 1] == ' ' || text[end - 1] == '\t'))
        end--;
    for (begin = end; begin > 0 && text[begin - 1] != ' ' && text[begin - 1] != '\t'; begin--)
        continue;
    *n_word = end - begin;
    *n = begin;
    while (*n > 0 && (text[*n - 1] == ' ' || text[*n - 1] == '\t'))
        --*n;
    return text + begin;
}

static bool is_word(const char *text, size_t n, const char *word)
{
    return strlen(word) == n && memcmp(text, word, n) == 0;
}

static bool read_role(const char *word, size_t n, struct grant *grant)
{
    static const char more[] = "+identity";
    const size_t n_more = sizeof more - 1;
    grant->sees_identity = n > n_more && memcmp(word + n - n_more, more, n_more) == 0;
    if (grant->sees_identity)
        n -= n_more;
    for (int role = ACCESS_ROLE_OBSERVER; role < ACCESS_N_ROLES; role++)
        if (is_word(word, n, access_role_words[role])) {
            grant->role = (enum access_role)role;
            return true;
        }
    return false;
}

static bool read_who(const char *word, size_t n, struct grant *grant)
{
    grant->who = is_word(word, n, "*") ? WHO_ALL : n > 0 && word[0] == '@' ? WHO_GROUP : WHO_USER;
    const size_t skipped = grant->who == WHO_USER ? 0 : 1;
    if (n <= skipped)
        return grant->who == WHO_ALL;
    if (n - skipped > IDENTITY_MAX_USER || memchr(word + skipped, '*', n - skipped))
        return false;
    memcpy(grant->name, word + skipped, n - skipped);
    grant->name_hash = hash_of(grant->name);
    return true;
}

/* A folder without the slashes at its end; "/" is every path. */
static bool read_folder(const char *text, size_t n, struct grant *grant)
{
    grant->where = is_word(text, n, "*")         ? WHERE_ALL
                   : is_word(text, n, "uploads") ? WHERE_UPLOADS
                   : is_word(text, n, "pulls")   ? WHERE_PULLS
                                                 : WHERE_PATH;
    if (grant->where != WHERE_PATH)
        return true;
    if (n == 0 || n > MAX_FOLDER || text[0] != '/')
        return false;
    while (n > 0 && text[n - 1] == '/')
        n--;
    char *folder = mem_new(n + 1);
    memcpy(folder, text, n);
    char *real = n > 0 ? realpath(folder, NULL) : NULL; /* plans are known by the path behind links */
    if (real)
        free(folder);
    grant->folder = real ? real : folder;
    grant->n_folder = strlen(grant->folder);
    return true;
}

static bool read_grant(const struct access_line *line, struct grant *grant, struct error *err)
{
    const char *text = line->value + strspn(line->value, " \t");
    size_t n = strlen(text), n_role, n_who;
    const char *role = last_word(text, &n, &n_role), *who = last_word(text, &n, &n_who);
    if (n == 0)
        return error_set(err, ERROR_FORMAT, "%s, line %d: grant = %.80s, expected FOLDER WHO ROLE", line->file,
                         line->line, text);
    if (!read_role(role, n_role, grant))
        return error_set(err, ERROR_FORMAT,
                         "%s, line %d: the role is \"%.*s\", expected observer, reviewer, presenter, planner or admin, "
                         "with +identity behind it or not",
                         line->file, line->line, (int)(n_role < 40 ? n_role : 40), role);
    if (!read_who(who, n_who, grant))
        return error_set(err, ERROR_FORMAT,
                         "%s, line %d: who is \"%.*s\", expected a user, @group, or * for whoever has signed in",
                         line->file, line->line, (int)(n_who < 40 ? n_who : 40), who);
    if (!read_folder(text, n, grant))
        return error_set(err, ERROR_FORMAT,
                         "%s, line %d: the folder is \"%.*s\", expected an absolute path, uploads, pulls or *",
                         line->file, line->line, (int)(n < 80 ? n : 80), text);
    return true;
}

bool access_set(struct access *access, const struct access_line *lines, size_t n_lines, struct error *err)
{
    if (n_lines > ACCESS_MAX_GRANTS)
        return error_set(err, ERROR_LIMIT, "%s, line %d: more than %d lines of grant; use groups",
                         lines[ACCESS_MAX_GRANTS].file, lines[ACCESS_MAX_GRANTS].line, ACCESS_MAX_GRANTS);
    struct grant *grants = mem_array(n_lines, sizeof *grants, sizeof *grants * ACCESS_MAX_GRANTS, err);
    if (!grants)
        return false;
    for (size_t i = 0; i < n_lines; i++)
        if (!read_grant(&lines[i], &grants[i], err)) {
            free_grants(grants, n_lines);
            return false;
        }
    lock_hold(access->lock);
    struct grant *before = access->grants;
    const size_t n_before = access->n_grants;
    access->grants = grants;
    access->n_grants = n_lines;
    lock_release(access->lock);
    free_grants(before, n_before);
    return true;
}

static bool is_below(const char *path, const char *folder, size_t n_folder)
{
    return path && strncmp(path, folder, n_folder) == 0 && (path[n_folder] == '/' || path[n_folder] == 0);
}

static bool is_for(const struct grant *grant, const struct identity *identity, const uint32_t *group_hashes)
{
    if (grant->who != WHO_GROUP)
        return grant->who == WHO_ALL || strcmp(grant->name, identity->user) == 0;
    for (size_t i = 0; i < identity->n_groups; i++)
        if (grant->name_hash == group_hashes[i] && strcmp(grant->name, identity->groups[i]) == 0)
            return true;
    return false;
}

static bool is_on(const struct grant *grant, const struct access_subject *subject)
{
    switch (grant->where) {
    case WHERE_ALL: return true;
    case WHERE_UPLOADS: return subject->is_upload || subject->kind == ACCESS_SUBJECT_KIND_UPLOADS;
    case WHERE_PULLS: return subject->is_pull;
    case WHERE_PATH: return is_below(subject->folder, grant->folder, grant->n_folder);
    }
    return false;
}

/* Whether a token that is held to folders may be used on the subject. */
static bool token_is_for(const struct identity *identity, const struct access_subject *subject)
{
    const char *at = identity->folders;
    if (at[0] == 0 || subject->kind == ACCESS_SUBJECT_KIND_NONE)
        return true;
    for (size_t n = strcspn(at, "\n"); at[0]; at += n + (at[n] == '\n'), n = strcspn(at, "\n")) {
        size_t n_path = n;
        while (n_path > 0 && at[n_path - 1] == '/')
            n_path--;
        if (is_word(at, n, "*") ||
            (is_word(at, n, "uploads") && (subject->is_upload || subject->kind == ACCESS_SUBJECT_KIND_UPLOADS)) ||
            (is_word(at, n, "pulls") && subject->is_pull) || (at[0] == '/' && is_below(subject->folder, at, n_path)))
            return true;
    }
    return false;
}

static bool is_owner(const struct identity *identity, const struct access_subject *subject)
{
    return subject->owner && subject->owner[0] && strcmp(subject->owner, identity->user) == 0;
}

/* The role by grants, or as the owner of an upload or a job. */
static enum access_role granted(const struct access *access, const struct identity *identity,
                                const struct access_subject *subject, bool *sees_identity)
{
    enum access_role role = identity->is_admin            ? ACCESS_ROLE_ADMIN
                            : is_owner(identity, subject) ? ACCESS_ROLE_PLANNER
                                                          : ACCESS_ROLE_NONE;
    *sees_identity = false;
    if (!access || identity->user[0] == 0 || subject->kind == ACCESS_SUBJECT_KIND_NONE)
        return role;
    uint32_t group_hashes[IDENTITY_MAX_GROUPS];
    for (size_t i = 0; i < identity->n_groups; i++)
        group_hashes[i] = hash_of(identity->groups[i]);
    lock_hold(access->lock);
    for (size_t i = 0; i < access->n_grants; i++) {
        const struct grant *grant = &access->grants[i];
        if ((grant->role <= role && (!grant->sees_identity || *sees_identity)) || !is_on(grant, subject) ||
            !is_for(grant, identity, group_hashes))
            continue;
        if (grant->role > role)
            role = grant->role;
        *sees_identity |= grant->sees_identity;
    }
    lock_release(access->lock);
    return role;
}

static enum access_role role_on(const struct access *access, const struct identity *identity,
                                const struct access_subject *subject, bool *sees_identity)
{
    *sees_identity = false;
    if (identity->source == IDENTITY_NOBODY)
        return subject->room_role;
    if (!token_is_for(identity, subject))
        return ACCESS_ROLE_NONE;
    enum access_role role = granted(access, identity, subject, sees_identity);
    if (subject->is_closed && role < ACCESS_ROLE_ADMIN)
        role = ACCESS_ROLE_NONE;
    return subject->room_role > role ? subject->room_role : role;
}

enum access_role access_role_on(const struct access *access, const struct identity *identity,
                                const struct access_subject *subject)
{
    bool sees_identity;
    return identity->source == IDENTITY_MACHINE ? ACCESS_ROLE_ADMIN
                                                : role_on(access, identity, subject, &sees_identity);
}

/* A token that may change plans or pull them may also read; an administrator's may do all that its person may. */
static bool scope_allows(unsigned scopes, unsigned needed)
{
    return needed == IDENTITY_SCOPE_READ ? scopes != 0 : (scopes & (needed | IDENTITY_SCOPE_ADMIN)) != 0;
}

bool access_check(const struct access *access, const struct identity *identity, enum access_right right,
                  const struct access_subject *subject)
{
    if (right == ACCESS_FREE || identity->source == IDENTITY_MACHINE)
        return true;
    if (identity->source == IDENTITY_TOKEN && !scope_allows(identity->scopes, access_rights[right].scope))
        return false;
    if (right == ACCESS_SIGNED_IN)
        return identity->source != IDENTITY_NOBODY;
    if (right == ACCESS_EXPORT && identity->source == IDENTITY_NOBODY)
        return false; /* guests take no files away */
    struct access_subject of_grants = *subject;
    if (subject->kind != ACCESS_SUBJECT_KIND_ROOM && subject->kind != ACCESS_SUBJECT_KIND_MEETING &&
        right != ACCESS_LOOK && right != ACCESS_MEASURE)
        of_grants.room_role = ACCESS_ROLE_NONE; /* of a room's plan its members see what the room needs, and no more */
    bool sees_identity;
    const enum access_role role = role_on(access, identity, &of_grants, &sees_identity);
    return right == ACCESS_IDENTITY ? role >= ACCESS_ROLE_OBSERVER && sees_identity : role >= access_rights[right].role;
}

const struct access_route *access_route_find(const char *method, const char *path)
{
    for (const struct access_route *route = access_routes; route->method; route++)
        if (strcmp(route->method, method) == 0 && strcmp(route->path, path) == 0)
            return route;
    return NULL;
}
