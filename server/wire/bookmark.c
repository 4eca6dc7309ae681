/* The form of bookmarks, their tokens, and opening them: bookmark.h. */
#include "server/wire/bookmark.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/wire/document.h"
#include "server/wire/json_index.h"
#include "server/wire/json_merge.h"
#include "server/wire/prune.h"
#include "server/wire/random.h"

enum {
    MAX_TRIES = 16, /* values in one document that are out of range and are left out */
    MAX_VERSION = 1000000
};
static const double order_most = 1e9;

/* ---- form ------------------------------------------------------------------------------------------------------- */

static bool wrong(struct problem *problem, const char *pointer, const char *code, const char *sentence)
{
    return problem_set(problem, PROBLEM_VALIDATION, pointer, code, "%s", sentence);
}

/* Characters of UTF-8 text without control characters; SIZE_MAX: it has some. */
static size_t n_characters(const char *text)
{
    size_t n = 0;
    for (const unsigned char *c = (const unsigned char *)text; *c; c++) {
        if (*c < 0x20 || *c == 0x7f)
            return SIZE_MAX;
        n += (*c & 0xc0) != 0x80;
    }
    return n;
}

static bool is_whole(const cJSON *json, double least, double most)
{
    return cJSON_IsNumber(json) && json->valuedouble >= least && json->valuedouble <= most &&
           json->valuedouble == floor(json->valuedouble);
}

static bool check_views(const cJSON *views, struct problem *problem)
{
    char pointer[48];
    int at = 0;
    bool is_there[BOOKMARK_MAX_VIEWS] = { false };
    if (!cJSON_IsArray(views))
        return wrong(problem, "/views", views ? "type" : "required", "views must be a list of {view, document}");
    for (const cJSON *entry = views->child; entry; entry = entry->next, at++) {
        const cJSON *view = cJSON_GetObjectItemCaseSensitive(entry, "view");
        (void)snprintf(pointer, sizeof pointer, "/views/%d", at);
        if (at >= BOOKMARK_MAX_VIEWS)
            return wrong(problem, "/views", "count", "at most 8 views");
        if (!cJSON_IsObject(entry) || !cJSON_IsObject(cJSON_GetObjectItemCaseSensitive(entry, "document")))
            return wrong(problem, pointer, "type", "expected {view, document}, the document an object");
        if (!is_whole(view, 1, BOOKMARK_MAX_VIEWS))
            return wrong(problem, pointer, "range", "view must be a whole number, 1 to 8");
        if (is_there[view->valueint - 1])
            return wrong(problem, pointer, "duplicate", "a view stands twice");
        is_there[view->valueint - 1] = true;
    }
    return true;
}

/* The page's own: numbers, words, and lists of them, a few. */
static bool check_layout(const cJSON *layout, struct problem *problem)
{
    static const char small[] =
        "layout must be an object of at most 8 numbers, words of at most 40 bytes or lists of them";
    if (!layout)
        return true;
    if (!cJSON_IsObject(layout) || cJSON_GetArraySize(layout) > BOOKMARK_MAX_LAYOUT)
        return wrong(problem, "/layout", "type", small);
    for (const cJSON *item = layout->child; item; item = item->next) {
        const cJSON *value = cJSON_IsArray(item) ? item->child : item;
        if (cJSON_IsArray(item) && cJSON_GetArraySize(item) > BOOKMARK_MAX_LAYOUT)
            return wrong(problem, "/layout", "count", small);
        for (; value; value = cJSON_IsArray(item) ? value->next : NULL)
            if (!cJSON_IsNumber(value) && !(cJSON_IsString(value) && strlen(value->valuestring) <= 40))
                return wrong(problem, "/layout", "type", small);
    }
    return true;
}

bool bookmark_check(const cJSON *body, struct problem *problem)
{
    if (!cJSON_IsObject(body))
        return wrong(problem, "", "type", "a bookmark must be an object");
    const char *format = json_text(body, "format"), *name = json_text(body, "name"), *plan = json_text(body, "plan"),
               *token = json_text(body, "token");
    const cJSON *order = cJSON_GetObjectItemCaseSensitive(body, "order"),
                *scene = cJSON_GetObjectItemCaseSensitive(body, "scene");
    if (!format || strcmp(format, BOOKMARK_FORMAT) != 0)
        return wrong(problem, "/format", format ? "enum" : "required", "format must be \"" BOOKMARK_FORMAT "\"");
    if (!is_whole(cJSON_GetObjectItemCaseSensitive(body, "version"), 1, MAX_VERSION))
        return wrong(problem, "/version", "range", "version must be a whole number from 1");
    if (!name || name[0] == 0)
        return wrong(problem, "/name", "required", "a bookmark needs a name");
    if (n_characters(name) > BOOKMARK_MAX_NAME)
        return wrong(problem, "/name", "length", "a name has at most 80 characters, none of them a control character");
    if (!plan || !id_is_valid(plan))
        return wrong(problem, "/plan", "pattern", "plan must be the id of a plan");
    if (order && !(cJSON_IsNumber(order) && fabs(order->valuedouble) <= order_most))
        return wrong(problem, "/order", "range", "order must be a number of at most 1e9");
    if (scene && !cJSON_IsObject(scene) && !cJSON_IsNull(scene))
        return wrong(problem, "/scene", "type", "scene must be a merge patch on the plan's default scene");
    if (cJSON_HasObjectItem(body, "token") && (!token || !id_is_valid(token)))
        return wrong(problem, "/token", "pattern", "token is given by the server");
    if (!check_views(cJSON_GetObjectItemCaseSensitive(body, "views"), problem) ||
        !check_layout(cJSON_GetObjectItemCaseSensitive(body, "layout"), problem))
        return false;
    char *text = json_print(body);
    if (!text)
        return json_no_memory(problem, "a bookmark");
    size_t n = strlen(text);
    free(text);
    return n <= BOOKMARK_MAX_BYTES ||
           problem_set(problem, PROBLEM_TOO_LARGE, "", "", "this bookmark has %zu bytes, at most %d are kept", n,
                       BOOKMARK_MAX_BYTES);
}

/* ---- tokens ----------------------------------------------------------------------------------------------------- */

bool bookmark_make_token(char token[BOOKMARK_TOKEN_CHARS + 1])
{
    return random_letters(token, BOOKMARK_TOKEN_CHARS);
}

bool bookmark_has_token(const cJSON *body, const char *token)
{
    const char *own = json_text(body, "token");
    if (!own || strlen(own) != BOOKMARK_TOKEN_CHARS || strlen(token) != BOOKMARK_TOKEN_CHARS)
        return false;
    unsigned differs = 0;
    for (size_t i = 0; i < BOOKMARK_TOKEN_CHARS; i++)
        differs |= (unsigned)(unsigned char)own[i] ^ (unsigned)(unsigned char)token[i];
    return differs == 0;
}

/* ---- opening ---------------------------------------------------------------------------------------------------- */

struct report {
    cJSON *lines;
    int n;
};

static void note(void *context, const char *pointer, const char *code, const char *detail)
{
    struct report *report = context;
    if (report->n++ >= BOOKMARK_MAX_REPORT)
        return;
    cJSON *line = cJSON_CreateObject();
    cJSON_AddStringToObject(line, "pointer", pointer);
    cJSON_AddStringToObject(line, "code", code);
    cJSON_AddStringToObject(line, "detail", detail);
    json_append(report->lines, line);
}

static void note_problem(struct report *report, const struct problem *problem, const char *prefix)
{
    struct problem here = *problem;
    problem_below(&here, prefix);
    note(report, here.pointer, here.code, here.detail);
}

/* The scene of the patch, with values that are not valid any more left out one by one. Changes patch. */
static cJSON *open_scene(cJSON *patch, const cJSON *plan, const cJSON *defaults, struct report *report,
                         struct problem *problem)
{
    prune(&scene_object, patch, plan, "/scene", note, report);
    for (int i = 0; i < MAX_TRIES; i++) {
        cJSON *scene = scene_document_patch(plan, defaults, defaults, patch, problem);
        if (scene || problem->type != PROBLEM_VALIDATION)
            return scene;
        note_problem(report, problem, "/scene");
        if (!prune_at(patch, problem->pointer))
            break;
    }
    note(report, "/scene", "type", "the scene cannot be shown: the plan's own is shown instead");
    cJSON *scene = cJSON_Duplicate(defaults, true);
    if (!scene)
        json_no_memory(problem, "a scene");
    return scene;
}

/* The view of a saved document; NULL with problem of another type than validation: no memory. */
static cJSON *open_view(const cJSON *saved, const cJSON *plan, const char *pointer, struct report *report,
                        struct problem *problem)
{
    static const char *const not_saved[] = { "size_px", "override" }; /* the page's, and part of the scene */
    cJSON *document = cJSON_Duplicate(saved, true), *view = NULL;
    if (!document) {
        json_no_memory(problem, "a view");
        return NULL;
    }
    prune(&view_object, document, plan, pointer, note, report);
    for (size_t i = 0; i < sizeof not_saved / sizeof not_saved[0]; i++)
        cJSON_DeleteItemFromObjectCaseSensitive(document, not_saved[i]);
    for (int i = 0; i < MAX_TRIES && !view; i++) {
        view = view_document_patch(NULL, document, problem);
        if (view || problem->type != PROBLEM_VALIDATION)
            break;
        note_problem(report, problem, pointer);
        if (strcmp(problem->pointer, "/kind") == 0 || !prune_at(document, problem->pointer))
            break; /* a view of another kind would be another picture */
    }
    cJSON_Delete(document);
    for (size_t i = 0; view && i < sizeof not_saved / sizeof not_saved[0]; i++)
        cJSON_DeleteItemFromObjectCaseSensitive(view, not_saved[i]);
    return view;
}

static bool open_views(const cJSON *saved, const cJSON *plan, cJSON *views, struct report *report,
                       struct problem *problem)
{
    char pointer[48];
    int at = 0;
    for (const cJSON *entry = saved ? saved->child : NULL; entry; entry = entry->next, at++) {
        (void)snprintf(pointer, sizeof pointer, "/views/%d/document", at);
        cJSON *view = open_view(cJSON_GetObjectItemCaseSensitive(entry, "document"), plan, pointer, report, problem);
        if (!view && problem->type != PROBLEM_VALIDATION)
            return false;
        if (!view) {
            note(report, pointer, "type", "this view cannot be shown and is left out");
            continue;
        }
        cJSON *shown = cJSON_CreateObject();
        cJSON_AddNumberToObject(shown, "view", json_number(entry, "view", 1));
        json_add(shown, "document", view);
        json_append(views, shown);
    }
    return true;
}

static void note_own_fields(const cJSON *body, struct report *report)
{
    static const char *const known[] = { "format", "version", "name",   "plan", "order",
                                         "scene",  "views",   "layout", "token" };
    char pointer[80], detail[160];
    int version = (int)json_number(body, "version", 1);
    if (version > BOOKMARK_VERSION) {
        (void)snprintf(detail, sizeof detail,
                       "saved by a newer Beamroom (bookmark version %d): what this one does not know is left out",
                       version);
        note(report, "/version", "version", detail);
    }
    for (const cJSON *item = body->child; item; item = item->next) {
        bool is_known = false;
        for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
            is_known = is_known || strcmp(item->string, known[i]) == 0;
        if (is_known)
            continue;
        (void)snprintf(pointer, sizeof pointer, "/%.60s", item->string);
        (void)snprintf(detail, sizeof detail, "this version does not know %.60s", item->string);
        note(report, pointer, "unknown-field", detail);
    }
}

cJSON *bookmark_open(const cJSON *body, const cJSON *plan, const cJSON *defaults, struct problem *problem)
{
    size_t refused = mem_n_refused();
    struct report report = { cJSON_CreateArray(), 0 };
    const cJSON *saved = cJSON_GetObjectItemCaseSensitive(body, "scene"),
                *layout = cJSON_GetObjectItemCaseSensitive(body, "layout");
    cJSON *patch = cJSON_IsObject(saved) ? cJSON_Duplicate(saved, true) : cJSON_CreateObject();
    cJSON *views = cJSON_CreateArray(), *opened = cJSON_CreateObject();
    struct problem found = { 0 };
    note_own_fields(body, &report);
    cJSON *scene = patch ? open_scene(patch, plan, defaults, &report, &found) : NULL;
    bool ok = scene && open_views(cJSON_GetObjectItemCaseSensitive(body, "views"), plan, views, &report, &found);
    cJSON_Delete(patch);
    cJSON_AddStringToObject(opened, "name", json_text(body, "name"));
    cJSON_AddNumberToObject(opened, "version", json_number(body, "version", 1));
    json_add(opened, "scene", scene);
    json_add(opened, "views", views);
    json_add(opened, "layout", layout ? cJSON_Duplicate(layout, true) : cJSON_CreateObject());
    json_add(opened, "report", report.lines);
    cJSON_AddNumberToObject(opened, "n_report", report.n);
    if (ok && mem_n_refused() == refused)
        return opened;
    cJSON_Delete(opened);
    json_no_memory(problem, "a bookmark");
    return NULL;
}

cJSON *bookmark_views(const cJSON *body)
{
    size_t refused = mem_n_refused();
    struct report report = { NULL, BOOKMARK_MAX_REPORT }; /* full: nothing is written down */
    struct problem problem = { 0 };
    cJSON *views = cJSON_CreateArray();
    if (open_views(cJSON_GetObjectItemCaseSensitive(body, "views"), NULL, views, &report, &problem) &&
        mem_n_refused() == refused)
        return views;
    cJSON_Delete(views);
    return NULL;
}

/* ---- making ----------------------------------------------------------------------------------------------------- */

static cJSON *difference(const cJSON *before, const cJSON *after)
{
    cJSON *patch = cJSON_CreateObject();
    struct json_index old_members, new_members;
    json_index_init(&old_members, before);
    json_index_init(&new_members, after);
    for (const cJSON *item = after->child; item; item = item->next) {
        const cJSON *old = json_index_find(&old_members, item->string);
        if (!cJSON_IsObject(old) || !cJSON_IsObject(item)) {
            if (!json_equal(old, item))
                json_add(patch, item->string, cJSON_Duplicate(item, true));
            continue;
        }
        cJSON *inner = difference(old, item);
        if (inner && inner->child)
            json_add(patch, item->string, inner);
        else
            cJSON_Delete(inner);
    }
    for (const cJSON *item = before->child; item; item = item->next)
        if (!json_index_find(&new_members, item->string))
            cJSON_AddNullToObject(patch, item->string);
    json_index_finish(&old_members);
    json_index_finish(&new_members);
    return patch;
}

cJSON *bookmark_difference(const cJSON *defaults, const cJSON *scene)
{
    size_t before = mem_n_refused();
    cJSON *patch = difference(defaults, scene);
    if (mem_n_refused() == before)
        return patch;
    cJSON_Delete(patch);
    return NULL;
}
