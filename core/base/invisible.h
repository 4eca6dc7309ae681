#pragma once
/* Characters that do not show and change how others show: marks of direction, of width zero, of line breaks. Names of
 * files and people may hold them, so that two names look alike or a name reads backwards. They are shown as tags. The
 * page's rule is web/js/parts/visible_text.js; tests/data/invisible_characters.json holds both to it. */
#include <stdint.h>

/* "RLO" for U+202E; NULL for a character that shows. */
const char *invisible_tag(uint32_t character);
