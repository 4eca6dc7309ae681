/* Handles the messages about a member's views. */
#include "server/room/views/member_view.h"

#include <stdio.h>
#include <string.h>

#include "server/room/out/send.h"
#include "server/room/state/event.h"
#include "server/room/state/member_list.h"
#include "server/room/state/own_view.h"
#include "server/room/streams/main_view.h"
#include "server/room/streams/pictures.h"
#include "server/room/streams/stream.h"
#include "server/room/streams/wall.h"

/* ---- joining and leaving a stream ------------------------------------------------------------------------------- */

static void view_leave(struct room *room, struct member_view *view)
{
    view->is_following = false;
    view->has_moved = false;
    view->n_waiting = 0;
    view->sent_number = 0;
    view->lag_least_us = view->lag_excess_us = 0;
    if (view->stream) /* a shared stream stays for members who follow later */
        stream_remove_viewer(room, view);
}

static void view_close(struct room *room, struct member_view *view)
{
    view_leave(room, view);
    cJSON_Delete(view->missing);
    view->missing = NULL;
}

void views_close(struct room *room, struct member *member)
{
    for (int i = 0; i < ROOM_WATCH; i++) {
        view_close(room, &member->views[i]);
        member->views[i] = (struct member_view){ 0 }; /* frames are counted from 1 on each connection */
    }
    member->watch.is_wanted = member->watch.is_late = false;
}

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

static void view_join(struct room *room, struct member *member, struct member_view *view, struct stream *stream,
                      bool is_following)
{
    if (view->stream != stream) {
        view_leave(room, view);
        if (stream->is_of_display)
            room_event(room, ROOM_VIEWS, NULL);
        stream->is_of_display = false;
        view->member = member;
        stream_add_viewer(stream, view);
    }
    view->is_following = is_following;
    view->was_open = true;
}

static void read_size(const cJSON *document, int size_px[2])
{
    const cJSON *size = cJSON_GetObjectItemCaseSensitive(document, "size_px");
    for (int i = 0; i < 2; i++)
        size_px[i] = cJSON_GetArrayItem(size, i)->valueint; /* checked: two whole numbers */
}

static void write_size(cJSON *document, const int size_px[2])
{
    cJSON *size = cJSON_GetObjectItemCaseSensitive(document, "size_px");
    for (int i = 0; i < 2; i++)
        cJSON_SetNumberValue(cJSON_GetArrayItem(size, i), size_px[i]);
}

static bool is_members_own(const struct member_view *view)
{
    return view->stream && !view->is_following;
}

/* The viewers of the stream but one are to be sent the changed view before its next frame. */
static void note_mover(struct stream *stream, const struct member_view *mover_view, const struct member *by)
{
    (void)snprintf(stream->mover, sizeof stream->mover, "%s", by->id);
    for (struct member_view *view = stream->viewers; view; view = view->next_viewer) {
        if (view == mover_view)
            continue;
        view->has_moved = true;
        memcpy(view->moved_by, by->id, sizeof view->moved_by);
    }
}

/* The presenter changes a shared stream. Takes document. */
static void set_shared_view(struct room *room, struct member *presenter, const struct member_view *view,
                            struct stream *stream, cJSON *document)
{
    if (stream_set_view(room, stream, document))
        note_mover(stream, view, presenter);
}

/* The document with which a member shows the shared view of its kind: the whole document from the presenter, kind and
 * size from others. Takes document; NULL with problem when there is no memory. */
static cJSON *document_to_share(const struct room *room, const struct member *member, cJSON *document,
                                struct problem *problem)
{
    if (!document || member_presents(room, member))
        return document;
    cJSON *nulls = cJSON_CreateObject();
    cJSON_AddNullToObject(nulls, "camera");
    cJSON_AddNullToObject(nulls, "override");
    cJSON *plain = cJSON_GetArraySize(nulls) == 2 ? view_document_patch(document, nulls, problem) : NULL;
    if (!plain)
        (void)json_no_memory(problem, "a view");
    cJSON_Delete(nulls);
    cJSON_Delete(document);
    return plain;
}

/* Shows the shared stream of views like the document, which is made from the document when there is none yet. Takes
 * document, of document_to_share. */
static void join_shared(struct room *room, struct member *member, struct member_view *view, cJSON *document)
{
    struct stream *stream = stream_shared(room, document);
    if (!stream || stream->is_of_display) {
        document = stream_first_view(room, document);
        if (stream)
            (void)stream_set_view(room, stream, document);
        else
            stream = stream_create(room, document, true);
        if (member_presents(room, member))
            (void)snprintf(stream->mover, sizeof stream->mover, "%s", member->id);
    } else {
        cJSON_Delete(document);
    }
    view_join(room, member, view, stream, true);
}

/* A shared stream has the size of the presenter's view. */
static void share_size(struct room *room, struct member *presenter, struct member_view *view)
{
    cJSON *document = cJSON_Duplicate(view->stream->view, true);
    if (!document) /* no memory: the size stays as it was */
        return;
    write_size(document, view->size_px);
    set_shared_view(room, presenter, view, view->stream, document);
}

/* After a view began to show another stream: its document, and the picture that is there already. */
static void send_joined(struct room *room, struct member *member, int index)
{
    struct member_view *view = &member->views[index];
    send_view(room, member, index, view->is_following ? view->stream->mover : "");
    view->has_moved = false;
    stream_send_picture(room, member, view);
    stream_send_refusal(room, member, view);
}

static void send_members_if(struct room *room, const struct member *member, bool followed)
{
    if (followed != member_follows(room, member))
        send_members(room);
}

/* The wall's view shows the stream for such documents. Takes document. */
static bool join_wall(struct room *room, struct member *member, struct member_view *view, cJSON *document,
                      struct problem *problem)
{
    read_size(document, view->size_px);
    struct stream *stream = wall_stream(room, document, problem);
    if (!stream)
        return false;
    view_join(room, member, view, stream, true);
    return true;
}

static bool refuse_wall(struct problem *problem)
{
    return problem_set(problem, PROBLEM_CONFLICT, "", "wall", "a wall has no views but those that follow");
}

/* ---- opening, changing, closing --------------------------------------------------------------------------------- */

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
    int size_px[2];
    cJSON *document = view_document_patch(NULL, open->document, problem);
    if (!document)
        return false;
    if (!override_is_valid(room, document, problem)) {
        cJSON_Delete(document);
        return false;
    }
    if (member_is_wall(member)) {
        if (!join_wall(room, member, view, document, problem))
            return false;
        view_add_input(view, (uint32_t)open->input);
        send_joined(room, member, (int)open->view - 1);
        return true;
    }
    read_size(document, size_px);
    if (open->follow && !(document = document_to_share(room, member, document, problem)))
        return false;
    bool followed = member_follows(room, member);
    memcpy(view->size_px, size_px, sizeof size_px);
    if (open->follow) {
        join_shared(room, member, view, document);
        if (member_presents(room, member))
            share_size(room, member, view);
    } else {
        view_join(room, member, view, stream_create(room, document, false), false);
    }
    view_add_input(view, (uint32_t)open->input);
    if (open->follow)
        send_joined(room, member, (int)open->view - 1);
    send_members_if(room, member, followed);
    return true;
}

/* A follower may patch only the size of a shared view: it counts once they leave it. */
static bool patch_of_follower(struct room *room, struct member_view *view, const cJSON *patch, const cJSON *document,
                              struct problem *problem)
{
    for (const cJSON *field = patch->child; field; field = field->next)
        if (strcmp(field->string, "size_px") != 0)
            return refuse_not_presenter(room, problem, "change a shared view");
    if (patch->child)
        read_size(document, view->size_px);
    return true;
}

/* A wall gives the view another size. Takes document. */
static bool patch_of_wall(struct room *room, struct member *member, struct member_view *view,
                          const struct message_view_patch *patch, cJSON *document, struct problem *problem)
{
    for (const cJSON *field = patch->patch->child; field; field = field->next)
        if (strcmp(field->string, "size_px") != 0 && strcmp(field->string, "pixel_ratio") != 0) {
            cJSON_Delete(document);
            return refuse_wall(problem);
        }
    if (!join_wall(room, member, view, document, problem))
        return false;
    view_add_input(view, (uint32_t)patch->input);
    send_joined(room, member, (int)patch->view - 1);
    return true;
}

bool member_view_patch(struct room *room, struct member *member, const struct message *message, struct problem *problem)
{
    const struct message_view_patch *patch = &message->view_patch;
    struct member_view *view = open_view(member, patch->view, problem);
    if (!view)
        return false;
    struct stream *stream = view->stream;
    cJSON *document = view_document_patch(stream->view, patch->patch, problem);
    if (!document)
        return false;
    if (member_is_wall(member))
        return patch_of_wall(room, member, view, patch, document, problem);
    if (patch->acted)
        main_view_patched(member, (int)patch->view, patch->patch);
    if (view->is_following && !member_presents(room, member)) {
        bool is_kept = patch_of_follower(room, view, patch->patch, document, problem);
        cJSON_Delete(document);
        if (!is_kept)
            return false;
        view_add_input(view, (uint32_t)patch->input);
        stream_send_picture(room, member, view);
        return true;
    }
    if (!override_is_valid(room, document, problem)) {
        cJSON_Delete(document);
        return false;
    }
    if (cJSON_GetObjectItemCaseSensitive(patch->patch, "size_px"))
        read_size(document, view->size_px);
    write_size(document, view->size_px);
    stream->acted_us = room->now_us;
    if (!view->is_following) {
        (void)stream_set_view(room, stream, document);
    } else if (views_are_alike(document, stream->view)) {
        set_shared_view(room, member, view, stream, document);
    } else { /* another kind, number or plane has a shared view of its own */
        join_shared(room, member, view, document);
        share_size(room, member, view);
        view_add_input(view, (uint32_t)patch->input);
        send_joined(room, member, (int)patch->view - 1);
        return true;
    }
    view_add_input(view, (uint32_t)patch->input);
    stream_send_picture(room, member, view);
    return true;
}

bool member_view_active(struct room *room, struct member *member, const struct message *message,
                        struct problem *problem)
{
    const struct member_view *view = open_view(member, message->view_active.view, problem);
    if (!view)
        return false;
    main_view_active(member, (int)message->view_active.view);
    if (!view->is_following || member_presents(room, member))
        view->stream->acted_us = room->now_us;
    return true;
}

bool member_view_close(struct room *room, struct member *member, const struct message *message, struct problem *problem)
{
    struct member_view *view = open_view(member, message->view_close.view, problem);
    if (!view)
        return false;
    bool followed = member_follows(room, member);
    view_close(room, view);
    send_members_if(room, member, followed);
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

/* ---- following, leaving, sharing -------------------------------------------------------------------------------- */

static void delete_all(cJSON *documents[ROOM_MAX_VIEWS])
{
    for (int i = 0; i < ROOM_MAX_VIEWS; i++)
        cJSON_Delete(documents[i]);
}

bool views_follow(struct room *room, struct member *member, uint32_t input, struct problem *problem)
{
    cJSON *documents[ROOM_MAX_VIEWS] = { NULL };
    for (int i = 0; i < ROOM_MAX_VIEWS; i++) {
        const struct member_view *view = &member->views[i];
        if (!is_members_own(view))
            continue;
        cJSON *copy = cJSON_Duplicate(view->stream->view, true);
        documents[i] = document_to_share(room, member, copy, problem);
        if (!documents[i]) {
            delete_all(documents);
            return json_no_memory(problem, "a view");
        }
    }
    for (int i = 0; i < ROOM_MAX_VIEWS; i++) {
        struct member_view *view = &member->views[i];
        if (!view->stream)
            continue;
        if (documents[i])
            join_shared(room, member, view, documents[i]);
        if (member_presents(room, member))
            share_size(room, member, view);
        view_add_input(view, input);
        send_joined(room, member, i);
    }
    return true;
}

/* True if an earlier view of the member is alike. */
static bool is_taken(const struct member *member, int index)
{
    for (int i = 0; i < index; i++)
        if (member->views[i].stream &&
            views_are_alike(member->views[i].stream->view, member->views[index].stream->view))
            return true;
    return false;
}

bool views_share(struct room *room, struct member *presenter, bool keep_override, uint32_t input,
                 struct problem *problem)
{
    cJSON *documents[ROOM_MAX_VIEWS] = { NULL };
    for (int i = 0; i < ROOM_MAX_VIEWS; i++) {
        const struct member_view *view = &presenter->views[i];
        if (!is_members_own(view))
            continue;
        documents[i] = cJSON_Duplicate(view->stream->view, true);
        if (!documents[i]) {
            delete_all(documents);
            return json_no_memory(problem, "a view");
        }
        if (!keep_override)
            cJSON_DeleteItemFromObjectCaseSensitive(documents[i], "override");
    }
    for (int i = 0; i < ROOM_MAX_VIEWS; i++) {
        struct member_view *view = &presenter->views[i];
        if (!view->stream)
            continue;
        bool was_own = is_members_own(view), is_first = !is_taken(presenter, i);
        struct stream *stream = stream_shared(room, view->stream->view);
        if (was_own && stream && is_first) {
            set_shared_view(room, presenter, view, stream, documents[i]);
            view_join(room, presenter, view, stream, true);
        } else if (was_own) {
            join_shared(room, presenter, view, documents[i]);
        } else if (is_first) {
            share_size(room, presenter, view);
        }
        view_add_input(view, input);
        if (was_own)
            send_joined(room, presenter, i);
        else
            stream_send_picture(room, presenter, view);
    }
    return true;
}

/* Checks one entry of a follow's views and gives its complete document to documents. */
static bool read_own(struct room *room, struct member *member, const cJSON *entry, cJSON *documents[ROOM_MAX_VIEWS],
                     struct problem *problem)
{
    static const char *const names[] = { "view", "document" };
    const cJSON *number = cJSON_GetObjectItemCaseSensitive(entry, names[0]),
                *document = cJSON_GetObjectItemCaseSensitive(entry, names[1]);
    if (!cJSON_IsObject(entry))
        return problem_set(problem, PROBLEM_VALIDATION, "", "type", "an entry of views must be an object");
    for (const cJSON *field = entry->child; field; field = field->next)
        if (field != number && field != document)
            return problem_set(problem, PROBLEM_VALIDATION, "", "unknown-field",
                               "an entry of views has \"view\" and \"document\", each once, and no other field");
    if (!number || !document)
        return problem_set(problem, PROBLEM_VALIDATION, number ? "/document" : "/view", "required",
                           "an entry of views needs \"view\" and \"document\"");
    if (!cJSON_IsNumber(number))
        return problem_set(problem, PROBLEM_VALIDATION, "/view", "type", "view must be a number");
    if (!(number->valuedouble >= 1 && number->valuedouble <= ROOM_MAX_VIEWS) ||
        number->valuedouble != (double)number->valueint)
        return problem_set(problem, PROBLEM_VALIDATION, "/view", "range", "view must be a whole number, 1 to %d",
                           ROOM_MAX_VIEWS);
    int index = number->valueint - 1;
    if (!member->views[index].stream)
        return problem_set(problem, PROBLEM_NOT_FOUND, "/view", "", "view %d is not open", index + 1);
    if (documents[index])
        return problem_set(problem, PROBLEM_VALIDATION, "/view", "duplicate", "view %d stands twice", index + 1);
    documents[index] = view_document_patch(NULL, document, problem);
    if (documents[index] && override_is_valid(room, documents[index], problem))
        return true;
    problem_below(problem, "/document");
    return false;
}

/* Fills documents for all open views that change: those of the message, and copies of shared views. */
static bool read_leaving(struct room *room, struct member *member, const cJSON *views, cJSON *documents[ROOM_MAX_VIEWS],
                         struct problem *problem)
{
    char pointer[32];
    int n = 0;
    if (views && !cJSON_IsArray(views))
        return problem_set(problem, PROBLEM_VALIDATION, "/views", "type", "views must be a list");
    for (const cJSON *entry = views ? views->child : NULL; entry; entry = entry->next, n++) {
        (void)snprintf(pointer, sizeof pointer, "/views/%d", n); /* at most ROOM_MAX_VIEWS pass as no duplicates */
        if (!read_own(room, member, entry, documents, problem)) {
            problem_below(problem, pointer);
            return false;
        }
    }
    for (int i = 0; i < ROOM_MAX_VIEWS; i++) {
        const struct member_view *view = &member->views[i];
        if (!view->is_following || documents[i])
            continue;
        documents[i] = own_view(view->stream->view, stream_scene(room, view->stream), view->size_px, problem);
        if (!documents[i])
            return false;
    }
    return true;
}

static bool views_leave(struct room *room, struct member *member, const cJSON *views, uint32_t input,
                        struct problem *problem)
{
    cJSON *documents[ROOM_MAX_VIEWS] = { NULL };
    if (!read_leaving(room, member, views, documents, problem)) {
        delete_all(documents);
        return false;
    }
    for (int i = 0; i < ROOM_MAX_VIEWS; i++) {
        struct member_view *view = &member->views[i];
        if (!view->stream)
            continue;
        if (documents[i])
            read_size(documents[i], view->size_px);
        if (documents[i] && view->is_following)
            view_join(room, member, view, stream_create(room, documents[i], false), false);
        else if (documents[i])
            (void)stream_set_view(room, view->stream, documents[i]);
        view_add_input(view, input);
        send_joined(room, member, i);
    }
    return true;
}

bool member_follow(struct room *room, struct member *member, const struct message *message, struct problem *problem)
{
    const struct message_follow *follow = &message->follow;
    if (follow->follow && follow->views)
        return problem_set(problem, PROBLEM_VALIDATION, "/views", "unknown-field",
                           "views are given when leaving, with follow false");
    if (!follow->follow && member_presents(room, member))
        return problem_set(problem, PROBLEM_NOT_PRESENTER, "/follow", "",
                           "the presenter cannot leave: the presenter's views are the room's");
    if (!follow->follow && member_is_wall(member))
        return refuse_wall(problem);
    bool followed = member_follows(room, member);
    if (!(follow->follow ? views_follow(room, member, (uint32_t)follow->input, problem)
                         : views_leave(room, member, follow->views, (uint32_t)follow->input, problem)))
        return false;
    send_members_if(room, member, followed);
    return true;
}
