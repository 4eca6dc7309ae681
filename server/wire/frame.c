/* Reference counting of frames. */
#include "server/wire/frame.h"

#include <stdlib.h>

struct frame *frame_ref(struct frame *frame)
{
    atomic_fetch_add(&frame->references, 1);
    return frame;
}

void frame_unref(struct frame *frame)
{
    if (!frame || atomic_fetch_sub(&frame->references, 1) > 1)
        return;
    for (int i = 0; i < IMAGE_N_REDUCED; i++)
        frame_unref(frame->reduced[i]); /* these have none */
    frame_unref(frame->marked);
    free(frame->bytes);
    cJSON_Delete(frame->missing);
    free(frame);
}
