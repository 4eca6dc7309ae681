/* Writes and reads what is kept of a room. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/room/entry.h"
#include "server/room/people/admission.h"
#include "server/room/people/known.h"
#include "server/room/people/links.h"
#include "server/room/room.h"
#include "server/room/state/presence.h"
#include "server/room/streams/stream.h"
#include "server/room/streams/wall.h"
#include "server/wire/document.h"
#include "server/wire/json.h"

/* ---- writing ---------------------------------------------------------------------------------------------------- */

static bool write_members(const struct room *room, struct store_room *kept)
{
    size_t n = (size_t)(room->members.n + room->known->n);
    kept->members = mem_array(n, sizeof kept->members[0], 1 << 20, NULL);
    if (!kept->members)
        return false;
    for (int i = 0; i < room->known->n; i++)
        kept->members[kept->n_members++] = room->known->list[i];
    for (int i = 0; i < room->members.n; i++)
        if (!member_is_wall(room->members.list[i])) /* has no seat to come back to */
            known_write(room->members.list[i], &kept->members[kept->n_members++]);
    return true;
}

bool room_keep(const struct room *room, unsigned parts, struct store_room *kept)
{
    const cJSON *scene = room->shared.scene ? room->shared.scene : room->shared.restored;
    *kept = (struct store_room){ .created_ms = room->created_at_s * 1000,
                                 .revision = room->shared.revision,
                                 .n_named = room->members.n_named,
                                 .has_links = links_were_made(room) };
    (void)snprintf(kept->id, sizeof kept->id, "%s", room->id);
    (void)snprintf(kept->plan, sizeof kept->plan, "%s", room->plan_id);
    (void)snprintf(kept->name, sizeof kept->name, "%s", room->name);
    kept->is_changed = room_was_changed(room);
    admission_facts(room, kept);
    if (room->presenter)
        (void)snprintf(kept->presenter, sizeof kept->presenter, "%s", room->presenter->id);
    bool ok = true;
    if (ok && (parts & ROOM_SCENE) && scene)
        ok = (kept->scene = json_print(scene)) != NULL;
    if (ok && (parts & ROOM_VIEWS))
        ok = (kept->views = streams_write(room)) != NULL;
    if (ok && (parts & ROOM_MEMBERS))
        ok = write_members(room, kept);
    if (ok && (parts & ROOM_LINKS))
        ok = links_write(room, kept);
    if (ok && (parts & (ROOM_MEMBERS | ROOM_PEOPLE)))
        ok = admission_write(room, kept);
    if (ok && (parts & ROOM_PRESENCE))
        ok = (kept->presence = presence_write(room)) != NULL;
    if (!ok)
        room_kept_finish(kept);
    return ok;
}

void room_kept_finish(struct store_room *kept)
{
    free(kept->scene);
    free(kept->views);
    free(kept->presence);
    free(kept->people);
    free(kept->members);
    free(kept->links);
    *kept = (struct store_room){ 0 };
}

/* ---- reading ---------------------------------------------------------------------------------------------------- */

static cJSON *read_json(const struct room *room, const char *text, const char *what)
{
    struct problem problem = { 0 };
    cJSON *json = text ? json_read(text, strlen(text), &problem) : NULL;
    if (text && !json)
        log_error("room %s: %s is not readable in the database: %s", room->id, what, problem.detail);
    return json;
}

static void read_members(struct room *room, const struct store_room *kept)
{
    for (size_t i = 0; i < kept->n_members; i++) {
        const struct store_member *from = &kept->members[i];
        if (!id_is_valid(from->id))
            continue;
        if (from->has_left || room->members.n == room->members.max /* of people */) {
            known_add(room, from);
            continue;
        }
        struct member *member = mem_new(sizeof *member);
        known_read(from, member);
        member->away_us = room->now_us;
        room->members.list[room->members.n++] = member;
        if (strcmp(member->id, kept->presenter) == 0)
            room->presenter = member;
    }
}

void room_restore(struct room *room, const struct store_room *kept, int64_t now_us)
{
    room_enter(room, now_us);
    room->created_at_s = kept->created_ms / 1000;
    room->shared.revision = kept->revision;
    room->members.n_named =
        kept->n_named > room->members.n_named ? kept->n_named : room->members.n_named; /* items were restored before */
    room->shared.is_changed = kept->is_changed;
    (void)snprintf(room->name, sizeof room->name, "%s", kept->name);
    cJSON *scene = read_json(room, kept->scene, "the scene");
    if (cJSON_IsObject(scene))
        room->shared.restored = scene;
    else
        cJSON_Delete(scene);
    read_members(room, kept);
    admission_read(room, kept);
    presence_read(room, kept->presence);
    links_read(room, kept);
    cJSON *views = read_json(room, kept->views, "the list of views");
    streams_read(room, views);
    cJSON_Delete(views);
}
