#pragma once
/* A meeting: an agenda of cases, each a plan and its room; which case is now, how long each took, who may come, and
 * links that open whatever case is now. Plain data and its changes: no rooms, no sockets, no disk, no clock of its own
 * (now_ms, since 1970, is passed in). One thread. */
#include "server/auth/secret.h"
#include "server/store/store_rows.h"
#include "server/wire/named.h"

enum {
    MEETING_MAX_CASES = 40,
    MEETING_MAX_NAME = 80,    /* characters */
    MEETING_MAX_PEOPLE = 100, /* who may come without a link */
    MEETING_MAX_CAME = 200,   /* users who came by a link or along with others; beyond, they are not remembered */
    MEETING_MAX_BARRED = 64,  /* who were removed; of more, the first are forgotten */
    MEETING_MAX_LINKS = 32,   /* ever made, those that were ended included */
    MEETING_MAX_VISITS = 100, /* of one case that are told apart; the time of further ones counts with the last */
    MEETING_MAX_STAYS = 300,  /* of people in one case, in its attendance */
    MEETING_ID = 24,
    MEETING_TOKEN = 33 /* bytes of the token of a link, with the final zero */
};

struct meeting_link {
    unsigned char token_hash[SECRET_HASH_BYTES];
    enum wire_member_role role;
    bool allows_guests, is_ended;
    int64_t expires_ms;
    char maker[STORE_USER], name[161]; /* the user who made it, what it is for; "": not known */
};

struct meeting_visit {
    int64_t from_ms, to_ms;
};

struct meeting_case {
    char id[MEETING_ID], plan[64], room[64]; /* plan "": it was erased; room "": none was made yet */
    enum wire_member_role cap; /* role on the plan of who put it on the agenda: links of the meeting give no higher one
                                  in this case */
    struct meeting_visit visits[MEETING_MAX_VISITS]; /* that ended, the first first */
    size_t n_visits;
    char decision[24], decided_by[164]; /* the newest one of the meeting in this case; "": none */
    int64_t decided_ms;
    cJSON *stays; /* of people in its room, as in the room's attendance; NULL: none is known */
    char patient[64], label[164], approval[24]; /* masked, as the plan said last; "": not known. Not kept */
    bool opens; /* it is now for the first time, and its first saved view is still to be shown. Not kept */
};

struct meeting {
    char id[64], owner[STORE_USER], name[4 * MEETING_MAX_NAME + 1]; /* owner "": made without sign-in */
    int64_t created_ms, starts_ms, ended_ms;                        /* ended_ms 0: it is not over */
    uint32_t n_made;                                                /* cases ever made, for ids */
    char now[MEETING_ID];                                           /* the case that is now; "": none */
    int64_t since_ms;                                               /* since when it is */
    struct meeting_case *cases[MEETING_MAX_CASES];
    size_t n_cases;
    struct named people[MEETING_MAX_PEOPLE]; /* without a role: the highest that they have on the plans of the cases */
    size_t n_people;
    struct meeting_link links[MEETING_MAX_LINKS];
    size_t n_links;
    char came[MEETING_MAX_CAME][STORE_USER];
    size_t n_came;
    char barred[MEETING_MAX_BARRED][STORE_USER]; /* users who were removed from one of its rooms */
    size_t n_barred;
};

enum meeting_state { MEETING_PLANNED, MEETING_RUNNING, MEETING_OVER };
enum meeting_state meeting_state(const struct meeting *meeting);
const char *meeting_state_word(enum meeting_state state); /* "planned", "running", "over" */

NODISCARD struct meeting *meeting_create(const char *id, const char *owner, int64_t now_ms);
NODISCARD struct meeting *meeting_copy(const struct meeting *meeting); /* NULL: no memory */
void meeting_free(struct meeting *meeting);

/* ---- the agenda ---- */
struct meeting_case *meeting_find(const struct meeting *meeting, const char *case_id);
struct meeting_case *meeting_of_room(const struct meeting *meeting, const char *room);
size_t meeting_place(const struct meeting *meeting, const struct meeting_case *of); /* from 0 */
/* Puts a case before another one; before NULL or "": at the end. Each fails with problem limit, not-found, conflict. */
NODISCARD struct meeting_case *meeting_add(struct meeting *meeting, const char *plan, const char *room,
                                           const char *before, struct problem *problem);
NODISCARD bool meeting_order(struct meeting *meeting, const char *case_id, const char *before, struct problem *problem);
/* A case that was entered stays, as do its time and attendance: conflict. */
NODISCARD bool meeting_remove(struct meeting *meeting, const char *case_id, struct problem *problem);
/* The case that "next" names: behind the one of now, else the first. NULL with problem conflict. */
struct meeting_case *meeting_next(const struct meeting *meeting, struct problem *problem);
/* True if `from` is the case of now (NULL: none is); else false with problem conflict, code from. */
NODISCARD bool meeting_is_at(const struct meeting *meeting, const char *from, struct problem *problem);
/* The case is now, and opens if it never was. The meeting must not be over. Nothing happens when it is already. */
void meeting_go(struct meeting *meeting, struct meeting_case *to, int64_t now_ms);
void meeting_end(struct meeting *meeting, int64_t now_ms);
/* Time for which this case was now, all its visits together. */
int64_t meeting_spent_ms(const struct meeting *meeting, const struct meeting_case *of, int64_t now_ms);
bool meeting_was_entered(const struct meeting *meeting, const struct meeting_case *of);
/* When the case was now first; 0: never. */
int64_t meeting_first_ms(const struct meeting *meeting, const struct meeting_case *of);
/* Strikes out what is known of a plan that is erased. True: there was something. */
bool meeting_erase(struct meeting *meeting, const char *plan, const char *other);

/* ---- people ---- */
/* The highest role that the meeting itself allows this user: planner for its owner and who came. False: it does not
 * know them, or they were removed. */
bool meeting_allows(const struct meeting *meeting, const struct identity *who, enum wire_member_role *role);
/* True of its owner and those whom it names; false of those who only came. */
bool meeting_names(const struct meeting *meeting, const struct identity *who);
bool meeting_is_barred(const struct meeting *meeting, const char *user);
void meeting_came(struct meeting *meeting, const char *user);
/* Replaces people by [{who, role}]. False with problem: nothing of it was applied. */
NODISCARD bool meeting_set_people(struct meeting *meeting, const cJSON *list, struct problem *problem);
NODISCARD cJSON *meeting_people(const struct meeting *meeting);
NODISCARD bool meeting_set_name(struct meeting *meeting, const cJSON *name, struct problem *problem);
/* The member was removed from one of its rooms: they do not come to another before they are named in people again; the
 * link of a guest ends. */
void meeting_bar(struct meeting *meeting, const char *user, const char *link);

/* ---- links ---- */
/* Makes a link from wanted, which has no hash; token is filled in. False with problem limit. */
NODISCARD bool meeting_add_link(struct meeting *meeting, const struct meeting_link *wanted, char token[MEETING_TOKEN],
                                struct problem *problem);
/* The link of this token that lets in now; NULL: there is none. */
const struct meeting_link *meeting_link_of(const struct meeting *meeting, const char *token, int64_t now_ms);
/* The link with these digits, ended or not. */
struct meeting_link *meeting_link_find(struct meeting *meeting, const char *digits);
void meeting_link_digits(const struct meeting_link *link, char digits[9]);

/* ---- on disk ---- */
NODISCARD struct store_meeting *meeting_write(const struct meeting *meeting); /* NULL: no memory */
/* NULL: it is not readable, or there is no memory. */
NODISCARD struct meeting *meeting_read(const struct store_meeting *row);
