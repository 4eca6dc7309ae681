/* One opened plan on one socket: packets in, events of other threads in, packets out. */
#include "server/renderer/session.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/renderer/answers.h"
#include "server/renderer/pictures.h"
#include "server/wire/plan_document.h"

enum { LAST_PACKETS_MS = 1000, STATEMENT_MS = 10000 };

struct session {
    const struct session_options *options;
    struct link *link;
    struct inbox *inbox;
    struct pipeline *pipeline;
    struct loader *loader;
    struct scenes *scenes;
    struct pictures *pictures;
    struct plan *plan;      /* NULL until it is loaded */
    struct derive *derived; /* the plan's store */
    char seen[65];          /* patients_seen of it */
    bool is_built, has_gl, is_ready;
    int64_t began_us;
    int status; /* exit status; -1: go on */
};

/* ---- to the daemon ---------------------------------------------------------------------------------------------- */

static void send_failed(struct session *session, const struct error *err)
{
    struct problem problem;
    problem_from_error(&problem, err);
    link_send_failed(session->link, &problem);
    log_warn("the plan cannot be read: %s", err->text);
    session->status = SESSION_UNREADABLE;
}

static int64_t resident_bytes(void)
{
    unsigned long long all = 0, resident = 0;
    FILE *file = fopen("/proc/self/statm", "re");
    if (!file)
        return 0;
    char text[128];
    if (!fgets(text, sizeof text, file) || sscanf(text, "%llu %llu", &all, &resident) != 2)
        resident = 0;
    fclose(file);
    return (int64_t)resident * 4096;
}

static void send_ready_once(struct session *session)
{
    if (session->is_ready || !session->plan || !session->is_built || !session->has_gl)
        return;
    session->is_ready = true;
    cJSON *document = plan_document(session->plan);
    struct packet packet;
    packet_init(&packet, PACKET_READY);
    packet.ready.plan = document;
    packet.ready.scene = scenes_default(session->scenes);
    packet_put_text(packet.ready.confined, sizeof packet.ready.confined, session->options->confined);
    packet_put_text(packet.ready.patients, sizeof packet.ready.patients, session->seen);
    packet.ready.memory_bytes = resident_bytes();
    packet.ready.load_ms = (clock_now_us() - session->began_us) / 1000;
    link_send(session->link, &packet, NULL, 0);
    cJSON_Delete(document);
    pictures_warm_up(session->pictures);
}

static void send_answer(struct session *session, int64_t id, const cJSON *body, const uint8_t *blob, size_t n_blob)
{
    struct packet packet;
    packet_init(&packet, PACKET_ANSWER);
    packet.answer.id = id;
    packet.answer.body = body;
    link_send(session->link, &packet, blob, n_blob);
}

/* ---- packets from the daemon ------------------------------------------------------------------------------------ */

static void refuse_busy(struct session *session, int64_t id, const char *why)
{
    struct problem problem;
    problem_set(&problem, PROBLEM_BUSY, "", "", "%s", why);
    problem.retry_after_ms = 500;
    link_send_problem(session->link, id, &problem);
}

/* Hands a question to the thread that answers it. Takes packet's contents. */
static void start_answer(struct session *session, struct packet *packet)
{
    const struct packet_snapshot *shown = packet_snapshot_of(packet);
    int64_t id = packet_id(packet);
    struct snapshot *snapshot = NULL;
    struct problem problem;
    uint32_t scene_revision;
    if (shown && !(snapshot = scenes_snapshot(session->scenes, shown, &scene_revision, &problem)))
        link_send_problem(session->link, id, &problem);
    else if (!loader_answer(session->loader, question_create(packet, snapshot)))
        refuse_busy(session, id, "too many questions wait for an answer");
}

static void put_scene(struct session *session, struct packet *packet)
{
    cJSON *scene = packet_take_document(packet, packet->scene.scene);
    cJSON *acceptances = packet_take_document(packet, packet->scene.acceptances);
    if (!scenes_put_room(session->scenes, packet->scene.room, (uint32_t)packet->scene.revision, scene, acceptances))
        log_error("no place for the scene of another room");
}

static void handle_packet(struct session *session, struct packet *packet)
{
    const struct packet_description *description = &packet_descriptions[packet->type];
    if (description->is_request && !session->is_ready) {
        refuse_busy(session, packet_id(packet), "the plan is still being read");
        return;
    }
    if (description->question) {
        start_answer(session, packet);
        return;
    }
    switch (packet->type) {
    case PACKET_PING: {
        struct packet pong;
        packet_init(&pong, PACKET_PONG);
        link_send(session->link, &pong, NULL, 0);
        break;
    }
    case PACKET_SCENE: put_scene(session, packet); break;
    case PACKET_FORGET: scenes_forget_room(session->scenes, packet->forget.room); break;
    case PACKET_DROP: pictures_drop(session->pictures, &packet->drop); break;
    case PACKET_RENDER: pictures_start(session->pictures, &packet->render); break;
    case PACKET_AWAIT_READY: {
        cJSON *body = cJSON_CreateObject();
        send_answer(session, packet->await_ready.id, body, NULL, 0);
        cJSON_Delete(body);
        break;
    }
    default: log_error("a packet \"%s\" is not handled", description->name);
    }
}

/* ---- events of other threads ------------------------------------------------------------------------------------ */

static void gl_started(void *context, const struct render_facts *facts, const struct error *err)
{
    struct inbox_event event = { .type = INBOX_GL_STARTED };
    if (facts)
        event.facts = *facts;
    else
        event.error = *err;
    inbox_put(context, &event);
}

static void frame_encoded(void *context, struct pipeline_frame *frame)
{
    struct inbox_event event = { .type = INBOX_FRAME, .frame = *frame };
    frame->picture = (struct encoded){ 0 };
    memset(frame->reduced, 0, sizeof frame->reduced);
    frame->marked = (struct encoded){ 0 };
    inbox_put(context, &event);
}

static void send_gl(struct session *session, const struct inbox_event *event)
{
    struct packet packet;
    packet_init(&packet, PACKET_GL);
    struct packet_gl *gl = &packet.gl;
    session->has_gl = true;
    if (event->error.code == ERROR_NONE) {
        const char *back_end = session->options->is_stub ? "stub" : render_back_end_word(event->facts.back_end);
        packet_put_text(gl->back_end, sizeof gl->back_end, back_end);
        packet_put_text(gl->vendor, sizeof gl->vendor, event->facts.vendor);
        packet_put_text(gl->renderer, sizeof gl->renderer, event->facts.renderer);
        packet_put_text(gl->version, sizeof gl->version, event->facts.version);
        packet_put_text(gl->confined, sizeof gl->confined, session->options->confined);
        gl->is_software = event->facts.is_software;
    } else {
        problem_set(&gl->problem, PROBLEM_GL_UNAVAILABLE, "", "", "%s", event->error.text);
        pictures_refuse_all(session->pictures, &gl->problem);
        log_warn("nothing can be drawn: %s", event->error.text);
    }
    link_send(session->link, &packet, NULL, 0);
}

static void send_progress(struct session *session, const struct inbox_event *event)
{
    struct packet packet;
    if (session->is_ready)
        return;
    packet_init(&packet, PACKET_PROGRESS);
    packet_put_text(packet.progress.phase, sizeof packet.progress.phase, event->phase);
    packet.progress.percent = fmax(0, fmin(100, event->percent));
    link_send(session->link, &packet, NULL, 0);
}

static void handle_event(struct session *session, struct inbox_event *event)
{
    switch (event->type) {
    case INBOX_GL_STARTED: send_gl(session, event); break;
    case INBOX_PROGRESS: send_progress(session, event); break;
    case INBOX_LOADED:
        session->plan = event->plan;
        session->derived = event->derived;
        mem_put_text(session->seen, sizeof session->seen, event->seen);
        event->plan = NULL;
        event->derived = NULL;
        scenes_set_plan(session->scenes, session->derived);
        if (!scenes_default(session->scenes))
            send_failed(session, &(struct error){ ERROR_MEMORY, "no memory for the scene of the plan" });
        break;
    case INBOX_LOAD_FAILED: send_failed(session, &event->error); break;
    case INBOX_BUILT: session->is_built = true; break;
    case INBOX_FRAME: pictures_send_frame(session->pictures, &event->frame); break;
    case INBOX_SHAPES_BUILT:
        pictures_shapes_built(session->pictures, event->waiting);
        event->waiting = NULL;
        break;
    case INBOX_ANSWER:
        if (event->body)
            send_answer(session, event->id, event->body, event->blob, event->n_blob);
        else
            link_send_problem(session->link, event->id, &event->problem);
        break;
    }
    send_ready_once(session);
}

/* ---- the loop --------------------------------------------------------------------------------------------------- */

static void loop(struct session *session)
{
    while (session->status < 0) {
        short wanted = (short)(POLLIN | (link_has_outgoing(session->link) ? POLLOUT : 0));
        struct pollfd polled[2] = { { .fd = link_file(session->link), .events = wanted },
                                    { .fd = inbox_wake_fd(session->inbox), .events = POLLIN } };
        if (poll(polled, 2, -1) < 0 && errno != EINTR) {
            session->status = SESSION_BROKEN;
            return;
        }
        mem_keep_reserve();
        link_write(session->link);
        if ((polled[0].revents & ~POLLOUT) && !link_read(session->link))
            session->status = SESSION_DONE;
        struct packet packet;
        int got = 0;
        while (session->status < 0 && (got = link_take(session->link, &packet)) > 0) {
            handle_packet(session, &packet);
            packet_finish(&packet);
        }
        if (got < 0)
            session->status = SESSION_BROKEN;
        for (struct inbox_event *event; session->status < 0 && (event = inbox_take(session->inbox));) {
            handle_event(session, event);
            inbox_event_destroy(event);
        }
    }
}

/* Waits for the packet that the daemon sends with the start of the process. */
static bool read_statement(struct session *session, struct packet_statement *statement, struct error *err)
{
    struct pollfd polled = { .fd = link_file(session->link), .events = POLLIN };
    const int64_t until_us = clock_now_us() + STATEMENT_MS * INT64_C(1000);
    struct packet packet;
    int got = 0;
    while (got == 0 && clock_now_us() < until_us && (poll(&polled, 1, STATEMENT_MS) >= 0 || errno == EINTR)) {
        if (polled.revents && !link_read(session->link))
            break;
        got = link_take(session->link, &packet);
    }
    if (got <= 0)
        return error_set(err, ERROR_IO, "no packet \"statement\" came");
    const bool is_one = packet.type == PACKET_STATEMENT;
    if (is_one)
        *statement = packet.statement;
    packet_finish(&packet);
    return is_one || error_set(err, ERROR_IO, "another packet came before \"statement\"");
}

static bool start(struct session *session, struct error *err)
{
    const struct session_options *options = session->options;
    struct packet_statement statement;
    if (options->awaits_statement && !read_statement(session, &statement, err))
        return false;
    session->inbox = inbox_create();
    if (!session->inbox)
        return error_set(err, ERROR_IO, "no file to wait on: %s", strerror(errno));
    struct pipeline_callbacks callbacks = { gl_started, frame_encoded, session->inbox };
    session->pipeline = pipeline_create(options->back_end, options->is_stub, &callbacks, err);
    if (!session->pipeline)
        return false;
    struct loader_options load = { options->plan_folder,
                                   options->plan_id,
                                   options->max_bytes,
                                   options->cache,
                                   options->hides_folder,
                                   options->awaits_statement ? &statement : NULL,
                                   0 };
    session->loader = loader_create(&load, session->inbox, err);
    if (!session->loader)
        return false;
    session->pictures = pictures_create(
        &(struct pictures_options){ session->link, session->pipeline, session->loader, session->scenes });
    return true;
}

int session_run(const struct session_options *options)
{
    struct session session = { .options = options, .status = -1, .began_us = clock_now_us() };
    struct error err = { 0 };
    session.link = link_create(options->socket, options->max_bytes);
    session.scenes = scenes_create();
    if (start(&session, &err))
        loop(&session);
    else
        send_failed(&session, &err);
    link_flush(session.link, LAST_PACKETS_MS);

    loader_destroy(session.loader);
    if (session.pipeline)
        pipeline_destroy(session.pipeline);
    pictures_destroy(session.pictures);
    inbox_destroy(session.inbox);
    scenes_destroy(session.scenes);
    derive_destroy(session.derived);
    plan_destroy(session.plan);
    link_destroy(session.link);
    return session.status < 0 ? SESSION_BROKEN : session.status;
}
