/* Reference counting of pictures. */
#include <stdlib.h>

#include "server/room/state/room_types.h"

struct room_picture *room_picture_hold(struct room_picture *picture)
{
    atomic_fetch_add(&picture->references, 1);
    return picture;
}

void room_picture_drop(struct room_picture *picture)
{
    if (!picture || atomic_fetch_sub(&picture->references, 1) > 1)
        return;
    for (int i = 0; i < IMAGE_N_REDUCED; i++)
        room_picture_drop(picture->reduced[i]); /* these have none */
    room_picture_drop(picture->marked);
    free(picture->bytes);
    cJSON_Delete(picture->missing);
    free(picture);
}
