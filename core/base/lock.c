/* One mutex. */
#include "core/base/lock.h"

#include <pthread.h>
#include <stdlib.h>

#include "core/base/mem.h"

struct lock {
    pthread_mutex_t mutex;
};

struct lock *lock_create(void)
{
    struct lock *lock = mem_new(sizeof *lock);
    (void)pthread_mutex_init(&lock->mutex, NULL);
    return lock;
}

void lock_destroy(struct lock *lock)
{
    if (!lock)
        return;
    (void)pthread_mutex_destroy(&lock->mutex);
    free(lock);
}

void lock_hold(struct lock *lock)
{
    (void)pthread_mutex_lock(&lock->mutex);
}

void lock_release(struct lock *lock)
{
    (void)pthread_mutex_unlock(&lock->mutex);
}
