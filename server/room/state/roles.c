/* Checks roles against rights, and chooses colours of new members. */
#include "server/room/state/roles.h"

#include <string.h>

/* On the page's darkest and lightest panels (--bg0, --bg5) and under dark letters (--ink) each has a contrast of at
 * least 4.5:1, and no two are nearer than 25 in CIE Lab; tests/unit/server/room/test_roles.c computes both. */
static const uint32_t colors[ROLES_N_COLORS] = { 0x56b4e9, 0xe69f00, 0x2fd08f, 0xff7fd1, 0xf0e442, 0xaa93ff,
                                                 0xff8a65, 0x40d8dc, 0x9ccc3c, 0xc9a27c, 0xd5dbe3, 0xff7389 };

bool role_has_right(enum wire_member_role role, enum wire_right right)
{
    return (wire_role_rights[role] >> right & 1U) != 0;
}

enum wire_member_role role_lower(enum wire_member_role a, enum wire_member_role b)
{
    return role_rank(a) < role_rank(b) ? a : b;
}

bool role_of_word(const char *word, enum wire_member_role *role)
{
    for (size_t i = 0; word && i < wire_member_role_words.n; i++)
        if (strcmp(word, wire_member_role_words.words[i]) == 0) {
            *role = (enum wire_member_role)i;
            return true;
        }
    return false;
}

bool member_has_right(const struct member *member, enum wire_right right)
{
    if (!member->is_guest || member->role == WIRE_MEMBER_ROLE_WALL)
        return role_has_right(member->role, right);
    return right == WIRE_RIGHT_LOOK || right == WIRE_RIGHT_POINT ||
           (right == WIRE_RIGHT_NOTE && role_has_right(member->role, right));
}

static bool refuse(const char *who, enum wire_right right, struct problem *problem)
{
    static const char *const acts[] = {
        [WIRE_RIGHT_LOOK] = "look",
        [WIRE_RIGHT_POINT] = "point",
        [WIRE_RIGHT_NOTE] = "write notes and bookmarks",
        [WIRE_RIGHT_SCENE] = "present or change what the room shows",
        [WIRE_RIGHT_CONTROL] = "lock control, make links or close the room",
    };
    return problem_set(problem, PROBLEM_FORBIDDEN, "", "role", "the role of %s does not include to %s", who,
                       acts[right]);
}

bool role_check(enum wire_member_role role, enum wire_right right, struct problem *problem)
{
    return role_has_right(role, right) || refuse(wire_member_role_words.words[role], right, problem);
}

bool member_check(const struct member *member, enum wire_right right, struct problem *problem)
{
    return member_has_right(member, right) ||
           refuse(member->is_guest ? "guest" : wire_member_role_words.words[member->role], right, problem);
}

int color_of_newcomer(const struct room *room)
{
    int n_of[ROLES_N_COLORS] = { 0 }, best = 0;
    for (int i = 0; i < room->members.n; i++)
        n_of[room->members.list[i]->color] += room->members.list[i]->role != WIRE_MEMBER_ROLE_WALL;
    for (int i = 1; i < ROLES_N_COLORS; i++)
        if (n_of[i] < n_of[best])
            best = i;
    return best;
}

uint32_t color_rgb(int color)
{
    return colors[color];
}
