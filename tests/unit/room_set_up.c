/* A room for three and four pages. */
#include "tests/unit/room_set_up.h"

struct fake_room fake;
struct fake_page ann, ben, cem, dee;

int room_start(void **state)
{
    (void)state;
    fake_room_start(&fake, 3);
    fake_plan_ready(&fake, true);
    return 0;
}

int room_end(void **state)
{
    (void)state;
    fake_room_end(&fake);
    fake_page_end(&ann);
    fake_page_end(&ben);
    fake_page_end(&cem);
    fake_page_end(&dee);
    return 0;
}

void settle_one(void)
{
    fake_settle(&fake, (struct fake_page *const[]){ &ann }, 1);
}

void settle_two(void)
{
    fake_settle(&fake, (struct fake_page *const[]){ &ann, &ben }, 2);
}

const char *heard(const struct fake_page *page, const char *type, const char *field)
{
    static char text[256];
    cJSON *json = fake_heard(page, type);
    assert_non_null(json);
    const char *value = json_text(json, field);
    (void)snprintf(text, sizeof text, "%s", value ? value : "");
    cJSON_Delete(json);
    return text;
}

const char *refused(const struct fake_page *page)
{
    static char text[256];
    cJSON *json = fake_heard(page, "problem");
    assert_non_null(json);
    const cJSON *problem = cJSON_GetObjectItem(json, "problem");
    const char *pointer = json_text(problem, "pointer");
    (void)snprintf(text, sizeof text, "%d %s", (int)json_number(problem, "status", 0), pointer ? pointer : "");
    cJSON_Delete(json);
    return text;
}
