/* A singly linked list in the order of use. */
#include "core/render/visible/kept.h"

void kept_put_first(struct kept **first, struct kept *kept)
{
    kept->next = *first;
    *first = kept;
}

void kept_use_again(struct kept **first, struct kept **at)
{
    struct kept *kept = *at;
    *at = kept->next;
    kept_put_first(first, kept);
}

static void drop(struct kept **at, const struct kept_type *type)
{
    struct kept *kept = *at;
    *at = kept->next;
    type->destroy(kept);
}

void kept_forget(struct kept **first, const struct kept_type *type, const struct plan *plan)
{
    for (struct kept **at = first; *at;)
        if (plan && (*at)->plan != plan)
            at = &(*at)->next;
        else
            drop(at, type);
}

void kept_trim(struct kept **first, const struct kept_type *type)
{
    size_t n = 0, size = 0;
    for (struct kept **at = first; *at;) {
        n++;
        size += type->size_of(*at);
        if (type->is_used(*at) || (n <= type->max_n && size <= type->max_size))
            at = &(*at)->next;
        else
            drop(at, type);
    }
}
