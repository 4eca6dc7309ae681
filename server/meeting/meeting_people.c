/* The people of a meeting, and its links: meeting.h. */
#include <stdio.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/meeting/meeting.h"
#include "server/wire/random.h"

bool meeting_is_barred(const struct meeting *meeting, const char *user)
{
    for (size_t i = 0; user[0] && i < meeting->n_barred; i++)
        if (strcmp(meeting->barred[i], user) == 0)
            return true;
    return false;
}

static bool is_owner(const struct meeting *meeting, const struct identity *who)
{
    return who->user[0] && strcmp(meeting->owner, who->user) == 0;
}

bool meeting_names(const struct meeting *meeting, const struct identity *who)
{
    return is_owner(meeting, who) || (who->user[0] && !meeting_is_barred(meeting, who->user) &&
                                      named_find(meeting->people, meeting->n_people, who));
}

bool meeting_allows(const struct meeting *meeting, const struct identity *who, enum wire_member_role *role)
{
    *role = WIRE_MEMBER_ROLE_PLANNER;
    if (!who->user[0] || is_owner(meeting, who))
        return who->user[0] != 0;
    if (meeting_is_barred(meeting, who->user))
        return false;
    const struct named *person = named_find(meeting->people, meeting->n_people, who);
    if (person && person->has_role)
        *role = person->role;
    for (size_t i = 0; !person && i < meeting->n_came; i++)
        if (strcmp(meeting->came[i], who->user) == 0)
            return true;
    return person != NULL;
}

void meeting_came(struct meeting *meeting, const char *user)
{
    if (!user[0] || meeting->n_came == MEETING_MAX_CAME)
        return;
    for (size_t i = 0; i < meeting->n_came; i++)
        if (strcmp(meeting->came[i], user) == 0)
            return;
    mem_put_text(meeting->came[meeting->n_came++], STORE_USER, user);
}

void meeting_bar(struct meeting *meeting, const char *user, const char *link)
{
    for (size_t i = meeting->n_people; user[0] && i-- > 0;)
        if (strcmp(meeting->people[i].who, user) == 0)
            meeting->people[i] = meeting->people[--meeting->n_people];
    for (size_t i = meeting->n_came; user[0] && i-- > 0;)
        if (strcmp(meeting->came[i], user) == 0)
            memmove(meeting->came[i], meeting->came[--meeting->n_came], STORE_USER);
    if (user[0] && !meeting_is_barred(meeting, user)) {
        if (meeting->n_barred == MEETING_MAX_BARRED)
            memmove(meeting->barred[0], meeting->barred[1], sizeof meeting->barred[0] * --meeting->n_barred);
        mem_put_text(meeting->barred[meeting->n_barred++], STORE_USER, user);
    }
    struct meeting_link *found = meeting_link_find(meeting, link);
    if (found && !user[0]) /* who has not signed in can be another person each time */
        found->is_ended = true;
}

/* ---- documents -------------------------------------------------------------------------------------------------- */

static bool refuse_people(struct problem *problem, size_t index, const char *code, const char *words)
{
    char where[40];
    (void)snprintf(where, sizeof where, "/people/%zu", index);
    return problem_set(problem, PROBLEM_VALIDATION, where, code, "%s", words);
}

static bool read_role(const char *word, enum wire_member_role *role)
{
    for (size_t i = 0; word && i < wire_member_role_words.n; i++)
        if (strcmp(word, wire_member_role_words.words[i]) == 0) {
            *role = (enum wire_member_role)i;
            return true;
        }
    return false;
}

static bool read_person(const cJSON *row, size_t index, struct named *person, struct problem *problem)
{
    const cJSON *item;
    const char *who = json_text(row, "who");
    if (!cJSON_IsObject(row))
        return refuse_people(problem, index, "type", "an entry of people must be an object");
    cJSON_ArrayForEach(item,
                       row) if (strcmp(item->string, "who") != 0 &&
                                strcmp(item->string, "role") !=
                                    0) return refuse_people(problem, index, "unknown-field",
                                                            "an entry of people has the fields who and role alone");
    if (!named_is_id(who))
        return refuse_people(problem, index, "pattern",
                             "who may come? give the id of a user, or @ and the id of a group");
    *person = (struct named){ .has_role = cJSON_HasObjectItem(row, "role") };
    mem_put_text(person->who, sizeof person->who, who);
    if (person->has_role &&
        (!read_role(json_text(row, "role"), &person->role) || person->role == WIRE_MEMBER_ROLE_WALL))
        return refuse_people(problem, index, "enum", "role must be observer, reviewer, presenter or planner");
    return true;
}

bool meeting_set_people(struct meeting *meeting, const cJSON *list, struct problem *problem)
{
    const cJSON *row;
    struct named people[MEETING_MAX_PEOPLE];
    size_t n = 0;
    if (!cJSON_IsArray(list))
        return problem_set(problem, PROBLEM_VALIDATION, "/people", "type", "people must be a list");
    if (cJSON_GetArraySize(list) > MEETING_MAX_PEOPLE)
        return problem_set(problem, PROBLEM_LIMIT, "/people", "", "%d people and groups, at most %d are allowed",
                           cJSON_GetArraySize(list), MEETING_MAX_PEOPLE);
    cJSON_ArrayForEach(row, list)
    {
        if (!read_person(row, n, &people[n], problem))
            return false;
        n++;
    }
    memcpy(meeting->people, people, n * sizeof people[0]);
    meeting->n_people = n;
    for (size_t i = meeting->n_barred; i-- > 0;) /* whoever is named anew was asked in again */
        for (size_t k = 0; k < n; k++)
            if (strcmp(people[k].who, meeting->barred[i]) == 0) {
                memmove(meeting->barred[i], meeting->barred[--meeting->n_barred], STORE_USER);
                break;
            }
    return true;
}

cJSON *meeting_people(const struct meeting *meeting)
{
    return named_list(meeting->people, meeting->n_people);
}

/* Characters of UTF-8. */
static size_t n_characters(const char *text)
{
    size_t n = 0;
    for (; *text; text++)
        n += ((unsigned char)*text & 0xc0) != 0x80;
    return n;
}

bool meeting_set_name(struct meeting *meeting, const cJSON *name, struct problem *problem)
{
    const char *text = cJSON_GetStringValue(name);
    bool is_blank = true;
    for (const char *at = text; at && *at; at++) {
        if ((unsigned char)*at < 32 || *at == 127)
            return problem_set(problem, PROBLEM_VALIDATION, "/name", "pattern",
                               "name must not have control characters");
        is_blank = is_blank && *at == ' ';
    }
    if (!text || is_blank || n_characters(text) > MEETING_MAX_NAME)
        return problem_set(problem, PROBLEM_VALIDATION, "/name", text ? "range" : "type",
                           "name must be a text of 1 to %d characters", MEETING_MAX_NAME);
    (void)snprintf(meeting->name, sizeof meeting->name, "%s", text);
    return true;
}

/* ---- links ------------------------------------------------------------------------------------------------------ */

bool meeting_add_link(struct meeting *meeting, const struct meeting_link *wanted, char token[MEETING_TOKEN],
                      struct problem *problem)
{
    if (meeting->n_links == MEETING_MAX_LINKS)
        return problem_set(problem, PROBLEM_LIMIT, "", "", "%d links of this meeting were made, more are not allowed",
                           MEETING_MAX_LINKS);
    random_hex(token, (MEETING_TOKEN - 1) / 2);
    struct meeting_link *link = &meeting->links[meeting->n_links++];
    *link = *wanted;
    secret_hash(token, link->token_hash);
    return true;
}

const struct meeting_link *meeting_link_of(const struct meeting *meeting, const char *token, int64_t now_ms)
{
    const struct meeting_link *found = NULL;
    for (size_t i = 0; i < meeting->n_links; i++) /* all of them, whichever it is */
        if (secret_matches(token, meeting->links[i].token_hash))
            found = &meeting->links[i];
    return found && !found->is_ended && now_ms < found->expires_ms ? found : NULL;
}

void meeting_link_digits(const struct meeting_link *link, char digits[9])
{
    const unsigned char *hash = link->token_hash;
    (void)snprintf(digits, 9, "%02x%02x%02x%02x", hash[0], hash[1], hash[2], hash[3]);
}

struct meeting_link *meeting_link_find(struct meeting *meeting, const char *digits)
{
    for (size_t i = 0; digits[0] && i < meeting->n_links; i++) {
        char found[9];
        meeting_link_digits(&meeting->links[i], found);
        if (strcmp(found, digits) == 0)
            return &meeting->links[i];
    }
    return NULL;
}
