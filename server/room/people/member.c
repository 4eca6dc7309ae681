/* Lets members in and out. */
#include "server/room/people/member.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/room/items/item_list.h"
#include "server/room/out/audit.h"
#include "server/room/out/send.h"
#include "server/room/people/admission.h"
#include "server/room/people/control.h"
#include "server/room/people/known.h"
#include "server/room/people/links.h"
#include "server/room/people/look.h"
#include "server/room/people/pointers.h"
#include "server/room/people/presenter.h"
#include "server/room/state/member_list.h"
#include "server/room/state/presence.h"
#include "server/room/state/roles.h"
#include "server/room/state/secret.h"
#include "server/room/state/who.h"
#include "server/room/streams/lag.h"
#include "server/room/streams/wall.h"
#include "server/room/views/marks.h"
#include "server/room/views/member_view.h"

static const char replaced[] = "this member has come back on another connection";
static const char room_is_full[] = "the room is full";
static const char too_many_tabs[] = "this person has too many tabs of the room open: close one";
static const char link_is_full[] = "as many as may come by one link are in the room already";
static const char old_page[] = "the page speaks another protocol version: reload it";
static const char unrecorded[] = "what happens here is recorded, and the server's disk takes no more records now";
enum { FULL_RETRY_MS = 30000, UNRECORDED_RETRY_MS = 10000 };

static void member_free(struct room *room, int index)
{
    struct member *member = room->members.list[index];
    views_close(room, member);
    if (member_presents(room, member))
        room->presenter = NULL;
    free(member);
    room->members.list[index] = room->members.list[--room->members.n];
}

void members_free(struct room *room)
{
    while (room->members.n)
        member_free(room, room->members.n - 1);
}

int64_t members_settle_away(struct room *room)
{
    const int64_t kept_us = ROOM_MEMBER_KEPT_S * INT64_C(1000000);
    int64_t again_us = INT64_MAX;
    bool has_changed = false;
    for (int i = room->members.n - 1; i >= 0; i--) {
        const struct member *member = room->members.list[i];
        if (member->connection)
            continue;
        const bool is_wall = member->role == WIRE_MEMBER_ROLE_WALL; /* has no seat that would wait for it */
        const int64_t wall_us = member->is_expected ? ROOM_SEAT_KEPT_S * INT64_C(1000000) : 0;
        int64_t due_us = member->away_us + (is_wall ? wall_us : kept_us);
        if (room->now_us >= due_us) {
            if (!is_wall)
                known_add_member(room, member);
            member_free(room, i);
            has_changed = true;
        } else if (due_us < again_us) {
            again_us = due_us;
        }
    }
    if (has_changed)
        send_members(room);
    return again_us;
}

int64_t members_settle_lost(struct room *room)
{
    if (!room->members.has_lost)
        return INT64_MAX;
    for (int i = 0; i < room->members.n; i++) /* saying who is there may lose others */
        if (room->members.list[i]->is_lost) {
            member_disconnected(room, room->members.list[i], room->now_us);
            i = -1;
        }
    room->members.has_lost = false;
    return INT64_MAX;
}

int64_t members_settle(struct room *room)
{
    bool has_changed = presenter_settle(room);
    const int64_t lag_us = lags_settle(room, &has_changed);
    if (has_changed)
        send_members(room);
    return lag_us;
}

void member_disconnected(struct room *room, struct member *member, int64_t heard_us)
{
    member->is_lost = false;
    views_close(room, member);
    member->connection = NULL;
    member->is_naming = false;
    member->away_us = heard_us;
    control_left(room, member);
    audit_flush(room, member);
    presence_left(room, member);
    audit_tell(room, &(struct audit_act){ .by = member, .action = "leave", .before = -1, .after = -1 });
    (void)presenter_settle(room);
    send_members(room);
    pointer_end(room, member);
    look_end(room, member);
}

static bool name_is_taken(const struct room *room, const char *name)
{
    for (int i = 0; i < room->members.n; i++)
        if (strcmp(room->members.list[i]->name, name) == 0)
            return true;
    return false;
}

static int n_walls(const struct room *room)
{
    int n = 0;
    for (int i = 0; i < room->members.n; i++)
        n += member_is_wall(room->members.list[i]);
    return n;
}

/* Makes room for one more member by dropping the one away longest, who does not present. Returns false when there is
 * none. Walls have places of their own. */
static bool make_place(struct room *room, enum wire_member_role role)
{
    if (role == WIRE_MEMBER_ROLE_WALL)
        return n_walls(room) < ROOM_MAX_WALLS_IN;
    if (room->members.n - n_walls(room) < room->members.max)
        return true;
    int longest = -1;
    for (int i = 0; i < room->members.n; i++)
        if (!room->members.list[i]->connection && !member_is_wall(room->members.list[i]) &&
            !member_presents(room, room->members.list[i]) &&
            (longest < 0 || room->members.list[i]->away_us < room->members.list[longest]->away_us))
            longest = i;
    if (longest < 0)
        return false;
    known_add_member(room, room->members.list[longest]);
    member_free(room, longest);
    return true;
}

static struct member *member_create(struct room *room, const char *name, enum wire_member_role role)
{
    const char *kind = role == WIRE_MEMBER_ROLE_WALL ? "Wall" : "Reviewer";
    struct member *member = mem_new(sizeof *member);
    member->number = room->members.n_named = marks_next_number(room);
    (void)snprintf(member->id, sizeof member->id, "m%u", member->number);
    (void)snprintf(member->name, sizeof member->name, "%s", name);
    for (int number = 1; member->name[0] == 0 || (name[0] == 0 && name_is_taken(room, member->name)); number++)
        (void)snprintf(member->name, sizeof member->name, "%s %d", kind, number);
    secret_make(member->secret);
    member->role = role;
    member->color = color_of_newcomer(room);
    secret_hash(member->secret, member->secret_hash);
    room->members.list[room->members.n++] = member;
    return member;
}

struct member *member_seat(struct room *room, const char *name, enum wire_member_role role)
{
    return make_place(room, role) ? member_create(room, name, role) : NULL;
}

/* as: "new", "back", or "link" for a new one who came by a link. */
static void audit_entered(struct room *room, const struct member *member, const char *as)
{
    const struct audit_act row = {
        .by = member, .action = "open", .detail = cJSON_CreateObject(), .before = -1, .after = room->shared.revision
    };
    cJSON_AddStringToObject(row.detail, "as", as);
    audit_tell(room, &row);
}

static const char *address_of(const struct room *room, void *connection)
{
    return room->callbacks.address ? room->callbacks.address(room->callbacks.context, connection) : "";
}

static void refuse_entry(struct room *room, void *connection, const struct message_hello *hello,
                         const struct admitted *in)
{
    const struct identity *who = who_connects(room, connection);
    const struct audit_act row = { .action = "refused",
                                   .address = address_of(room, connection),
                                   .who = who,
                                   .detail = cJSON_CreateObject(),
                                   .is_refused = true,
                                   .before = -1,
                                   .after = -1 };
    cJSON_AddStringToObject(row.detail, "what", "hello");
    if (who_is_machine(who)) /* with sign-in it is anybody's word, and would make a row of each of a stranger's tries */
        cJSON_AddStringToObject(row.detail, "name", hello->name);
    cJSON_AddStringToObject(row.detail, "why", in->refusal);
    audit_tell(room, &row);
    send_bye_for(room, connection, in->code, -1, in->refusal);
}

/* The documents in the message are borrowed: message_finish is not called on it. */
static void welcome_member(struct room *room, struct member *member)
{
    struct message message = { .type = MESSAGE_WELCOME };
    struct message_welcome *welcome = &message.welcome;
    welcome->protocol = WIRE_PROTOCOL;
    (void)snprintf(welcome->room, sizeof welcome->room, "%s", room->id);
    (void)snprintf(welcome->member, sizeof welcome->member, "%s", member->id);
    (void)snprintf(welcome->secret, sizeof welcome->secret, "%s", member->secret);
    (void)snprintf(welcome->name, sizeof welcome->name, "%s", member->name);
    (void)snprintf(welcome->plan_id, sizeof welcome->plan_id, "%s", room->plan_id);
    welcome->plan = room->shared.plan;
    welcome->scene = room->shared.scene;
    welcome->revision = room->shared.revision;
    (void)snprintf(welcome->gl, sizeof welcome->gl, "%s", room->renderer.gl);
    welcome->sees_identity = member->role != WIRE_MEMBER_ROLE_WALL && room->callbacks.sees_identity &&
                             room->callbacks.sees_identity(room->callbacks.context, room, member->connection);
    cJSON *items = items_rows(room);
    welcome->items = items;
    send_to_member(room, member, &message);
    cJSON_Delete(items);
}

/* The member, in the list, whose seat hello proves to be this identity's. */
static struct member *find_seat(const struct room *room, const struct identity *who, const struct message_hello *hello)
{
    for (int i = 0; i < room->members.n && hello->member[0]; i++) {
        struct member *member = room->members.list[i];
        if (strcmp(member->id, hello->member) == 0 && secret_matches(hello->secret, member->secret_hash) &&
            who_has_seat(who, member->user, member->is_guest, member->role))
            return member;
    }
    return NULL;
}

/* A copy of what is kept of the member that left and whose seat this is, for free(). NULL: none. */
static struct member *find_known_seat(const struct room *room, const struct identity *who,
                                      const struct message_hello *hello)
{
    struct member *seat = mem_new(sizeof *seat);
    if (known_has(room, hello->member, hello->secret, seat) &&
        who_has_seat(who, seat->user, seat->is_guest, seat->role))
        return seat;
    free(seat);
    return NULL;
}

/* The seat is taken by its member again. */
static void sit_down_again(struct room *room, struct member *member)
{
    void *old = member->connection; /* half-open: the page notices a lost connection before the server does */
    member->is_lost = false;
    member->connection = NULL;
    member->is_naming = false;
    views_close(room, member);
    if (old)
        send_bye(room, old, -1, replaced);
}

static const char *name_of(const struct identity *who, const struct message_hello *hello, const struct admitted *in)
{
    if (in->role == WIRE_MEMBER_ROLE_WALL) /* nobody's name */
        return !hello->name[0] && in->link ? in->link->name : who_is_user(who) ? "" : hello->name;
    if (who_is_user(who))
        return who->name[0] ? who->name : who->user;
    return hello->name;
}

static void name_member(struct room *room, struct member *member, const struct identity *who,
                        const struct message_hello *hello, const struct admitted *in)
{
    const char *name = name_of(who, hello, in);
    member->role = in->role;
    member->is_guest = in->is_guest;
    if (who_is_user(who))
        (void)snprintf(member->user, sizeof member->user, "%s", who->user);
    if (in->link)
        link_digits(in->link, member->link);
    if (name[0])
        (void)snprintf(member->name, sizeof member->name, "%s", name);
    if (!member->secret[0]) /* it came back with the secret of which only the hash was kept */
        (void)snprintf(member->secret, sizeof member->secret, "%.32s", hello->secret);
    (void)snprintf(member->person, sizeof member->person, "%s", in->key);
    if (member_presents(room, member) && !member_has_right(member, WIRE_RIGHT_SCENE)) /* it had more rights before */
        control_pass(room, NULL);
}

/* The member of a hello that was let in; NULL: there is no place. as: of audit_entered. */
static struct member *take_place(struct room *room, void *connection, const struct identity *who,
                                 const struct message_hello *hello, const struct admitted *in, const char **as)
{
    if (!make_place(room, in->role))
        return NULL;
    struct member *left = find_known_seat(room, who, hello), *member = NULL;
    *as = left ? "back" : *as;
    if (left) {
        member = known_back(room, hello->member, hello->secret);
        room->members.list[room->members.n++] = member;
        free(left);
    } else {
        member = member_create(room, name_of(who, hello, in), in->role);
    }
    (void)snprintf(member->address, sizeof member->address, "%s", address_of(room, connection));
    if (in->link)
        link_used(room, in->link, member, in->key);
    return member;
}

static bool has_too_many_tabs(const struct room *room, const char *key)
{
    int n = 0;
    for (int i = 0; i < room->members.n && key[0]; i++)
        n += room->members.list[i]->connection && strcmp(room->members.list[i]->person, key) == 0;
    return n >= ROOM_MAX_TABS;
}

/* Counts those who have not signed in, as each can be another person every time. seat NULL: a new member. */
static bool is_link_full(const struct room *room, const struct admitted *in, const struct member *seat)
{
    const int most = room->members.max / 2 > ROOM_MIN_GUESTS ? room->members.max / 2 : ROOM_MIN_GUESTS;
    char digits[9] = "";
    int n = 0;
    if (in->link)
        link_digits(in->link, digits);
    else if (seat)
        (void)snprintf(digits, sizeof digits, "%s", seat->link);
    for (int i = 0; i < room->members.n && digits[0]; i++) {
        const struct member *member = room->members.list[i];
        n += member->connection && !member->user[0] && strcmp(member->link, digits) == 0;
    }
    return n >= (in->role == WIRE_MEMBER_ROLE_WALL ? ROOM_MAX_WALLS : most);
}

/* Where people sign in, nobody fills a room alone. False: bye was said. */
static bool leaves_places(struct room *room, void *connection, const struct identity *who, const struct admitted *in,
                          const struct member *seat)
{
    if (who_is_machine(who) || (seat && seat->connection)) /* which takes no place more */
        return true;
    if (has_too_many_tabs(room, in->key))
        send_bye(room, connection, -1, too_many_tabs);
    else if (!who_is_user(who) && is_link_full(room, in, seat))
        send_bye(room, connection, FULL_RETRY_MS, link_is_full);
    else
        return true;
    return false;
}

/* Decides on the connection, with the seat that hello proves, if it does. False: bye was said. */
static bool is_let_in(struct room *room, void *connection, const struct identity *who,
                      const struct message_hello *hello, const struct member *seat, struct admitted *in)
{
    *in = admission_decide(room, who, hello, seat);
    if (in->refusal[0]) {
        refuse_entry(room, connection, hello, in);
        return false;
    }
    if (hello->protocol != WIRE_PROTOCOL) { /* who is not let in is not even told that there is a room */
        send_bye(room, connection, -1, old_page);
        return false;
    }
    if (!audit_has_place(room, NULL)) {
        send_bye(room, connection, UNRECORDED_RETRY_MS, unrecorded);
        return false;
    }
    return leaves_places(room, connection, who, in, seat);
}

bool member_refuse_stranger(struct room *room, void *connection)
{
    static const struct message_hello nothing;
    const struct identity *who = who_connects(room, connection);
    if (who_is_machine(who))
        return false;
    const struct admitted in = admission_decide(room, who, &nothing, NULL);
    if (in.refusal[0])
        refuse_entry(room, connection, &nothing, &in);
    return in.refusal[0] != 0;
}

struct member *member_hello(struct room *room, void *connection, const struct message_hello *hello)
{
    const struct identity *who = who_connects(room, connection);
    struct admitted in;
    struct member *member = find_seat(room, who, hello);
    struct member *left = member ? NULL : find_known_seat(room, who, hello);
    const bool enters = is_let_in(room, connection, who, hello, member ? member : left, &in);
    free(left);
    if (!enters)
        return NULL;
    const char *as = member ? "back" : in.link ? "link" : "new";
    if (member)
        sit_down_again(room, member);
    else
        member = take_place(room, connection, who, hello, &in, &as);
    if (!member) {
        send_bye(room, connection, FULL_RETRY_MS, room_is_full);
        return NULL;
    }
    name_member(room, member, who, hello, &in);
    member->is_expected = false;
    member->connection = connection;
    (void)snprintf(member->address, sizeof member->address, "%s", address_of(room, connection));
    audit_entered(room, member, as);
    presence_entered(room, member);
    welcome_member(room, member);
    return member;
}

void member_drop(struct room *room, struct member *member)
{
    int index = 0;
    if (member->connection)
        member_disconnected(room, member, room->now_us);
    if (member_presents(room, member))
        control_pass(room, NULL);
    while (room->members.list[index] != member)
        index++;
    member_free(room, index);
}

void members_show(struct room *room, struct member *member)
{
    (void)presenter_settle(room);
    send_members_to_newcomer(room, member);
}
