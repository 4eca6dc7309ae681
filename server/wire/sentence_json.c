/* Codes and values of sentences to JSON and back: sentence_json.h. */
#include "server/wire/sentence_json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/wire/json_member.h"

enum { KEY_SIZE = 64 };

static const char *key_of(const char *name, const char *end, char key[KEY_SIZE])
{
    (void)snprintf(key, KEY_SIZE, "%s%s", name, end);
    return key;
}

static void add_value(cJSON *values, const struct sentence_place *place, const char *text)
{
    if (cJSON_HasObjectItem(values, place->name)) /* a name that stands twice in the sentence */
        return;
    if (place->type == SENTENCE_TEXT)
        cJSON_AddStringToObject(values, place->name, text);
    else if (text[0])
        json_add_finite(values, place->name, strtod(text, NULL));
    else
        cJSON_AddNullToObject(values, place->name);
}

void sentence_add_json(cJSON *object, const char *name, const struct sentence_facts *facts)
{
    const struct sentence *sentence = facts->code[0] ? sentence_find(facts->code) : NULL;
    if (!sentence)
        return;
    char key[KEY_SIZE], text[SENTENCE_VALUES_SIZE];
    cJSON_AddStringToObject(object, key_of(name, "_code", key), sentence->code);
    if (sentence->n_places == 0)
        return;
    cJSON *values = cJSON_AddObjectToObject(object, key_of(name, "_values", key));
    const char *at = facts->values;
    for (int i = 0; i < sentence->n_places; i++) {
        size_t n = strcspn(at, (const char[]){ SENTENCE_BREAK, '\0' });
        memcpy(text, at, n);
        text[n] = '\0';
        add_value(values, &sentence->places[i], text);
        at += n + (at[n] == SENTENCE_BREAK);
    }
}

void reason_add_json(cJSON *object, const char *name, const char *text)
{
    char key[KEY_SIZE];
    json_add_text(object, name, text);
    for (size_t i = 0; text && i < n_sentences; i++)
        if (sentences[i].n_places == 0 && strcmp(sentences[i].format, text) == 0)
            cJSON_AddStringToObject(object, key_of(name, "_code", key), sentences[i].code);
}

void fit_words_add_json(cJSON *object, const char *name, const struct fit_words *words)
{
    char key[KEY_SIZE];
    sentence_add_json(object, name, &words->all);
    cJSON *values = cJSON_GetObjectItemCaseSensitive(object, key_of(name, "_values", key));
    if (!values)
        return;
    sentence_add_json(values, "fact", &words->fact);
    sentence_add_json(values, "may", &words->may);
}

static bool read_value(struct sentence_facts *facts, bool is_first, const struct sentence_place *place,
                       const cJSON *value)
{
    if (place->type == SENTENCE_TEXT)
        return cJSON_IsString(value) && sentence_add_text(facts, is_first, value->valuestring, -1);
    return (cJSON_IsNumber(value) || cJSON_IsNull(value)) &&
           sentence_add_number(facts, is_first, place, cJSON_IsNumber(value) ? value->valuedouble : NAN);
}

void sentence_read_json(const cJSON *object, const char *name, struct sentence_facts *facts)
{
    *facts = (struct sentence_facts){ 0 };
    char key[KEY_SIZE];
    const char *code = json_text(object, key_of(name, "_code", key));
    const struct sentence *sentence = code ? sentence_find(code) : NULL;
    const cJSON *values = cJSON_GetObjectItemCaseSensitive(object, key_of(name, "_values", key));
    bool fits = sentence != NULL;
    for (int i = 0; fits && i < sentence->n_places; i++)
        fits = read_value(facts, i == 0, &sentence->places[i],
                          cJSON_GetObjectItemCaseSensitive(values, sentence->places[i].name));
    if (fits)
        (void)snprintf(facts->code, sizeof facts->code, "%s", sentence->code);
    else
        *facts = (struct sentence_facts){ 0 };
}
