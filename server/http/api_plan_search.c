/* POST /plans/search: plans by what they and their rooms are called, page by page. What is looked for may name a
 * patient, so it stands in the body and in no address. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "server/auth/digest.h"
#include "server/http/api_access.h"
#include "server/http/api_audit.h"
#include "server/http/api_handlers.h"
#include "server/net/listed.h"

enum {
    MAX_TEXT = 200,
    MAX_FOLDER = 4096,
    LIMIT_BY_DEFAULT = 50,
    LIMIT_AT_MOST = 200,
    MAX_FOLDERS = 64,
    FOLDER_ID = 16, /* hex digits of the id of a folder */
    MAX_ROOMS = 10, /* of one plan in the answer */
    ROOM_DAYS = 30, /* a room that was used longer ago is not gone on with */
    MIN_ID = 6      /* letters of a whole id, of which the end is shown */
};

struct search {
    const char *text, *folder, *cursor, *sort, *kind;
    double limit;
};

struct found { /* a plan that the caller may look at */
    size_t index;
    char id[64], name[128], date[9];
    int rank; /* of its approval */
    int64_t used_ms;
    bool is_kind, is_in_folder, is_named;
};

struct room_found {
    size_t plan, index; /* of found, of the list of rooms */
    int64_t used_ms;
};

struct folder_found { /* in which plans lie */
    const char *path; /* borrowed from a plan, and not ended by 0 */
    size_t n_path;
    int n; /* plans */
};

struct finding {
    struct found *plans; /* by id, then as they are sorted */
    struct room_found *rooms;
    size_t n_plans, n_rooms, n_folders;
    struct folder_found folders[MAX_FOLDERS];
    int n_all, n_uploads, n_no_plans;
};

static bool read_text(const cJSON *item, const char *pointer, size_t max_bytes, const char **text,
                      struct problem *problem)
{
    if (!item)
        return true;
    if (!cJSON_IsString(item) || strlen(item->valuestring) > max_bytes)
        return problem_set(problem, PROBLEM_VALIDATION, pointer, "type", "%s must be a text of at most %zu bytes",
                           pointer, max_bytes);
    *text = item->valuestring;
    return true;
}

/* Reads one of these words. */
static bool read_word(const cJSON *item, const char *pointer, const char *const words[3], const char **text,
                      struct problem *problem)
{
    if (!read_text(item, pointer, 20, text, problem))
        return false;
    for (int i = 0; item && i < 3; i++)
        if (strcmp(*text, words[i]) == 0)
            return true;
    return !item || problem_set(problem, PROBLEM_VALIDATION, pointer, "enum", "%s must be %s, %s or %s", pointer,
                                words[0], words[1], words[2]);
}

/* The texts are borrowed from body. */
static bool read_search(const cJSON *body, struct search *search, struct problem *problem)
{
    static const char *const known[] = { "text", "folder", "cursor", "limit", "sort", "kind" };
    static const char *const sorts[] = { "used", "name", "approved" }, *const kinds[] = { "plan", "no-plan", "all" };
    const cJSON *item;
    *search =
        (struct search){ .text = "", .folder = "", .cursor = "", .sort = "", .kind = "all", .limit = LIMIT_BY_DEFAULT };
    cJSON_ArrayForEach(item, body)
    {
        char pointer[64];
        bool is_known = false;
        for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
            is_known = is_known || strcmp(item->string, known[i]) == 0;
        (void)snprintf(pointer, sizeof pointer, "/%.60s", item->string);
        if (!is_known)
            return problem_set(problem, PROBLEM_VALIDATION, pointer, "unknown-field", "%.60s is not a field of it",
                               item->string);
    }
    const cJSON *limit = cJSON_GetObjectItemCaseSensitive(body, "limit");
    if (limit && !(cJSON_IsNumber(limit) && limit->valuedouble >= 1 && limit->valuedouble <= LIMIT_AT_MOST))
        return problem_set(problem, PROBLEM_VALIDATION, "/limit", "range", "limit must be 1 to %d", LIMIT_AT_MOST);
    if (limit)
        search->limit = limit->valuedouble;
    return read_text(cJSON_GetObjectItemCaseSensitive(body, "text"), "/text", MAX_TEXT, &search->text, problem) &&
           read_text(cJSON_GetObjectItemCaseSensitive(body, "folder"), "/folder", MAX_FOLDER, &search->folder,
                     problem) &&
           read_text(cJSON_GetObjectItemCaseSensitive(body, "cursor"), "/cursor", 63, &search->cursor, problem) &&
           read_word(cJSON_GetObjectItemCaseSensitive(body, "sort"), "/sort", sorts, &search->sort, problem) &&
           read_word(cJSON_GetObjectItemCaseSensitive(body, "kind"), "/kind", kinds, &search->kind, problem);
}

/* ---- one plan --------------------------------------------------------------------------------------------------- */

/* Without regard to the case of letters of ASCII. */
static bool has_text(const char *in, const char *text)
{
    const size_t n = strlen(text);
    for (; n > 0 && in && *in && strncasecmp(in, text, n) != 0; in++)
        continue;
    return n == 0 || (in && *in);
}

/* Whether a whole id was typed whose end is the end of this masked patient. */
static bool ends_as(const char *text, const char *masked)
{
    static const char dots[] = "\xe2\x80\xa6";
    const char *tail = strstr(masked, dots);
    const size_t n = strlen(text), n_tail = tail ? strlen(tail + 3) : 0;
    return n_tail > 0 && n >= MIN_ID && strpbrk(text, "0123456789") && !strpbrk(text, " \t") && !strstr(text, dots) &&
           strcasecmp(text + n - n_tail, tail + 3) == 0;
}

static bool may_name(const struct api *api, const struct call *call, const struct fleet_plan *plan)
{
    return call->identity.source == IDENTITY_MACHINE ? api_is_of_this_machine(api, call)
                                                     : api_access_to_found_plan(api, call, ACCESS_IDENTITY, plan);
}

static bool is_patient(const struct api *api, const struct call *call, const struct fleet_plan *plan, const char *text)
{
    const cJSON *patient;
    bool is_named = has_text(plan->patient, text) || ends_as(text, plan->patient) ||
                    has_text(plan->stated_patient, text) || ends_as(text, plan->stated_patient);
    cJSON_ArrayForEach(patient, cJSON_GetObjectItemCaseSensitive(plan->document, "patients"))
    {
        is_named = is_named || has_text(json_text(patient, "masked"), text);
    }
    if (is_named && plan->patient_id[0] && ends_as(text, plan->patient) && may_name(api, call, plan))
        return has_text(plan->patient_id, text); /* it is another's whose id ends alike */
    return is_named || (plan->patient_id[0] && has_text(plan->patient_id, text) && may_name(api, call, plan));
}

/* Bytes of the path of the folder that a folder of a plan lies in. */
static size_t parent_length(const char *folder)
{
    const char *last = strrchr(folder, '/');
    return last ? (size_t)(last - folder) : 0;
}

/* An id that stays when other folders come to be called alike, and does not tell the path. */
static void folder_id(const char *path, size_t n, char id[FOLDER_ID + 1])
{
    char hex[DIGEST_TEXT];
    digest_bytes(path, n, hex);
    (void)snprintf(id, FOLDER_ID + 1, "%.*s", FOLDER_ID, hex);
}

/* The end of a path that has so many names. */
static const char *tail_of(const char *path, size_t n, int n_names)
{
    const char *at = path + n;
    while (at > path && (at[-1] != '/' || --n_names > 0))
        at--;
    return at;
}

/* The path of that many bytes is called so: by its id, or by the end of its path. */
static bool is_called(const char *path, size_t n_path, const char *name)
{
    const size_t n = strlen(name);
    char id[FOLDER_ID + 1];
    if (n && n < n_path && path[n_path - n - 1] == '/' && memcmp(path + n_path - n, name, n) == 0)
        return true;
    if (n != FOLDER_ID || strspn(name, "0123456789abcdef") != n)
        return false;
    folder_id(path, n_path, id);
    return strcmp(id, name) == 0;
}

static bool is_in_folder(const struct fleet_plan *plan, const char *folder)
{
    const size_t n = strlen(folder);
    if (n == 0 || (strcmp(folder, "uploads") == 0 && plan->is_uploaded) ||
        (strncmp(plan->folder, folder, n) == 0 && (plan->folder[n] == '/' || plan->folder[n] == 0)))
        return true;
    return !plan->is_uploaded && is_called(plan->folder, parent_length(plan->folder), folder);
}

/* A folder in which nothing can be shown, and nothing says that it is meant to be a plan. */
static bool is_no_plan(const struct fleet_plan *plan)
{
    return plan->state == FLEET_UNREADABLE && !plan->has_plan_file && !plan->is_uploaded;
}

static int approval_rank(const char *approval)
{
    static const char *const order[] = { "APPROVED", "UNAPPROVED", "", "REJECTED" };
    int rank = 0;
    while (rank < 4 && strcmp(order[rank], approval) != 0)
        rank++;
    return rank;
}

/* ---- finding ---------------------------------------------------------------------------------------------------- */

static bool is_path(const struct folder_found *folder, const char *path, size_t n)
{
    return folder->n_path == n && memcmp(folder->path, path, n) == 0;
}

static void count_folder(struct finding *finding, const struct fleet_plan *plan)
{
    const size_t n_path = parent_length(plan->folder);
    size_t i = 0;
    finding->n_all++;
    if (plan->is_uploaded) {
        finding->n_uploads++;
        return;
    }
    while (i < finding->n_folders && !is_path(&finding->folders[i], plan->folder, n_path))
        i++;
    if (i == MAX_FOLDERS || n_path == 0)
        return;
    if (i == finding->n_folders)
        finding->folders[finding->n_folders++] = (struct folder_found){ .path = plan->folder, .n_path = n_path };
    finding->folders[i].n++;
}

static void find_plans(const struct api *api, const struct call *call, const struct search *search,
                       struct finding *finding)
{
    struct fleet *fleet = net_fleet(api->net);
    struct fleet_plan plan;
    for (size_t i = 0; i < fleet_n_plans(fleet); i++) {
        if (!fleet_plan_at(fleet, i, &plan) || !api_access_to_found_plan(api, call, ACCESS_LOOK, &plan))
            continue;
        struct found *found = &finding->plans[finding->n_plans++];
        *found = (struct found){ .index = i, .rank = approval_rank(plan.approval) };
        (void)snprintf(found->id, sizeof found->id, "%s", plan.id);
        (void)snprintf(found->name, sizeof found->name, "%s", plan.name);
        (void)snprintf(found->date, sizeof found->date, "%s", plan.date);
        finding->n_no_plans += is_no_plan(&plan);
        if (!is_no_plan(&plan))
            count_folder(finding, &plan);
        found->is_kind =
            strcmp(search->kind, "all") == 0 || is_no_plan(&plan) == (strcmp(search->kind, "no-plan") == 0);
        found->is_in_folder = is_in_folder(&plan, search->folder);
        found->is_named = has_text(plan.name, search->text) || has_text(plan.note, search->text) ||
                          has_text(plan.id, search->text) || has_text(plan.label, search->text) ||
                          is_patient(api, call, &plan, search->text);
    }
}

static int by_id(const void *a, const void *b)
{
    const struct found *left = a, *right = b;
    return strcmp(left->id, right->id);
}

static int by_list(const void *a, const void *b)
{
    const struct found *left = a, *right = b;
    return left->index < right->index ? -1 : left->index > right->index;
}

static int by_name(const void *a, const void *b)
{
    const struct found *left = a, *right = b;
    const int names = strcasecmp(left->name, right->name);
    return names ? names : by_id(a, b);
}

static int by_use(const void *a, const void *b)
{
    const struct found *left = a, *right = b;
    return left->used_ms > right->used_ms ? -1 : left->used_ms < right->used_ms ? 1 : by_name(a, b);
}

static int by_approval(const void *a, const void *b)
{
    const struct found *left = a, *right = b;
    const int dates = strcmp(right->date, left->date);
    return left->rank != right->rank ? left->rank - right->rank : dates ? dates : by_name(a, b);
}

/* The plan of a room; NULL: the caller sees none. Plans are sorted by id. */
static struct found *plan_of(const struct api *api, const struct finding *finding, const char *id)
{
    struct found key;
    struct fleet_plan plan;
    (void)snprintf(key.id, sizeof key.id, "%s", id);
    struct found *found = bsearch(&key, finding->plans, finding->n_plans, sizeof key, by_id);
    if (found || !fleet_plan_find(net_fleet(api->net), id, &plan)) /* by the id of another time */
        return found;
    (void)snprintf(key.id, sizeof key.id, "%s", plan.id);
    return bsearch(&key, finding->plans, finding->n_plans, sizeof key, by_id);
}

static int by_newest(const void *a, const void *b)
{
    const struct room_found *left = a, *right = b;
    return left->used_ms > right->used_ms ? -1 : left->used_ms < right->used_ms;
}

/* The caller's own rooms: a plan is found by their names and people, and was used when they were. */
static void find_rooms(const struct api *api, const struct call *call, const struct search *search,
                       struct finding *finding)
{
    struct net_listed row;
    for (size_t i = 0; i < net_n_listed(api->net); i++) {
        struct found *plan = plan_of(api, finding, net_listed_plan(api->net, i));
        if (!plan || !net_listed_at(api->net, i, &call->identity, &row) || !row.is_mine)
            continue;
        finding->rooms[finding->n_rooms++] =
            (struct room_found){ .plan = plan->index, .index = i, .used_ms = row.used_ms };
        plan->used_ms = plan->used_ms > row.used_ms ? plan->used_ms : row.used_ms;
        plan->is_named = plan->is_named || has_text(row.name, search->text) || has_text(row.names, search->text);
    }
    qsort(finding->rooms, finding->n_rooms, sizeof finding->rooms[0], by_newest);
}

static bool find(const struct api *api, const struct call *call, const struct search *search, struct finding *finding)
{
    const size_t n_plans = fleet_n_plans(net_fleet(api->net)), n_rooms = net_n_listed(api->net);
    finding->plans = mem_array(n_plans + 1, sizeof finding->plans[0], 16 << 20, NULL);
    finding->rooms = mem_array(n_rooms + 1, sizeof finding->rooms[0], 16 << 20, NULL);
    if (!finding->plans || !finding->rooms)
        return false;
    find_plans(api, call, search, finding);
    qsort(finding->plans, finding->n_plans, sizeof finding->plans[0], by_id);
    find_rooms(api, call, search, finding);
    qsort(finding->plans, finding->n_plans, sizeof finding->plans[0],
          strcmp(search->sort, "used") == 0       ? by_use
          : strcmp(search->sort, "name") == 0     ? by_name
          : strcmp(search->sort, "approved") == 0 ? by_approval
                                                  : by_list);
    return true;
}

/* ---- the answer ------------------------------------------------------------------------------------------------- */

/* Adds the rooms that may be gone on with, the newest first. */
static void add_rooms(const struct api *api, const struct call *call, const struct finding *finding, size_t plan,
                      cJSON *json)
{
    const int64_t since_ms = clock_wall_ms() - ROOM_DAYS * INT64_C(86400000);
    cJSON *list = cJSON_AddArrayToObject(json, "rooms");
    struct net_listed row;
    int n = 0;
    for (size_t i = 0; i < finding->n_rooms && finding->rooms[i].used_ms >= since_ms; i++) {
        if (finding->rooms[i].plan != plan || n++ >= MAX_ROOMS)
            continue;
        if (net_listed_at(api->net, finding->rooms[i].index, &call->identity, &row))
            json_append(list, net_listed_document(api->net, finding->rooms[i].index, &row));
    }
    cJSON_AddNumberToObject(json, "n_rooms", n);
}

/* True if another folder's path ends alike. */
static bool is_ambiguous(const struct finding *finding, const struct folder_found *folder, const char *tail)
{
    const size_t n = folder->n_path - (size_t)(tail - folder->path);
    for (size_t i = 0; i < finding->n_folders; i++) {
        const struct folder_found *other = &finding->folders[i];
        const bool ends_alike =
            other != folder && other->n_path >= n && memcmp(other->path + other->n_path - n, tail, n) == 0;
        if (ends_alike && (other->n_path == n || other->path[other->n_path - n - 1] == '/'))
            return true;
    }
    return false;
}

/* The last name of its path, with as many before it as tell it from the other folders of the answer. */
static cJSON *name_of(const struct finding *finding, const struct folder_found *folder)
{
    const char *tail = tail_of(folder->path, folder->n_path, 1);
    char name[MAX_FOLDER + 1];
    for (int n = 2; tail > folder->path && is_ambiguous(finding, folder, tail); n++)
        tail = tail_of(folder->path, folder->n_path, n);
    (void)snprintf(name, sizeof name, "%.*s", (int)(folder->path + folder->n_path - tail), tail);
    return cJSON_CreateString(name);
}

static cJSON *list_folders(const struct finding *finding)
{
    cJSON *list = cJSON_CreateArray();
    for (size_t i = 0; i < finding->n_folders; i++) {
        const struct folder_found *folder = &finding->folders[i];
        cJSON *row = cJSON_CreateObject();
        char id[FOLDER_ID + 1];
        folder_id(folder->path, folder->n_path, id);
        cJSON_AddStringToObject(row, "id", id);
        json_add(row, "name", name_of(finding, folder));
        cJSON_AddNumberToObject(row, "n", folder->n);
        json_append(list, row);
    }
    return list;
}

static cJSON *make_answer(const struct api *api, const struct call *call, const struct search *search,
                          const struct finding *finding)
{
    cJSON *answer = cJSON_CreateObject(), *list = cJSON_AddArrayToObject(answer, "plans");
    bool is_behind = search->cursor[0] == 0, is_cut = false;
    const char *last = "";
    int n = 0, n_found = 0, n_of = 0;
    for (size_t i = 0; i < finding->n_plans; i++) {
        const struct found *found = &finding->plans[i];
        struct fleet_plan plan;
        if (!found->is_kind || !found->is_in_folder)
            continue;
        n_of++;
        if (found->is_named && is_behind && n < search->limit &&
            fleet_plan_at(net_fleet(api->net), found->index, &plan)) {
            cJSON *row = api_plan_head(&plan);
            add_rooms(api, call, finding, found->index, row);
            json_append(list, row);
            last = found->id;
            n++;
        } else if (found->is_named && is_behind) {
            is_cut = true;
        }
        n_found += found->is_named;
        is_behind = is_behind || strcmp(found->id, search->cursor) == 0;
    }
    cJSON_AddNumberToObject(answer, "total", n_found);
    cJSON_AddNumberToObject(answer, "of", n_of);
    json_add(answer, "next", is_cut ? cJSON_CreateString(last) : cJSON_CreateNull());
    json_add(answer, "folders", list_folders(finding));
    cJSON_AddNumberToObject(answer, "n_all", finding->n_all);
    cJSON_AddNumberToObject(answer, "n_uploads", finding->n_uploads);
    cJSON_AddNumberToObject(answer, "n_no_plans", finding->n_no_plans);
    return answer;
}

void api_plan_search(struct api *api, struct call *call)
{
    static const char *const media_types[] = { "application/json", NULL };
    struct problem problem = { 0 };
    struct finding finding = { .plans = NULL };
    struct search search;
    cJSON *body;
    if (!call_read_object(call, media_types, &body))
        return;
    fleet_rescan(net_fleet(api->net));
    if (read_search(body, &search, &problem) &&
        (find(api, call, &search, &finding) || json_no_memory(&problem, "a list of plans")))
        call_answer_json(call, 200, make_answer(api, call, &search, &finding));
    else
        call_answer_problem(call, &problem);
    free(finding.plans);
    free(finding.rooms);
    cJSON_Delete(body);
}
