#pragma once
/* Parts that the short options of `beamroom render` share: words, numbers and points of the command line, members of
 * JSON objects. */
#include <stdbool.h>

#include "server/wire/json.h"

enum { RENDER_WORD_SIZE = 80 };

/* Takes the next word before the separator off the text. False: there is none, or it is longer than any that is known.
 */
bool render_next_word(const char **text, char separator, char word[RENDER_WORD_SIZE]);
/* A number up to the end of the text, finite. */
bool render_number(const char *text, double *value);
/* Takes "X,Y,Z" off the text, up to its end or the separator. */
bool render_next_point(const char **text, char separator, double point[3]);

/* The member of this name; render_member adds an empty object if there is none, render_field returns NULL. */
cJSON *render_member(cJSON *object, const char *name);
const cJSON *render_field(const cJSON *object, const char *name);
