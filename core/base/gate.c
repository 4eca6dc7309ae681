/* A count of those inside, and a flag, under one mutex. */
#include "core/base/gate.h"

#include <assert.h>
#include <pthread.h>
#include <stddef.h>
#include <stdlib.h>

#include "core/base/mem.h"

struct gate {
    pthread_mutex_t mutex;
    pthread_cond_t empty;
    size_t n_inside;
    bool is_closed;
};

struct gate *gate_create(void)
{
    struct gate *gate = mem_new(sizeof *gate);
    pthread_mutex_init(&gate->mutex, NULL);
    pthread_cond_init(&gate->empty, NULL);
    return gate;
}

void gate_destroy(struct gate *gate)
{
    if (!gate)
        return;
    pthread_cond_destroy(&gate->empty);
    pthread_mutex_destroy(&gate->mutex);
    free(gate);
}

bool gate_enter(struct gate *gate)
{
    pthread_mutex_lock(&gate->mutex);
    bool is_open = !gate->is_closed;
    gate->n_inside += is_open;
    pthread_mutex_unlock(&gate->mutex);
    return is_open;
}

void gate_leave(struct gate *gate)
{
    pthread_mutex_lock(&gate->mutex);
    assert(gate->n_inside > 0);
    if (--gate->n_inside == 0)
        pthread_cond_broadcast(&gate->empty);
    pthread_mutex_unlock(&gate->mutex);
}

void gate_close(struct gate *gate)
{
    pthread_mutex_lock(&gate->mutex);
    gate->is_closed = true;
    while (gate->n_inside > 0)
        pthread_cond_wait(&gate->empty, &gate->mutex);
    pthread_mutex_unlock(&gate->mutex);
}
