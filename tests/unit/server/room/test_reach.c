/* Which pictures a change of the scene reaches, and that only these are requested anew. */
#include "server/room/state/reach.h"
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
                                     "{\"kind\":\"beam\"}",
                                     "{\"kind\":\"axial\"}",
                                     "{\"kind\":\"coronal\"}",
                                     "{\"kind\":\"sagittal\"}",
                                     "{\"kind\":\"oblique\",\"plane\":\"a\"}",
                                     "{\"kind\":\"oblique\",\"plane\":\"gone\"}",
                                     "{\"kind\":\"beam-slice\"}" };
/* b: along a beam; O: an oblique view of a plane that the scene does not have; B: across a beam, as O where the plan
 * has none */
static const char view_letters[] = "3bacsoOB";

/* The letters of the views that the patch reaches in a scene. */
static const char *reached_in(const char *scene, const char *patch_text)
{
    static char letters[16];
    cJSON *before = cJSON_Parse(scene), *patch = cJSON_Parse(patch_text);
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

static const char *reached(const char *patch_text)
{
    return reached_in(scene_text, patch_text);
}

static void a_slice_that_moves_reaches_its_own_pane_and_3d_where_it_is_shown_there(void **state)
{
    (void)state;
    assert_string_equal(reached("{\"image\":{\"slices\":{\"axial\":{\"position_mm\":9}}}}"), "3baOB");
    assert_string_equal(reached("{\"image\":{\"slices\":{\"coronal\":{\"position_mm\":9}}}}"), "c");
    assert_string_equal(reached("{\"image\":{\"slices\":{\"axial\":{\"position_mm\":1},\"coronal\":{\"position_mm\":9},"
                                "\"sagittal\":{\"position_mm\":9}}}}"),
                        "cs");
    assert_string_equal(reached("{\"image\":{\"slices\":{\"coronal\":{\"visible\":true}}}}"), "3b");
    assert_string_equal(reached("{\"image\":{\"slices\":{\"axial\":{\"visible\":false}}}}"), "3b");
}

static void an_oblique_plane_reaches_its_own_pane_and_3d_where_it_is_shown_there(void **state)
{
    (void)state;
    assert_string_equal(reached("{\"image\":{\"obliques\":{\"a\":{\"origin_mm\":[0,0,5]}}}}"), "o");
    assert_string_equal(reached("{\"image\":{\"obliques\":{\"a\":{\"normal\":[0,0,5]}}}}"), "o");
    assert_string_equal(reached("{\"image\":{\"obliques\":{\"a\":{\"visible\":true}}}}"), "3b");
    assert_string_equal(reached("{\"image\":{\"obliques\":{\"a\":{\"name\":\"along the beam\"}}}}"), "");
    assert_string_equal(reached("{\"image\":{\"obliques\":{\"a\":null}}}"), "o");
    assert_string_equal(reached("{\"image\":{\"obliques\":{\"gone\":{\"origin_mm\":[0,0,1],\"normal\":[0,0,1]}}}}"),
                        "O");
    assert_string_equal(reached("{\"image\":{\"obliques\":{\"b\":{\"origin_mm\":[0,0,1],\"visible\":true}}}}"), "3b");
}

static void what_is_drawn_in_3d_only_reaches_3d_and_measures_reach_nothing(void **state)
{
    (void)state;
    assert_string_equal(reached("{\"clip\":{\"axial_low\":{\"enabled\":true}}}"), "3b");
    assert_string_equal(reached("{\"axes\":{\"visible\":true}}"), "3b");
    assert_string_equal(reached("{\"image\":{\"volume\":{\"visible\":true}}}"), "3b");
    assert_string_equal(reached("{\"image\":{\"cull_below\":5}}"), "3b");
    assert_string_equal(reached("{\"lights\":{\"ambient\":0.5}}"), "3b");
    assert_string_equal(reached("{\"space\":{\"background\":\"#ffffff\"}}"), "3b");
    assert_string_equal(reached("{\"measures\":{\"m\":{\"kind\":\"angle\"}}}"), "");
}

/* The reach of a patch after another one. */
static const char *reached_after(const char *first, const char *patch_text)
{
    static char kept[1024];
    cJSON *scene = cJSON_Parse(scene_text), *patch = cJSON_Parse(first);
    assert_non_null(patch);
    cJSON *merged = json_merge(scene, patch);
    char *text = cJSON_PrintUnformatted(merged);
    assert_true(strlen(text) < sizeof kept);
    snprintf(kept, sizeof kept, "%s", text);
    cJSON_free(text);
    cJSON_Delete(scene);
    cJSON_Delete(patch);
    cJSON_Delete(merged);
    return reached_in(kept, patch_text);
}

static void axes_through_the_crosshair_go_with_it_in_3d(void **state)
{
    (void)state;
    static const char moved[] = "{\"image\":{\"slices\":{\"coronal\":{\"position_mm\":9}}}}";
    assert_string_equal(reached_after("{\"axes\":{\"visible\":true,\"form\":\"crosshair\"}}", moved), "3bc");
    assert_string_equal(reached_after("{\"axes\":{\"visible\":true,\"form\":\"box\"}}", moved), "c");
    assert_string_equal(reached_after("{\"axes\":{\"visible\":false,\"form\":\"crosshair\"}}", moved), "c");
}

static void a_change_of_dose_reaches_exactly_the_pictures_that_show_it(void **state)
{
    (void)state;
    static const char *const values[] = { "{\"dose\":{\"blood_ppm\":20}}", "{\"dose\":{\"quantity\":\"boron\"}}",
                                          "{\"dose\":{\"levels\":{\"a\":{\"value\":3}}}}",
                                          "{\"dose\":{\"weights\":{\"brain\":{\"cbe\":2}}}}",
                                          "{\"dose\":{\"id\":\"d\"}}" };
    static const char no_slice[] = "\"image\":{\"slices\":{\"axial\":{\"visible\":false}}}";
    static const char *const shown[][2] = {
        { "\"wash\":{\"visible\":true}", "acsoOB" }, { "\"lines\":{\"visible\":true}", "acsoOB" },
        { "\"surfaces\":{\"visible\":true}", "3b" }, { "\"coverage\":{\"visible\":true}", "3bacsoOB" },
        { "\"wash\":{\"visible\":false}", "" },
    };
    for (size_t i = 0; i < sizeof shown / sizeof shown[0]; i++)
        for (size_t v = 0; v < sizeof values / sizeof values[0]; v++) {
            char first[256];
            snprintf(first, sizeof first, "{%s,\"dose\":{%s}}", no_slice, shown[i][0]);
            assert_string_equal(reached_after(first, values[v]), shown[i][1]);
        }
    /* in 3-D a wash is on slices, caps, volumes and textures */
    assert_string_equal(reached_after("{\"dose\":{\"wash\":{\"visible\":true}}}", values[0]), "3bacsoOB");
    static const char *const in_3d[] = { "\"clip\":{\"axial_low\":{\"enabled\":true}},\"image\":{",
                                         "\"regions\":{\"brain\":{\"texture\":\"dose\"}},\"image\":{",
                                         "\"image\":{\"volume\":{\"visible\":true},",
                                         "\"image\":{\"obliques\":{\"a\":{\"visible\":true}}," };
    for (size_t i = 0; i < sizeof in_3d / sizeof in_3d[0]; i++) {
        char first[256];
        snprintf(first, sizeof first,
                 "{\"dose\":{\"wash\":{\"visible\":true}},%s\"slices\":{\"axial\":{\"visible\":false}}}}", in_3d[i]);
        assert_string_equal(reached_after(first, values[0]), "3bacsoOB");
    }
    /* switched on and off; the box of the grid; what is only words */
    assert_string_equal(reached("{\"dose\":{\"wash\":{\"visible\":true}}}"), "3bacsoOB");
    assert_string_equal(reached_after("{\"dose\":{\"lines\":{\"visible\":true}}}", "{\"dose\":{\"lines\":null}}"),
                        "3bacsoOB");
    assert_string_equal(reached("{\"dose\":{\"grid\":true}}"), "3bacsoOB");
    assert_string_equal(reached_after("{\"dose\":{\"grid\":true}}", "{\"dose\":{\"id\":\"d\"}}"), "3bacsoOB");
    assert_string_equal(reached_after("{\"dose\":{\"wash\":{\"visible\":true}}}",
                                      "{\"dose\":{\"weights_name\":\"x\"}}"),
                        "");
    assert_string_equal(reached("{\"dose\":{\"wash\":{\"opacity\":0.3},\"surfaces\":{\"clipped\":false}}}"), "");
    assert_string_equal(reached_after("{\"dose\":{\"compare\":{\"mode\":\"gamma\"}}}", values[0]), "3bacsoOB");
    assert_string_equal(reached("{\"constraints\":{\"c\":{\"metric\":\"mean\"}}}"), "");
}

static void beams_reach_what_lies_along_and_across_them_and_other_pictures_where_they_are_drawn(void **state)
{
    (void)state;
    static const char drafted[] = "{\"beam\":{\"draft\":{\"enabled\":true,\"line\":{\"entry_mm\":[0,0,9]}}}}",
                      moved[] = "{\"beam\":{\"draft\":{\"line\":{\"entry_mm\":[0,0,8]}}}}",
                      slid[] = "{\"beam\":{\"slice\":{\"along_mm\":5}}}", chosen[] = "{\"beam\":{\"id\":\"two\"}}";
    assert_string_equal(reached(slid), "B");
    assert_string_equal(reached_after("{\"beam\":{\"slice\":{\"visible\":true}}}", slid), "3bB");
    assert_string_equal(reached("{\"beam\":{\"slice\":{\"visible\":true}}}"), "3b");
    assert_string_equal(reached(chosen), "bB");
    assert_string_equal(reached_after("{\"beam\":{\"slice\":{\"visible\":true}}}", chosen), "3bB");
    assert_string_equal(reached_after("{\"clip\":{\"beam\":{\"enabled\":true}}}", chosen), "3bB");
    assert_string_equal(reached_after("{\"beam\":{\"looks\":{\"one\":{\"visible\":true}}}}", chosen), view_letters);
    assert_string_equal(reached("{\"beam\":{\"looks\":{\"one\":{\"visible\":true}}}}"), view_letters);
    assert_string_equal(reached(drafted), view_letters);
    assert_string_equal(reached_after(drafted, moved), view_letters);
    assert_string_equal(reached_after(drafted, "{\"beam\":{\"draft\":{\"enabled\":false}}}"), view_letters);
    assert_string_equal(reached(moved), ""); /* not enabled */
    assert_string_equal(reached("{\"beam\":{\"opacity\":0.5,\"kept\":{\"a\":{\"name\":\"first\"}}}}"), "");
    assert_string_equal(reached_after(drafted, "{\"beam\":{\"opacity\":0.5}}"), view_letters);
    assert_string_equal(reached_after(drafted, "{\"beam\":null}"), view_letters);
    /* the wash lies on the beam slice, too */
    assert_string_equal(reached_after("{\"dose\":{\"wash\":{\"visible\":true}},\"beam\":{\"slice\":{\"visible\":true}},"
                                      "\"image\":{\"slices\":{\"axial\":{\"visible\":false}}}}",
                                      "{\"dose\":{\"blood_ppm\":20}}"),
                        view_letters);
}

static void tracks_reach_views_into_space_while_they_are_shown(void **state)
{
    (void)state;
    static const char shown[] = "{\"tracks\":{\"visible\":true}}", played[] = "{\"tracks\":{\"count\":5}}";
    assert_string_equal(reached(shown), "3b");
    assert_string_equal(reached(played), "");
    assert_string_equal(reached_after(shown, played), "3b");
    assert_string_equal(reached_after(shown, "{\"tracks\":null}"), "3b");
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
        cmocka_unit_test(axes_through_the_crosshair_go_with_it_in_3d),
        cmocka_unit_test(a_change_of_dose_reaches_exactly_the_pictures_that_show_it),
        cmocka_unit_test(beams_reach_what_lies_along_and_across_them_and_other_pictures_where_they_are_drawn),
        cmocka_unit_test(tracks_reach_views_into_space_while_they_are_shown),
        cmocka_unit_test(all_else_reaches_every_picture_unless_it_changes_nothing),
        ROOM_TEST(a_crosshair_moved_in_one_pane_requests_the_two_others_and_says_what_stays),
        ROOM_TEST(a_view_with_an_override_is_drawn_anew_by_every_change),
    };
    return cmocka_run_group_tests_name("reach", tests, NULL, NULL);
}
