/* Lists of users and groups: named.h. */
#include "server/wire/named.h"

#include <string.h>

int role_rank(enum wire_member_role role)
{
    static const int ranks[] = { [WIRE_MEMBER_ROLE_WALL] = 0,
                                 [WIRE_MEMBER_ROLE_OBSERVER] = 1,
                                 [WIRE_MEMBER_ROLE_REVIEWER] = 2,
                                 [WIRE_MEMBER_ROLE_PRESENTER] = 3,
                                 [WIRE_MEMBER_ROLE_PLANNER] = 4 };
    return ranks[role];
}

bool named_is_id(const char *text)
{
    const size_t n = text ? strlen(text) : 0;
    const bool is_group = n && text[0] == '@';
    bool is_right = is_group ? n >= 2 && n <= IDENTITY_MAX_USER + 1 : n >= 1 && n <= IDENTITY_MAX_USER;
    for (size_t i = is_group; is_right && i < n; i++)
        is_right = (unsigned char)text[i] > 32 && text[i] != 127 && text[i] != '@';
    return is_right;
}

bool named_is(const char *who, const struct identity *identity)
{
    if (who[0] != '@')
        return strcmp(who, identity->user) == 0;
    for (size_t i = 0; i < identity->n_groups; i++)
        if (strcmp(who + 1, identity->groups[i]) == 0)
            return true;
    return false;
}

const struct named *named_find(const struct named *list, size_t n, const struct identity *identity)
{
    const struct named *found = NULL;
    for (size_t i = 0; i < n; i++) {
        if (!named_is(list[i].who, identity))
            continue;
        if (list[i].who[0] != '@')
            return &list[i];
        if (!found || !list[i].has_role || (found->has_role && role_rank(list[i].role) > role_rank(found->role)))
            found = &list[i];
    }
    return found;
}

cJSON *named_list(const struct named *list, size_t n)
{
    cJSON *json = cJSON_CreateArray();
    for (size_t i = 0; i < n; i++) {
        cJSON *row = cJSON_CreateObject();
        cJSON_AddStringToObject(row, "who", list[i].who);
        if (list[i].has_role)
            cJSON_AddStringToObject(row, "role", wire_member_role_words.words[list[i].role]);
        json_append(json, row);
    }
    return json;
}
