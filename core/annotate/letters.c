/* Orientation letters from directions. */
#include "core/annotate/letters.h"

/* Smallest cosine for which an oblique direction gets a second letter. */
#define SECOND_FROM 0.3

void letters_of_direction(struct vec3 direction, char letters[3])
{
    static const char names[3][2] = { { 'L', 'R' }, { 'P', 'A' }, { 'S', 'I' } };
    const double cosines[3] = { direction.x, direction.y, direction.z };
    int first = 0, second = -1;
    for (int axis = 1; axis < 3; axis++)
        if (fabs(cosines[axis]) > fabs(cosines[first]))
            first = axis;
    for (int axis = 0; axis < 3; axis++)
        if (axis != first && (second < 0 || fabs(cosines[axis]) > fabs(cosines[second])))
            second = axis;
    letters[0] = names[first][cosines[first] >= 0 ? 0 : 1];
    letters[1] = '\0';
    if (fabs(cosines[second]) >= SECOND_FROM)
        letters[1] = names[second][cosines[second] >= 0 ? 0 : 1];
    letters[2] = '\0';
}

struct edge_letters letters_of_edges(struct vec3 right, struct vec3 up)
{
    struct edge_letters letters;
    letters_of_direction(vec3_scale(right, -1), letters.left);
    letters_of_direction(right, letters.right);
    letters_of_direction(up, letters.top);
    letters_of_direction(vec3_scale(up, -1), letters.bottom);
    return letters;
}
