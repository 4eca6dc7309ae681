/* Writes and reads the shared views of a room. */
#include <stdio.h>

#include "core/base/log.h"
#include "server/room/streams/stream.h"
#include "server/wire/json.h"

char *streams_write(const struct room *room)
{
    cJSON *list = cJSON_CreateArray();
    for (const struct stream *stream = room->streams.first; stream; stream = stream->next) {
        if (!stream->is_shared || stream->is_of_display)
            continue;
        cJSON *item = cJSON_CreateObject();
        json_add(item, "view", cJSON_Duplicate(stream->view, true));
        cJSON_AddStringToObject(item, "mover", stream->mover);
        json_append(list, item);
    }
    char *text = list ? json_print(list) : NULL;
    cJSON_Delete(list);
    return text;
}

void streams_read(struct room *room, const cJSON *list)
{
    const cJSON *item;
    int n = 0;
    cJSON_ArrayForEach(item, list)
    {
        struct problem problem = { 0 };
        const cJSON *kept = cJSON_GetObjectItemCaseSensitive(item, "view");
        cJSON *view = kept && n++ < 64 ? view_document_patch(NULL, kept, &problem) : NULL;
        if (!view) {
            log_error("room %s: a kept view is left out: %s", room->id, problem.detail);
            continue;
        }
        if (stream_shared(room, view)) {
            cJSON_Delete(view);
            continue;
        }
        const char *mover = json_text(item, "mover");
        struct stream *stream = stream_create(room, view, true);
        (void)snprintf(stream->mover, sizeof stream->mover, "%s", mover && id_is_valid(mover) ? mover : "");
    }
}
