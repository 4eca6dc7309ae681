#pragma once
/* Rights: the one place that decides who may do what. Grants are lines FOLDER WHO ROLE of the configuration; what a
 * call or message needs stands in proto/ and comes as a generated table. Knows no rooms, plans or calls: who asks
 * describes the subject. Thread: any. */
#include <stdbool.h>
#include <stddef.h>

#include "core/base/error.h"
#include "rights_gen.h"
#include "server/wire/identity.h"

enum { ACCESS_MAX_GRANTS = 256 }; /* lines: a list of plans asks each of them for each plan */

struct access;

/* On what a right is needed. All zero: on nothing in particular (subject "none"). */
struct access_subject {
    enum access_subject_kind kind;
    const char *folder;      /* of a plan, absolute, links resolved; NULL: not known, which only the folder * is */
    bool is_upload, is_pull; /* the plan lies in the folder of uploads, of pulls from an archive */
    const char *owner;       /* who uploaded the plan, or made the job: has the role planner on it; NULL, "": nobody */
    bool is_closed;          /* a room that lets in only whom it knows (room_role), and administrators */
    enum access_role room_role; /* of a room, or of a plan through one: what the room itself gives the caller as its
                                   member, by the secret of the seat or by name; it is not capped here */
};

struct access *access_create(void); /* without grants: whoever has signed in has no role anywhere */
void access_destroy(struct access *access);

/* One line "grant = FOLDER WHO ROLE" of a configuration, from FOLDER on.
 *   FOLDER  absolute path of a folder of plans, or of one above it; uploads; pulls; * for all of these and the server
 *   WHO     user, @group, or * for whoever has signed in
 *   ROLE    observer, reviewer, presenter, planner or admin; +identity behind it: sees whom a plan is of */
struct access_line {
    const char *value, *file; /* file and line are for errors */
    int line;
};

/* Replaces all grants; none is changed on failure. Of several lines that match, the highest role counts.
 *   errors  ERROR_FORMAT  names file and line, what was found and what was expected; ERROR_LIMIT */
NODISCARD bool access_set(struct access *access, const struct access_line *lines, size_t n_lines, struct error *err);

/* Whether this identity has the right on the subject. access NULL: nobody signs in, and there are no grants. */
bool access_check(const struct access *access, const struct identity *identity, enum access_right right,
                  const struct access_subject *subject);

/* The role that the identity has on the subject; of a token, without regard to its scopes. */
enum access_role access_role_on(const struct access *access, const struct identity *identity,
                                const struct access_subject *subject);

/* The right that a route needs: method and path as in proto/http.json. NULL: it is not described there, and nobody may
 * use it. */
const struct access_route *access_route_find(const char *method, const char *path);
