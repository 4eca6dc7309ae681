#include "server/renderer/desk.h"

#include <poll.h>
#include <stdlib.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "core/base/mem.h"
#include "core/base/queue.h"

enum { CAPACITY = 2048, BUSY = 64 };

struct desk {
    struct queue *notes;
    int bell;
};

void note_destroy(struct note *note)
{
    if (!note)
        return;
    derive_destroy(note->derived);
    plan_destroy(note->plan);
    free(note->frame.picture.bytes);
    cJSON_Delete(note->body);
    free(note->blob);
    waiting_request_destroy(note->waiting);
    free(note);
}

static void drop_note(void *note)
{
    note_destroy(note);
}

struct desk *desk_create(void)
{
    struct desk *desk = mem_new(sizeof *desk);
    desk->bell = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (desk->bell < 0) {
        free(desk);
        return NULL;
    }
    desk->notes = queue_create(CAPACITY, drop_note);
    return desk;
}

void desk_destroy(struct desk *desk)
{
    if (!desk)
        return;
    queue_destroy(desk->notes);
    close(desk->bell);
    free(desk);
}

int desk_bell(const struct desk *desk)
{
    return desk->bell;
}

static void ring(struct desk *desk)
{
    uint64_t one = 1;
    if (write(desk->bell, &one, sizeof one) < 0)
        return; /* rung so often that nobody can miss it */
}

void desk_put(struct desk *desk, const struct note *note)
{
    struct note *copy = mem_new(sizeof *copy);
    *copy = *note;
    while (!queue_try_put(desk->notes, copy)) {
        ring(desk);
        poll(NULL, 0, 1);
    }
    ring(desk);
}

void desk_offer(struct desk *desk, const struct note *note)
{
    if (queue_length(desk->notes) < BUSY)
        desk_put(desk, note);
}

struct note *desk_take(struct desk *desk)
{
    struct note *note = queue_try_take(desk->notes);
    uint64_t rung;
    if (!note && read(desk->bell, &rung, sizeof rung) > 0)
        note = queue_try_take(desk->notes); /* laid down between looking and rearming */
    return note;
}
