/* Compares views by what they show: stream.h. */
#include <string.h>

#include "server/room/streams/stream.h"

int view_kind(const cJSON *view)
{
    const char *word = json_text(view, "kind");
    for (size_t i = 0; word && i < scene_kind_words.n; i++)
        if (strcmp(word, scene_kind_words.words[i]) == 0)
            return (int)i;
    return SCENE_KIND_3D;
}

bool views_are_alike(const cJSON *a, const cJSON *b)
{
    const char *plane_a = json_text(a, "plane"), *plane_b = json_text(b, "plane");
    if (view_kind(a) != view_kind(b) || json_number(a, "number", 1) != json_number(b, "number", 1))
        return false;
    return view_kind(a) != SCENE_KIND_OBLIQUE || strcmp(plane_a ? plane_a : "", plane_b ? plane_b : "") == 0;
}
