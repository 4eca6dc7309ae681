/* Random meetings against a simple model of who presents, follows and looks on their own. After each act: every view
 * shows what the model says, nobody's picture has moved but by the presenter or by that person, and the list of members
 * is told as it is. */
#include <math.h>
#include <stdarg.h>

#include "server/room/state/room_state.h"
#include "server/room/streams/stream.h"
#include "server/wire/json_merge.h"
#include "tests/unit/meeting_model.h"
#include "tests/unit/room_fake.h"

enum { N_SEEDS = 150, N_STEPS = 120 };
static const char *const kind_words[N_PANE_KINDS] = { "3d", "axial", "coronal", "sagittal", "3d" };
static int number_of(int kind)
{
    return kind == SECOND_3D ? 2 : 1;
}
static const char *const slice_words[N_SLICES] = { "axial", "coronal", "sagittal" };

static struct person {
    struct fake_page page;
    char id[64], secret[64];
    cJSON *heard[N_PANES]; /* document of the last view message */
} people[N_PEOPLE];

static struct fake_room fake;
static struct meeting meeting;

/* ---- comparing -------------------------------------------------------------------------------------------------- */

static char act[600]; /* the last one, with seed and step: told when something differs */

static void differs(const char *format, ...)
{
    char text[300];
    va_list args;
    va_start(args, format);
    (void)vsnprintf(text, sizeof text, format, args);
    va_end(args);
    fail_msg("%s: after %s", text, act);
}

static struct member *member_of(int who)
{
    for (int m = 0; m < fake.room->members.n; m++)
        if (meeting.seats[who].is_member && strcmp(fake.room->members.list[m]->id, people[who].id) == 0)
            return fake.room->members.list[m];
    return NULL;
}

/* The scene that requests of the stream show. */
static const cJSON *scene_of(struct stream *stream)
{
    const cJSON *scene = stream_scene(fake.room, stream);
    assert_non_null(scene);
    return scene;
}

static double slice_mm(const cJSON *scene, int i)
{
    const cJSON *slices = cJSON_GetObjectItem(cJSON_GetObjectItem(scene, "image"), "slices");
    return json_number(cJSON_GetObjectItem(slices, slice_words[i]), "position_mm", NAN);
}

static bool is_same(double a, double b)
{
    return (isnan(a) && isnan(b)) || fabs(a - b) < 1e-9;
}

static double or_scene(double override, double scene)
{
    return isnan(override) ? scene : override;
}

static void check_pane(int who, int p)
{
    struct pane *pane = &meeting.seats[who].panes[p];
    const struct member_view *view = &member_of(who)->views[p];
    if (pane->is_open != (view->stream != NULL))
        differs("%d's pane %d is %s", who, p, pane->is_open ? "closed" : "open");
    if (!pane->is_open)
        return;
    const struct shown *expected = shown_in(&meeting, pane);
    const cJSON *document = view->stream->view, *camera = cJSON_GetObjectItem(document, "camera");
    const cJSON *target = cJSON_GetObjectItem(camera, "target_mm"), *size = cJSON_GetObjectItem(document, "size_px");
    const cJSON *scene = scene_of(view->stream);
    double x = cJSON_IsArray(target) ? cJSON_GetArrayItem(target, 0)->valuedouble : NAN;
    if (view->is_following != pane->is_following || view->stream->is_shared != pane->is_following)
        differs("%d's pane %d shows the %s view", who, p, view->is_following ? "shared" : "own");
    if (strcmp(json_text(document, "kind"), kind_words[pane->kind]) != 0)
        differs("%d's pane %d is %s, not %s", who, p, json_text(document, "kind"), kind_words[pane->kind]);
    if (json_number(document, "number", NAN) != number_of(pane->kind))
        differs("%d's pane %d has number %g", who, p, json_number(document, "number", NAN));
    for (int i = 0; i < 2; i++)
        if (cJSON_GetArrayItem(size, i)->valueint != expected->size_px[i])
            differs("side %d of %d's pane %d is %d px, not %d", i, who, p, cJSON_GetArrayItem(size, i)->valueint,
                    expected->size_px[i]);
    if (!pane->is_following && memcmp(expected->size_px, pane->own_px, sizeof pane->own_px) != 0)
        differs("the model itself: the size of %d's own pane %d", who, p);
    if (!is_same(x, expected->target_x_mm))
        differs("%d's pane %d looks at %g, not at %g", who, p, x, expected->target_x_mm);
    if (!is_same(json_number(camera, "height_mm", NAN), expected->height_mm))
        differs("%d's pane %d is %.12g mm high, not %.12g", who, p, json_number(camera, "height_mm", NAN),
                expected->height_mm);
    for (int i = 0; i < N_SLICES; i++)
        if (!is_same(slice_mm(scene, i), or_scene(expected->slices_mm[i], meeting.slices_mm[i])))
            differs("%d's pane %d has the %s slice at %g, not at %g", who, p, slice_words[i], slice_mm(scene, i),
                    or_scene(expected->slices_mm[i], meeting.slices_mm[i]));
    double opacity = json_number(cJSON_GetObjectItem(cJSON_GetObjectItem(scene, "regions"), "scalp"), "opacity", NAN);
    if (!is_same(opacity, or_scene(expected->opacity, meeting.opacity)))
        differs("%d's pane %d has opacity %g, not %g", who, p, opacity, or_scene(expected->opacity, meeting.opacity));
}

/* The last list of members that this page was sent is true now. */
static void check_members_heard(int listener)
{
    cJSON *said = fake_heard(&people[listener].page, "members");
    const cJSON *item;
    int n_presenting = 0, n = 0;
    cJSON_ArrayForEach(item, cJSON_GetObjectItem(said, "members"))
    {
        n_presenting += json_flag(item, "presenting", false);
        for (int who = 0; who < N_PEOPLE; who++)
            if (meeting.seats[who].is_member && strcmp(json_text(item, "id"), people[who].id) == 0) {
                n++;
                if (json_flag(item, "presenting", false) != (who == meeting.presenter) ||
                    json_flag(item, "following", false) != meeting_follows(&meeting, who) ||
                    json_flag(item, "connected", false) != meeting.seats[who].is_connected)
                    differs("%d is told of %d: presenting %d, following %d, connected %d", listener, who,
                            json_flag(item, "presenting", false), json_flag(item, "following", false),
                            json_flag(item, "connected", false));
            }
    }
    if (n_presenting > 1 || n != fake.room->members.n)
        differs("%d is told of %d members of %d, %d present", listener, n, fake.room->members.n, n_presenting);
    cJSON_Delete(said);
}

static void check(void)
{
    for (int who = 0; who < N_PEOPLE; who++) {
        const struct seat *seat = &meeting.seats[who];
        const struct member *member = member_of(who);
        if (seat->is_member != (member != NULL) || (member && seat->is_connected != (member->connection != NULL)))
            differs("%d is %s", who, member ? "a member" : "no member");
        if (member && (fake.room->presenter == member) != (who == meeting.presenter))
            differs("%d %s", who, who == meeting.presenter ? "does not present" : "presents");
        for (int p = 0; p < N_PANES && seat->is_connected; p++)
            check_pane(who, p);
        if (seat->is_connected)
            check_members_heard(who);
    }
    if (meeting.presenter >= 0 && !meeting.seats[meeting.presenter].is_connected &&
        (double)fake.now_us - meeting.seats[meeting.presenter].away_us >= ROOM_PRESENTER_KEPT_S * 1e6)
        differs("the presenter is away for long");
}

/* ---- nobody's picture is moved by others, without the model ---------------------------------------------------- */

static char *pictures[N_PEOPLE][N_PANES]; /* all that a request says; NULL: closed */

static char *picture_of(int who, int p)
{
    struct member *member = meeting.seats[who].is_connected ? member_of(who) : NULL;
    if (!member || !member->views[p].stream)
        return NULL;
    char *view = json_write(member->views[p].stream->view), *scene = json_write(scene_of(member->views[p].stream));
    size_t n = strlen(view) + strlen(scene) + 2;
    char *both = malloc(n);
    assert_non_null(both);
    (void)snprintf(both, n, "%s %s", view, scene);
    free(view);
    free(scene);
    return both;
}

static void remember_pictures(void)
{
    for (int who = 0; who < N_PEOPLE; who++)
        for (int p = 0; p < N_PANES; p++) {
            free(pictures[who][p]);
            pictures[who][p] = picture_of(who, p);
        }
}

/* actor: who acted; -1: only time passed. before: who presented. */
static void check_nobody_was_moved(int actor, int before)
{
    for (int who = 0; who < N_PEOPLE; who++)
        for (int p = 0; p < N_PANES; p++) {
            char *now = picture_of(who, p);
            bool may_move = who == actor || (actor >= 0 && actor == meeting.presenter) ||
                            (who == meeting.presenter && before != meeting.presenter); /* alone in the room */
            if (now && pictures[who][p] && !may_move && strcmp(now, pictures[who][p]) != 0)
                differs("%d's pane %d moved, who presented: %d\nfrom %s\nto   %s", who, p, before, pictures[who][p],
                        now);
            free(now);
        }
}

/* ---- pages ------------------------------------------------------------------------------------------------------ */

static uint64_t random_state;

static int any(int n) /* 0 to n - 1; xorshift64 */
{
    random_state ^= random_state << 13;
    random_state ^= random_state >> 7;
    random_state ^= random_state << 17;
    return (int)(random_state % (uint64_t)n);
}

/* Keeps the last view messages, acknowledges the frames, and empties the page but for the last list of members. */
static void read_page(struct person *person)
{
    struct fake_page *page = &person->page;
    char *members = NULL;
    for (size_t i = 0; i < page->n_texts; i++) {
        cJSON *json = json_read(page->texts[i], strlen(page->texts[i]), NULL);
        if (strcmp(json_text(json, "type"), "view") == 0) {
            int p = (int)json_number(json, "view", 0) - 1;
            cJSON_Delete(person->heard[p]);
            person->heard[p] = cJSON_DetachItemFromObject(json, "document");
        }
        if (strcmp(json_text(json, "type"), "members") == 0) {
            free(members);
            members = page->texts[i];
        } else {
            free(page->texts[i]);
        }
        cJSON_Delete(json);
    }
    page->n_texts = 0;
    if (members)
        page->texts[page->n_texts++] = members;
}

static void forget_page(struct person *person)
{
    for (int p = 0; p < N_PANES; p++) {
        cJSON_Delete(person->heard[p]);
        person->heard[p] = NULL;
    }
    fake_page_end(&person->page);
}

/* Answers all requests and shows all frames until nothing is due. */
static void draw_all(void)
{
    for (bool is_busy = true; is_busy;) {
        is_busy = false;
        for (struct fake_request *request; (request = fake_oldest(&fake)); is_busy = true)
            fake_draw(&fake, request);
        for (int who = 0; who < N_PEOPLE; who++) {
            struct fake_page *page = &people[who].page;
            for (size_t i = 0; i < page->n_frames; i++)
                fake_say(&fake, page, "{\"type\":\"frame.shown\",\"view\":%u,\"sequence\":%u}", page->frames[i].view,
                         page->frames[i].sequence);
            is_busy = is_busy || page->n_frames;
            page->n_frames = 0;
        }
        if (!is_busy && fake.again_us < fake.now_us + 1000000) { /* a still is due */
            fake_pass(&fake, 200);
            is_busy = true;
        }
    }
}

static void forget_requests(void)
{
    size_t n = 0;
    for (size_t i = 0; i < fake.n_requests; i++) {
        struct fake_request *request = &fake.requests[i];
        if (!request->is_answered && !request->is_forgotten) {
            fake.requests[n++] = *request;
            continue;
        }
        cJSON_Delete(request->view);
        cJSON_Delete(request->scene);
    }
    fake.n_requests = n;
}

/* With every picture drawn: the last request of each stream was for what its viewers are to see, and followers have
 * the document that belongs to it. */
static void check_drawn(void)
{
    draw_all();
    for (int who = 0; who < N_PEOPLE; who++)
        read_page(&people[who]);
    for (int who = 0; who < N_PEOPLE; who++)
        for (int p = 0; p < N_PANES && meeting.seats[who].is_connected; p++) {
            struct stream *stream = member_of(who)->views[p].stream;
            if (!stream)
                continue;
            if (stream->latest_version != stream->version || !stream->latest_is_still)
                differs("%d's pane %d is not drawn to the end", who, p);
            for (size_t i = 0; i < fake.n_requests; i++)
                if (fake.requests[i].request == stream->latest_number &&
                    (!json_equal(fake.requests[i].view, stream->view) ||
                     (fake.requests[i].scene && !json_equal(fake.requests[i].scene, scene_of(stream)))))
                    differs("%d's pane %d was drawn otherwise", who, p);
            if (meeting.seats[who].panes[p].is_following && who != meeting.presenter &&
                !json_equal(people[who].heard[p], stream->view))
                differs("%d follows with pane %d, and was told another document", who, p);
        }
    forget_requests();
}

/* ---- acts ------------------------------------------------------------------------------------------------------- */

static const char *expected; /* type of the problem that the act is to be refused with; NULL: it is accepted */

static void say(int who, const char *format, ...) PRINTF_LIKE(2, 3);
static void say(int who, const char *format, ...)
{
    char text[500];
    va_list args;
    va_start(args, format);
    (void)vsnprintf(text, sizeof text, format, args);
    va_end(args);
    size_t n = strlen(act);
    (void)snprintf(act + n, sizeof act - n, " %d says %s", who, text);
    size_t before = fake_n_heard(&people[who].page, "problem");
    fake_say(&fake, &people[who].page, "%s", text);
    if (fake_n_heard(&people[who].page, "problem") != before + (expected != NULL))
        differs(expected ? "not refused" : "refused");
    cJSON *problem = expected ? fake_heard(&people[who].page, "problem") : NULL;
    if (expected && strcmp(json_text(cJSON_GetObjectItem(problem, "problem"), "type"), expected) != 0)
        differs("refused as %s, not %s", json_text(cJSON_GetObjectItem(problem, "problem"), "type"), expected);
    cJSON_Delete(problem);
}

static void enter(int who)
{
    struct person *person = &people[who];
    forget_page(person);
    fake_say(&fake, &person->page, "{\"type\":\"hello\",\"protocol\":2,\"member\":\"%s\",\"secret\":\"%s\"}",
             person->id, person->secret);
    cJSON *welcome = fake_heard(&person->page, "welcome");
    bool was_here = person->id[0] != 0; /* also one who left the list of members comes back as the same */
    if (was_here != (strcmp(person->id, json_text(welcome, "member")) == 0))
        differs("%d came back as %s, was %s", who, json_text(welcome, "member"), person->id);
    (void)snprintf(person->id, sizeof person->id, "%s", json_text(welcome, "member"));
    (void)snprintf(person->secret, sizeof person->secret, "%s", json_text(welcome, "secret"));
    cJSON_Delete(welcome);
    meeting.seats[who].is_member = meeting.seats[who].is_connected = true;
}

static void lose_link(int who)
{
    struct person *person = &people[who];
    room_connection_closed(fake.room, &person->page, fake.now_us);
    forget_page(person);
    meeting_lose(&meeting, who, (double)fake.now_us);
    fake.again_us = room_settle(fake.room, fake.now_us);
}

static void any_size(int size_px[2])
{
    static const int sizes[][2] = { { 800, 600 }, { 300, 400 }, { 1280, 720 }, { 64, 64 }, { 500, 300 } };
    memcpy(size_px, sizes[any(5)], 2 * sizeof *size_px);
}

/* A random document as text and as shown. */
static struct shown any_document(int kind, char text[300])
{
    int size_px[2];
    any_size(size_px);
    struct shown shown = plain_view(size_px);
    shown.target_x_mm = any(100);
    shown.height_mm = 50 + any(100);
    shown.is_parallel = any(2);
    int n = snprintf(
        text, 300,
        "{\"kind\":\"%s\",\"number\":%d,\"size_px\":[%d,%d],\"camera\":{\"target_mm\":[%g,0,0],\"height_mm\":%g,"
        "\"projection\":\"%s\"}",
        kind_words[kind], number_of(kind), size_px[0], size_px[1], shown.target_x_mm, shown.height_mm,
        shown.is_parallel ? "parallel" : "perspective");
    if (any(3) == 0) {
        shown.slices_mm[1] = any(50);
        shown.opacity = any(4) / 4.0;
        n += snprintf(text + n, 300 - (size_t)n,
                      ",\"override\":{\"image\":{\"slices\":{\"coronal\":{\"position_mm\":%g}}},"
                      "\"regions\":{\"scalp\":{\"opacity\":%g}}}",
                      shown.slices_mm[1], shown.opacity);
    }
    (void)snprintf(text + n, 300 - (size_t)n, "}");
    return shown;
}

static void open_pane(int who, int p)
{
    char text[300];
    struct pane *pane = &meeting.seats[who].panes[p];
    int kind = any(N_PANE_KINDS);
    bool follow = any(4) != 0;
    struct shown document = any_document(kind, text);
    *pane = own_pane(kind, document);
    if (follow)
        meeting_join(&meeting, who, pane, document);
    say(who, "{\"type\":\"view.open\",\"view\":%d,\"document\":%s,\"follow\":%s}", p + 1, text,
        follow ? "true" : "false");
}

static void resize(int who, int p)
{
    struct pane *pane = &meeting.seats[who].panes[p];
    int size_px[2];
    any_size(size_px);
    memcpy(pane->own_px, size_px, sizeof size_px);
    if (!pane->is_following || who == meeting.presenter)
        memcpy(shown_in(&meeting, pane)->size_px, size_px, sizeof size_px);
    say(who, "{\"type\":\"view.patch\",\"view\":%d,\"patch\":{\"size_px\":[%d,%d]}}", p + 1, size_px[0], size_px[1]);
}

static void move(int who, int p)
{
    struct pane *pane = &meeting.seats[who].panes[p];
    struct shown *shown = shown_in(&meeting, pane);
    int value = any(60);
    bool may = !pane->is_following || who == meeting.presenter;
    const char *patch[] = { "\"camera\":{\"target_mm\":[%d,0,0]}", "\"camera\":{\"height_mm\":%d}",
                            "\"override\":{\"image\":{\"slices\":{\"axial\":{\"position_mm\":%d}}}}",
                            "\"size_px\":[333,222],\"camera\":{\"height_mm\":%d}" };
    int which = any(4);
    expected = may ? NULL : "/problems/not-presenter";
    value += 1;
    if (may) {
        if (which == 3)
            memcpy(pane->own_px, ((int[]){ 333, 222 }), sizeof pane->own_px);
        memcpy(shown->size_px, pane->own_px, sizeof pane->own_px);
        *(which == 0 ? &shown->target_x_mm : which == 2 ? &shown->slices_mm[0] : &shown->height_mm) = value;
    }
    char text[200], with[20];
    (void)snprintf(with, sizeof with, "%d", value);
    const char *hole = strstr(patch[which], "%d");
    (void)snprintf(text, sizeof text, "%.*s%s%s", (int)(hole - patch[which]), patch[which], with, hole + 2);
    say(who, "{\"type\":\"view.patch\",\"view\":%d,\"patch\":{%s}}", p + 1, text);
}

static void close_pane(int who, int p)
{
    meeting.seats[who].panes[p] = (struct pane){ 0 };
    say(who, "{\"type\":\"view.close\",\"view\":%d}", p + 1);
}

/* Half of the time with a document for pane p. */
static void leave(int who, int p)
{
    struct pane *panes = meeting.seats[who].panes;
    char text[300], views[400] = "";
    bool has_document = panes[p].is_open && any(2);
    int kind = has_document ? any(N_PANE_KINDS) : 0;
    struct shown document = { 0 };
    if (has_document) {
        document = any_document(kind, text);
        (void)snprintf(views, sizeof views, ",\"views\":[{\"view\":%d,\"document\":%s}]", p + 1, text);
    }
    expected = who == meeting.presenter ? "/problems/not-presenter" : NULL;
    for (int i = 0; i < N_PANES && !expected; i++)
        if (has_document && i == p)
            panes[i] = own_pane(kind, document);
        else if (panes[i].is_following)
            meeting_leave(&meeting, &panes[i]);
    say(who, "{\"type\":\"follow\",\"follow\":false%s}", views);
}

static void return_to_all(int who)
{
    meeting_follow(&meeting, who);
    say(who, "{\"type\":\"follow\",\"follow\":true}");
}

static void take_over(int who)
{
    expected = meeting.presenter >= 0 && meeting.presenter != who ? "/problems/not-presenter" : NULL;
    if (!expected) {
        meeting.presenter = who;
        meeting_share(&meeting, who);
    }
    say(who, "{\"type\":\"present\"}");
}

static void call_back(int who)
{
    expected = meeting.presenter == who ? NULL : "/problems/not-presenter";
    if (!expected) {
        meeting_share(&meeting, who);
        for (int m = 0; m < fake.room->members.n; m++) /* of several who show a new kind, the room's first makes it */
            for (int i = 0; i < N_PEOPLE; i++)
                if (i != who && meeting.seats[i].is_connected && member_of(i) == fake.room->members.list[m])
                    meeting_follow(&meeting, i);
    }
    say(who, "{\"type\":\"show.everyone\"}");
}

static void change_scene(int who)
{
    int value = any(80), i = any(N_SLICES);
    expected = meeting.presenter == who ? NULL : "/problems/not-presenter";
    if (!expected)
        meeting.slices_mm[i] = value;
    say(who, "{\"type\":\"scene.patch\",\"patch\":{\"image\":{\"slices\":{\"%s\":{\"position_mm\":%d}}}}}",
        slice_words[i], value);
}

/* Returns who acted. */
static int act_of_somebody(int who, int p)
{
    expected = NULL;
    if (!meeting.seats[who].is_connected && any(3) == 0) {
        enter(who);
        meeting_settle(&meeting, (double)fake.now_us);
        return who;
    }
    if (!meeting.seats[who].is_connected) /* it only takes time */
        who = -1;
    bool is_open = who >= 0 && meeting.seats[who].panes[p].is_open;
    switch (who >= 0 ? any(14) : 1) {
    case 0:
        if (any(2) == 0)
            lose_link(who);
        break;
    case 1:
        fake_pass(&fake, (int[]){ 10, 400, 9000, 31000, 301000 }[any(5)]);
        who = -1;
        break;
    case 2: leave(who, p); break;
    case 3: return_to_all(who); break;
    case 4: take_over(who); break;
    case 5: call_back(who); break;
    case 6: change_scene(who); break;
    case 7:
        if (is_open)
            close_pane(who, p);
        break;
    case 8:
    case 9:
        if (is_open)
            resize(who, p);
        break;
    case 10:
    case 11:
        if (is_open)
            move(who, p);
        break;
    default: open_pane(who, p); break;
    }
    meeting_settle(&meeting, (double)fake.now_us);
    return who;
}

static void play(int seed)
{
    const int n_people = 1 + seed % N_PEOPLE;
    memset(people, 0, sizeof people);
    random_state = (uint64_t)seed * 0x9e3779b97f4a7c15u;
    meeting_start(&meeting, 0.4); /* the scalp's opacity in fake_plan_ready; all slices at the default, 0 */
    fake_room_start(&fake, N_PEOPLE + 1);
    fake_plan_ready(&fake, true);
    for (int step = 0; step < N_STEPS; step++) {
        int before = meeting.presenter;
        (void)snprintf(act, sizeof act, "seed %d, step %d (presents: %d):", seed, step, before);
        remember_pictures();
        int actor = act_of_somebody(any(n_people), any(N_PANES));
        check();
        check_nobody_was_moved(actor, before);
        for (int who = 0; who < N_PEOPLE; who++)
            read_page(&people[who]);
        if (any(4) == 0 || fake.n_requests > 900) {
            check_drawn();
            meeting_settle(&meeting, (double)fake.now_us); /* drawing takes time */
            check();
        }
    }
    for (int who = 0; who < N_PEOPLE; who++)
        if (meeting.seats[who].is_connected)
            lose_link(who);
    remember_pictures(); /* of nobody: frees them */
    fake_room_end(&fake);
}

static void in_random_meetings_nobodys_picture_moves_but_by_the_presenter_or_themselves(void **state)
{
    (void)state;
    for (int seed = 1; seed <= N_SEEDS; seed++)
        play(seed);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(in_random_meetings_nobodys_picture_moves_but_by_the_presenter_or_themselves),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
