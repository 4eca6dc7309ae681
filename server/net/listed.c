/* The list of rooms, awake and asleep: listed.h. */
#include "server/net/listed.h"

#include <stdio.h>
#include <string.h>

#include "core/base/clock.h"
#include "server/net/asleep.h"
#include "server/net/net_state.h"
#include "server/net/rooms.h"

size_t net_n_listed(const struct net *net)
{
    return net->n_rooms + net->n_asleep;
}

const char *net_listed_plan(const struct net *net, size_t index)
{
    return index < net->n_rooms ? room_plan_id(net->rooms[index]->room) : net->asleep[index - net->n_rooms].facts.plan;
}

static bool is_line_of(const char *lines, const char *line)
{
    const size_t n = strlen(line);
    for (const char *at = lines; n && at && (at = strstr(at, line)); at++)
        if ((at == lines || at[-1] == '\n') && at[n] == '\n')
            return true;
    return false;
}

static bool find_awake(const struct net_room *entry, const struct identity *who, struct net_listed *row)
{
    const struct room *room = entry->room;
    const bool is_machine = who->source == IDENTITY_MACHINE;
    struct store_room kept;
    if ((entry->empty_since_us && room_n_named(room) > 0 && !room_was_changed(room)) || /* it leaves no trace */
        (!is_machine && !room_is_listed_to(room, who)))
        return false;
    row->is_mine = is_machine || strcmp(room_owner(room), who->user) == 0 || room_was_in(room, who);
    if (!row->is_mine && room_keep(room, ROOM_PEOPLE, &kept)) {
        row->is_mine = room_people_name(kept.owner, kept.people, who, true);
        room_kept_finish(&kept);
    }
    const int64_t empty_ms = entry->empty_since_us ? (clock_now_us() - entry->empty_since_us) / 1000 : 0;
    row->name = room_name(room);
    row->used_ms = clock_wall_ms() - empty_ms;
    room_names_in(room, row->names);
    return true;
}

static bool find_asleep(const struct net *net, size_t index, const struct identity *who, struct net_listed *row)
{
    const struct store_summary *facts = &net->asleep[index].facts;
    if (!facts->is_changed || !net_asleep_is_listed_to(net, index, who))
        return false;
    row->is_mine = who->source == IDENTITY_MACHINE || is_line_of(facts->users, who->user) ||
                   room_people_name(facts->owner, facts->people, who, true);
    row->name = facts->name;
    row->used_ms = facts->used_ms;
    (void)snprintf(row->names, sizeof row->names, "%s", facts->names ? facts->names : "");
    return true;
}

bool net_listed_at(const struct net *net, size_t index, const struct identity *who, struct net_listed *row)
{
    *row = (struct net_listed){ .name = "" };
    return index < net->n_rooms ? find_awake(net->rooms[index], who, row)
                                : find_asleep(net, index - net->n_rooms, who, row);
}

static cJSON *asleep_document(const struct net *net, const struct store_summary *facts)
{
    char known[64];
    const struct room_facts row = { .id = facts->id,
                                    .plan_id = rooms_plan_id_now(net, facts->plan, known),
                                    .name = facts->name,
                                    .names = facts->names ? facts->names : "",
                                    .revision = facts->revision,
                                    .renderer = WIRE_RENDERER_STATE_CLOSED,
                                    .created_at_s = facts->created_ms / 1000,
                                    .n_notes = facts->n_notes };
    return room_document_of(&row);
}

cJSON *net_listed_document(const struct net *net, size_t index, const struct net_listed *row)
{
    cJSON *json = index < net->n_rooms ? room_document(net->rooms[index]->room)
                                       : asleep_document(net, &net->asleep[index - net->n_rooms].facts);
    cJSON_AddBoolToObject(json, "is_mine", row->is_mine);
    cJSON_AddNumberToObject(json, "used_ms", (double)row->used_ms);
    return json;
}

const char *net_room_name(const struct net *net, const char *room_id)
{
    const struct net_room *room = rooms_find(net, room_id);
    const struct asleep_room *asleep = room ? NULL : asleep_find(net, room_id);
    return room ? room_name(room->room) : asleep ? asleep->facts.name : NULL;
}
