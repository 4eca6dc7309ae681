/* The draw list of a picture: its memory. */
#include "core/render/visible/draw.h"

#include <stdlib.h>

bool draw_list_add(struct draw_list *list, const struct draw *draw, struct error *err)
{
    if (list->n == list->capacity) {
        size_t capacity = 2 * list->capacity + 16;
        struct draw *grown = realloc(list->draws, capacity * sizeof *grown);
        if (!grown)
            return error_set(err, ERROR_MEMORY, "no memory for %zu entries of a draw list", capacity);
        list->draws = grown;
        list->capacity = capacity;
    }
    list->draws[list->n++] = *draw;
    list->n_in_image += draw->pass != DRAW_OVERLAY;
    if (draw->kind == DRAW_SHAPE) {
        list->n_triangles += draw->shape.drawable->n_triangles;
        list->is_coarse |= draw->shape.drawable->is_coarse;
    }
    return true;
}

size_t draw_list_n_layers(const struct draw_list *list, size_t first)
{
    size_t end = first;
    while (end < list->n_in_image && list->draws[end].depth == DRAW_DEPTH_LAYER)
        end++;
    return end - first;
}
