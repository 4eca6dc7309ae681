/* Acceptances of a room: who makes and withdraws them, for which files they count, and that nothing else carries them.
 * The model beside the room is the list of pairs that a person has accepted and not withdrawn, with their files. */
#include "tests/unit/room_set_up.h"

#include "core/base/mem.h"

static const char files_a[] = "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa";
static const char files_b[] = "bbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbb";
static const char *const doses[] = { "d-0", "d-1", "d-2", "d-3" };
enum { N_DOSES = 4 };

/* A plan with doses of another frame than its image; one of another patient, and one that fits. */
static void plan_ready(struct fake_room *room)
{
    uint32_t revision;
    cJSON *scene = cJSON_Duplicate(room_scene(fake.room, &revision), true);
    cJSON *plan = cJSON_Parse("{\"id\":\"head\",\"images\":[{\"id\":\"ct\"}],\"regions\":[{\"id\":\"scalp\"},"
                              "{\"id\":\"brain\"}]}");
    cJSON *fits = cJSON_AddArrayToObject(plan, "fits");
    for (int i = 0; i < N_DOSES + 2; i++) {
        char thing[16];
        cJSON *fit = cJSON_CreateObject();
        (void)snprintf(thing, sizeof thing, "dose:d-%d", i);
        cJSON_AddStringToObject(fit, "thing", thing);
        cJSON_AddStringToObject(fit, "with", "image:ct");
        cJSON_AddStringToObject(fit, "needs", i < N_DOSES ? "acceptance" : i == N_DOSES ? "never" : "nothing");
        cJSON_AddStringToObject(fit, "reason", "Dose \"Boost\" is not used with CT: it is another patient's.");
        cJSON_AddItemToArray(fits, fit);
    }
    (void)room_plan_ready(room->room, plan, scene, "osmesa", true, room->now_us);
    cJSON_Delete(scene);
    cJSON_Delete(plan);
}

static void enter(void)
{
    plan_ready(&fake);
    room_revision_came(fake.room, files_a, fake.now_us);
    fake_join(&fake, &ann, false);
    fake_join(&fake, &ben, false);
}

static void accept_pair(struct fake_room *room, struct fake_page *page, const char *dose)
{
    fake_say(room, page,
             "{\"type\":\"item.put\",\"kind\":\"acceptance\",\"body\":{\"thing\":\"dose:%s\",\"with\":\"image:ct\","
             "\"reason\":\"registered-elsewhere\",\"words\":\"CT to MR by hand, skull base checked\"},\"input\":3}",
             dose);
}

static size_t n_told(struct fake_room *room)
{
    return (size_t)cJSON_GetArraySize(room_acceptances(room->room));
}

static bool is_told(struct fake_room *room, const char *dose)
{
    char thing[32];
    const cJSON *entry;
    (void)snprintf(thing, sizeof thing, "dose:%s", dose);
    cJSON_ArrayForEach(entry,
                       room_acceptances(room->room)) if (strcmp(json_text(entry, "thing"), thing) == 0) return true;
    return false;
}

/* The id of the acceptance of this dose; "": none. */
static const char *id_of(struct fake_room *room, const char *dose)
{
    static char id[64];
    char thing[32];
    (void)snprintf(thing, sizeof thing, "\"dose:%s\"", dose);
    cJSON *rows = room_items(room->room, WIRE_ITEM_KIND_ACCEPTANCE);
    const cJSON *raw;
    id[0] = 0;
    cJSON_ArrayForEach(raw, rows) if (strstr(raw->valuestring, thing))
    {
        cJSON *row = cJSON_Parse(raw->valuestring);
        (void)snprintf(id, sizeof id, "%s", json_text(row, "id"));
        cJSON_Delete(row);
    }
    cJSON_Delete(rows);
    return id;
}

static void withdraw(struct fake_room *room, struct fake_page *page, const char *dose)
{
    fake_say(room, page, "{\"type\":\"item.delete\",\"item\":\"%s\"}", id_of(room, dose));
}

static void an_acceptance_is_told_to_the_renderer_and_draws_all_pictures_anew(void **state)
{
    (void)state;
    enter();
    settle_two();
    const size_t n_requests = fake.n_requests, n_scenes = fake.n_scenes;
    uint32_t before, after;
    (void)room_scene(fake.room, &before);
    accept_pair(&fake, &ann, "d-1");
    assert_int_equal(n_told(&fake), 1);
    const cJSON *entry = cJSON_GetArrayItem(room_acceptances(fake.room), 0);
    assert_string_equal(json_text(entry, "thing"), "dose:d-1");
    assert_string_equal(json_text(entry, "with"), "image:ct");
    assert_string_equal(json_text(entry, "by"), "Reviewer 1");
    assert_string_equal(json_text(entry, "words"), "CT to MR by hand, skull base checked");
    (void)room_scene(fake.room, &after);
    assert_int_equal(after, before + 1);
    assert_int_equal(fake.n_scenes, n_scenes + 1);
    settle_two();
    assert_true(fake.n_requests >= n_requests + 2); /* of both pages */
    cJSON *said = fake_heard(&ben, "acceptances");
    assert_true(json_flag(said, "known", false));
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(said, "items")), 1);
    cJSON_Delete(said);
    cJSON *item = fake_heard(&ben, "item");
    const cJSON *body = cJSON_GetObjectItem(cJSON_GetObjectItem(item, "item"), "body");
    assert_string_equal(json_text(body, "plan_revision"), files_a);
    assert_string_equal(json_text(body, "role"), "presenter");
    assert_non_null(strstr(json_text(body, "fact"), "another patient"));
    cJSON_Delete(item);
    withdraw(&fake, &ann, "d-1");
    assert_int_equal(n_told(&fake), 0);
    assert_int_equal(fake.n_scenes, n_scenes + 2);
}

static void only_the_presenter_makes_and_withdraws_and_who_is_never_taken_from_the_body(void **state)
{
    (void)state;
    enter();
    accept_pair(&fake, &ben, "d-0");
    assert_string_equal(refused(&ben), "403 ");
    assert_int_equal(n_told(&fake), 0);
    fake_say(&fake, &ann,
             "{\"type\":\"item.put\",\"kind\":\"acceptance\",\"body\":{\"thing\":\"dose:d-0\",\"with\":\"image:ct\","
             "\"reason\":\"other\",\"words\":\"somebody else says so\",\"by\":\"Dr Keller\"}}");
    assert_string_equal(refused(&ann), "422 /body/by");
    accept_pair(&fake, &ann, "d-0");
    withdraw(&fake, &ben, "d-0");
    assert_string_equal(refused(&ben), "403 ");
    assert_int_equal(n_told(&fake), 1);
    fake_say(&fake, &ann, "{\"type\":\"present\"}"); /* nothing changes */
    fake_say(&fake, &ann, "{\"type\":\"control.give\",\"member\":\"m2\"}");
    withdraw(&fake, &ben, "d-0"); /* by the presenter, who is not its author */
    assert_int_equal(n_told(&fake), 0);
}

static void what_cannot_be_accepted_is_refused_with_the_reason(void **state)
{
    (void)state;
    static const char *const bodies[][2] = {
        { "{\"thing\":\"dose:d-4\",\"with\":\"image:ct\",\"reason\":\"other\",\"words\":\"it is one person\"}",
          "403 /body/thing" },
        { "{\"thing\":\"dose:d-5\",\"with\":\"image:ct\",\"reason\":\"other\",\"words\":\"it fits anyhow\"}",
          "422 /body/thing" },
        { "{\"thing\":\"dose:d-9\",\"with\":\"image:ct\",\"reason\":\"other\",\"words\":\"there is no such\"}",
          "422 /body/thing" },
        { "{\"thing\":\"dose:d-0\",\"with\":\"image:ct\",\"reason\":\"because\",\"words\":\"ten letters\"}",
          "422 /body/reason" },
        { "{\"thing\":\"dose:d-0\",\"with\":\"image:ct\",\"reason\":\"other\",\"words\":\"a b c d e !!!!!! ??\"}",
          "422 /body/words" },
        { "{\"thing\":\"dose:d-0\",\"with\":\"image:ct\",\"reason\":\"other\"}", "422 /body/words" },
        { "{\"thing\":\"wash:d-0\",\"with\":\"image:ct\",\"reason\":\"other\",\"words\":\"ten letters\"}",
          "422 /body/thing" },
        { "{\"thing\":\"dose:d-0\",\"reason\":\"other\",\"words\":\"ten letters\"}", "422 /body/with" },
    };
    enter();
    for (size_t i = 0; i < sizeof bodies / sizeof bodies[0]; i++) {
        fake_say(&fake, &ann, "{\"type\":\"item.put\",\"kind\":\"acceptance\",\"body\":%s}", bodies[i][0]);
        assert_string_equal(refused(&ann), bodies[i][1]);
    }
    assert_int_equal(n_told(&fake), 0);
    accept_pair(&fake, &ann, "d-0");
    accept_pair(&fake, &ann, "d-0");
    assert_string_equal(refused(&ann), "409 /body/thing");
    fake_say(&fake, &ann,
             "{\"type\":\"item.put\",\"item\":\"%s\",\"version\":1,\"kind\":\"acceptance\",\"body\":{\"thing\":"
             "\"dose:d-1\",\"with\":\"image:ct\",\"reason\":\"other\",\"words\":\"another dose now\"}}",
             id_of(&fake, "d-0"));
    assert_string_equal(refused(&ann), "403 /item");
}

static void with_other_files_it_does_not_count_and_stands_as_void(void **state)
{
    (void)state;
    enter();
    accept_pair(&fake, &ann, "d-0");
    plan_ready(&fake); /* another process: what it has read is not known yet */
    assert_int_equal(n_told(&fake), 0);
    cJSON *said = fake_heard(&ann, "acceptances");
    assert_false(json_flag(said, "known", true));
    cJSON_Delete(said);
    assert_true(room_wants_revision(fake.room));
    accept_pair(&fake, &ann, "d-1");
    assert_string_equal(refused(&ann), "503 ");
    room_revision_came(fake.room, files_b, fake.now_us);
    assert_int_equal(n_told(&fake), 0);
    assert_string_not_equal(id_of(&fake, "d-0"), ""); /* it is still shown */
    accept_pair(&fake, &ann, "d-0");                  /* and may be said anew */
    assert_int_equal(n_told(&fake), 1);
    plan_ready(&fake);
    room_revision_came(fake.room, files_a, fake.now_us);
    assert_int_equal(n_told(&fake), 1);
    room_revision_came(fake.room, files_b, fake.now_us); /* on the disk only; what is loaded is that of a */
    assert_int_equal(n_told(&fake), 1);
}

static void making_and_withdrawing_are_in_the_audit(void **state)
{
    (void)state;
    enter();
    const size_t before = fake.n_audited;
    accept_pair(&fake, &ann, "d-2");
    assert_int_equal(fake.n_audited, before + 1);
    const char *row = fake.audit[before % 16];
    assert_non_null(strstr(row, "acceptance m1 done"));
    assert_non_null(strstr(row, "\"thing\":\"dose:d-2\""));
    assert_non_null(strstr(row, "skull base checked"));
    withdraw(&fake, &ann, "d-2");
    assert_int_equal(fake.n_audited, before + 2);
    assert_non_null(strstr(fake.audit[(before + 1) % 16], "withdrawal m1 done"));
    fake.audit_is_full = true;
    accept_pair(&fake, &ann, "d-2");
    assert_int_equal(n_told(&fake), 0); /* what cannot be recorded is refused */
}

static void the_record_lists_them_with_fact_words_and_person(void **state)
{
    (void)state;
    enter();
    accept_pair(&fake, &ann, "d-2");
    cJSON *record = room_record(fake.room);
    const cJSON *list = cJSON_GetObjectItem(record, "acceptances"), *row = cJSON_GetArrayItem(list, 0);
    assert_int_equal(cJSON_GetArraySize(list), 1);
    assert_string_equal(json_text(row, "thing"), "dose:d-2");
    assert_string_equal(json_text(row, "words"), "CT to MR by hand, skull base checked");
    assert_string_equal(json_text(row, "author_name"), "Reviewer 1");
    assert_non_null(strstr(json_text(row, "fact"), "not used with CT"));
    assert_true(json_flag(row, "counts", false));
    cJSON_Delete(record);
}

/* ---- what carries them ------------------------------------------------------------------------------------------ */

static struct fake_room other;

/* Restores the room from its kept state, as after a restart. */
static void wake_in(struct fake_room *woken)
{
    struct store_room kept;
    assert_true(room_keep(fake.room, ROOM_ALL_PARTS, &kept));
    fake_room_start(woken, 3);
    cJSON *rows = room_items(fake.room, WIRE_ITEM_KIND_ACCEPTANCE);
    const cJSON *row;
    struct problem problem = { 0 };
    cJSON_ArrayForEach(row, rows)
        assert_true(room_restore_item(woken->room, row->valuestring, strlen(row->valuestring), &problem));
    cJSON_Delete(rows);
    room_restore(woken->room, &kept, woken->now_us);
    room_kept_finish(&kept);
}

static void it_is_woken_with_its_room_and_counts_once_the_files_are_known_to_be_the_same(void **state)
{
    (void)state;
    enter();
    accept_pair(&fake, &ann, "d-3");
    wake_in(&other);
    assert_int_equal(n_told(&other), 0);
    plan_ready(&other);
    assert_int_equal(n_told(&other), 0);
    assert_true(room_wants_revision(other.room));
    room_revision_came(other.room, files_a, other.now_us);
    assert_int_equal(n_told(&other), 1);
    fake_room_end(&other);
}

static void a_room_that_begins_with_a_saved_view_begins_unaccepted(void **state)
{
    (void)state;
    struct fake_page eve = { 0 };
    enter();
    accept_pair(&fake, &ann, "d-3");
    fake_say(&fake, &ann, "{\"type\":\"item.put\",\"kind\":\"bookmark\",\"body\":{\"name\":\"as it is\"}}");
    cJSON *item = fake_heard(&ann, "item");
    const cJSON *body = cJSON_GetObjectItem(cJSON_GetObjectItem(item, "item"), "body");
    char *text = cJSON_PrintUnformatted(body);
    assert_null(strstr(text, "accept"));
    free(text);
    fake_room_start(&other, 3);
    assert_true(room_begin_with(other.room, body, &(struct problem){ 0 }));
    plan_ready(&other);
    room_revision_came(other.room, files_a, other.now_us);
    fake_join(&other, &eve, false);
    assert_int_equal(n_told(&other), 0);
    cJSON_Delete(item);
    fake_room_end(&other);
    fake_page_end(&eve);
}

static void a_room_kept_when_the_scene_held_acceptances_loads_without_them_and_keeps_the_rest(void **state)
{
    (void)state;
    struct store_room kept;
    enter();
    fake_say(&fake, &ann, "{\"type\":\"scene.patch\",\"patch\":{\"regions\":{\"brain\":{\"opacity\":0.25}}}}");
    assert_true(room_keep(fake.room, ROOM_ALL_PARTS, &kept));
    cJSON *scene = cJSON_Parse(kept.scene);
    cJSON *old = cJSON_Parse("{\"d-0\":{\"accepted\":true}}");
    cJSON_AddItemToObject(cJSON_GetObjectItem(scene, "dose"), "accepted", old);
    free(kept.scene);
    kept.scene = cJSON_PrintUnformatted(scene);
    cJSON_Delete(scene);
    fake_room_start(&other, 3);
    room_restore(other.room, &kept, other.now_us);
    room_kept_finish(&kept);
    plan_ready(&other);
    const cJSON *woken = room_scene(other.room, NULL);
    assert_null(cJSON_GetObjectItem(cJSON_GetObjectItem(woken, "dose"), "accepted"));
    assert_near(json_number(cJSON_GetObjectItem(cJSON_GetObjectItem(woken, "regions"), "brain"), "opacity", 1), 0.25,
                1e-9);
    fake_room_end(&other);
}

static void a_saved_view_of_that_time_opens_with_a_note(void **state)
{
    (void)state;
    enter();
    cJSON *body = cJSON_Parse("{\"format\":\"beamroom-bookmark\",\"version\":1,\"name\":\"old\",\"plan\":\"head\","
                              "\"scene\":{\"dose\":{\"accepted\":{\"d-0\":{\"accepted\":true}},\"blood_ppm\":12}},"
                              "\"views\":[]}");
    struct problem problem = { 0 };
    cJSON *opened = room_bookmark_open(fake.room, body, &problem);
    assert_non_null(opened);
    const cJSON *dose = cJSON_GetObjectItem(cJSON_GetObjectItem(opened, "scene"), "dose");
    assert_null(cJSON_GetObjectItem(dose, "accepted"));
    assert_near(json_number(dose, "blood_ppm", 0), 12, 1e-9);
    const cJSON *note = cJSON_GetArrayItem(cJSON_GetObjectItem(opened, "report"), 0);
    assert_string_equal(json_text(note, "pointer"), "/scene/dose/accepted");
    cJSON_Delete(opened);
    cJSON_Delete(body);
}

/* ---- random acts ------------------------------------------------------------------------------------------------ */

static unsigned next(unsigned *seed)
{
    *seed = *seed * 1664525U + 1013904223U;
    return *seed >> 16;
}

static void after_any_acts_the_renderer_is_told_exactly_what_was_accepted_for_these_files(void **state)
{
    (void)state;
    bool is_accepted[2][N_DOSES] = { { false } }; /* by files */
    int files = 0;
    unsigned seed = 25;
    enter();
    for (int act = 0; act < 400; act++) {
        const unsigned dose = next(&seed) % N_DOSES, kind = next(&seed) % 8;
        if (kind <= 2) {
            accept_pair(&fake, &ann, doses[dose]);
            is_accepted[files][dose] = true;
        } else if (kind == 3 && id_of(&fake, doses[dose])[0]) {
            /* the first of them, which may be one for the other files */
            cJSON *rows = room_items(fake.room, WIRE_ITEM_KIND_ACCEPTANCE);
            char thing[32];
            (void)snprintf(thing, sizeof thing, "\"dose:%s\"", doses[dose]);
            const cJSON *raw;
            bool is_first = true;
            cJSON_ArrayForEach(raw, rows) if (is_first && strstr(raw->valuestring, thing))
            {
                cJSON *row = cJSON_Parse(raw->valuestring);
                const char *of = json_text(cJSON_GetObjectItem(row, "body"), "plan_revision");
                is_accepted[of[0] == 'b'][dose] = false;
                fake_say(&fake, &ann, "{\"type\":\"item.delete\",\"item\":\"%s\"}", json_text(row, "id"));
                cJSON_Delete(row);
                is_first = false;
            }
            cJSON_Delete(rows);
        } else if (kind == 4) {
            fake_say(&fake, &ann, "{\"type\":\"scene.patch\",\"patch\":{\"regions\":{\"brain\":{\"opacity\":%g}}}}",
                     (next(&seed) % 100) / 100.0);
        } else if (kind == 5) { /* the files change, or only the process does */
            files = (int)(next(&seed) % 2);
            plan_ready(&fake);
            room_revision_came(fake.room, files ? files_b : files_a, fake.now_us);
        } else if (kind == 6) {
            accept_pair(&fake, &ben, doses[dose]); /* refused */
        } else {
            wake_in(&other);
            plan_ready(&other);
            room_revision_came(other.room, files ? files_b : files_a, other.now_us);
            for (unsigned d = 0; d < N_DOSES; d++)
                assert_int_equal(is_told(&other, doses[d]), is_accepted[files][d]);
            fake_room_end(&other);
        }
        for (unsigned d = 0; d < N_DOSES; d++)
            assert_int_equal(is_told(&fake, doses[d]), is_accepted[files][d]);
        settle_two();
        if (fake.n_requests > 900 || ann.n_texts > 3000) /* what the fakes hold */
            break;
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        ROOM_TEST(an_acceptance_is_told_to_the_renderer_and_draws_all_pictures_anew),
        ROOM_TEST(only_the_presenter_makes_and_withdraws_and_who_is_never_taken_from_the_body),
        ROOM_TEST(what_cannot_be_accepted_is_refused_with_the_reason),
        ROOM_TEST(with_other_files_it_does_not_count_and_stands_as_void),
        ROOM_TEST(making_and_withdrawing_are_in_the_audit),
        ROOM_TEST(the_record_lists_them_with_fact_words_and_person),
        ROOM_TEST(it_is_woken_with_its_room_and_counts_once_the_files_are_known_to_be_the_same),
        ROOM_TEST(a_room_that_begins_with_a_saved_view_begins_unaccepted),
        ROOM_TEST(a_room_kept_when_the_scene_held_acceptances_loads_without_them_and_keeps_the_rest),
        ROOM_TEST(a_saved_view_of_that_time_opens_with_a_note),
        ROOM_TEST(after_any_acts_the_renderer_is_told_exactly_what_was_accepted_for_these_files),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
