#pragma once
/* Set-up of a test of a room: a fake room for three whose plan is ready, and four pages that have said nothing. */
#include "tests/unit/room_fake.h"

extern struct fake_room fake;
extern struct fake_page ann, ben, cem, dee;

int room_start(void **state);
int room_end(void **state);
#define ROOM_TEST(name) cmocka_unit_test_setup_teardown(name, room_start, room_end)

/* Draws and shows until no request is outstanding: Ann alone, or Ann and Ben. */
void settle_one(void);
void settle_two(void);
/* The text of a field of the newest message of a type. Good until the next call, as is the other. */
const char *heard(const struct fake_page *page, const char *type, const char *field);
/* Status and pointer of the newest problem, as "422 /regions/liver". */
const char *refused(const struct fake_page *page);
