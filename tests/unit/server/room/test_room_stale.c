/* Whether a page knows from the messages and headers which of its pictures show the newest scene: random changes,
 * reloads and layouts, with a model of the page that keeps what web/js/room/view.js keeps. */
#include "tests/unit/room_set_up.h"

enum { N_PAGES = 3, N_VIEWS = 3, N_STEPS = 80, N_RUNS = 40 };

static const char *const kinds[N_VIEWS] = { "3d", "axial", "coronal" };

/* Changes of the scene: which kinds of view they reach is plain from what they change. %d is another value each time.
 */
static const struct {
    const char *patch;
    bool reaches[N_VIEWS];
} changes[] = {
    { "{\"image\":{\"window\":{\"center\":%d}}}", { true, true, true } },
    { "{\"image\":{\"slices\":{\"axial\":{\"position_mm\":%d}}}}", { false, true, false } },
    { "{\"image\":{\"slices\":{\"coronal\":{\"position_mm\":%d}}}}", { false, false, true } },
    { "{\"image\":{\"cull_below\":%d}}", { true, false, false } },
    { "{\"constraints\":{\"limit-%d\":{\"metric\":\"max\",\"limit\":5,\"region\":\"brain\"}}}",
      { false, false, false } },
};
static const char no_slices_in_3d[] = "{\"image\":{\"slices\":{\"axial\":{\"visible\":false},\"coronal\":{\"visible\":"
                                      "false},\"sagittal\":{\"visible\":false}}}}";
enum { N_CHANGES = sizeof changes / sizeof changes[0] };

static struct {
    unsigned n_reached[N_VIEWS]; /* changes so far that reach a view of the kind */
    unsigned stamps[1024];       /* by request: n_reached of its kind when it was made */
    size_t n_stamped;
    int n_values;
} truth;

static struct model { /* of a page */
    struct fake_page *page;
    size_t n_texts, n_frames; /* read so far */
    uint32_t revision;
    struct {
        bool is_open, has_picture;
        uint32_t same_since, held; /* the picture holds for the revisions up to held */
        unsigned stamp;            /* of the picture's request */
        uint32_t sequence;
    } views[N_VIEWS];
} models[N_PAGES];

static unsigned random_state;
static unsigned random_below(unsigned n)
{
    random_state = random_state * 1664525u + 1013904223u;
    return (random_state >> 16) % n;
}

static int kind_of(const cJSON *view)
{
    const char *kind = json_text(view, "kind");
    for (int i = 0; i < N_VIEWS; i++)
        if (strcmp(kinds[i], kind ? kind : "3d") == 0)
            return i;
    fail_msg("a view of another kind");
    return 0;
}

static void stamp_requests(void)
{
    for (; truth.n_stamped < fake.n_requests; truth.n_stamped++)
        truth.stamps[truth.n_stamped] = truth.n_reached[kind_of(fake.requests[truth.n_stamped].view)];
}

static bool lists(const cJSON *numbers, int number)
{
    for (const cJSON *one = numbers ? numbers->child : NULL; one; one = one->next)
        if (one->valueint == number)
            return true;
    return false;
}

static void scene_came(struct model *model, uint32_t revision, const cJSON *unchanged)
{
    if (revision == model->revision)
        return;
    model->revision = revision;
    for (int i = 0; i < N_VIEWS; i++) {
        if (!lists(unchanged, i + 1))
            model->views[i].same_since = revision;
        else if (model->views[i].held >= model->views[i].same_since)
            model->views[i].held = revision;
    }
}

static void read_text(struct model *model, const char *text)
{
    cJSON *json = json_read(text, strlen(text), NULL);
    const char *type = json_text(json, "type");
    const uint32_t revision = (uint32_t)json_number(json, "revision", 0);
    if (strcmp(type, "scene") == 0)
        scene_came(model, revision, cJSON_GetObjectItem(json, "unchanged"));
    else if (strcmp(type, "welcome") == 0)
        scene_came(model, revision, NULL);
    cJSON_Delete(json);
}

/* Texts overtake pictures, so all of them are read first. */
static void read_all(struct model *model)
{
    const struct fake_page *page = model->page;
    for (; model->n_texts < page->n_texts; model->n_texts++)
        read_text(model, page->texts[model->n_texts]);
    for (; model->n_frames < page->n_frames; model->n_frames++) {
        const struct frame_header *header = &page->frames[model->n_frames];
        const int view = (int)header->view - 1;
        const bool is_now = header->scene_revision >= model->views[view].same_since;
        model->views[view].has_picture = true;
        model->views[view].held = is_now ? model->revision : header->scene_revision;
        model->views[view].sequence = header->sequence;
        model->views[view].stamp = truth.stamps[header->render_us - 1]; /* as draw wrote it */
    }
}

static void draw(struct fake_request *request)
{
    fake_draw_slow(&fake, request, (uint32_t)(request - fake.requests) + 1);
}

static void open_or_close(struct model *model, int view)
{
    const bool is_open = model->views[view].is_open = !model->views[view].is_open;
    if (is_open)
        fake_say(
            &fake, model->page,
            "{\"type\":\"view.open\",\"view\":%d,\"follow\":%s,\"document\":{\"kind\":\"%s\",\"size_px\":[300,200]}}",
            view + 1, random_below(2) ? "true" : "false", kinds[view]);
    else
        fake_say(&fake, model->page, "{\"type\":\"view.close\",\"view\":%d}", view + 1);
    model->views[view].has_picture = false;
}

static void enter(struct model *model)
{
    fake_hello(&fake, model->page);
    for (int view = 0; view < N_VIEWS; view++)
        open_or_close(model, view);
}

static void reload(struct model *model)
{
    struct fake_page *page = model->page;
    room_connection_closed(fake.room, page, fake.now_us);
    fake_page_end(page);
    *model = (struct model){ .page = page };
    enter(model);
}

static void patch_scene(const char *text)
{
    struct problem problem = { 0 };
    cJSON *patch = json_read(text, strlen(text), NULL);
    if (!room_patch_scene(fake.room, patch, NULL, "", fake.now_us, &problem))
        fail_msg("%s: %s %s", text, problem.pointer, problem.detail);
    cJSON_Delete(patch);
}

static void change(unsigned which)
{
    char text[256];
    (void)snprintf(text, sizeof text, changes[which].patch, ++truth.n_values);
    patch_scene(text);
    for (int kind = 0; kind < N_VIEWS; kind++)
        truth.n_reached[kind] += changes[which].reaches[kind];
    fake_pass(&fake, 0);
}

static void acknowledge(struct model *model)
{
    for (int view = 0; view < N_VIEWS; view++)
        if (model->views[view].sequence) /* a picture that came after its view was closed is acknowledged, too */
            fake_say(&fake, model->page, "{\"type\":\"frame.shown\",\"view\":%d,\"sequence\":%u}", view + 1,
                     model->views[view].sequence);
}

static void check(const struct model *model, unsigned seed, int step)
{
    for (int view = 0; view < N_VIEWS; view++) {
        if (!model->views[view].has_picture)
            continue;
        const bool is_stale = model->views[view].held < model->revision;
        const bool is_due = model->views[view].stamp < truth.n_reached[view];
        if (is_stale != is_due)
            fail_msg("run %u, step %d, page %d, view %s: the badge is%s stale, and a newer picture is%s due", seed,
                     step, (int)(model - models), kinds[view], is_stale ? "" : " not", is_due ? "" : " not");
    }
}

static void step(void)
{
    struct model *model = &models[random_below(N_PAGES)];
    switch (random_below(10)) {
    case 0: open_or_close(model, (int)random_below(N_VIEWS)); break;
    case 1: reload(model); break;
    case 2:
    case 3:
    case 4: change(random_below(N_CHANGES)); break;
    case 5: acknowledge(model); break;
    case 6: fake_pass(&fake, random_below(400)); break;
    default: {
        struct fake_request *request = random_below(2) ? fake_oldest(&fake) : fake_newest(&fake);
        if (request)
            draw(request);
    }
    }
}

static void read_pages(unsigned seed, int at)
{
    stamp_requests();
    for (int i = 0; i < N_PAGES; i++) {
        read_all(&models[i]);
        check(&models[i], seed, at);
    }
}

static void settle(unsigned seed)
{
    for (int turn = 0; turn < 20; turn++) {
        for (struct fake_request *request; (request = fake_oldest(&fake));) {
            draw(request);
            read_pages(seed, N_STEPS);
        }
        for (int i = 0; i < N_PAGES; i++)
            acknowledge(&models[i]);
        fake_pass(&fake, 200);
        read_pages(seed, N_STEPS);
    }
    for (int i = 0; i < N_PAGES; i++)
        for (int view = 0; view < N_VIEWS; view++)
            if (models[i].views[view].is_open) {
                assert_true(models[i].views[view].has_picture);
                assert_int_equal(models[i].views[view].held, models[i].revision);
            }
}

static void a_page_takes_a_picture_for_stale_exactly_while_a_newer_one_is_due(void **state)
{
    struct fake_page *const pages[N_PAGES] = { &ann, &ben, &cem };
    for (unsigned seed = 1; seed <= N_RUNS; seed++) {
        (void)room_end(state);
        fake_room_start(&fake, 64); /* who reloads enters as another member */
        fake_plan_ready(&fake, true);
        random_state = seed;
        memset(&truth, 0, sizeof truth);
        patch_scene(no_slices_in_3d);
        for (int i = 0; i < N_PAGES; i++) {
            models[i] = (struct model){ .page = pages[i] };
            enter(&models[i]);
        }
        read_pages(seed, 0);
        for (int at = 1; at <= N_STEPS; at++) {
            step();
            read_pages(seed, at);
        }
        settle(seed);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        ROOM_TEST(a_page_takes_a_picture_for_stale_exactly_while_a_newer_one_is_due),
    };
    return cmocka_run_group_tests_name("room_stale", tests, NULL, NULL);
}
