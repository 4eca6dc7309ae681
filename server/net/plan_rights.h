#pragma once
/* Plans as subjects of rights: where a plan lies and whose it is, for access_check. Net thread. */
#include "server/auth/access.h"
#include "server/auth/auth.h"
#include "server/fleet/fleet.h"
#include "wire_gen.h"

/* How rights are found out, where people sign in. */
struct plan_rights {
    const struct access *access; /* NULL: there are no grants */
    struct auth *auth;           /* which knows who uploaded a plan; NULL: nobody did */
};

struct plan_subject {
    struct access_subject subject;
    char owner[IDENTITY_MAX_USER + 1];
};

/* Describes the plan, also one that is gone: only who has a role everywhere has one there. subject.folder is borrowed
 * until the next call into the fleet. */
void plan_subject_fill(const struct plan_rights *rights, const struct fleet *fleet, const char *plan_id,
                       struct plan_subject *plan);
/* Whether the identity has the right on the plan by grants or as its owner, without regard to rooms. */
bool plan_rights_check(const struct plan_rights *rights, const struct fleet *fleet, const struct identity *who,
                       enum access_right right, const char *plan_id);
/* Like plan_rights_check, of a plan that was found; for lists. */
bool plan_rights_check_found(const struct plan_rights *rights, const struct fleet_plan *found,
                             const struct identity *who, enum access_right right);
/* The highest role that who has signed in may have in rooms on the plan. False: none. */
bool plan_rights_role(const struct plan_rights *rights, const struct fleet *fleet, const struct identity *who,
                      const char *plan_id, enum wire_member_role *role);
