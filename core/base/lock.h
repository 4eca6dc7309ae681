#pragma once
/* A lock for a table that many threads read for microseconds at a time, where a queue would cost more than the work
 * itself: who makes a request (server/auth). Everything else crosses threads by queue.h and mailbox.h. */
struct lock;

struct lock *lock_create(void);
void lock_destroy(struct lock *lock); /* NULL: nothing; nobody may hold it */
void lock_hold(struct lock *lock);    /* waits for it; not twice in one thread */
void lock_release(struct lock *lock);
