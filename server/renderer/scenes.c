/* Scenes by room, and snapshots of them. */
#include "server/renderer/scenes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/wire/acceptances.h"
#include "server/wire/document.h"

struct room_scene {
    char id[64];
    uint32_t revision;
    cJSON *scene;
    cJSON *acceptances; /* a list; NULL: none */
};

struct scenes {
    struct derive *derived; /* the plan's store */
    cJSON *plans_own;
    struct room_scene *rooms;
    size_t n_rooms, room_capacity; /* at most SCENE_MAX_ROOMS */
};

struct scenes *scenes_create(void)
{
    return mem_new(sizeof(struct scenes));
}

void scenes_destroy(struct scenes *scenes)
{
    if (!scenes)
        return;
    for (size_t i = 0; i < scenes->n_rooms; i++) {
        cJSON_Delete(scenes->rooms[i].scene);
        cJSON_Delete(scenes->rooms[i].acceptances);
    }
    free(scenes->rooms);
    cJSON_Delete(scenes->plans_own);
    free(scenes);
}

void scenes_set_plan(struct scenes *scenes, struct derive *derived)
{
    struct scene scene;
    scenes->derived = derived;
    scene_for_plan(derive_plan(derived), &scene);
    cJSON_Delete(scenes->plans_own);
    scenes->plans_own = scene_write(&scene);
    scene_finish(&scene);
}

const cJSON *scenes_default(const struct scenes *scenes)
{
    return scenes->plans_own;
}

static struct room_scene *find_room(const struct scenes *scenes, const char *id)
{
    for (size_t i = 0; i < scenes->n_rooms; i++)
        if (strcmp(scenes->rooms[i].id, id) == 0)
            return &scenes->rooms[i];
    return NULL;
}

/* NULL: there are SCENE_MAX_ROOMS already. */
static struct room_scene *add_room(struct scenes *scenes, const char *id)
{
    if (scenes->n_rooms == SCENE_MAX_ROOMS)
        return NULL;
    if (scenes->n_rooms == scenes->room_capacity) {
        size_t capacity = scenes->room_capacity ? 2 * scenes->room_capacity : 16;
        struct room_scene *rooms = mem_new(capacity * sizeof rooms[0]);
        if (scenes->n_rooms)
            memcpy(rooms, scenes->rooms, scenes->n_rooms * sizeof rooms[0]);
        free(scenes->rooms);
        scenes->rooms = rooms;
        scenes->room_capacity = capacity;
    }
    struct room_scene *room = &scenes->rooms[scenes->n_rooms++];
    *room = (struct room_scene){ .revision = 0 };
    (void)snprintf(room->id, sizeof room->id, "%s", id);
    return room;
}

bool scenes_put_room(struct scenes *scenes, const char *id, uint32_t revision, cJSON *scene, cJSON *acceptances)
{
    struct room_scene *room = find_room(scenes, id);
    if (!room)
        room = add_room(scenes, id);
    if (!room) {
        cJSON_Delete(scene);
        cJSON_Delete(acceptances);
        return false;
    }
    cJSON_Delete(room->scene);
    cJSON_Delete(room->acceptances);
    room->scene = scene;
    room->acceptances = acceptances;
    room->revision = revision;
    return true;
}

void scenes_forget_room(struct scenes *scenes, const char *id)
{
    struct room_scene *room = find_room(scenes, id);
    if (!room)
        return;
    cJSON_Delete(room->scene);
    cJSON_Delete(room->acceptances);
    *room = scenes->rooms[--scenes->n_rooms];
}

static bool read_view(const cJSON *document, struct view *view, struct problem *problem)
{
    cJSON *defaults = document ? NULL : cJSON_CreateObject();
    bool is_read = view_read(document ? document : defaults, view, problem);
    cJSON_Delete(defaults);
    return is_read;
}

struct snapshot *scenes_snapshot(const struct scenes *scenes, const struct packet_snapshot *shown, uint32_t *revision,
                                 struct problem *problem)
{
    const struct room_scene *room = find_room(scenes, shown->room);
    const cJSON *document = shown->scene;
    struct scene scene;
    struct view view;
    struct acceptances acceptances;
    *revision = shown->has_scene_revision ? (uint32_t)shown->scene_revision : room ? room->revision : 0;
    if (!document && shown->room[0] && !room) {
        (void)problem_set(problem, PROBLEM_NOT_FOUND, "/room", "", "nothing is known of room \"%.64s\"", shown->room);
        return NULL;
    }
    if (!document)
        document = room ? room->scene : scenes->plans_own;
    if (!scene_read(document, &scene, problem)) {
        problem_below(problem, "/scene");
        return NULL;
    }
    if (!read_view(shown->view, &view, problem)) {
        scene_finish(&scene);
        problem_below(problem, "/view");
        return NULL;
    }
    if (!acceptances_read(shown->acceptances ? shown->acceptances
                          : room             ? room->acceptances
                                             : NULL,
                          &acceptances, problem)) {
        scene_finish(&scene);
        view_finish(&view);
        return NULL;
    }
    char field[128] = "";
    struct error err = { 0 };
    struct snapshot *snapshot =
        snapshot_create_accepted(scenes->derived, &scene, &view, &acceptances, *revision, field, &err);
    acceptances_finish(&acceptances);
    if (!snapshot) {
        (void)problem_from_error(problem, &err);
        if (problem->type == PROBLEM_NOT_FOUND)
            problem->type = PROBLEM_VALIDATION; /* a field that names a part the plan does not have */
        (void)snprintf(problem->pointer, sizeof problem->pointer, "%s", field);
        problem_below(problem, strncmp(field, "/camera", 7) == 0 ? "/view" : "/scene");
    }
    return snapshot;
}
