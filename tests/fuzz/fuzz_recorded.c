/* A recording as it is read from the disk: each line is a batch, but the first: "WHEN CHANGED", the time that is asked
 * for and whether the plan is another one since. It is read as a state, and played in a room. Invariants: what is
 * refused comes with a sentence; pages are sent JSON and renderers scenes alone; the room that was left can be kept. */
#include "core/base/log.h"
#include "server/room/log/recording.h"
#include "server/wire/json_merge.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/kept_plan.h"

enum { MAX_BATCHES = 32 };

static int n_asked;

static bool replay_read(void *context, struct room *room, const char *of_room, const char *recording, int64_t t_ms,
                        struct problem *problem)
{
    (void)context;
    (void)room;
    (void)problem;
    REQUIRE(of_room[0] && recording[0] && t_ms >= 0);
    n_asked++;
    return true;
}

static void read_as_state(const char *const *texts, size_t n, int64_t t_ms)
{
    struct problem problem = { 0 };
    cJSON *state = room_recorded_state(texts, n, t_ms, &problem);
    if (!state) {
        REQUIRE(problem.type != PROBLEM_NONE && problem.detail[0]);
        return;
    }
    char *text = json_print(state);
    REQUIRE(text != NULL);
    cJSON *again = json_read(text, strlen(text), &problem);
    REQUIRE(again != NULL && json_equal(state, again));
    cJSON_Delete(again);
    cJSON_Delete(state);
    free(text);
}

static void say(struct room *room, void *page, const char *text, int64_t now_us)
{
    room_text_came(room, page, text, strlen(text), now_us);
}

static void play(const char *const *texts, size_t n, int64_t t_ms, bool is_changed)
{
    struct room_callbacks callbacks = kept_plan_callbacks;
    struct room_recording facts = { .id = "rec-1", .by_name = "Ann", .length_ms = 5000 };
    int64_t now_us = 1000000;
    char seek[64], page, late;
    callbacks.replay_read = replay_read;
    n_asked = 0;
    struct room *room = room_create("7q4k-m2wz", "head", &callbacks, NULL);
    kept_plan_ready(room, now_us);
    if (!is_changed)
        REQUIRE(recording_plan_sum(room, facts.plan_sum));
    room_replay_begin(room, "2v8x-p5fd", 3, &facts, now_us);
    say(room, &page, "{\"type\":\"hello\",\"protocol\":2,\"name\":\"Dee\"}", now_us);
    say(room, &page, "{\"type\":\"view.open\",\"view\":1,\"follow\":true,\"document\":{\"size_px\":[64,48]}}", now_us);
    (void)snprintf(seek, sizeof seek, "{\"type\":\"replay.seek\",\"t_ms\":%lld}", (long long)t_ms);
    const char *const said[] = { "{\"type\":\"replay.play\",\"rate\":1}", seek, "{\"type\":\"replay.seek\",\"t_ms\":0}",
                                 "{\"type\":\"replay.leave\",\"input\":7}" };
    for (size_t i = 0; i < sizeof said / sizeof said[0]; i++) {
        say(room, &page, said[i], now_us);
        for (int tick = 0; tick < 4; tick++) {
            REQUIRE(room_settle(room, now_us) > now_us);
            if (n_asked) {
                struct problem problem = { .type = PROBLEM_STORAGE, .detail = "nothing is there" };
                n_asked = 0;
                room_replay_came(room, texts, n, INT64_MAX, n ? NULL : &problem, now_us);
            }
            now_us += 400000;
        }
        if (i == 1) /* who comes late is told what is shown */
            say(room, &late, "{\"type\":\"hello\",\"protocol\":2,\"name\":\"Eva\"}", now_us);
    }
    struct store_room kept;
    REQUIRE(room_keep(room, ROOM_ALL_PARTS, &kept));
    room_kept_finish(&kept);
    room_destroy(room);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    const char *texts[MAX_BATCHES];
    size_t n_texts = 0;
    char *bytes = malloc(n + 1), *rest = bytes;
    REQUIRE(bytes != NULL);
    memcpy(bytes, data, n);
    bytes[n] = 0;
    log_start("fuzz", (enum log_level)(LOG_ERROR + 1));
    const int64_t t_ms = (int64_t)(strtoul(bytes, &rest, 10) % 6000);
    const bool is_changed = strtoul(rest, &rest, 10) % 2;
    for (rest = strchr(rest, '\n'); rest && n_texts < MAX_BATCHES; rest = strchr(rest, '\n')) {
        *rest++ = 0;
        if (rest[0] && rest[0] != '\n') /* not behind the last end of line */
            texts[n_texts++] = rest;
    }
    read_as_state(texts, n_texts, t_ms);
    play(texts, n_texts, t_ms, is_changed);
    free(bytes);
    return 0;
}
