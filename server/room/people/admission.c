/* Decides who enters: admission.h. */
#include "server/room/people/admission.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/room/people/known.h"
#include "server/room/people/room_people.h"
#include "server/room/state/body_check.h"
#include "server/room/state/event.h"
#include "server/room/state/roles.h"
#include "server/room/state/who.h"

enum { MAX_DIGITS = 9 };

static const char is_closed[] = ROOM_IS_CLOSED, needs_sign_in[] = ROOM_NEEDS_SIGN_IN;
static const char was_removed[] = "you were removed from this room: ask to be let in again";

struct removed { /* not let in again by these links, or without one */
    char key[WHO_KEY], name[161];
    char links[ROOM_MAX_LINKS][MAX_DIGITS]; /* the valid ones of then */
    int n_links;
};

struct admission {
    char owner[STORE_USER]; /* "": made without sign-in */
    bool is_open;           /* whoever has a role on the plan may come in */
    bool is_kept;           /* there is something of it on disk, perhaps */
    struct named *people;
    size_t n;
    struct removed *removed; /* the first first; room for ROOM_MAX_REMOVED. NULL: nobody was */
    int n_removed;
};

void admission_init(struct room *room)
{
    room->admission = mem_new(sizeof *room->admission);
}

void admission_free(struct room *room)
{
    free(room->admission->people);
    free(room->admission->removed);
    free(room->admission);
}

void room_set_owner(struct room *room, const char *user)
{
    (void)snprintf(room->admission->owner, sizeof room->admission->owner, "%s", user);
    room_event(room, ROOM_PEOPLE, NULL);
}

const char *room_owner(const struct room *room)
{
    return room->admission->owner;
}

/* ---- without a link --------------------------------------------------------------------------------------------- */

/* Whether the meeting that the room is a case of lets this user in. */
static bool is_asked_to_meeting(const struct room *room, const struct identity *who, enum wire_member_role *role)
{
    const struct room_meeting_callbacks *meeting = room->callbacks.meeting;
    enum wire_member_role most;
    if (!meeting || !meeting->role(room->callbacks.context, room, who, &most))
        return false;
    *role = role_lower(*role, most);
    return true;
}

/* Like admission_role, and true of who was removed. */
static bool has_own_right(const struct room *room, const struct identity *who, enum wire_member_role *role)
{
    const struct admission *admission = room->admission;
    if (!who_is_user(who) || !room->callbacks.role_of ||
        !room->callbacks.role_of(room->callbacks.context, room, who, role))
        return false;
    if (strcmp(admission->owner, who->user) == 0)
        return true;
    const struct named *person = named_find(admission->people, admission->n, who);
    if (person && person->has_role)
        *role = role_lower(*role, person->role);
    /* a room of before there was sign-in is nobody's */
    return person || admission->is_open || is_asked_to_meeting(room, who, role) ||
           (!admission->owner[0] && *role == WIRE_MEMBER_ROLE_PLANNER);
}

/* ---- removed ---------------------------------------------------------------------------------------------------- */

static int find_removed(const struct admission *admission, const char *key)
{
    int i = 0;
    while (i < admission->n_removed && (!key[0] || strcmp(admission->removed[i].key, key) != 0))
        i++;
    return i < admission->n_removed ? i : -1;
}

bool admission_role(const struct room *room, const struct identity *who, enum wire_member_role *role)
{
    char key[WHO_KEY];
    who_key(who, "", key);
    return has_own_right(room, who, role) && find_removed(room->admission, key) < 0;
}

static void let_in_again(struct room *room, int index)
{
    struct admission *admission = room->admission;
    admission->n_removed--;
    memmove(&admission->removed[index], &admission->removed[index + 1],
            (size_t)(admission->n_removed - index) * sizeof admission->removed[0]);
    room_event(room, ROOM_PEOPLE, NULL);
}

/* link NULL: without one. Who comes by a link that was made later was asked in again. */
static bool refuses(struct room *room, const char *key, const struct link *link)
{
    const int index = find_removed(room->admission, key);
    if (index < 0)
        return false;
    const struct removed *removed = &room->admission->removed[index];
    char digits[MAX_DIGITS];
    bool is_old = !link || link->is_of_meeting; /* which stands as long as the meeting */
    if (link)
        link_digits(link, digits);
    for (int i = 0; link && i < removed->n_links; i++)
        is_old = is_old || strcmp(removed->links[i], digits) == 0;
    if (!is_old)
        let_in_again(room, index);
    return is_old;
}

static struct removed *add_removed(struct room *room, const char *key)
{
    struct admission *admission = room->admission;
    const int before = find_removed(admission, key);
    if (before >= 0)
        let_in_again(room, before);
    if (!admission->removed)
        admission->removed = mem_array(ROOM_MAX_REMOVED, sizeof admission->removed[0], 1 << 20, NULL);
    if (!admission->removed) {
        log_error("room %s: no memory to remember who was removed", room->id);
        return NULL;
    }
    if (admission->n_removed == ROOM_MAX_REMOVED)
        let_in_again(room, 0);
    struct removed *removed = &admission->removed[admission->n_removed++];
    *removed = (struct removed){ .n_links = 0 };
    (void)snprintf(removed->key, sizeof removed->key, "%s", key);
    return removed;
}

/* Nobody comes in by this name any more, until it is added again. */
static void drop_person(struct admission *admission, const char *user)
{
    for (size_t i = admission->n; i-- > 0;)
        if (strcmp(admission->people[i].who, user) == 0) {
            admission->n--;
            memmove(&admission->people[i], &admission->people[i + 1], (admission->n - i) * sizeof admission->people[0]);
        }
}

void admission_ban(struct room *room, const struct member *member)
{
    room_event(room, ROOM_PEOPLE, NULL);
    if (room->callbacks.meeting)
        room->callbacks.meeting->barred(room->callbacks.context, room, member->user, member->link);
    if (member->user[0])
        drop_person(room->admission, member->user);
    else if (member->link[0]) /* who has not signed in can be another person each time */
        (void)link_end(room, member->link);
    struct removed *removed = member->person[0] ? add_removed(room, member->person) : NULL;
    if (!removed)
        return;
    (void)snprintf(removed->name, sizeof removed->name, "%s", member->name);
    removed->n_links = links_all_digits(room, removed->links);
}

/* ---- entering --------------------------------------------------------------------------------------------------- */

static struct admitted refuse(struct admitted in, const char *code, const char *refusal)
{
    in.code = code;
    (void)snprintf(in.refusal, sizeof in.refusal, "%s", refusal);
    return in;
}

static bool admits_guest(const struct room *room, const struct link *link)
{
    return link->role == WIRE_MEMBER_ROLE_WALL || (room->admits_guests && link->allows_guests);
}

static struct admitted by_link(struct room *room, const struct identity *who, const char *token, struct admitted in)
{
    const bool is_machine = who_is_machine(who);
    const char *refusal = link_find(room, who, token, in.key, &in.link);
    if (refusal) {
        in.link = NULL;
        return refuse(in, "", refusal == link_is_unknown && !is_machine ? is_closed : refusal);
    }
    in.role = in.link->role;
    if (!is_machine && !who_is_user(who)) {
        if (!admits_guest(room, in.link))
            return refuse(in, "sign-in", needs_sign_in);
        in.is_guest = in.role != WIRE_MEMBER_ROLE_WALL;
        if (in.is_guest)
            in.role = role_lower(in.role, WIRE_MEMBER_ROLE_REVIEWER);
    }
    return refuses(room, in.key, in.link) ? refuse(in, "removed", was_removed) : in;
}

static struct admitted by_seat(const struct room *room, const struct identity *who, const struct member *seat,
                               struct admitted in)
{
    const struct room_meeting_callbacks *meeting = room->callbacks.meeting;
    in.role = seat->role;
    in.is_guest = seat->is_guest && !who_is_user(who);
    if (seat->link[0] && meeting && meeting->link_is_over(room->callbacks.context, room, seat->link))
        return refuse(in, "", is_closed);
    if (who_is_machine(who) || (seat->link[0] && who_is_user(who)) || seat->role == WIRE_MEMBER_ROLE_WALL)
        return in;
    if (!who_is_user(who))
        return room->admits_guests ? in : refuse(in, "sign-in", needs_sign_in);
    return admission_role(room, who, &in.role) ? in : refuse(in, "", is_closed);
}

static struct admitted decide(struct room *room, const struct identity *who, const struct message_hello *hello,
                              const struct member *seat)
{
    struct admitted in = { .role = role_of_newcomer(room), .code = "" };
    who_key(who, hello->person, in.key);
    if (seat)
        return by_seat(room, who, seat, in);
    if (hello->link[0])
        return by_link(room, who, hello->link, in);
    if (!who_is_machine(who) && !who_is_user(who))
        return refuse(in, "sign-in", needs_sign_in);
    if (!who_is_machine(who) && !has_own_right(room, who, &in.role))
        return refuse(in, "", is_closed);
    return refuses(room, in.key, NULL) ? refuse(in, "removed", was_removed) : in;
}

struct admitted admission_decide(struct room *room, const struct identity *who, const struct message_hello *hello,
                                 const struct member *seat)
{
    struct admitted in = decide(room, who, hello, seat);
    if (hello->wall) {
        in.role = WIRE_MEMBER_ROLE_WALL;
        in.is_guest = false;
    }
    in.role = who_holds(who, in.role);
    return in;
}

/* ---- documents -------------------------------------------------------------------------------------------------- */

cJSON *admission_document(const struct room *room)
{
    static const char user[] = "user:";
    const struct admission *admission = room->admission;
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "owner", admission->owner);
    cJSON_AddBoolToObject(json, "is_open", admission->is_open);
    json_add(json, "people", named_list(admission->people, admission->n));
    cJSON *list = cJSON_CreateArray();
    for (int i = 0; i < admission->n_removed; i++) {
        const struct removed *removed = &admission->removed[i];
        const bool is_user = strncmp(removed->key, user, sizeof user - 1) == 0;
        cJSON *row = cJSON_CreateObject();
        cJSON_AddStringToObject(row, "user", is_user ? removed->key + sizeof user - 1 : "");
        cJSON_AddStringToObject(row, "name", removed->name);
        json_append(list, row);
    }
    json_add(json, "removed", list);
    return json;
}

static bool read_person(const cJSON *row, size_t index, struct named *person, struct problem *problem)
{
    static const char *const names[] = { "who", "role", NULL };
    char where[40];
    (void)snprintf(where, sizeof where, "/people/%zu", index);
    if (!cJSON_IsObject(row))
        return body_refuse_type(problem, where, "an object");
    if (!body_names_are(row, names, where, problem))
        return false;
    const char *who = json_text(row, "who"), *role = json_text(row, "role");
    if (!named_is_id(who))
        return problem_set(problem, PROBLEM_VALIDATION, where, "pattern",
                           "who may come in? give the id of a user, or @ and the id of a group");
    (void)snprintf(person->who, sizeof person->who, "%s", who);
    person->has_role = cJSON_HasObjectItem(row, "role");
    if (person->has_role && (!role_of_word(role, &person->role) || person->role == WIRE_MEMBER_ROLE_WALL))
        return problem_set(problem, PROBLEM_VALIDATION, where, "enum",
                           "role must be observer, reviewer, presenter or planner");
    return true;
}

/* The list, for free(); NULL with problem. */
static struct named *read_people(const cJSON *list, size_t *n, struct problem *problem)
{
    const cJSON *row;
    const int count = cJSON_GetArraySize(list);
    *n = 0;
    if (!cJSON_IsArray(list)) {
        (void)body_refuse_type(problem, "/people", "a list");
        return NULL;
    }
    if (count > ROOM_MAX_PEOPLE) {
        problem_set(problem, PROBLEM_LIMIT, "/people", "", "%d people and groups, at most %d are allowed", count,
                    ROOM_MAX_PEOPLE);
        return NULL;
    }
    struct named *people = mem_array((size_t)count + 1, sizeof *people, 1 << 20, NULL);
    if (!people) {
        (void)json_no_memory(problem, "the people of the room");
        return NULL;
    }
    cJSON_ArrayForEach(row, list)
    {
        if (!read_person(row, *n, &people[*n], problem)) {
            free(people);
            return NULL;
        }
        (*n)++;
    }
    return people;
}

static bool check_roles(const struct named *people, size_t n, enum wire_member_role most, struct problem *problem)
{
    for (size_t i = 0; i < n; i++)
        if (people[i].has_role && role_rank(people[i].role) > role_rank(most))
            return problem_set(problem, PROBLEM_FORBIDDEN, "/people", "role",
                               "a %s gives no role above it: %s of %s is", wire_member_role_words.words[most],
                               wire_member_role_words.words[people[i].role], people[i].who);
    return true;
}

bool admission_patch(struct room *room, const cJSON *patch, enum wire_member_role most, struct problem *problem)
{
    static const char *const names[] = { "is_open", "people", NULL };
    struct admission *admission = room->admission;
    const cJSON *is_open = cJSON_GetObjectItemCaseSensitive(patch, "is_open"),
                *list = cJSON_GetObjectItemCaseSensitive(patch, "people");
    size_t n = 0;
    if (!body_names_are(patch, names, "", problem))
        return false;
    if (is_open && !cJSON_IsBool(is_open))
        return body_refuse_type(problem, "/is_open", "true or false");
    struct named *people = list ? read_people(list, &n, problem) : NULL;
    if ((list && !people) || !check_roles(people, n, most, problem)) {
        free(people);
        return false;
    }
    for (size_t i = 0; i < n; i++) {
        char key[WHO_KEY];
        who_key_of_user(people[i].who, key);
        const int index = find_removed(admission, key);
        if (index >= 0)
            let_in_again(room, index);
    }
    if (people) {
        free(admission->people);
        admission->people = people;
        admission->n = n;
    }
    if (is_open)
        admission->is_open = cJSON_IsTrue(is_open);
    room->shared.is_changed = true;
    room_event(room, ROOM_PEOPLE, NULL);
    return true;
}

/* ---- on disk ---------------------------------------------------------------------------------------------------- */

static cJSON *write_removed(const struct admission *admission)
{
    cJSON *list = cJSON_CreateArray();
    for (int i = 0; i < admission->n_removed; i++) {
        const struct removed *removed = &admission->removed[i];
        cJSON *row = cJSON_CreateObject(), *links = cJSON_CreateArray();
        cJSON_AddStringToObject(row, "key", removed->key);
        cJSON_AddStringToObject(row, "name", removed->name);
        for (int k = 0; k < removed->n_links; k++)
            json_append(links, cJSON_CreateString(removed->links[k]));
        json_add(row, "links", links);
        json_append(list, row);
    }
    return list;
}

/* The users who have a seat by a link, for lists of rooms. */
static cJSON *write_users(const struct room *room)
{
    cJSON *list = cJSON_CreateArray();
    for (int i = 0; i < room->members.n; i++)
        if (room->members.list[i]->user[0] && room->members.list[i]->link[0])
            json_append(list, cJSON_CreateString(room->members.list[i]->user));
    for (int i = 0; i < room->known->n; i++)
        if (room->known->list[i].user[0] && room->known->list[i].link[0])
            json_append(list, cJSON_CreateString(room->known->list[i].user));
    return list;
}

void admission_facts(const struct room *room, struct store_room *kept)
{
    kept->is_open = room->admission->is_open;
    (void)snprintf(kept->owner, sizeof kept->owner, "%s", room->admission->owner);
}

bool admission_write(const struct room *room, struct store_room *kept)
{
    struct admission *admission = room->admission;
    cJSON *users = write_users(room);
    const bool has_any = admission->is_kept || admission->n || admission->n_removed || (users && users->child);
    if (!has_any) { /* as on disk: nothing */
        cJSON_Delete(users);
        return true;
    }
    cJSON *json = cJSON_CreateObject();
    json_add(json, "people", named_list(admission->people, admission->n));
    json_add(json, "removed", write_removed(admission));
    json_add(json, "users", users);
    kept->people = json_print(json);
    cJSON_Delete(json);
    admission->is_kept = true;
    return kept->people != NULL;
}

static void read_removed(struct room *room, const cJSON *row)
{
    const char *key = json_text(row, "key"), *name = json_text(row, "name");
    struct removed *removed = key && strlen(key) < WHO_KEY ? add_removed(room, key) : NULL;
    const cJSON *link;
    if (!removed)
        return;
    (void)snprintf(removed->name, sizeof removed->name, "%.160s", name ? name : "");
    cJSON_ArrayForEach(link, cJSON_GetObjectItemCaseSensitive(row, "links"))
    {
        if (cJSON_IsString(link) && removed->n_links < ROOM_MAX_LINKS)
            (void)snprintf(removed->links[removed->n_links++], MAX_DIGITS, "%.8s", link->valuestring);
    }
}

void admission_read(struct room *room, const struct store_room *kept)
{
    struct problem problem = { 0 };
    cJSON *json = kept->people ? json_read(kept->people, strlen(kept->people), &problem) : NULL;
    const cJSON *row, *list = cJSON_GetObjectItemCaseSensitive(json, "people");
    struct admission *admission = room->admission;
    (void)snprintf(admission->owner, sizeof admission->owner, "%s", kept->owner);
    admission->is_open = kept->is_open;
    admission->is_kept = kept->people != NULL;
    if (kept->people && !json)
        log_error("room %s: who may come in is not readable in the database: %s", room->id, problem.detail);
    struct named *people = list ? read_people(list, &admission->n, &problem) : NULL;
    if (list && !people)
        log_error("room %s: who may come in is left out: %s", room->id, problem.detail);
    free(admission->people);
    admission->people = people;
    cJSON_ArrayForEach(row, cJSON_GetObjectItemCaseSensitive(json, "removed")) read_removed(room, row);
    cJSON_Delete(json);
}

bool room_people_name(const char *owner, const char *people, const struct identity *who, bool has_role)
{
    char quoted[STORE_USER + 4];
    bool is_there = has_role && owner[0] && strcmp(owner, who->user) == 0, may_be_there = false;
    if (is_there || !people)
        return is_there;
    (void)snprintf(quoted, sizeof quoted, "\"%s\"", who->user);
    may_be_there = strstr(people, quoted) != NULL;
    for (size_t i = 0; i < who->n_groups && !may_be_there; i++) {
        (void)snprintf(quoted, sizeof quoted, "\"@%s\"", who->groups[i]);
        may_be_there = strstr(people, quoted) != NULL;
    }
    cJSON *json =
        may_be_there ? json_read(people, strlen(people), NULL) : NULL; /* of few rooms alone: there are many */
    const cJSON *row;
    cJSON_ArrayForEach(row, cJSON_GetObjectItemCaseSensitive(json, "people"))
    {
        const char *named = json_text(row, "who");
        is_there = is_there || (has_role && named && named_is(named, who));
    }
    cJSON_ArrayForEach(row, cJSON_GetObjectItemCaseSensitive(json, "users")) is_there =
        is_there || (!who->folders[0] && cJSON_IsString(row) && strcmp(row->valuestring, who->user) == 0);
    cJSON_Delete(json);
    return is_there;
}
