/* Members and their views. */
#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>

#include "core/base/mem.h"
#include "server/room/parts.h"

static const char replaced[] = "this member has come back on another connection";
static const char room_is_full[] = "the room is full";
static const char old_page[] = "the page speaks another protocol version: reload it";
enum { FULL_RETRY_MS = 30000 };

/* ---- coming and going ------------------------------------------------------------------------------------------- */

struct member *member_of(const struct room *room, const void *connection)
{
    for (int i = 0; i < room->n_members; i++)
        if (connection && room->members[i]->connection == connection)
            return room->members[i];
    return NULL;
}

static void make_secret(char hex[2 * SECRET_BYTES + 1])
{
    uint8_t bytes[SECRET_BYTES];
    ssize_t n;
    do
        n = getrandom(bytes, sizeof bytes, 0);
    while (n < 0 && errno == EINTR);
    if (n != (ssize_t)sizeof bytes)
        abort(); /* a secret that can be guessed is none */
    for (int i = 0; i < SECRET_BYTES; i++)
        (void)snprintf(hex + 2 * i, 3, "%02x", bytes[i]);
}

/* In a time that says nothing about how much of it is right; its length is no secret. */
static bool secret_is(const struct member *member, const char *secret)
{
    if (strlen(secret) != 2 * SECRET_BYTES)
        return false;
    unsigned char differs = 0;
    for (size_t i = 0; i < 2 * SECRET_BYTES; i++)
        differs |= (unsigned char)(secret[i] ^ member->secret[i]);
    return differs == 0;
}

static void view_leave(struct room *room, struct member_view *view)
{
    struct stream *stream = view->stream;
    view->stream = NULL;
    view->is_following = false;
    view->has_news = false;
    view->n_waiting = 0;
    view->sent_number = 0;
    view->lag_least_us = view->lag_excess_us = 0;
    if (stream && stream->is_shared) /* stays for those who come later */
        stream_left(room, stream);
    else if (stream)
        stream_destroy(room, stream);
}

static bool follows(const struct member *member)
{
    for (int i = 0; i < ROOM_MAX_VIEWS; i++)
        if (member->views[i].is_following)
            return true;
    return false;
}

static void view_close(struct room *room, struct member_view *view)
{
    view_leave(room, view);
    cJSON_Delete(view->missing);
    view->missing = NULL;
}

/* Views belong to a connection: a page that comes back opens its own again. */
static void close_views(struct room *room, struct member *member)
{
    for (int i = 0; i < ROOM_MAX_VIEWS; i++) {
        view_close(room, &member->views[i]);
        member->views[i] = (struct member_view){ 0 }; /* a new connection counts its frames anew */
    }
    member->connection = NULL;
}

static void member_free(struct room *room, int index)
{
    struct member *member = room->members[index];
    close_views(room, member);
    free(member);
    room->members[index] = room->members[--room->n_members];
}

void members_free(struct room *room)
{
    while (room->n_members)
        member_free(room, room->n_members - 1);
}

int64_t members_forget(struct room *room)
{
    const int64_t kept_us = ROOM_MEMBER_KEPT_S * INT64_C(1000000);
    int64_t again_us = INT64_MAX;
    bool has_changed = false;
    for (int i = room->n_members - 1; i >= 0; i--) {
        const struct member *member = room->members[i];
        if (member->connection)
            continue;
        int64_t due_us = member->away_us + kept_us;
        if (room->now_us >= due_us) {
            member_free(room, i);
            has_changed = true;
        } else if (due_us < again_us) {
            again_us = due_us;
        }
    }
    if (has_changed)
        say_members(room);
    return again_us;
}

void member_disconnected(struct room *room, struct member *member)
{
    close_views(room, member);
    member->away_us = room->now_us;
    say_members(room);
}

static bool name_is_taken(const struct room *room, const char *name)
{
    for (int i = 0; i < room->n_members; i++)
        if (strcmp(room->members[i]->name, name) == 0)
            return true;
    return false;
}

/* Makes room for one more by forgetting who is away longest; false when all are here. */
static bool make_place(struct room *room)
{
    if (room->n_members < room->max_members)
        return true;
    int longest = -1;
    for (int i = 0; i < room->n_members; i++)
        if (!room->members[i]->connection &&
            (longest < 0 || room->members[i]->away_us < room->members[longest]->away_us))
            longest = i;
    if (longest < 0)
        return false;
    member_free(room, longest);
    return true;
}

static struct member *member_create(struct room *room, const char *name)
{
    struct member *member = mem_new(sizeof *member);
    (void)snprintf(member->id, sizeof member->id, "m%u", ++room->n_named);
    (void)snprintf(member->name, sizeof member->name, "%s", name);
    for (int number = 1; member->name[0] == 0 || (name[0] == 0 && name_is_taken(room, member->name)); number++)
        (void)snprintf(member->name, sizeof member->name, "Reviewer %d", number);
    make_secret(member->secret);
    room->members[room->n_members++] = member;
    return member;
}

bool member_hello(struct room *room, void *connection, const struct message_hello *hello)
{
    if (hello->protocol != WIRE_PROTOCOL) {
        say_bye(room, connection, -1, old_page);
        return false;
    }
    struct member *member = NULL;
    for (int i = 0; i < room->n_members && hello->member[0]; i++)
        if (strcmp(room->members[i]->id, hello->member) == 0 && secret_is(room->members[i], hello->secret))
            member = room->members[i];
    if (member) {
        void *old = member->connection; /* half-open: the page knows before we do */
        close_views(room, member);
        if (old)
            say_bye(room, old, -1, replaced);
        if (hello->name[0])
            (void)snprintf(member->name, sizeof member->name, "%s", hello->name);
    } else if (make_place(room)) {
        member = member_create(room, hello->name);
    } else {
        say_bye(room, connection, FULL_RETRY_MS, room_is_full);
        return false;
    }
    member->connection = connection;
    say_welcome(room, member);
    say_renderer(room, member);
    say_members(room);
    return true;
}

static bool is_blank(const char *text)
{
    return text[strspn(text, " ")] == 0;
}

cJSON *room_members(const struct room *room)
{
    cJSON *list = cJSON_CreateArray();
    for (int i = 0; i < room->n_members; i++) {
        const struct member *member = room->members[i];
        cJSON *item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "id", member->id);
        cJSON_AddStringToObject(item, "name", is_blank(member->name) ? member->id : member->name);
        cJSON_AddBoolToObject(item, "connected", member->connection != NULL);
        cJSON_AddBoolToObject(item, "following", follows(member));
        cJSON_AddItemToArray(list, item);
    }
    return list;
}

/* ---- views ------------------------------------------------------------------------------------------------------ */

void view_input(struct member_view *view, uint32_t input)
{
    if (!view->stream || input == 0)
        return;
    if (view->n_waiting ==
        MAX_WAITING_INPUTS) /* the older of the two is then reported with the newer, never too early */
        view->n_waiting--;
    view->waiting[view->n_waiting].version = view->stream->version;
    view->waiting[view->n_waiting].input = input;
    view->n_waiting++;
}

static void view_join(struct room *room, struct member_view *view, struct stream *stream, bool is_following,
                      uint32_t input)
{
    if (view->stream != stream)
        view_leave(room, view);
    view->stream = stream;
    view->is_following = is_following;
    view->was_open = true;
    view_input(view, input);
}

static void read_size(const cJSON *document, int size_px[2])
{
    const cJSON *size = cJSON_GetObjectItemCaseSensitive(document, "size_px");
    for (int i = 0; i < 2; i++)
        size_px[i] = cJSON_GetArrayItem(size, i)->valueint; /* checked: two whole numbers */
}

static void write_size(cJSON *document, const int size_px[2])
{
    cJSON_ReplaceItemInObjectCaseSensitive(document, "size_px", cJSON_CreateIntArray(size_px, 2));
}

/* The shared view of the document's kind; made from the document (taken) when there is none yet. */
static struct stream *shared_stream(struct room *room, struct member *member, cJSON *document)
{
    struct stream *stream = room->shared[view_kind(document)];
    if (stream) {
        cJSON_Delete(document);
        return stream;
    }
    stream = stream_create(room, document, true);
    (void)snprintf(stream->mover, sizeof stream->mover, "%s", member->id);
    return stream;
}

/* Says the new state of following to its member, and to all who look at the list of members when that changed. */
static void tell_following(struct room *room, struct member *member, int index, bool followed)
{
    const struct member_view *view = &member->views[index];
    say_view(room, member, index, view->is_following ? view->stream->mover : "");
    if (followed != follows(member))
        say_members(room);
}

static struct member_view *open_view(struct member *member, int64_t number, struct problem *problem)
{
    struct member_view *view = &member->views[number - 1];
    if (view->stream)
        return view;
    problem_set(problem, PROBLEM_NOT_FOUND, "/view", "", "view %d is not open", (int)number);
    return NULL;
}

bool member_view_open(struct room *room, struct member *member, const struct message *message, struct problem *problem)
{
    const struct message_view_open *open = &message->view_open;
    struct member_view *view = &member->views[open->view - 1];
    cJSON *document = view_document_patch(NULL, open->document, problem);
    if (!document)
        return false;
    if (!override_is_valid(room, document, problem)) {
        cJSON_Delete(document);
        return false;
    }
    bool followed = follows(member);
    read_size(document, view->size_px);
    struct stream *stream = open->follow ? shared_stream(room, member, document) : stream_create(room, document, false);
    view_join(room, view, stream, open->follow, (uint32_t)open->input);
    if (open->follow)
        tell_following(room, member, (int)open->view - 1, followed);
    else if (followed != follows(member))
        say_members(room);
    stream_send(room, member, view); /* what is there is seen at once */
    stream_say_refusal(room, member, view);
    return true;
}

static void tell_followers(struct room *room, struct stream *stream, const struct member_view *mover_view,
                           const char *by)
{
    for (int m = 0; m < room->n_members; m++)
        for (int v = 0; v < ROOM_MAX_VIEWS; v++) {
            struct member_view *view = &room->members[m]->views[v];
            if (view->stream != stream || view == mover_view)
                continue;
            view->has_news = true;
            (void)snprintf(view->news_by, sizeof view->news_by, "%s", by);
        }
}

static bool is_here(const struct room *room, const char *id)
{
    for (int i = 0; i < room->n_members; i++)
        if (strcmp(room->members[i]->id, id) == 0)
            return room->members[i]->connection && follows(room->members[i]);
    return false;
}

/* A window that was made larger does not take the lead from who presents. */
static bool only_resizes(const cJSON *patch)
{
    return patch->child && !patch->child->next && strcmp(patch->child->string, "size_px") == 0;
}

bool member_view_patch(struct room *room, struct member *member, const struct message *message, struct problem *problem)
{
    const struct message_view_patch *patch = &message->view_patch;
    struct member_view *view = open_view(member, patch->view, problem);
    if (!view)
        return false;
    cJSON *document = view_document_patch(view->stream->view, patch->patch, problem);
    if (!document)
        return false;
    if (!override_is_valid(room, document, problem)) {
        cJSON_Delete(document);
        return false;
    }
    struct stream *stream = view->stream;
    if (cJSON_GetObjectItemCaseSensitive(patch->patch, "size_px"))
        read_size(document, view->size_px);
    if (view->is_following) {
        write_size(document, view->size_px);
        if (view_kind(document) != stream->kind) { /* another kind: its shared view */
            view_join(room, view, shared_stream(room, member, document), true, (uint32_t)patch->input);
            say_view(room, member, (int)patch->view - 1, view->stream->mover);
            stream_send(room, member, view);
            stream_say_refusal(room, member, view);
            return true;
        }
        if (only_resizes(patch->patch) && strcmp(stream->mover, member->id) != 0 && is_here(room, stream->mover)) {
            cJSON_Delete(document);
        } else if (stream_set_view(room, stream, document)) {
            (void)snprintf(stream->mover, sizeof stream->mover, "%s", member->id);
            tell_followers(room, stream, view, member->id);
        }
    } else {
        (void)stream_set_view(room, stream, document);
    }
    view_input(view, (uint32_t)patch->input);
    stream_send(room, member, view);
    return true;
}

bool member_view_follow(struct room *room, struct member *member, const struct message *message,
                        struct problem *problem)
{
    const struct message_view_follow *follow = &message->view_follow;
    struct member_view *view = open_view(member, follow->view, problem);
    if (!view)
        return false;
    bool followed = follows(member);
    if (follow->follow == view->is_following) {
        view_input(view, (uint32_t)follow->input);
    } else {
        cJSON *document = cJSON_Duplicate(view->stream->view, true);
        struct stream *stream;
        if (follow->follow) {
            stream = shared_stream(room, member, document);
        } else {
            write_size(document, view->size_px);
            stream = stream_create(room, document, false);
        }
        view_join(room, view, stream, follow->follow, (uint32_t)follow->input);
    }
    tell_following(room, member, (int)follow->view - 1, followed);
    stream_send(room, member, view);
    stream_say_refusal(room, member, view);
    return true;
}

bool member_view_close(struct room *room, struct member *member, const struct message *message, struct problem *problem)
{
    struct member_view *view = open_view(member, message->view_close.view, problem);
    if (!view)
        return false;
    bool followed = follows(member);
    view_close(room, view);
    if (followed != follows(member))
        say_members(room);
    return true;
}

bool member_frame_shown(struct room *room, struct member *member, const struct message *message,
                        struct problem *problem)
{
    struct member_view *view = &member->views[message->frame_shown.view - 1];
    uint32_t sequence = (uint32_t)message->frame_shown.sequence;
    if (!view->was_open) /* one that was closed may still be answered for */
        return open_view(member, message->frame_shown.view, problem) != NULL;
    if (sequence > view->sent_sequence)
        return problem_set(problem, PROBLEM_VALIDATION, "/sequence", "range",
                           "frame %u of view %d was never sent, the newest is %u", sequence,
                           (int)message->frame_shown.view, view->sent_sequence);
    if (sequence <= view->shown_sequence)
        return true; /* already known */
    stream_acknowledged(room, view, sequence);
    stream_send(room, member, view);
    return true;
}
