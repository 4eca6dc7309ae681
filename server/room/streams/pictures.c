/* Requests pictures for streams, sends them to the viewers, and gives up on those that cannot be drawn. */
#include "server/room/streams/pictures.h"

#include <string.h>

#include "core/base/log.h"
#include "server/room/out/send.h"
#include "server/room/streams/display.h"
#include "server/room/streams/size_class.h"
#include "server/room/streams/stream.h"
#include "server/room/streams/wall.h"
#include "server/room/streams/watch.h"

enum { STILL_QUALITY = 92 };
static const int64_t still_after_us = ROOM_STILL_AFTER_MS * INT64_C(1000);
/* A drag sends changes all the time; after a pause of this length it is over. */
static const int64_t acted_for_us = 500000;

/* ---- requests --------------------------------------------------------------------------------------------------- */

static int n_outstanding(const struct stream *stream)
{
    return (stream->requests[0].number != 0) + (stream->requests[1].number != 0);
}

static bool still_is_outstanding(const struct stream *stream)
{
    return (stream->requests[0].number && stream->requests[0].is_still) ||
           (stream->requests[1].number && stream->requests[1].is_still);
}

static uint32_t n_unshown(const struct member_view *view)
{
    return view->sent_sequence - view->shown_sequence;
}

/* True if any viewer of the stream still has credit beyond the requests in flight. */
static bool has_credit(const struct room *room, const struct stream *stream)
{
    uint32_t coming = (uint32_t)n_outstanding(stream);
    for (const struct member_view *view = stream->viewers; view; view = view->next_viewer)
        if (!view_is_watch(view) && n_unshown(view) + coming < ROOM_MAX_UNSHOWN)
            return true;
    return displays_have_credit(stream, coming, room->now_us) || watches_have_credit(stream, coming, room->now_us);
}

/* Id of the member whose own view it is; NULL: shared, or without a viewer. */
static const char *owner_of(const struct stream *stream)
{
    return stream->is_shared || stream->is_of_wall || !stream->viewers ? NULL : stream->viewers->member->id;
}

/* False: not now, but at retry_us. */
static bool request_picture(struct room *room, struct stream *stream, bool is_still)
{
    if (!stream_scene(room, stream)) {
        stream->retry_us = room->now_us + RETRY_US;
        return false;
    }
    struct request *request = stream->requests[0].number ? &stream->requests[1] : &stream->requests[0];
    *request = (struct request){ .number = ++room->streams.n_requests,
                                 .version = stream->version,
                                 .requested_us = room->now_us,
                                 .is_still = is_still,
                                 .n_outstanding = n_outstanding(stream) + 1 };
    stream->requested_version = stream->version;
    if (!is_still)
        stream->wall_requested_us = room->now_us;
    if (is_still)
        stream->still_requested_version = stream->version;
    struct pace_choice choice = { .scale_percent = 100, .quality = STILL_QUALITY };
    if (!is_still)
        choice = pace_choose(&stream->pace);
    struct room_render render = { .request = request->number,
                                  .view = stream->view,
                                  .scene = stream->scene,
                                  .scene_revision = room->shared.revision,
                                  .scale_percent = choice.scale_percent,
                                  .quality = choice.quality,
                                  .is_still = is_still,
                                  .full_color = is_still,
                                  .coarse = choice.coarse,
                                  .is_acted = stream->acted_us > 0 && room->now_us - stream->acted_us < acted_for_us,
                                  .is_of_wall = stream->is_of_wall,
                                  .is_marked = stream->displays != NULL,
                                  .member = owner_of(stream) };
    size_classes_needed(room, stream, choice.scale_percent, is_still, render.is_reduced);
    room->counters.pictures_requested++;
    room->callbacks.render(room->callbacks.context, room, &render);
    return true;
}

/* Requests the pictures of one stream that are due; returns when to call again, INT64_MAX when only credit or a picture
 * can change that: each comes as an event. */
static int64_t request_due(struct room *room, struct stream *stream)
{
    const int64_t still_due_us = stream->changed_us + still_after_us + (stream->is_of_wall ? WALL_STILL_LATER_US : 0);
    const int most = stream->is_of_wall ? 1 : 2;
    for (;;) {
        bool wants_still = stream->still_requested_version < stream->version,
             wants_moving = stream->requested_version < stream->version;
        if (!wants_still && !wants_moving)
            return INT64_MAX;
        if (!has_credit(room, stream))
            return stream->displays ? room->now_us + DISPLAY_AGAIN_US : INT64_MAX;
        if (room->now_us < stream->retry_us)
            return stream->retry_us;
        if (n_outstanding(stream) >= most)
            return INT64_MAX;
        if (wants_still && room->now_us >= still_due_us && !still_is_outstanding(stream)) {
            if (!request_picture(room, stream, true))
                return stream->retry_us;
            continue;
        }
        if (wants_moving && stream->is_of_wall && room->now_us < wall_due_us(stream))
            return wall_due_us(stream);
        if (wants_moving) {
            /* The second request is made when the first is drawn and being compressed. Made earlier it would wait and
             * show an older state. */
            const struct request *other = stream->requests[0].number ? &stream->requests[0] : &stream->requests[1];
            int64_t worth_us = other->requested_us + (int64_t)stream->pace.render_us;
            if (other->number && !other->is_still && room->now_us < worth_us)
                return worth_us;
            if (!request_picture(room, stream, false))
                return stream->retry_us;
            continue;
        }
        return room->now_us < still_due_us ? still_due_us : INT64_MAX;
    }
}

int64_t streams_request_due(struct room *room)
{
    int64_t again_us = INT64_MAX;
    if (room->renderer.state != WIRE_RENDERER_STATE_READY || !room->shared.scene)
        return again_us;
    for (struct stream *stream = room->streams.first; stream; stream = stream->next) {
        int64_t us = request_due(room, stream);
        again_us = us < again_us ? us : again_us;
    }
    return again_us;
}

/* ---- sending ---------------------------------------------------------------------------------------------------- */

/* A picture of this version is sent: its header reports the newest input it shows, those up to it wait no longer. */
static void mark_inputs_shown(struct member_view *view, uint64_t version)
{
    int n = 0;
    while (n < view->n_waiting && view->waiting[n].version <= version)
        view->input = view->waiting[n++].input;
    view->n_waiting -= n;
    memmove(view->waiting, view->waiting + n, (size_t)view->n_waiting * sizeof view->waiting[0]);
}

/* The newest revision of the scene whose picture is the stream's latest: changes that do not reach it leave it as it
 * is. */
static uint32_t revision_held(const struct room *room, const struct stream *stream)
{
    return stream->latest_version >= stream->scene_version ? room->shared.revision
                                                           : stream->latest->header.scene_revision;
}

/* True if the latest picture shows an input that is not yet reported because it changed nothing: the picture is sent
 * once more to report it. */
static bool shows_waiting_input(const struct stream *stream, const struct member_view *view)
{
    return view->n_waiting > 0 && view->waiting[0].version <= stream->latest_version;
}

static bool is_refused(const struct stream *stream)
{
    return stream->refused_version > 0 && stream->refused_version == stream->version;
}

void stream_send_picture(struct room *room, struct member *member, struct member_view *view)
{
    struct stream *stream = view->stream;
    if (!stream || !stream->latest || n_unshown(view) >= ROOM_MAX_UNSHOWN || !member->connection)
        return;
    if (is_refused(stream)) /* texts overtake pictures, and viewers take a picture as the end of a refusal */
        return;
    struct frame *picture = size_class_picture(room, view, stream->latest, stream->latest_is_still);
    if (view->sent_number == stream->latest_number && view->sent_width_px >= picture->header.width_px &&
        !shows_waiting_input(stream, view))
        return;
    if (view_is_watch(view) && !watch_has_turn(room, view, picture->n_bytes))
        return;
    int index = (int)(view - member->views);
    if (view->has_moved) {
        view->has_moved = false;
        send_view(room, member, index, view->moved_by);
    }
    if (!cJSON_Compare(view->missing, stream->latest->missing, true) && (view->missing || stream->latest->missing)) {
        cJSON_Delete(view->missing);
        view->missing = cJSON_Duplicate(stream->latest->missing, true);
        send_missing(room, member, index, view->missing);
    }
    mark_inputs_shown(view, stream->latest_version);
    view->sent_number = stream->latest_number;
    view->sent_width_px = picture->header.width_px;
    view->sent_sequence++;
    view->sent[view->sent_sequence % ROOM_MAX_UNSHOWN].sent_us = room->now_us;
    view->sent[view->sent_sequence % ROOM_MAX_UNSHOWN].is_still = stream->latest_is_still;
    struct frame_header header = picture->header;
    header.view = (uint32_t)index + 1;
    header.sequence = view->sent_sequence;
    header.input_id = view->input;
    header.scene_revision = revision_held(room, stream);
    if (stream->is_shared || stream->is_of_wall)
        header.flags |= FRAME_SHARED;
    room->counters.frames_sent++;
    room->counters.frame_bytes += picture->n_bytes;
    room->counters.stills_sent += stream->latest_is_still;
    watch_count(room, view, picture->n_bytes);
    room->callbacks.send_frame(room->callbacks.context, member->connection, &header, picture);
}

void stream_send_watch(struct room *room, struct member *member)
{
    stream_send_picture(room, member, &member->views[ROOM_WATCH - 1]);
}

int64_t streams_send_watches(struct room *room)
{
    for (int i = 0; i < room->members.n; i++)
        stream_send_watch(room, room->members.list[i]);
    return INT64_MAX;
}

static void send_to_subscribers(struct room *room, struct stream *stream)
{
    for (struct member_view *view = stream->viewers; view; view = view->next_viewer) {
        if (n_unshown(view) >= ROOM_MAX_UNSHOWN)
            room->counters.frames_skipped++; /* the viewer gets the newest picture when its credit returns */
        stream_send_picture(room, view->member, view);
    }
    displays_send(room, stream);
}

static struct member_view *find_least_lagging(const struct stream *stream)
{
    struct member_view *least = NULL;
    for (struct member_view *view = stream->viewers; view; view = view->next_viewer)
        if (view->lag_least_us && (!least || view->lag_excess_us < least->lag_excess_us))
            least = view;
    return least;
}

/* The viewer with the best link decides: one slow member must not make the picture worse for others. All are looked at
 * only when that one's own lag was measured anew, in view. */
static void measure_lag(struct stream *stream, struct member_view *view)
{
    if (!stream->least_lagging || stream->least_lagging == view)
        stream->least_lagging = find_least_lagging(stream);
    else if (view->lag_excess_us < stream->least_lagging->lag_excess_us)
        stream->least_lagging = view;
    if (stream->least_lagging)
        pace_lagged(&stream->pace, stream->least_lagging->lag_excess_us);
}

void stream_acknowledged(struct room *room, struct member_view *view, uint32_t sequence)
{
    int64_t sent_us = view->sent[sequence % ROOM_MAX_UNSHOWN].sent_us;
    bool was_still = view->sent[sequence % ROOM_MAX_UNSHOWN].is_still;
    view->shown_sequence = sequence;
    if (was_still || !view->stream || view_is_watch(view))
        return; /* a still is larger than the pictures that pace the link; those of watch pace nothing */
    int64_t lag_us = room->now_us - sent_us + 1;
    if (view->lag_least_us == 0 || lag_us < view->lag_least_us)
        view->lag_least_us = lag_us;
    else
        view->lag_least_us += (lag_us - view->lag_least_us) / 256; /* follows a link that became slower */
    view->lag_excess_us = lag_us - view->lag_least_us;
    measure_lag(view->stream, view);
}

/* ---- answers ---------------------------------------------------------------------------------------------------- */

static struct stream *remove_request(struct room *room, uint64_t number, struct request *request)
{
    for (struct stream *stream = room->streams.first; stream && number; stream = stream->next)
        for (int i = 0; i < 2; i++)
            if (stream->requests[i].number == number) {
                *request = stream->requests[i];
                stream->requests[i].number = 0;
                return stream;
            }
    return NULL;
}

/* A newer version replaces an older one; of one version, a still replaces a moving picture. */
static bool is_newer(const struct stream *stream, const struct request *request)
{
    if (request->version != stream->latest_version)
        return request->version > stream->latest_version;
    return request->is_still || !stream->latest_is_still;
}

static bool newer_is_coming(const struct stream *stream, uint64_t version)
{
    return (stream->requests[0].number && stream->requests[0].version > version) ||
           (stream->requests[1].number && stream->requests[1].version > version);
}

void streams_picture_came(struct room *room, uint64_t number, struct frame *picture)
{
    struct request request;
    const int64_t now_us = room->now_us;
    struct stream *stream = remove_request(room, number, &request);
    if (!stream) {
        frame_unref(picture);
        return;
    }
    stream->n_failed = 0;
    stream->retry_us = 0;
    if (!request.is_still && !still_is_outstanding(stream))
        pace_drawn(&stream->pace, picture->header.render_us, picture->header.encode_us, now_us - request.requested_us,
                   request.n_outstanding, now_us);
    /* the viewer moved on while the still was drawn: it would only delay the moving picture that is coming */
    bool is_overtaken = request.is_still && newer_is_coming(stream, request.version);
    is_overtaken |= request.version < stream->refused_version; /* viewers take a picture as the end of a refusal */
    if (is_newer(stream, &request) && !is_overtaken) {
        frame_unref(stream->latest);
        stream->latest = picture;
        stream->latest_number = request.number;
        stream->latest_version = request.version;
        stream->latest_is_still = request.is_still;
        stream->behind_us = request.version < stream->version ? now_us : 0;
        send_to_subscribers(room, stream);
    } else {
        frame_unref(picture);
    }
}

void stream_send_refusal(struct room *room, struct member *member, const struct member_view *view)
{
    if (is_refused(view->stream) && member->connection)
        (void)send_problem(room, member->connection, "", view - member->views + 1, 0, &view->stream->refusal);
}

/* True for failures that a second try would repeat: an invalid field, a picture too large for the memory, a fixed
 * limit. A limit on how much may wait is not fixed: it has a retry_after_ms. */
static bool is_final(const struct problem *problem)
{
    return problem && (problem->type == PROBLEM_VALIDATION || problem->type == PROBLEM_MEMORY ||
                       (problem->type == PROBLEM_LIMIT && problem->retry_after_ms == 0));
}

/* Sends the problem to the viewers, and requests no more until the version changes. */
static void refuse_version(struct room *room, struct stream *stream, uint64_t version, const struct problem *problem)
{
    if (stream->still_requested_version < version)
        stream->still_requested_version = version;
    if (stream->refused_version >= version)
        return; /* the viewers were sent it, for this version or a newer one */
    stream->refused_version = version;
    stream->refusal = *problem;
    for (const struct member_view *view = stream->viewers; view; view = view->next_viewer)
        if (view->member->connection && !view_is_watch(view))
            (void)send_problem(room, view->member->connection, "", view - view->member->views + 1, 0, problem);
}

void streams_picture_failed(struct room *room, uint64_t number, const struct problem *problem)
{
    struct request request;
    struct stream *stream = remove_request(room, number, &request);
    if (!stream)
        return;
    log_warn("room %s: a picture failed: %s", room->id, problem ? problem->detail : "no reason given");
    if (is_final(problem)) {
        refuse_version(room, stream, request.version, problem);
        return;
    }
    /* Request again, but not at once: a picture that fails every time must not keep the renderer busy. One that a busy
     * renderer did not take is requested again before others have had many pictures each. */
    const int most = problem && problem->type == PROBLEM_BUSY ? 2 : 6;
    int64_t wait_us = RETRY_US << (stream->n_failed < most ? stream->n_failed : most);
    stream->n_failed++;
    stream->retry_us = room->now_us + (wait_us < RETRY_AT_MOST_US ? wait_us : RETRY_AT_MOST_US);
    if (request.is_still && stream->still_requested_version == request.version)
        stream->still_requested_version = 0;
    bool other_will_do = (stream->requests[0].number && stream->requests[0].version >= request.version) ||
                         (stream->requests[1].number && stream->requests[1].version >= request.version);
    if (stream->requested_version == request.version && !other_will_do && stream->latest_version < request.version)
        stream->requested_version = 0;
}
