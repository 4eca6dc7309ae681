/* Random rooms of people who have signed in, guests and links, against a simple model of the people let in. After each
 * act the members are those of the model with their roles, and each call has the right that its person has there. */
#include <stdarg.h>

#include "server/room/state/room_state.h"
#include "tests/unit/room_fake.h"

enum { N_SEEDS = 120, N_STEPS = 90, N_USERS = 5, N_PEOPLE = 7, MAX_LINKS = 24, MAX_SEATS = 120, NO_LINK = -1 };
enum { PAT, LEE, RAE, OLI, ZOE, GUS, GIA }; /* the last two never sign in */
static const char *const users[N_USERS] = { "pat", "lee", "rae", "oli", "zoe" };
/* their roles on the plan; Zoe has none */
static const enum wire_member_role caps[N_USERS] = { WIRE_MEMBER_ROLE_PLANNER, WIRE_MEMBER_ROLE_PLANNER,
                                                     WIRE_MEMBER_ROLE_REVIEWER, WIRE_MEMBER_ROLE_OBSERVER };

struct seat {
    struct fake_page page;
    char id[64], secret[64];
    int person, link;
    enum wire_member_role role;
    bool is_there, is_connected;
};

struct made_link {
    char token[33], digits[9];
    enum wire_member_role role;
    bool admits_guests, is_over;
};

static struct fake_room fake;
static struct identity identities[N_PEOPLE];
static struct seat *seats[MAX_SEATS];
static struct made_link links[MAX_LINKS];
static int n_seats, n_links;
static bool is_named[N_USERS], is_open, is_banned[N_PEOPLE];
static int links_at_ban[N_PEOPLE]; /* links made before it do not let in */
static unsigned random_state;
static char act[200];

static int choose(int n)
{
    random_state = random_state * 1664525U + 1013904223U;
    return (int)(random_state >> 8) % n;
}

static bool role_of(const struct identity *who, enum wire_member_role *role)
{
    for (int i = 0; i < ZOE; i++)
        if (strcmp(who->user, users[i]) == 0) {
            *role = caps[i];
            return true;
        }
    return false;
}

static void did(const char *format, ...)
{
    va_list args;
    va_start(args, format);
    (void)vsnprintf(act, sizeof act, format, args);
    va_end(args);
}

/* ---- the model -------------------------------------------------------------------------------------------------- */

static bool is_user(int person)
{
    return person < N_USERS;
}

/* Comes in without a link: who made the room, was asked in, or in an open room has a role on the plan. */
static bool has_own_right(int person)
{
    return person < ZOE && (person == PAT || is_named[person] || is_open);
}

static bool link_admits(int person, int link)
{
    return !links[link].is_over && (is_user(person) || links[link].admits_guests) &&
           !(is_banned[person] && link < links_at_ban[person]);
}

static enum wire_member_role link_role(int person, int link)
{
    const bool is_more = links[link].role == WIRE_MEMBER_ROLE_PRESENTER || links[link].role == WIRE_MEMBER_ROLE_PLANNER;
    return !is_user(person) && is_more ? WIRE_MEMBER_ROLE_REVIEWER : links[link].role;
}

/* ---- checking --------------------------------------------------------------------------------------------------- */

static const struct member *find(const char *id)
{
    for (int i = 0; i < fake.room->members.n; i++)
        if (strcmp(fake.room->members.list[i]->id, id) == 0)
            return fake.room->members.list[i];
    return NULL;
}

static void check(unsigned seed, int step)
{
    int n_connected = 0;
    for (int i = 0; i < n_seats; i++) {
        const struct seat *seat = seats[i];
        const struct member *member = find(seat->id);
        const bool is_connected = member && member->connection == &seat->page;
        if (is_connected != seat->is_connected)
            fail_msg("seed %u, step %d, %s: %s is %sconnected", seed, step, act, seat->id, is_connected ? "" : "not ");
        n_connected += is_connected;
        if (!is_connected)
            continue;
        if (member->role != seat->role)
            fail_msg("seed %u, step %d, %s: %s has role %d, not %d", seed, step, act, seat->id, (int)member->role,
                     (int)seat->role);
        assert_string_equal(member->user, is_user(seat->person) ? users[seat->person] : "");
        assert_int_equal(member->is_guest, !is_user(seat->person));
        if (fake.room->presenter == member)
            assert_true(!member->is_guest && member->role != WIRE_MEMBER_ROLE_OBSERVER);
    }
    assert_int_equal(room_n_connected(fake.room), n_connected);
    for (int person = 0; person < N_PEOPLE; person++) {
        const struct room_caller caller = room_caller_of(fake.room, &identities[person], NULL);
        if (caller.is_here != (has_own_right(person) && !is_banned[person]))
            fail_msg("seed %u, step %d, %s: a call of person %d is %shere", seed, step, act, person,
                     caller.is_here ? "" : "not ");
        assert_true(!caller.is_here || caller.role == caps[person]);
    }
    for (int i = 0; i < n_seats; i++) { /* a seat over HTTP is its user's alone */
        char member[140];
        const int other = choose(N_PEOPLE);
        (void)snprintf(member, sizeof member, "%s %s", seats[i]->id, seats[i]->secret);
        const bool is_same = is_user(other) ? other == seats[i]->person : !is_user(seats[i]->person);
        if (room_caller_of(fake.room, &identities[other], member).is_here != (is_same && find(seats[i]->id)))
            fail_msg("seed %u, step %d, %s: a call of person %d with the seat of %s", seed, step, act, other,
                     seats[i]->id);
    }
}

/* ---- acts ------------------------------------------------------------------------------------------------------- */

static struct seat *new_seat(int person, int link, enum wire_member_role role)
{
    struct seat *seat = calloc(1, sizeof *seat);
    assert_non_null(seat);
    *seat = (struct seat){ .person = person, .link = link, .role = role };
    return seat;
}

/* Says hello on the page of this seat; more: what else it says. True: it was let in. */
static bool hello(struct seat *seat, const char *more)
{
    fake_page_end(&seat->page);
    seat->page.identity = &identities[seat->person];
    fake_say(&fake, &seat->page, "{\"type\":\"hello\",\"protocol\":2,\"name\":\"g%d\",\"person\":\"p%d\"%s}",
             seat->person, seat->person, more);
    cJSON *welcome = fake_heard(&seat->page, "welcome");
    if (welcome) {
        (void)snprintf(seat->id, sizeof seat->id, "%s", json_text(welcome, "member"));
        (void)snprintf(seat->secret, sizeof seat->secret, "%s", json_text(welcome, "secret"));
    }
    cJSON_Delete(welcome);
    return !seat->page.is_closed;
}

static void expect(bool is_in, bool expected)
{
    if (is_in != expected)
        fail_msg("%s: was %slet in", act, is_in ? "" : "not ");
}

static void enter(int person, int link)
{
    char more[80] = "";
    struct seat *seat = new_seat(person, link, link == NO_LINK ? caps[person % N_USERS] : link_role(person, link));
    const bool expected = link == NO_LINK ? has_own_right(person) && !is_banned[person] : link_admits(person, link);
    did("person %d enters by link %d", person, link);
    if (link != NO_LINK)
        (void)snprintf(more, sizeof more, ",\"link\":\"%s\"", links[link].token);
    expect(hello(seat, more), expected);
    if (!expected) {
        fake_page_end(&seat->page);
        free(seat);
        return;
    }
    is_banned[person] = false; /* came by a later link, or was not */
    seat->is_there = seat->is_connected = true;
    seats[n_seats++] = seat;
}

/* Somebody, perhaps somebody else, comes back with what this seat proves itself by. */
static void come_back(struct seat *seat, int person)
{
    char more[220];
    const bool is_same = is_user(person) ? person == seat->person : !is_user(seat->person);
    const bool is_in = is_same && (seat->link != NO_LINK || (has_own_right(person) && !is_banned[person]));
    did("person %d comes back as %s of person %d", person, seat->id, seat->person);
    if (!is_same || !is_in) { /* anew, and only by one's own right */
        struct seat *other = new_seat(person, NO_LINK, caps[person % N_USERS]);
        const bool expected = !is_same && has_own_right(person) && !is_banned[person];
        (void)snprintf(more, sizeof more, ",\"member\":\"%s\",\"secret\":\"%s\"", seat->id, seat->secret);
        expect(hello(other, more), expected);
        if (expected) {
            assert_string_not_equal(other->id, seat->id);
            other->is_there = other->is_connected = true;
            seats[n_seats++] = other;
            return;
        }
        fake_page_end(&other->page);
        free(other);
        return;
    }
    if (seat->is_connected) {
        room_connection_closed(fake.room, &seat->page, fake.now_us);
        fake.again_us = room_settle(fake.room, fake.now_us);
    }
    char id[64];
    (void)snprintf(id, sizeof id, "%s", seat->id);
    (void)snprintf(more, sizeof more, ",\"member\":\"%s\",\"secret\":\"%s\"", seat->id, seat->secret);
    const int was = seat->person;
    seat->person = person;
    expect(hello(seat, more), true);
    seat->person = is_user(person) ? person : was;
    assert_string_equal(seat->id, id);
    seat->is_connected = true;
    if (seat->link == NO_LINK)
        seat->role = caps[person];
}

static void leave(struct seat *seat)
{
    did("%s leaves", seat->id);
    room_connection_closed(fake.room, &seat->page, fake.now_us);
    fake.again_us = room_settle(fake.room, fake.now_us);
    seat->is_connected = false;
}

static void ask_in(void)
{
    char text[300] = "";
    struct problem problem = { 0 };
    is_open = choose(4) == 0;
    for (int i = LEE; i < N_USERS; i++) {
        is_named[i] = choose(2) == 0;
        if (!is_named[i])
            continue;
        is_banned[i] = false;
        (void)snprintf(text + strlen(text), sizeof text - strlen(text), "%s{\"who\":\"%s\"}", text[0] ? "," : "",
                       users[i]);
    }
    did("people are %s, open %d", text, is_open);
    char whole[400];
    (void)snprintf(whole, sizeof whole, "{\"is_open\":%s,\"people\":[%s]}", is_open ? "true" : "false", text);
    cJSON *patch = json_read(whole, strlen(whole), NULL);
    assert_true(room_people_patch(fake.room, patch, &identities[PAT], NULL, "", fake.now_us, &problem));
    cJSON_Delete(patch);
}

static void make_link(void)
{
    struct problem problem = { 0 };
    struct made_link *link = &links[n_links++];
    *link = (struct made_link){ .role = (enum wire_member_role)choose(4), .admits_guests = choose(2) == 0 };
    const struct room_link wanted = { .role = link->role,
                                      .expires_s = ROOM_LINK_MAX_S,
                                      .allows_guests = link->admits_guests,
                                      .maker = "pat",
                                      .name = "" };
    did("link %d is made", n_links - 1);
    assert_true(room_link_make(fake.room, &wanted, fake.now_us, link->token, &problem));
    room_link_digits(link->token, link->digits);
}

/* The seat is none any more. */
static void lose(struct seat *seat)
{
    if (seat->is_connected)
        assert_true(seat->page.is_closed);
    seat->is_there = seat->is_connected = false;
}

static bool is_last_planner(const struct seat *seat)
{
    const struct member *member = find(seat->id);
    if (!member || member->role != WIRE_MEMBER_ROLE_PLANNER)
        return false;
    for (int i = 0; i < fake.room->members.n; i++)
        if (fake.room->members.list[i]->role == WIRE_MEMBER_ROLE_PLANNER &&
            strcmp(fake.room->members.list[i]->user, member->user) != 0)
            return false;
    return true;
}

static void end_link(int link, bool is_all)
{
    did("link %d ends, %s", link, is_all ? "with its members" : "alone");
    if (is_all) /* the last planner of a room stays */
        for (int i = 0; i < n_seats; i++)
            if (seats[i]->is_there && seats[i]->link == link && seats[i]->role == WIRE_MEMBER_ROLE_PLANNER)
                return;
    assert_true(
        (is_all ? room_link_revoke_all : room_link_revoke)(fake.room, links[link].digits, NULL, "", fake.now_us));
    links[link].is_over = true;
    for (int i = 0; i < n_seats; i++)
        if (is_all && seats[i]->is_there && seats[i]->link == link)
            lose(seats[i]);
}

static void remove_member(struct seat *by, struct seat *seat)
{
    did("%s removes %s", by->id, seat->id);
    const bool may = by->person != seat->person && find(seat->id) && !is_last_planner(seat) &&
                     (by->role == WIRE_MEMBER_ROLE_PLANNER || by->role == WIRE_MEMBER_ROLE_PRESENTER);
    const size_t n_before = fake_n_heard(&by->page, "problem");
    fake_say(&fake, &by->page, "{\"type\":\"member.remove\",\"member\":\"%s\"}", seat->id);
    if ((fake_n_heard(&by->page, "problem") == n_before) != may)
        fail_msg("%s: %s", act, may ? "was refused" : "was not refused");
    if (!may)
        return;
    const int person = seat->person;
    is_banned[person] = true;
    links_at_ban[person] = n_links;
    if (is_user(person))
        is_named[person] = false;
    else
        links[seat->link].is_over = true;
    for (int i = 0; i < n_seats; i++)
        if (seats[i]->is_there && seats[i]->person == person)
            lose(seats[i]);
}

/* All leave; the room is kept, and made again of what was kept. */
static void sleep_and_wake(void)
{
    struct store_room kept;
    did("the room sleeps and wakes");
    for (int i = 0; i < n_seats; i++)
        if (seats[i]->is_connected)
            leave(seats[i]);
    assert_true(room_keep(fake.room, ROOM_ALL_PARTS, &kept));
    fake_room_end(&fake);
    fake_room_start_with(&fake, &(struct room_limits){ .max_members = 60, .admits_guests = true });
    fake_sign_in(&fake, role_of);
    room_restore(fake.room, &kept, fake.now_us);
    room_kept_finish(&kept);
    fake_plan_ready(&fake, true);
}

/* One of the seats that are there, connected or not; NULL: there is none. */
static struct seat *some_seat(bool is_connected)
{
    for (int tries = 0; n_seats && tries < 40; tries++) {
        struct seat *seat = seats[choose(n_seats)];
        if (seat->is_there && (!is_connected || seat->is_connected))
            return seat;
    }
    return NULL;
}

static void step(void)
{
    const int what = choose(20);
    struct seat *seat = some_seat(what == 9 || what == 10), *by = some_seat(true);
    if (n_seats > MAX_SEATS - 4)
        return;
    if (what < 4)
        enter(choose(N_PEOPLE), NO_LINK);
    else if (what < 8 && n_links)
        enter(choose(N_PEOPLE), choose(n_links));
    else if (what < 9 && seat)
        come_back(seat, choose(3) ? seat->person : choose(N_PEOPLE));
    else if (what < 11 && seat)
        leave(seat);
    else if (what < 13)
        ask_in();
    else if (what < 15 && n_links < MAX_LINKS)
        make_link();
    else if (what < 16 && n_links && !links[n_links - 1].is_over)
        end_link(n_links - 1, choose(2) == 0);
    else if (what < 18 && seat && by && is_user(seat->person))
        remove_member(by, seat);
    else if (what < 19)
        sleep_and_wake();
    else
        fake_pass(&fake, 1000 * (choose(2) ? 40 : ROOM_MEMBER_KEPT_S + 1));
}

static void only_who_may_is_in_the_room_and_as_what_they_may(void **state)
{
    (void)state;
    for (int i = 0; i < N_USERS; i++) {
        identities[i].source = IDENTITY_PASSWORD;
        (void)snprintf(identities[i].user, sizeof identities[i].user, "%s", users[i]);
    }
    for (unsigned seed = 1; seed <= N_SEEDS; seed++) {
        random_state = seed;
        n_seats = n_links = 0;
        is_open = false;
        memset(is_named, 0, sizeof is_named);
        memset(is_banned, 0, sizeof is_banned);
        fake_room_start_with(&fake, &(struct room_limits){ .max_members = 60, .admits_guests = true });
        fake_sign_in(&fake, role_of);
        room_set_owner(fake.room, users[PAT]);
        fake_plan_ready(&fake, true);
        for (int i = 0; i < N_STEPS; i++) {
            step();
            check(seed, i);
        }
        fake_room_end(&fake);
        for (int i = 0; i < n_seats; i++) {
            fake_page_end(&seats[i]->page);
            free(seats[i]);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(only_who_may_is_in_the_room_and_as_what_they_may) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
