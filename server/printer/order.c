/* Reads the head, then the paper and the pictures that it announces. */
#include "server/printer/order.h"

#include <stdlib.h>

static bool read_paper(struct order *order, size_t n, order_source *source, void *context)
{
    char *json = n <= PRINTER_MAX_JSON ? malloc(n + 1) : NULL;
    if (json && source(context, json, n))
        order->paper = json_read(json, n, NULL);
    free(json);
    return order->paper != NULL;
}

static bool read_picture(struct order *order, int i, size_t n, order_source *source, void *context)
{
    if (!n)
        return true;
    order->pictures[i] = n <= PRINTER_MAX_PICTURE ? malloc(n) : NULL;
    if (!order->pictures[i] || !source(context, order->pictures[i], n))
        return false;
    order->input.pictures[i] = order->pictures[i];
    order->input.n_pictures[i] = n;
    return true;
}

bool order_read(struct order *order, order_source *source, void *context)
{
    struct printer_head head;
    *order = (struct order){ .paper = NULL };
    if (!source(context, &head, sizeof head) || head.magic != PRINTER_MAGIC ||
        !read_paper(order, head.n_json, source, context))
        return false;
    order->input.paper = order->paper;
    order->input.is_letter = head.is_letter != 0;
    for (int i = 0; i < PRINTER_PICTURES; i++)
        if (!read_picture(order, i, head.n_pictures[i], source, context))
            return false;
    return true;
}

void order_finish(struct order *order)
{
    cJSON_Delete(order->paper);
    for (int i = 0; i < PRINTER_PICTURES; i++)
        free(order->pictures[i]);
    *order = (struct order){ .paper = NULL };
}
