#pragma once
/* Set-up of a test of who comes into a room: Pat's, which lets in guests by links that say so. */
#include "tests/unit/room_set_up.h"

/* Pat is planner, Rae reviewer, Oli observer on the plan; Zoe has no role on it. Two are called Pat. */
extern const struct identity pat, pat_too, rae, oli, zoe, nobody;

int people_start(void **state);
#define PEOPLE_TEST(name) cmocka_unit_test_setup_teardown(name, people_start, room_end)
/* Like people_start in place of the room that is there, for so many members. */
void people_start_again(int max_members);

/* more: fields of the message after the protocol, with a comma before each. */
void say_hello(struct fake_page *page, const struct identity *who, const char *more);
/* Says hello as Gus, another person in each page. */
void by_link(struct fake_page *page, const struct identity *who, const char *token);
void make_link(enum wire_member_role role, bool allows_guests, char token[33]);
/* The page's member. Good until the next call. */
const char *me(const struct fake_page *page);
/* A field of the member with this id in the newest list, "" for none; "true" of a bool. */
const char *of_member(const struct fake_page *page, const char *id, const char *field);
void expect_refused(const struct fake_page *page, const char *code, const char *reason);
