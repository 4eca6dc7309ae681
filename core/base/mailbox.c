/* The mailbox is one atomic pointer. */
#include "core/base/mailbox.h"

#include <stdatomic.h>
#include <stdlib.h>

#include "core/base/mem.h"

struct mailbox {
    _Atomic(void *) letter;
    void (*drop)(void *letter);
};

struct mailbox *mailbox_create(void (*drop)(void *letter))
{
    struct mailbox *box = mem_new(sizeof *box);
    atomic_init(&box->letter, NULL);
    box->drop = drop;
    return box;
}

void mailbox_put(struct mailbox *box, void *letter)
{
    void *old = atomic_exchange(&box->letter, letter);
    if (old && box->drop)
        box->drop(old);
}

void *mailbox_take(struct mailbox *box)
{
    return atomic_exchange(&box->letter, NULL);
}

void mailbox_destroy(struct mailbox *box)
{
    if (!box)
        return;
    mailbox_put(box, NULL);
    free(box);
}
