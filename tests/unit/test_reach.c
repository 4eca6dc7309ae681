/* Which pictures a change of the scene reaches, and that only these are requested anew. */
#include "server/room/reach.h"
#include "server/wire/json_merge.h"
#include "tests/unit/room_set_up.h"

static const char scene_text[] =
    "{\"regions\":{\"brain\":{\"visible\":true}},\"measures\":{},\"axes\":{\"visible\":false},"
    "\"clip\":{\"axial_low\":{\"enabled\":false}},"
    "\"image\":{\"id\":\"ct\",\"cull_below\":1,\"volume\":{\"visible\":false},"
    "\"slices\":{\"axial\":{\"visible\":true,\"position_mm\":1},\"coronal\":{\"visible\":false,\"position_mm\":2},"
    "\"sagittal\":{\"visible\":false,\"position_mm\":3}},"
    "\"obliques\":{\"a\":{\"visible\":false,\"origin_mm\":[0,0,0],\"normal\":[0,1,1],\"name\":\"\"}}}}";

static const char *const views[] = { "{\"kind\":\"3d\"}",
                                     "{\"kind\":\"axial\"}",
                                     "{\"kind\":\"coronal\"}",
                                     "{\"kind\":\"sagittal\"}",
                                     "{\"kind\":\"oblique\",\"plane\":\"a\"}",
                                     "{\"kind\":\"oblique\",\"plane\":\"gone\"}" };
static const char view_letters[] = "3acsoO"; /* O: an oblique view of a plane that the scene does not have */

/* The letters of the views that the patch reaches. */
static const char *reached(const char *patch_text)
{
    static char letters[16];
    cJSON *before = cJSON_Parse(scene_text), *patch = cJSON_Parse(patch_text);
    assert_non_null(before);
    assert_non_null(patch);
    cJSON *after = json_merge(before, patch);
    size_t n = 0;
    for (size_t i = 0; i < sizeof views / sizeof views[0]; i++) {
        cJSON *view = cJSON_Parse(views[i]);
        if (change_reaches(view, before, after, patch))
            letters[n++] = view_letters[i];
        cJSON_Delete(view);
    }
    letters[n] = 0;
    cJSON_Delete(before);
    cJSON_Delete(patch);
    cJSON_Delete(after);
    return letters;
}

static void a_slice_that_moves_reaches_its_own_pane_and_3d_where_it_is_shown_there(void **state)
{
    (void)state;
    assert_string_equal(reached("{\"image\":{\"slices\":{\"axial\":{\"position_mm\":9}}}}"), "3aO");
    assert_string_equal(reached("{\"image\":{\"slices\":{\"coronal\":{\"position_mm\":9}}}}"), "c");
    assert_string_equal(reached("{\"image\":{\"slices\":{\"axial\":{\"position_mm\":1},\"coronal\":{\"position_mm\":9},"
                                "\"sagittal\":{\"position_mm\":9}}}}"),
                        "cs");
    assert_string_equal(reached("{\"image\":{\"slices\":{\"coronal\":{\"visible\":true}}}}"), "3");
    assert_string_equal(reached("{\"image\":{\"slices\":{\"axial\":{\"visible\":false}}}}"), "3");
}

static void an_oblique_plane_reaches_its_own_pane_and_3d_where_it_is_shown_there(void **state)
{
    (void)state;
    assert_string_equal(reached("{\"image\":{\"obliques\":{\"a\":{\"origin_mm\":[0,0,5]}}}}"), "o");
    assert_string_equal(reached("{\"image\":{\"obliques\":{\"a\":{\"normal\":[0,0,5]}}}}"), "o");
    assert_string_equal(reached("{\"image\":{\"obliques\":{\"a\":{\"visible\":true}}}}"), "3");
    assert_string_equal(reached("{\"image\":{\"obliques\":{\"a\":{\"name\":\"along the beam\"}}}}"), "");
    assert_string_equal(reached("{\"image\":{\"obliques\":{\"a\":null}}}"), "o");
    assert_string_equal(reached("{\"image\":{\"obliques\":{\"gone\":{\"origin_mm\":[0,0,1],\"normal\":[0,0,1]}}}}"),
                        "O");
    assert_string_equal(reached("{\"image\":{\"obliques\":{\"b\":{\"origin_mm\":[0,0,1],\"visible\":true}}}}"), "3");
}

static void what_is_drawn_in_3d_only_reaches_3d_and_measures_reach_nothing(void **state)
{
    (void)state;
    assert_string_equal(reached("{\"clip\":{\"axial_low\":{\"enabled\":true}}}"), "3");
    assert_string_equal(reached("{\"axes\":{\"visible\":true}}"), "3");
    assert_string_equal(reached("{\"image\":{\"volume\":{\"visible\":true}}}"), "3");
    assert_string_equal(reached("{\"image\":{\"cull_below\":5}}"), "3");
    assert_string_equal(reached("{\"measures\":{\"m\":{\"kind\":\"angle\"}}}"), "");
}

static void all_else_reaches_every_picture_unless_it_changes_nothing(void **state)
{
    (void)state;
    assert_string_equal(reached("{\"regions\":{\"brain\":{\"visible\":false}}}"), view_letters);
    assert_string_equal(reached("{\"regions\":{\"brain\":{\"visible\":true}}}"), "");
    assert_string_equal(reached("{\"image\":{\"id\":\"mr\"}}"), view_letters);
    assert_string_equal(reached("{\"image\":null}"), view_letters);
    assert_string_equal(reached("{\"something\":1}"), view_letters);
    assert_string_equal(reached("{}"), "");
}

/* ---- in a room -------------------------------------------------------------------------------------------------- */

static void open_kind(int view, const char *kind)
{
    fake_say(
        &fake, &ann,
        "{\"type\":\"view.open\",\"view\":%d,\"follow\":true,\"document\":{\"kind\":\"%s\",\"size_px\":[300,200]}}",
        view, kind);
}

static void answer_all(void)
{
    for (struct fake_request *request; (request = fake_oldest(&fake)) != NULL;) {
        fake_draw(&fake, request);
        for (int view = 1; view <= 4; view++)
            for (size_t f = 0; f < ann.n_frames; f++)
                if (ann.frames[f].view == (uint32_t)view)
                    fake_say(&fake, &ann, "{\"type\":\"frame.shown\",\"view\":%d,\"sequence\":%u}", view,
                             ann.frames[f].sequence);
        fake_pass(&fake, 300);
    }
}

static void a_crosshair_moved_in_one_pane_requests_the_two_others_and_says_what_stays(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    open_kind(1, "3d");
    open_kind(2, "axial");
    open_kind(3, "sagittal");
    open_kind(4, "coronal");
    answer_all();
    fake_say(
        &fake, &ann,
        "{\"type\":\"scene.patch\",\"patch\":{\"image\":{\"slices\":{\"axial\":{\"visible\":false}}}},\"input\":1}");
    answer_all();
    size_t before = fake.n_requests;
    fake_say(&fake, &ann,
             "{\"type\":\"scene.patch\",\"patch\":{\"image\":{\"slices\":{\"sagittal\":{\"position_mm\":7},"
             "\"coronal\":{\"position_mm\":8}}}},\"input\":2}");
    cJSON *said = fake_heard(&ann, "scene");
    const cJSON *unchanged = cJSON_GetObjectItem(said, "unchanged");
    assert_int_equal(cJSON_GetArraySize(unchanged), 2);
    assert_int_equal(cJSON_GetArrayItem(unchanged, 0)->valueint, 1);
    assert_int_equal(cJSON_GetArrayItem(unchanged, 1)->valueint, 2);
    cJSON_Delete(said);
    answer_all();
    assert_true(fake.n_requests > before);
    for (size_t i = before; i < fake.n_requests; i++) {
        const char *kind = json_text(fake.requests[i].view, "kind");
        assert_true(strcmp(kind, "sagittal") == 0 || strcmp(kind, "coronal") == 0);
    }
}

static void a_view_with_an_override_is_drawn_anew_by_every_change(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    fake_say(&fake, &ann,
             "{\"type\":\"view.open\",\"view\":1,\"follow\":true,\"document\":{\"kind\":\"3d\",\"size_px\":[300,200],"
             "\"override\":{\"image\":{\"slices\":{\"coronal\":{\"visible\":true}}}}}}");
    answer_all();
    size_t before = fake.n_requests;
    fake_say(&fake, &ann,
             "{\"type\":\"scene.patch\",\"patch\":{\"image\":{\"slices\":{\"coronal\":{\"position_mm\":8}}}}}");
    assert_true(fake.n_requests > before);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_slice_that_moves_reaches_its_own_pane_and_3d_where_it_is_shown_there),
        cmocka_unit_test(an_oblique_plane_reaches_its_own_pane_and_3d_where_it_is_shown_there),
        cmocka_unit_test(what_is_drawn_in_3d_only_reaches_3d_and_measures_reach_nothing),
        cmocka_unit_test(all_else_reaches_every_picture_unless_it_changes_nothing),
        ROOM_TEST(a_crosshair_moved_in_one_pane_requests_the_two_others_and_says_what_stays),
        ROOM_TEST(a_view_with_an_override_is_drawn_anew_by_every_change),
    };
    return cmocka_run_group_tests_name("reach", tests, NULL, NULL);
}
