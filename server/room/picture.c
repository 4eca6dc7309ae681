/* Reference counting of pictures. */
#include <stdlib.h>

#include "server/room/room.h"

struct room_picture *room_picture_hold(struct room_picture *picture)
{
    picture->references++;
    return picture;
}

void room_picture_drop(struct room_picture *picture)
{
    if (!picture || --picture->references > 0)
        return;
    free(picture->bytes);
    cJSON_Delete(picture->missing);
    free(picture);
}
