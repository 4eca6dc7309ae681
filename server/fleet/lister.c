/* The thread that lists the plan folders. */
#include "server/fleet/lister.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/log.h"
#include "core/base/mailbox.h"
#include "core/base/mem.h"
#include "core/base/queue.h"

enum { IN_USE, WAKING, LEFT_BEHIND };

struct lister {
    pthread_t thread;
    char **folders;
    size_t n_folders;
    lister_function function;
    void (*wake)(void *context);
    void *context;
    struct queue *requested; /* holds at most one item, the lister: list again */
    struct queue *ended;     /* the same, put when the thread ends */
    struct mailbox *lists;   /* of struct numbered_list; a newer one replaces one that was not taken */
    _Atomic uint64_t n_requests;
    atomic_int state; /* WAKING: the thread is inside wake; LEFT_BEHIND: the owner is gone, wake must not be called */
    atomic_int references; /* the owner's and the thread's */
};

struct numbered_list {
    struct folder_list list;
    uint64_t number; /* requests before it was begun */
};

static void drop_list(void *letter)
{
    struct numbered_list *numbered = letter;
    folder_list_finish(&numbered->list);
    free(numbered);
}

static void unref(struct lister *lister)
{
    if (!lister || atomic_fetch_sub(&lister->references, 1) > 1)
        return;
    for (size_t i = 0; i < lister->n_folders; i++)
        free(lister->folders[i]);
    free(lister->folders);
    queue_destroy(lister->requested);
    queue_destroy(lister->ended);
    mailbox_destroy(lister->lists);
    free(lister);
}

/* Calls wake. Returns false when the owner is gone. */
static bool tell(struct lister *lister)
{
    int state = IN_USE;
    if (!atomic_compare_exchange_strong(&lister->state, &state, WAKING))
        return false;
    lister->wake(lister->context);
    atomic_store(&lister->state, IN_USE);
    return true;
}

static void *work(void *argument)
{
    struct lister *lister = argument;
    while (queue_take(lister->requested, -1)) {
        struct numbered_list *numbered = mem_new(sizeof *numbered);
        numbered->number = atomic_load(&lister->n_requests);
        lister->function((const char *const *)lister->folders, lister->n_folders, &numbered->list);
        mailbox_put(lister->lists, numbered);
        if (!tell(lister))
            break;
    }
    (void)queue_try_put(lister->ended, lister);
    unref(lister);
    return NULL;
}

struct lister *lister_create(const char *const *folders, size_t n_folders, lister_function function,
                             void (*wake)(void *context), void *context, struct error *err)
{
    struct lister *lister = mem_new(sizeof *lister);
    lister->folders = mem_new((n_folders + 1) * sizeof *lister->folders);
    for (; lister->n_folders < n_folders; lister->n_folders++)
        lister->folders[lister->n_folders] = mem_copy_text(folders[lister->n_folders]);
    lister->function = function;
    lister->wake = wake;
    lister->context = context;
    lister->requested = queue_create(1, NULL);
    lister->ended = queue_create(1, NULL);
    lister->lists = mailbox_create(drop_list);
    atomic_init(&lister->n_requests, 0);
    atomic_init(&lister->state, IN_USE);
    atomic_init(&lister->references, 2);
    int failed = pthread_create(&lister->thread, NULL, work, lister);
    if (!failed)
        return lister;
    error_set(err, ERROR_IO, "the thread that lists plan folders cannot be started: %s", strerror(failed));
    atomic_store(&lister->references, 1);
    unref(lister);
    return NULL;
}

void lister_destroy(struct lister *lister)
{
    if (!lister)
        return;
    (void)queue_try_take(lister->requested);
    queue_close(lister->requested);
    bool has_ended = queue_take(lister->ended, LISTER_LEAVE_MS) != NULL;
    int state = IN_USE;
    if (!has_ended && atomic_compare_exchange_strong(&lister->state, &state, LEFT_BEHIND)) {
        log_warn("the plan folders are still being listed: their disk does not answer");
        pthread_detach(lister->thread);
    } else {
        pthread_join(lister->thread, NULL);
    }
    unref(lister);
}

uint64_t lister_request(struct lister *lister)
{
    const uint64_t number = atomic_fetch_add(&lister->n_requests, 1) + 1;
    (void)queue_try_put(lister->requested, lister); /* full: one more listing is due already, and has this number */
    return number;
}

bool lister_take(struct lister *lister, struct folder_list *list, uint64_t *number)
{
    struct numbered_list *newest = mailbox_take(lister->lists);
    if (!newest)
        return false;
    *list = newest->list;
    *number = newest->number;
    free(newest);
    return true;
}
