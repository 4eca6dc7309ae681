/* A kept room as it is read from the disk: each line is a part, told by its first letter: an item's row, the scene, the
 * views, the presence, a member ("mID COLOR ROLE LEFT NAME"), a link ("lROLE SECONDS ONE USED PERSON") or the facts of
 * a recording ("rID FACTS"). Invariants: what is left out comes with a sentence; what a room that was restored keeps is
 * taken whole and unchanged by the next one. */
#include "core/base/clock.h"
#include "core/base/log.h"
#include "server/net/keep_recordings.h"
#include "server/wire/bookmark.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/kept_plan.h"

enum { MAX_MEMBERS = 300, MAX_LINKS = 40 };

static struct store_member members[MAX_MEMBERS];
static struct store_link links[MAX_LINKS];

/* Takes the word before the next blank, cut to the size. */
static const char *take_word(const char *at, char *to, size_t size)
{
    const size_t n = strcspn(at, " ");
    (void)snprintf(to, size, "%.*s", (int)n, at);
    return at + n + (at[n] == ' ');
}

static void take_member(struct store_room *kept, const char *at)
{
    char left[4];
    if (kept->n_members == MAX_MEMBERS)
        return;
    struct store_member *member = &members[kept->n_members++];
    *member = (struct store_member){ 0 };
    at = take_word(at, member->id, sizeof member->id);
    at = take_word(at, member->color, sizeof member->color);
    at = take_word(at, member->role, sizeof member->role);
    at = take_word(at, left, sizeof left);
    member->has_left = left[0] == '1';
    (void)snprintf(member->name, sizeof member->name, "%.163s", at);
    if (kept->n_members == 1)
        memcpy(kept->presenter, member->id, sizeof kept->presenter);
}

static void take_link(struct store_room *kept, const char *at)
{
    char word[24];
    if (kept->n_links == MAX_LINKS)
        return;
    struct store_link *link = &links[kept->n_links++];
    *link = (struct store_link){ 0 };
    link->token_hash[0] = (unsigned char)kept->n_links;
    at = take_word(at, link->role, sizeof link->role);
    at = take_word(at, word, sizeof word);
    link->expires_ms = strtoll(word, NULL, 10); /* any: a clock may have been set */
    at = take_word(at, word, sizeof word);
    link->is_one_use = word[0] == '1';
    at = take_word(at, word, sizeof word);
    link->is_used = word[0] == '1';
    (void)snprintf(link->person, sizeof link->person, "%.256s", at);
}

static void take_recording(struct room *room, char *at)
{
    struct store_recording recording = { .id = "" };
    recording.facts = (char *)take_word(at, recording.id, sizeof recording.id);
    const struct store_room row = { .recordings = &recording, .n_recordings = 1 };
    keep_recordings_restore(room, &row);
}

static void take_item(struct room *room, const char *row)
{
    struct problem problem = { 0 };
    if (!room_restore_item(room, row, strlen(row), &problem))
        REQUIRE(problem.type != PROBLEM_NONE && problem.detail[0]);
}

static void take_line(struct room *room, struct store_room *kept, char *line)
{
    switch (line[0]) {
    case 'i': take_item(room, line + 1); break;
    case 's': kept->scene = line + 1; break;
    case 'v': kept->views = line + 1; break;
    case 'p': kept->presence = line + 1; break;
    case 'm': take_member(kept, line + 1); break;
    case 'l': take_link(kept, line + 1); break;
    case 'r': take_recording(room, line + 1); break;
    default: break;
    }
}

static void check_text(cJSON *json)
{
    char *text = json_print(json);
    REQUIRE(text != NULL);
    free(text);
    cJSON_Delete(json);
}

static void check_recordings(cJSON *list)
{
    const cJSON *recording, *mark;
    cJSON_ArrayForEach(recording, list)
    {
        cJSON_ArrayForEach(mark, cJSON_GetObjectItemCaseSensitive(recording, "marks"))
        {
            REQUIRE(cJSON_IsArray(mark) && cJSON_GetArraySize(mark) == 3 && cJSON_IsNumber(mark->child));
            REQUIRE(cJSON_IsString(mark->child->next) && cJSON_IsString(mark->child->next->next));
        }
    }
    check_text(list);
}

static void begin_with(const cJSON *body, int64_t now_us)
{
    struct room *room = room_create("9h3d-t6rc", "head", &kept_plan_callbacks, NULL);
    REQUIRE(room_begin_with(room, body, NULL));
    kept_plan_ready(room, now_us);
    check_text(room_beginning(room));
    room_destroy(room);
}

/* All that is read of a room, and a page enters. */
static void use(struct room *room, const cJSON *items, int64_t now_us)
{
    static const char hello[] = "{\"type\":\"hello\",\"protocol\":2,\"name\":\"Dee\"}";
    char page;
    const cJSON *item;
    check_text(room_document(room));
    check_text(room_record(room));
    check_recordings(room_recordings(room, now_us));
    check_text(room_items(room, WIRE_ITEM_KIND_NOTE));
    cJSON_ArrayForEach(item, items)
    {
        uint32_t version;
        struct problem problem = { 0 };
        cJSON *row = json_read(item->valuestring, strlen(item->valuestring), NULL); /* rows are raw */
        cJSON *body = room_bookmark(room, json_text(row, "id"), &version);
        REQUIRE(body != NULL);
        cJSON_Delete(row);
        cJSON *opened = room_bookmark_open(room, body, &problem);
        REQUIRE(opened != NULL);
        check_text(opened);
        const char *token = json_text(body, "token");
        if (token && strlen(token) == BOOKMARK_TOKEN_CHARS) /* no other one is in a link */
            check_text(room_bookmark_of_token(room, token));
        begin_with(body, now_us);
        cJSON_Delete(body);
    }
    room_text_came(room, &page, hello, sizeof hello - 1, now_us);
    REQUIRE(room_settle(room, now_us) > now_us);
}

static bool is_same_text(const char *a, const char *b)
{
    return a && b ? strcmp(a, b) == 0 : a == b;
}

static void require_same(const struct store_room *a, const struct store_room *b)
{
    REQUIRE(a->n_members == b->n_members && a->n_links == b->n_links && a->n_named == b->n_named);
    REQUIRE(a->revision == b->revision && strcmp(a->presenter, b->presenter) == 0);
    REQUIRE(is_same_text(a->scene, b->scene) && is_same_text(a->views, b->views));
    REQUIRE(is_same_text(a->presence, b->presence));
    REQUIRE(memcmp(a->members, b->members, a->n_members * sizeof a->members[0]) == 0);
    for (size_t i = 0; i < a->n_links; i++) /* but for the time, which ends with the first reading where it is over */
        REQUIRE(strcmp(a->links[i].role, b->links[i].role) == 0 &&
                strcmp(a->links[i].person, b->links[i].person) == 0 &&
                a->links[i].is_one_use == b->links[i].is_one_use && a->links[i].is_used == b->links[i].is_used);
}

/* A room from what another one keeps keeps the same. */
static void check_next(const struct room *room, const cJSON *items, int64_t now_us)
{
    struct store_room kept, again;
    const cJSON *item;
    REQUIRE(room_keep(room, ROOM_ALL_PARTS, &kept));
    struct room *next = room_create("2v8x-p5fd", "head", &kept_plan_callbacks, NULL);
    cJSON_ArrayForEach(item, items)
    {
        struct problem problem = { 0 };
        char *row = json_print(item);
        REQUIRE(row != NULL && room_restore_item(next, row, strlen(row), &problem));
        free(row);
    }
    room_restore(next, &kept, now_us);
    kept_plan_ready(next, now_us);
    REQUIRE(room_keep(next, ROOM_ALL_PARTS, &again));
    require_same(&kept, &again);
    room_kept_finish(&kept);
    room_kept_finish(&again);
    room_destroy(next);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    struct store_room kept = { .created_ms = 1000, .revision = 7, .n_named = 2 };
    const int64_t now_us = 1000000;
    char *bytes = malloc(n + 1), *line = bytes;
    REQUIRE(bytes != NULL);
    memcpy(bytes, data, n);
    bytes[n] = 0;
    kept.members = members;
    kept.links = links;
    log_start("fuzz", (enum log_level)(LOG_ERROR + 1)); /* what is left out is said there, and much is */
    struct room *room = room_create("7q4k-m2wz", "head", &kept_plan_callbacks, NULL);
    for (char *end; line; line = end) {
        end = strchr(line, '\n');
        if (end)
            *end++ = 0;
        take_line(room, &kept, line);
    }
    room_restore(room, &kept, now_us);
    kept_plan_ready(room, now_us);
    cJSON *bookmarks = room_items(room, WIRE_ITEM_KIND_BOOKMARK);
    check_next(room, bookmarks, now_us);
    use(room, bookmarks, now_us);
    cJSON_Delete(bookmarks);
    room_destroy(room);
    free(bytes);
    return 0;
}
