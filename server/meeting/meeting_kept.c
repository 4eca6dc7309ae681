/* Meetings to rows and back: meeting.h. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/meeting/meeting.h"

static const double latest_ms = 9e15;

/* ---- writing ---------------------------------------------------------------------------------------------------- */

static void add_ms(cJSON *json, const char *name, int64_t ms)
{
    if (ms)
        cJSON_AddNumberToObject(json, name, (double)ms);
}

static void add_text(cJSON *json, const char *name, const char *text)
{
    if (text[0])
        cJSON_AddStringToObject(json, name, text);
}

static cJSON *write_links(const struct meeting *meeting)
{
    cJSON *list = cJSON_CreateArray();
    for (size_t i = 0; i < meeting->n_links; i++) {
        const struct meeting_link *link = &meeting->links[i];
        char hash[2 * SECRET_HASH_BYTES + 1];
        for (size_t k = 0; k < SECRET_HASH_BYTES; k++)
            (void)snprintf(hash + 2 * k, 3, "%02x", link->token_hash[k]);
        cJSON *row = cJSON_CreateObject();
        cJSON_AddStringToObject(row, "hash", hash);
        cJSON_AddStringToObject(row, "role", wire_member_role_words.words[link->role]);
        cJSON_AddBoolToObject(row, "guests", link->allows_guests);
        cJSON_AddBoolToObject(row, "ended", link->is_ended);
        add_ms(row, "expires_ms", link->expires_ms);
        add_text(row, "maker", link->maker);
        add_text(row, "name", link->name);
        json_append(list, row);
    }
    return list;
}

static char *write_body(const struct meeting *meeting)
{
    cJSON *json = cJSON_CreateObject(), *came = cJSON_CreateArray(), *barred = cJSON_CreateArray();
    cJSON_AddStringToObject(json, "name", meeting->name);
    add_ms(json, "created_ms", meeting->created_ms);
    add_ms(json, "starts_ms", meeting->starts_ms);
    add_ms(json, "ended_ms", meeting->ended_ms);
    add_ms(json, "since_ms", meeting->since_ms);
    cJSON_AddNumberToObject(json, "n_made", meeting->n_made);
    add_text(json, "now", meeting->now);
    json_add(json, "people", meeting_people(meeting));
    json_add(json, "links", write_links(meeting));
    for (size_t i = 0; i < meeting->n_came; i++)
        json_append(came, cJSON_CreateString(meeting->came[i]));
    json_add(json, "came", came);
    for (size_t i = 0; i < meeting->n_barred; i++)
        json_append(barred, cJSON_CreateString(meeting->barred[i]));
    json_add(json, "barred", barred);
    char *text = json_print(json);
    cJSON_Delete(json);
    return text;
}

static char *write_case(const struct meeting_case *one)
{
    cJSON *json = cJSON_CreateObject(), *visits = cJSON_CreateArray();
    cJSON_AddStringToObject(json, "cap", wire_member_role_words.words[one->cap]);
    for (size_t i = 0; i < one->n_visits; i++) {
        cJSON *visit = cJSON_CreateArray();
        json_append(visit, cJSON_CreateNumber((double)one->visits[i].from_ms));
        json_append(visit, cJSON_CreateNumber((double)one->visits[i].to_ms));
        json_append(visits, visit);
    }
    json_add(json, "visits", visits);
    add_text(json, "decision", one->decision);
    add_text(json, "decided_by", one->decided_by);
    add_ms(json, "decided_ms", one->decided_ms);
    if (one->stays)
        json_add(json, "stays", cJSON_Duplicate(one->stays, true));
    char *text = json_print(json);
    cJSON_Delete(json);
    return text;
}

struct store_meeting *meeting_write(const struct meeting *meeting)
{
    struct store_meeting *row = mem_new(sizeof *row);
    mem_put_text(row->id, sizeof row->id, meeting->id);
    mem_put_text(row->owner, sizeof row->owner, meeting->owner);
    row->body = write_body(meeting);
    row->cases = mem_array(meeting->n_cases + 1, sizeof row->cases[0], 1 << 20, NULL);
    bool ok = row->body && row->cases;
    for (size_t i = 0; ok && i < meeting->n_cases; i++) {
        const struct meeting_case *one = meeting->cases[i];
        struct store_meeting_case *to = &row->cases[row->n_cases++];
        *to = (struct store_meeting_case){ .body = write_case(one) };
        mem_put_text(to->id, sizeof to->id, one->id);
        mem_put_text(to->plan, sizeof to->plan, one->plan);
        mem_put_text(to->room, sizeof to->room, one->room);
        ok = to->body != NULL;
    }
    if (ok)
        return row;
    store_meeting_free(row);
    return NULL;
}

/* ---- reading ---------------------------------------------------------------------------------------------------- */

static int64_t read_ms(const cJSON *json, const char *name)
{
    const double ms = json_number(json, name, 0);
    return ms > 0 && ms < latest_ms ? (int64_t)ms : 0;
}

static bool read_role(const cJSON *json, const char *name, enum wire_member_role *role)
{
    const char *word = json_text(json, name);
    for (size_t i = 0; word && i < wire_member_role_words.n; i++)
        if (strcmp(word, wire_member_role_words.words[i]) == 0) {
            *role = (enum wire_member_role)i;
            return true;
        }
    return false;
}

static bool read_hash(const char *text, unsigned char hash[SECRET_HASH_BYTES])
{
    if (!text || strlen(text) != 2 * (size_t)SECRET_HASH_BYTES ||
        strspn(text, "0123456789abcdef") != 2 * (size_t)SECRET_HASH_BYTES)
        return false;
    for (size_t i = 0; i < SECRET_HASH_BYTES; i++) {
        const char pair[3] = { text[2 * i], text[2 * i + 1], 0 };
        hash[i] = (unsigned char)strtoul(pair, NULL, 16);
    }
    return true;
}

static void read_links(struct meeting *meeting, const cJSON *list)
{
    const cJSON *row;
    cJSON_ArrayForEach(row, list)
    {
        struct meeting_link link = { .expires_ms = read_ms(row, "expires_ms") };
        if (meeting->n_links == MEETING_MAX_LINKS || !read_hash(json_text(row, "hash"), link.token_hash) ||
            !read_role(row, "role", &link.role))
            continue;
        link.allows_guests = cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(row, "guests"));
        link.is_ended = cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(row, "ended"));
        json_put_text(link.maker, sizeof link.maker, row, "maker");
        json_put_text(link.name, sizeof link.name, row, "name");
        meeting->links[meeting->n_links++] = link;
    }
}

static bool read_body(struct meeting *meeting, const char *text)
{
    struct problem problem = { 0 };
    const cJSON *row;
    cJSON *json = json_read(text, strlen(text), &problem);
    if (!cJSON_IsObject(json)) {
        cJSON_Delete(json);
        return false;
    }
    json_put_text(meeting->name, sizeof meeting->name, json, "name");
    json_put_text(meeting->now, sizeof meeting->now, json, "now");
    meeting->created_ms = read_ms(json, "created_ms");
    meeting->starts_ms = read_ms(json, "starts_ms");
    meeting->ended_ms = read_ms(json, "ended_ms");
    meeting->since_ms = read_ms(json, "since_ms");
    const double n_made = json_number(json, "n_made", 0);
    meeting->n_made = n_made > 0 && n_made < 1e9 ? (uint32_t)n_made : 0;
    if (!meeting_set_people(meeting, cJSON_GetObjectItemCaseSensitive(json, "people"), &problem))
        meeting->n_people = 0;
    read_links(meeting, cJSON_GetObjectItemCaseSensitive(json, "links"));
    cJSON_ArrayForEach(row, cJSON_GetObjectItemCaseSensitive(json, "came"))
    {
        if (cJSON_IsString(row))
            meeting_came(meeting, row->valuestring);
    }
    cJSON_ArrayForEach(row, cJSON_GetObjectItemCaseSensitive(json, "barred"))
    {
        if (cJSON_IsString(row) && row->valuestring[0])
            meeting_bar(meeting, row->valuestring, "");
    }
    cJSON_Delete(json);
    return true;
}

static void read_visits(struct meeting_case *one, const cJSON *list)
{
    const cJSON *row;
    cJSON_ArrayForEach(row, list)
    {
        const cJSON *from = cJSON_GetArrayItem(row, 0), *to = cJSON_GetArrayItem(row, 1);
        if (one->n_visits < MEETING_MAX_VISITS && cJSON_IsNumber(from) && cJSON_IsNumber(to) &&
            from->valuedouble >= 0 && to->valuedouble >= from->valuedouble && to->valuedouble < latest_ms)
            one->visits[one->n_visits++] =
                (struct meeting_visit){ (int64_t)from->valuedouble, (int64_t)to->valuedouble };
    }
}

/* False: no memory. A row that is no good is left out. */
static bool read_case(struct meeting *meeting, const struct store_meeting_case *row)
{
    struct problem problem = { 0 };
    cJSON *json = row->body ? json_read(row->body, strlen(row->body), &problem) : NULL;
    if (!json && problem.type == PROBLEM_INTERNAL) /* else its time and decision would be lost with the next write */
        return false;
    if (!id_is_valid(row->id) || strlen(row->id) >= MEETING_ID || (row->plan[0] && !id_is_valid(row->plan)) ||
        (row->room[0] && !id_is_valid(row->room)) || meeting->n_cases == MEETING_MAX_CASES ||
        meeting_find(meeting, row->id)) {
        cJSON_Delete(json);
        return true;
    }
    struct meeting_case *one = mem_new(sizeof *one);
    mem_put_text(one->id, sizeof one->id, row->id);
    mem_put_text(one->plan, sizeof one->plan, row->plan);
    mem_put_text(one->room, sizeof one->room, row->room);
    one->cap = WIRE_MEMBER_ROLE_OBSERVER;
    (void)read_role(json, "cap", &one->cap);
    read_visits(one, cJSON_GetObjectItemCaseSensitive(json, "visits"));
    json_put_text(one->decision, sizeof one->decision, json, "decision");
    json_put_text(one->decided_by, sizeof one->decided_by, json, "decided_by");
    one->decided_ms = read_ms(json, "decided_ms");
    cJSON *stays = cJSON_DetachItemFromObjectCaseSensitive(json, "stays");
    one->stays = cJSON_IsArray(stays) ? stays : NULL;
    if (!one->stays)
        cJSON_Delete(stays);
    meeting->cases[meeting->n_cases++] = one;
    cJSON_Delete(json);
    return true;
}

struct meeting *meeting_read(const struct store_meeting *row)
{
    if (!id_is_valid(row->id) || !row->body)
        return NULL;
    struct meeting *meeting = meeting_create(row->id, row->owner, 0);
    if (!read_body(meeting, row->body)) {
        meeting_free(meeting);
        return NULL;
    }
    for (size_t i = 0; i < row->n_cases; i++)
        if (!read_case(meeting, &row->cases[i])) {
            meeting_free(meeting);
            return NULL;
        }
    if (!meeting_find(meeting, meeting->now))
        meeting->now[0] = 0;
    return meeting;
}
