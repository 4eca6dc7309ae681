#pragma once
/* The net thread's state, shared by the files of server/net: connections, rooms, outstanding picture requests. Internal
 * to server/net; everything on the net thread, but for the two atomics. */
#include <stdatomic.h>

#include <pthread.h>

#include "core/base/queue.h"
#include "server/fleet/fleet.h"
#include "server/net/net.h"
#include "server/net/plan_rights.h"
#include "server/room/room.h"
#include "server/store/store.h"
#include "server/wire/identity.h"
#include "server/ws/ws.h"

struct net;

struct visitor { /* one WebSocket connection, from its opening on */
    struct visitor *next;
    struct ws_connection *connection;
    struct net_room *room;    /* NULL: its room was closed, or still sleeps */
    char asleep[64];          /* id of the room that is being woken for it; "": none */
    struct early_text *early; /* what it has said meanwhile */
    size_t n_early_bytes;
    bool holds_plan; /* fleet_hold, on the room's plan */
    bool waits;      /* the plan is not held before it is a member: others than the machine's person */
    bool is_refused; /* bye was said, for want of a room */
    bool is_outside; /* has said nothing; the room, which is not listed to it, is not woken for it */
    struct identity identity;
};

struct early_text {
    struct early_text *next;
    size_t n;
    char text[];
};

struct picture_request { /* sent to the fleet and not yet answered */
    struct picture_request *next;
    struct net_room *room;
    uint64_t fleet_request, room_request;
    uint32_t scene_revision;
    uint8_t flags, quality, scale_percent; /* for the frame's header */
    bool is_override;                      /* the packet carries a scene of its own */
};

struct gathering;

struct prompt_write { /* of one item, which counts when it is on disk */
    struct prompt_write *next;
    uint64_t ticket, number;     /* of the store; of the room */
    struct store_room *row;      /* waits until the plan's files were looked at; NULL: it is with the store */
    struct gathering *gathering; /* then, of a decision, for its pictures (keep_figures.h); NULL: for nothing of that */
};

struct net_room { /* a room and what the net thread keeps beside it */
    struct net *net;
    struct room *room;
    struct picture_request *requests;
    bool renderer_has_scene; /* the renderer was sent the room's present scene */
    /* the plan as last reported to the room */
    uint32_t generation; /* 0: never ready */
    enum fleet_state state;
    char phase[200];
    double percent;
    int64_t wake_us;        /* when room_settle is due */
    int64_t empty_since_us; /* 0: a member is connected */
    struct {
        unsigned changed;          /* parts (enum room_part) that are to be written */
        uint64_t ticket;           /* of the write under way; 0: none */
        uint32_t writing, written; /* revisions: in the write under way, on disk */
        int64_t due_us;            /* no write begins before */
        struct store_item *items;  /* changed ones that are to be written, each once */
        size_t n_items;
        struct store_recording *recordings; /* changed ones, with batches that are to be written */
        size_t n_recordings;
        char **audit; /* rows that are to be written */
        size_t n_audit;
        struct prompt_write *prompts; /* items whose writing is under way */
        bool is_refused;              /* the store dropped a write, which it can never make */
    } keep;
};

struct asleep_room { /* kept on disk alone */
    struct store_summary facts;
    uint64_t ticket; /* of the reading under way; 0: none */
};

struct waiter { /* for a room that is being read */
    struct waiter *next;
    char room[64];
    uint64_t ticket; /* of the read that looks for the room of a bookmark, whose token stands in room; 0: none */
    void (*done)(void *context, const char *room_id, const struct problem *problem);
    void *context;
};

struct list_waiter { /* for a list of the plan folders */
    struct list_waiter *next;
    uint64_t number; /* of the list */
    void (*done)(void *context);
    void *context;
};

struct record_reader { /* waits for records */
    struct record_reader *next;
    uint64_t ticket;
    net_records_read *done;
    void *context;
};

struct audit_reader { /* waits for rows of the audit */
    struct audit_reader *next;
    uint64_t ticket;
    net_audit_read *done;
    void *context;
};

struct part_reader { /* waits for a part of a recording */
    struct part_reader *next;
    uint64_t ticket;
    void (*done)(void *context, const char *const *texts, size_t n, int64_t next_ms, const struct problem *problem);
    void *context;
};

struct net {
    pthread_t thread;
    struct ws *ws;
    struct fleet *fleet;
    struct queue *tasks;
    struct visitor *visitors;
    struct net_room **rooms; /* room for max_rooms */
    size_t n_rooms;
    int max_rooms, room_idle_close_s;
    struct room_limits limits;
    struct auth *auth;   /* NULL: nobody signs in */
    int64_t sign_ins_us; /* when sign-ins are looked at next */
    struct store *store; /* NULL: rooms are not kept */
    bool store_fails, store_is_full;
    struct asleep_room *asleep;
    size_t n_asleep, n_unchanged; /* n_unchanged: of them, in which nobody changed anything */
    struct waiter *waiters;
    struct part_reader *readers;
    struct record_reader *record_readers;
    struct audit_reader *audit_readers;
    struct often *often; /* often.c */
    size_t n_often;
    struct erasing *erasing;                            /* erase.c; NULL: no plan is being erased */
    const struct room_meeting_callbacks *meeting_doors; /* of every room: meeting_doors.h */
    struct meetings *meetings;                          /* meeting_list.c; NULL: there were none yet */
    struct statements *statements;                      /* statements.c; NULL: there were none yet */
    struct list_waiter *list_waiters;
    char (*undeleted)[64]; /* rooms whose deletion the store could not take yet */
    size_t n_undeleted;
    uint64_t n_tickets;
    struct identity caller; /* of the call that is being handled */
    bool has_caller;
    char **audit; /* rows for the audit of no room that is open */
    size_t n_audit;
    size_t n_audit_waiting; /* rows that are not on disk yet, of all rooms, those under way included */
    uint64_t n_audit_lost;  /* rows that found neither disk nor memory since the last row that did */
    struct net_audit_head audit_head;
    struct plan_rights plan_rights;
    bool is_alone; /* as in struct net_options */
    bool (*is_still)(void *context, struct identity *who);
    void *rights;
    void (*identities_looked)(void *context); /* net_on_identities; NULL: nobody asks */
    void *identities_context;
    int64_t looked_us;   /* when it is called as well: net_look_at; 0: at no time */
    bool store_was_open; /* so the rooms that sleep are known */
    void (*files_looked)(struct net_room *entry, const struct fleet_plan *plan); /* keep_files_looked */
    int64_t look_us;                    /* when files of plans are looked at next */
    int64_t fleet_tick_us;              /* when fleet_tick is due */
    int64_t calm_from_us;               /* unless somebody does something before, fleet_tick is rare from then on */
    int64_t due_us;                     /* not after the earliest time that a room, or looked_us, is due: schedule.h */
    bool is_spoken_to;                  /* a room is */
    struct room_counters closed;        /* sum over the rooms that were closed */
    atomic_bool is_listed, is_stopping; /* read by any thread */
};
