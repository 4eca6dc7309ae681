/* Describes plans for access_check. */
#include "server/net/plan_rights.h"

static void describe(const struct plan_rights *rights, const struct fleet_plan *found, struct plan_subject *plan)
{
    *plan = (struct plan_subject){
        .subject = { .kind = ACCESS_SUBJECT_KIND_PLAN, .folder = found->folder, .is_upload = found->is_uploaded }
    };
    if (rights->auth && found->is_uploaded)
        auth_owner(rights->auth, found->id, plan->owner);
    plan->subject.owner = plan->owner;
}

void plan_subject_fill(const struct plan_rights *rights, const struct fleet *fleet, const char *plan_id,
                       struct plan_subject *plan)
{
    struct fleet_plan found;
    if (fleet_plan_find(fleet, plan_id, &found))
        describe(rights, &found, plan);
    else
        *plan = (struct plan_subject){ .subject = { .kind = ACCESS_SUBJECT_KIND_PLAN } };
}

bool plan_rights_check_found(const struct plan_rights *rights, const struct fleet_plan *found,
                             const struct identity *who, enum access_right right)
{
    struct plan_subject plan;
    if (who->source == IDENTITY_MACHINE)
        return true;
    describe(rights, found, &plan);
    return access_check(rights->access, who, right, &plan.subject);
}

bool plan_rights_check(const struct plan_rights *rights, const struct fleet *fleet, const struct identity *who,
                       enum access_right right, const char *plan_id)
{
    struct plan_subject plan;
    if (who->source == IDENTITY_MACHINE)
        return true;
    plan_subject_fill(rights, fleet, plan_id, &plan);
    return access_check(rights->access, who, right, &plan.subject);
}

bool plan_rights_role(const struct plan_rights *rights, const struct fleet *fleet, const struct identity *who,
                      const char *plan_id, enum wire_member_role *role)
{
    static const enum wire_member_role roles[] = {
        [ACCESS_ROLE_OBSERVER] = WIRE_MEMBER_ROLE_OBSERVER,   [ACCESS_ROLE_REVIEWER] = WIRE_MEMBER_ROLE_REVIEWER,
        [ACCESS_ROLE_PRESENTER] = WIRE_MEMBER_ROLE_PRESENTER, [ACCESS_ROLE_PLANNER] = WIRE_MEMBER_ROLE_PLANNER,
        [ACCESS_ROLE_ADMIN] = WIRE_MEMBER_ROLE_PLANNER,
    };
    struct plan_subject plan;
    if (who->source == IDENTITY_NOBODY)
        return false;
    plan_subject_fill(rights, fleet, plan_id, &plan);
    const enum access_role found = access_role_on(rights->access, who, &plan.subject);
    if (found == ACCESS_ROLE_NONE)
        return false;
    *role = roles[found];
    return true;
}
