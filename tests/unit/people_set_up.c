/* A room of people who have signed in, and who comes to it: people_set_up.h. */
#include "tests/unit/people_set_up.h"

const struct identity pat = { .source = IDENTITY_PASSWORD, .user = "pat", .name = "Pat Lee" },
                      pat_too = { .source = IDENTITY_PROXY, .user = "plee", .name = "Pat Lee" },
                      rae = { .source = IDENTITY_PASSWORD,
                              .user = "rae",
                              .name = "Rae",
                              .groups = { "physics" },
                              .n_groups = 1 },
                      oli = { .source = IDENTITY_PASSWORD, .user = "oli", .name = "Oli" },
                      zoe = { .source = IDENTITY_PASSWORD, .user = "zoe", .name = "Zoe" },
                      nobody = { .source = IDENTITY_NOBODY };

static bool role_of(const struct identity *who, enum wire_member_role *role)
{
    static const struct {
        const struct identity *who;
        enum wire_member_role role;
    } roles[] = { { &pat, WIRE_MEMBER_ROLE_PLANNER },
                  { &pat_too, WIRE_MEMBER_ROLE_PLANNER },
                  { &rae, WIRE_MEMBER_ROLE_REVIEWER },
                  { &oli, WIRE_MEMBER_ROLE_OBSERVER } };
    for (size_t i = 0; i < sizeof roles / sizeof roles[0]; i++)
        if (strcmp(who->user, roles[i].who->user) == 0) {
            *role = roles[i].role;
            return true;
        }
    return false;
}

static void start(int max_members)
{
    fake_room_start_with(&fake, &(struct room_limits){ .max_members = max_members, .admits_guests = true });
    fake_sign_in(&fake, role_of);
    room_set_owner(fake.room, "pat");
    fake_plan_ready(&fake, true);
}

int people_start(void **state)
{
    (void)state;
    start(8);
    return 0;
}

void people_start_again(int max_members)
{
    fake_room_end(&fake);
    start(max_members);
}

void say_hello(struct fake_page *page, const struct identity *who, const char *more)
{
    page->identity = who;
    fake_say(&fake, page, "{\"type\":\"hello\",\"protocol\":2%s}", more);
}

void by_link(struct fake_page *page, const struct identity *who, const char *token)
{
    char more[100];
    (void)snprintf(more, sizeof more, ",\"link\":\"%s\",\"name\":\"Gus\",\"person\":\"p%p\"", token, (void *)page);
    say_hello(page, who, more);
}

void make_link(enum wire_member_role role, bool allows_guests, char token[33])
{
    struct problem problem = { 0 };
    const struct room_link wanted = {
        .role = role, .expires_s = 3600, .allows_guests = allows_guests, .maker = "pat", .name = "Thursday"
    };
    assert_true(room_link_make(fake.room, &wanted, fake.now_us, token, &problem));
}

const char *me(const struct fake_page *page)
{
    static char id[64];
    (void)snprintf(id, sizeof id, "%s", heard(page, "welcome", "member"));
    return id;
}

void expect_refused(const struct fake_page *page, const char *code, const char *reason)
{
    assert_true(page->is_closed);
    assert_int_equal(fake_n_heard(page, "welcome"), 0);
    assert_string_equal(heard(page, "bye", "code"), code);
    assert_string_equal(heard(page, "bye", "reason"), reason);
}

const char *of_member(const struct fake_page *page, const char *id, const char *field)
{
    static char text[200];
    cJSON *message = fake_heard(page, "members"), *row;
    text[0] = 0;
    cJSON_ArrayForEach(row, cJSON_GetObjectItem(message, "members"))
    {
        if (strcmp(json_text(row, "id"), id) != 0)
            continue;
        const char *value = json_text(row, field);
        (void)snprintf(text, sizeof text, "%s", value ? value : json_flag(row, field, false) ? "true" : "");
    }
    cJSON_Delete(message);
    return text;
}
