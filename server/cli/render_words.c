/* Words, numbers and points of the options of `beamroom render`. */
#include "server/cli/render_words.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

bool render_next_word(const char **text, char separator, char word[RENDER_WORD_SIZE])
{
    size_t n = strcspn(*text, (const char[]){ separator, 0 });
    if (n == 0 || n >= RENDER_WORD_SIZE)
        return false;
    memcpy(word, *text, n);
    word[n] = 0;
    *text += n;
    if (**text && **text == separator)
        (*text)++;
    return true;
}

bool render_number(const char *text, double *value)
{
    char *end;
    errno = 0;
    *value = strtod(text, &end);
    return end != text && *end == 0 && errno == 0 && isfinite(*value);
}

bool render_next_point(const char **text, char separator, double point[3])
{
    char word[RENDER_WORD_SIZE];
    const char *at = word;
    if (!render_next_word(text, separator, word))
        return false;
    for (int i = 0; i < 3; i++) {
        char number[RENDER_WORD_SIZE];
        if (!render_next_word(&at, ',', number) || !render_number(number, &point[i]))
            return false;
    }
    return *at == 0;
}

cJSON *render_member(cJSON *object, const char *name)
{
    cJSON *found = cJSON_GetObjectItemCaseSensitive(object, name);
    return found ? found : cJSON_AddObjectToObject(object, name);
}

const cJSON *render_field(const cJSON *object, const char *name)
{
    return cJSON_GetObjectItemCaseSensitive(object, name);
}
