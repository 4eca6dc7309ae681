#pragma once
/* A picture with its header, as the page is sent it: counted, so that all receivers share the bytes. Knows neither
 * rooms nor sockets. */
#include <stdatomic.h>

#include "core/base/image_reduce.h"
#include "server/wire/frame_header.h"
#include "server/wire/json.h"

/* Frozen once it is handed over; any thread may take and give up references. */
struct frame {
    struct frame_header header; /* of the picture; each receiver gets a copy with its own view, sequence and input_id */
    uint8_t *bytes;
    size_t n_bytes;
    cJSON *missing; /* {n, regions: [{region, reason}]}: the regions that it leaves out because they cannot be drawn;
                       NULL: none */
    struct frame *reduced[IMAGE_N_REDUCED]; /* owned: the same of a half and of a quarter of the size, without missing;
                                               NULL: not made */
    struct frame *marked; /* owned: the same, of the whole size, with the words for a draft; NULL: not made */
    atomic_int references;
};

struct frame *frame_ref(struct frame *frame);
void frame_unref(struct frame *frame); /* NULL: nothing happens */
