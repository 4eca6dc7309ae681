#pragma once
/* A one-slot mailbox: a newer letter replaces one nobody has taken yet, so a slow reader skips
 * letters but never falls behind. The mailbox drops what it replaces and what is left at the end. */
struct mailbox;

struct mailbox *mailbox_create(void (*drop)(void *letter));
void mailbox_destroy(struct mailbox *box);
void mailbox_put(struct mailbox *box, void *letter); /* takes letter; any thread; never blocks */
void *mailbox_take(struct mailbox *box);             /* gives the letter or NULL; never blocks */
