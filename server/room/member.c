/* Lets members in and out, and handles the messages about their views. */
#include "server/room/member.h"

#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>

#include "core/base/mem.h"
#include "server/room/member_list.h"
#include "server/room/send.h"
#include "server/room/stream.h"

static const char replaced[] = "this member has come back on another connection";
static const char room_is_full[] = "the room is full";
static const char old_page[] = "the page speaks another protocol version: reload it";
enum { FULL_RETRY_MS = 30000 };

/* ---- coming and going ------------------------------------------------------------------------------------------- */

static void make_secret(char hex[2 * SECRET_BYTES + 1])
{
    uint8_t bytes[SECRET_BYTES];
    ssize_t n;
    do
        n = getrandom(bytes, sizeof bytes, 0);
    while (n < 0 && errno == EINTR);
    if (n != (ssize_t)sizeof bytes)
        abort(); /* without a random secret anybody could take over the member */
    for (int i = 0; i < SECRET_BYTES; i++)
        (void)snprintf(hex + 2 * i, 3, "%02x", bytes[i]);
}

/* Compares in constant time: the time does not reveal how many digits match. The length is public. */
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
    view->has_moved = false;
    view->n_waiting = 0;
    view->sent_number = 0;
    view->lag_least_us = view->lag_excess_us = 0;
    if (stream && stream->is_shared) /* a shared stream stays for members who follow later */
        stream_left(room, stream);
    else if (stream)
        stream_destroy(room, stream);
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
        member->views[i] = (struct member_view){ 0 }; /* frames are counted from 1 on each connection */
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
        send_members(room);
    return again_us;
}

void members_close_lost(struct room *room)
{
    for (int i = 0; i < room->n_members; i++) /* saying who is there may lose others */
        if (room->members[i]->is_lost) {
            member_disconnected(room, room->members[i]);
            i = -1;
        }
}

void member_disconnected(struct room *room, struct member *member)
{
    member->is_lost = false;
    close_views(room, member);
    member->away_us = room->now_us;
    send_members(room);
}

static bool name_is_taken(const struct room *room, const char *name)
{
    for (int i = 0; i < room->n_members; i++)
        if (strcmp(room->members[i]->name, name) == 0)
            return true;
    return false;
}

/* Makes room for one more member by dropping the one away longest. Returns false when all are connected. */
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
        send_bye(room, connection, -1, old_page);
        return false;
    }
    struct member *member = NULL;
    for (int i = 0; i < room->n_members && hello->member[0]; i++)
        if (strcmp(room->members[i]->id, hello->member) == 0 && secret_is(room->members[i], hello->secret))
            member = room->members[i];
    if (member) {
        void *old = member->connection; /* half-open: the page notices a lost connection before the server does */
        member->is_lost = false;
        close_views(room, member);
        if (old)
            send_bye(room, old, -1, replaced);
        if (hello->name[0])
            (void)snprintf(member->name, sizeof member->name, "%s", hello->name);
    } else if (make_place(room)) {
        member = member_create(room, hello->name);
    } else {
        send_bye(room, connection, FULL_RETRY_MS, room_is_full);
        return false;
    }
    member->connection = connection;
    send_welcome(room, member);
    send_renderer_state(room, member);
    send_members(room);
    return true;
}

/* ---- views ------------------------------------------------------------------------------------------------------ */

void view_add_input(struct member_view *view, uint32_t input)
{
    if (!view->stream || input == 0)
        return;
    if (view->n_waiting ==
        MAX_WAITING_INPUTS) /* full: the older input is reported with the newer one, later but never too early */
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
    view_add_input(view, input);
}

static void read_size(const cJSON *document, int size_px[2])
{
    const cJSON *size = cJSON_GetObjectItemCaseSensitive(document, "size_px");
    for (int i = 0; i < 2; i++)
        size_px[i] = cJSON_GetArrayItem(size, i)->valueint; /* checked: two whole numbers */
}

static void write_size(cJSON *document, const int size_px[2])
{
    cJSON *size = cJSON_CreateIntArray(size_px, 2);
    if (!cJSON_ReplaceItemInObjectCaseSensitive(document, "size_px", size)) /* no memory: the size stays as it was */
        cJSON_Delete(size);
}

/* The shared stream of the document's kind. Takes document, and makes the stream from it when there is none yet. */
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

/* Sends the view to its member, and the list of members to all when the member began or ceased to follow. */
static void send_following(struct room *room, struct member *member, int index, bool followed)
{
    const struct member_view *view = &member->views[index];
    send_view(room, member, index, view->is_following ? view->stream->mover : "");
    if (followed != member_follows(member))
        send_members(room);
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
    bool followed = member_follows(member);
    read_size(document, view->size_px);
    struct stream *stream = open->follow ? shared_stream(room, member, document) : stream_create(room, document, false);
    view_join(room, view, stream, open->follow, (uint32_t)open->input);
    if (open->follow)
        send_following(room, member, (int)open->view - 1, followed);
    else if (followed != member_follows(member))
        send_members(room);
    stream_send_picture(room, member, view); /* a picture that is there already is sent at once */
    stream_send_refusal(room, member, view);
    return true;
}

static void note_mover(struct room *room, struct stream *stream, const struct member_view *mover_view, const char *by)
{
    for (int m = 0; m < room->n_members; m++)
        for (int v = 0; v < ROOM_MAX_VIEWS; v++) {
            struct member_view *view = &room->members[m]->views[v];
            if (view->stream != stream || view == mover_view)
                continue;
            view->has_moved = true;
            (void)snprintf(view->moved_by, sizeof view->moved_by, "%s", by);
        }
}

static bool is_present(const struct room *room, const char *id)
{
    for (int i = 0; i < room->n_members; i++)
        if (strcmp(room->members[i]->id, id) == 0)
            return room->members[i]->connection && member_follows(room->members[i]);
    return false;
}

/* A page whose window was resized does not take the lead from the presenter. */
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
        if (view_kind(document) != stream->kind) { /* another kind has a shared view of its own */
            view_join(room, view, shared_stream(room, member, document), true, (uint32_t)patch->input);
            send_view(room, member, (int)patch->view - 1, view->stream->mover);
            stream_send_picture(room, member, view);
            stream_send_refusal(room, member, view);
            return true;
        }
        if (only_resizes(patch->patch) && strcmp(stream->mover, member->id) != 0 && is_present(room, stream->mover)) {
            cJSON_Delete(document);
        } else if (stream_set_view(room, stream, document)) {
            (void)snprintf(stream->mover, sizeof stream->mover, "%s", member->id);
            note_mover(room, stream, view, member->id);
        }
    } else {
        (void)stream_set_view(room, stream, document);
    }
    view_add_input(view, (uint32_t)patch->input);
    stream_send_picture(room, member, view);
    return true;
}

bool member_view_follow(struct room *room, struct member *member, const struct message *message,
                        struct problem *problem)
{
    const struct message_view_follow *follow = &message->view_follow;
    struct member_view *view = open_view(member, follow->view, problem);
    if (!view)
        return false;
    bool followed = member_follows(member);
    if (follow->follow == view->is_following) {
        view_add_input(view, (uint32_t)follow->input);
    } else {
        cJSON *document = cJSON_Duplicate(view->stream->view, true);
        struct stream *stream;
        if (!document)
            return json_no_memory(problem, "a view");
        if (follow->follow) {
            stream = shared_stream(room, member, document);
        } else {
            write_size(document, view->size_px);
            stream = stream_create(room, document, false);
        }
        view_join(room, view, stream, follow->follow, (uint32_t)follow->input);
    }
    send_following(room, member, (int)follow->view - 1, followed);
    stream_send_picture(room, member, view);
    stream_send_refusal(room, member, view);
    return true;
}

bool member_view_close(struct room *room, struct member *member, const struct message *message, struct problem *problem)
{
    struct member_view *view = open_view(member, message->view_close.view, problem);
    if (!view)
        return false;
    bool followed = member_follows(member);
    view_close(room, view);
    if (followed != member_follows(member))
        send_members(room);
    return true;
}

bool member_frame_shown(struct room *room, struct member *member, const struct message *message,
                        struct problem *problem)
{
    struct member_view *view = &member->views[message->frame_shown.view - 1];
    uint32_t sequence = (uint32_t)message->frame_shown.sequence;
    if (!view->was_open) /* a view that was closed may still be acknowledged */
        return open_view(member, message->frame_shown.view, problem) != NULL;
    if (sequence > view->sent_sequence)
        return problem_set(problem, PROBLEM_VALIDATION, "/sequence", "range",
                           "frame %u of view %d was never sent, the newest is %u", sequence,
                           (int)message->frame_shown.view, view->sent_sequence);
    if (sequence <= view->shown_sequence)
        return true; /* acknowledged before */
    stream_acknowledged(room, view, sequence);
    stream_send_picture(room, member, view);
    return true;
}
