#pragma once
/* A one-slot mailbox between threads: a new letter replaces one that was not taken yet, so a slow reader skips letters
 * but never falls behind. Lock-free. */
struct mailbox;

/* drop frees a letter that is replaced, or left when the mailbox is destroyed; NULL: letters are not freed. */
struct mailbox *mailbox_create(void (*drop)(void *letter));
void mailbox_destroy(struct mailbox *box);
void mailbox_put(struct mailbox *box, void *letter); /* takes letter; any thread; never blocks */
void *mailbox_take(struct mailbox *box); /* the letter, now the caller's, or NULL; any thread; never blocks */
