/* Chooses in which size a viewer is sent a shared picture. */
#include "server/room/streams/size_class.h"

#include <math.h>

enum { LARGEST_DIVISOR = 4 };

/* 1: the whole picture. A picture that fits the pane at 1/d or less touches two of its sides: then one side of the
 * picture is d times the pane's or more. */
static int divisor_of(const struct room *room, const struct member_view *view, int width_px, int height_px,
                      bool is_still)
{
    if (!view->is_following || room->replay)
        return 1;
    int divisor = LARGEST_DIVISOR;
    while (divisor > 1 && divisor * view->size_px[0] > width_px && divisor * view->size_px[1] > height_px)
        divisor /= 2;
    const bool is_slow = view->member->lag == WIRE_MEMBER_LAG_LINK && !is_still;
    return is_slow && divisor < LARGEST_DIVISOR ? 2 * divisor : divisor;
}

void size_classes_needed(const struct room *room, const struct stream *stream, int scale_percent, bool is_still,
                         bool is_reduced[IMAGE_N_REDUCED])
{
    const cJSON *size = cJSON_GetObjectItemCaseSensitive(stream->view, "size_px");
    int side_px[2];
    for (int i = 0; i < 2; i++) /* as the renderer rounds it */
        side_px[i] = (int)lround(cJSON_GetArrayItem(size, i)->valuedouble * scale_percent / 100);
    for (const struct member_view *view = stream->viewers; view; view = view->next_viewer)
        for (int i = 0; i < IMAGE_N_REDUCED; i++)
            if (divisor_of(room, view, side_px[0], side_px[1], is_still) == image_divisor(i))
                is_reduced[i] = true;
}

struct frame *size_class_picture(const struct room *room, const struct member_view *view, struct frame *picture,
                                 bool is_still)
{
    const int divisor = divisor_of(room, view, picture->header.width_px, picture->header.height_px, is_still);
    struct frame *smallest = picture;
    for (int i = 0; i < IMAGE_N_REDUCED && image_divisor(i) <= divisor; i++)
        if (picture->reduced[i])
            smallest = picture->reduced[i];
    return smallest;
}
