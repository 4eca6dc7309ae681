/* Roles, rights and colours of members. */
#include "server/room/state/roles.h"

#include <math.h>

#include "tests/unit/room_set_up.h"

/* ---- the table -------------------------------------------------------------------------------------------------- */

static void each_role_has_the_rights_of_the_design(void **state)
{
    static const struct {
        enum wire_member_role role;
        bool look, point, note, scene, control;
    } expected[] = { { WIRE_MEMBER_ROLE_OBSERVER, true, false, false, false, false },
                     { WIRE_MEMBER_ROLE_REVIEWER, true, true, true, true, false },
                     { WIRE_MEMBER_ROLE_PRESENTER, true, true, true, true, true } };
    (void)state;
    for (size_t i = 0; i < sizeof expected / sizeof expected[0]; i++) {
        assert_int_equal(role_has_right(expected[i].role, WIRE_RIGHT_LOOK), expected[i].look);
        assert_int_equal(role_has_right(expected[i].role, WIRE_RIGHT_POINT), expected[i].point);
        assert_int_equal(role_has_right(expected[i].role, WIRE_RIGHT_NOTE), expected[i].note);
        assert_int_equal(role_has_right(expected[i].role, WIRE_RIGHT_SCENE), expected[i].scene);
        assert_int_equal(role_has_right(expected[i].role, WIRE_RIGHT_CONTROL), expected[i].control);
    }
}

static void a_role_without_the_right_is_told_so_in_a_sentence(void **state)
{
    struct problem problem = { 0 };
    (void)state;
    assert_true(role_check(WIRE_MEMBER_ROLE_OBSERVER, WIRE_RIGHT_LOOK, &problem));
    assert_false(role_check(WIRE_MEMBER_ROLE_OBSERVER, WIRE_RIGHT_SCENE, &problem));
    assert_int_equal(problem.type, PROBLEM_FORBIDDEN);
    assert_string_equal(problem.code, "role");
    assert_string_equal(problem.detail,
                        "the role of observer does not include to present or change what the room shows");
}

/* ---- members ---------------------------------------------------------------------------------------------------- */

static const char *of_member(const struct fake_page *page, int index, const char *field)
{
    static char text[64];
    cJSON *message = fake_heard(page, "members");
    const char *found = json_text(cJSON_GetArrayItem(cJSON_GetObjectItem(message, "members"), index), field);
    (void)snprintf(text, sizeof text, "%s", found ? found : "");
    cJSON_Delete(message);
    return text;
}

static void the_first_member_is_presenter_and_further_ones_are_reviewers(void **state)
{
    (void)state;
    fake_hello(&fake, &ann);
    fake_hello(&fake, &ben);
    fake_hello(&fake, &cem);
    assert_string_equal(of_member(&ann, 0, "role"), "presenter");
    assert_string_equal(of_member(&ann, 1, "role"), "reviewer");
    assert_string_equal(of_member(&ann, 2, "role"), "reviewer");
}

static void colours_differ_and_come_back_with_the_member(void **state)
{
    char id[64], secret[64], color[8];
    (void)state;
    fake_hello(&fake, &ann);
    fake_hello(&fake, &ben);
    assert_string_equal(of_member(&ann, 0, "color"), "#56b4e9");
    (void)snprintf(color, sizeof color, "%s", of_member(&ann, 1, "color"));
    assert_string_not_equal(color, "#56b4e9");
    (void)snprintf(id, sizeof id, "%s", heard(&ben, "welcome", "member"));
    (void)snprintf(secret, sizeof secret, "%s", heard(&ben, "welcome", "secret"));
    room_connection_closed(fake.room, &ben, fake.now_us);
    fake_hello(&fake, &cem);
    assert_string_not_equal(of_member(&ann, 2, "color"), color); /* kept for Ben */
    fake_say(&fake, &dee, "{\"type\":\"hello\",\"protocol\":2,\"member\":\"%s\",\"secret\":\"%s\"}", id, secret);
    assert_string_equal(of_member(&ann, 1, "id"), id);
    assert_string_equal(of_member(&ann, 1, "color"), color);
    assert_string_equal(of_member(&ann, 1, "role"), "reviewer");
}

/* ---- colours ---------------------------------------------------------------------------------------------------- */

static double linear(uint32_t rgb, int shift)
{
    double c = (rgb >> shift & 0xff) / 255.0; /* sRGB, IEC 61966-2-1 */
    return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4);
}

static double luminance(uint32_t rgb)
{
    return 0.2126 * linear(rgb, 16) + 0.7152 * linear(rgb, 8) + 0.0722 * linear(rgb, 0);
}

/* Contrast ratio of WCAG 2.2. */
static double contrast(uint32_t a, uint32_t b)
{
    double first = luminance(a) + 0.05, second = luminance(b) + 0.05;
    return first > second ? first / second : second / first;
}

static double lab_f(double t)
{
    return t > 0.008856 ? cbrt(t) : 7.787 * t + 16.0 / 116;
}

/* CIE 1976, D65. */
static double distance(uint32_t a, uint32_t b)
{
    const uint32_t both[2] = { a, b };
    double lab[2][3];
    for (int i = 0; i < 2; i++) {
        double red = linear(both[i], 16), green = linear(both[i], 8), blue = linear(both[i], 0);
        double x = lab_f((0.4124 * red + 0.3576 * green + 0.1805 * blue) / 0.95047),
               y = lab_f(0.2126 * red + 0.7152 * green + 0.0722 * blue),
               z = lab_f((0.0193 * red + 0.1192 * green + 0.9505 * blue) / 1.08883);
        lab[i][0] = 116 * y - 16;
        lab[i][1] = 500 * (x - y);
        lab[i][2] = 200 * (y - z);
    }
    return sqrt(pow(lab[0][0] - lab[1][0], 2) + pow(lab[0][1] - lab[1][1], 2) + pow(lab[0][2] - lab[1][2], 2));
}

static void colours_can_be_read_and_told_apart(void **state)
{
    static const uint32_t panels[] = { 0x07080a, 0x303740, 0x12151a }; /* --bg0, --bg5, --ink of web/css/tokens.css */
    (void)state;
    for (int i = 0; i < ROLES_N_COLORS; i++) {
        for (size_t k = 0; k < sizeof panels / sizeof panels[0]; k++)
            assert_true(contrast(color_rgb(i), panels[k]) >= 4.5);
        for (int k = 0; k < i; k++)
            assert_true(distance(color_rgb(i), color_rgb(k)) >= 25);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_role_has_the_rights_of_the_design),
        cmocka_unit_test(a_role_without_the_right_is_told_so_in_a_sentence),
        ROOM_TEST(the_first_member_is_presenter_and_further_ones_are_reviewers),
        ROOM_TEST(colours_differ_and_come_back_with_the_member),
        cmocka_unit_test(colours_can_be_read_and_told_apart),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
