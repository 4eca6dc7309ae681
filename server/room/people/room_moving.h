#pragma once
/* Public part of how the people of a room go on to the room of a meeting's next case. Included by room.h. */
#include "server/room/state/room_types.h"

struct message_meeting;
struct message_meeting_case;

/* A member who is connected. Borrowed until the next call into the room. */
struct room_present {
    void *connection;
    const char *id, *name, *user, *link, *person; /* user, link: as in struct store_member; person: of who_key */
    int color;
    enum wire_member_role role;
    bool is_guest, presents, looks_alone, waits_outside;
};

/* A seat that is made for somebody who comes from the room of another case. Texts are borrowed. */
struct room_seat {
    const char *name, *user, *link, *person;
    int color;
    enum wire_member_role role;
    bool is_guest, presents;
};

/* The index-th member, from 0 on. False: there are not so many. present->connection NULL: it is away. */
bool room_present_at(const struct room *room, size_t index, struct room_present *present);
/* The member at this connection; false: it has not said hello. */
bool room_present_of(const struct room *room, void *connection, struct room_present *present);
/* Makes a seat, or gives back one of the same person that is free; id gets 64 bytes, secret 33. Who presents, presents
 * from now on as after a lost connection: for ROOM_PRESENTER_KEPT_S. False with problem limit: the room is full. */
NODISCARD bool room_seat_make(struct room *room, const struct room_seat *seat, int64_t now_us, char id[64],
                              char secret[33], struct problem *problem);
/* Tells the member that its meeting.next was refused after all. */
void room_refuse_next(struct room *room, const char *member, const struct problem *problem);
/* Puts out who came in by the link with these digits, which is none of the room's own; returns how many. */
size_t room_remove_of_link(struct room *room, const char *digits, int64_t now_us);
/* The member at this connection waits until the meeting is in a case that is open to it, or does not any more. */
void room_set_waiting(struct room *room, void *connection, bool waits);
void room_tell_meeting(struct room *room, void *connection, const struct message_meeting *told);
void room_tell_case(struct room *room, void *connection, const struct message_meeting_case *told);
/* Gives the newest decision that was made at or after since_ms and is not corrected. False: there is none. */
bool room_decision(const struct room *room, int64_t since_ms, char decision[24], char by[164], int64_t *decided_ms);
/* The stays of its people: as presence_list. NULL: no memory. */
NODISCARD cJSON *room_stays(const struct room *room);
