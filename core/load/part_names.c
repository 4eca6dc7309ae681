/* Takes names of files in a plan's folder apart, and finds the data file beside a header. */
#include "core/load/part_names.h"

#include <stdio.h>
#include <string.h>

#include "core/formats/text.h"

const char *part_base_name(const char *name)
{
    const char *slash = strrchr(name, '/');
    return slash ? slash + 1 : name;
}

bool part_name_has_word(const char *name, const char *const *words, size_t n_words)
{
    char low[FOLDER_NAME_SIZE];
    size_t n = strlen(name);
    n = n < sizeof low ? n : sizeof low - 1;
    for (size_t i = 0; i < n; i++)
        low[i] = name[i] >= 'A' && name[i] <= 'Z' ? (char)(name[i] - 'A' + 'a') : name[i];
    low[n] = 0;
    for (size_t i = 0; i < n_words; i++)
        if (strstr(low, words[i]))
            return true;
    return false;
}

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

bool part_name_has_whole_word(const char *name, const char *word)
{
    size_t n = strlen(word);
    for (const char *at = name; *at; at++) {
        size_t i = 0;
        while (i < n && (at[i] == word[i] || (is_letter(at[i]) && (at[i] | 0x20) == word[i])))
            i++;
        if (i == n && (at == name || !is_letter(at[-1])) && !is_letter(at[n]))
            return true;
    }
    return false;
}

/* Length of the name without its last ending. */
static size_t stem_length(const char *name)
{
    const char *dot = strrchr(name, '.'), *slash = strrchr(name, '/');
    return dot && (!slash || dot > slash) ? (size_t)(dot - name) : strlen(name);
}

bool part_find_data(const struct folder *folder, const char *header, const char *ending, char data[FOLDER_NAME_SIZE])
{
    static const char *const packings[] = { ".gz", ".sz", "" };
    for (int i = 0; i < 3; i++) {
        int n = snprintf(data, FOLDER_NAME_SIZE, "%.*s%s%s", (int)stem_length(header), header, ending, packings[i]);
        if (n > 0 && n < FOLDER_NAME_SIZE && folder_look(folder, data, NULL) == FOLDER_FILE)
            return true;
    }
    return false;
}

bool part_is_plan_folder(const struct folder *folder, const char *name)
{
    char inner[FOLDER_NAME_SIZE];
    int n = snprintf(inner, sizeof inner, "%s/plan.json", name);
    return n > 0 && n < (int)sizeof inner && folder_look(folder, inner, NULL) == FOLDER_FILE;
}

void plan_folder_name(const char *path, char *out, size_t size)
{
    size_t end = strlen(path), from;
    while (end > 1 && path[end - 1] == '/')
        end--;
    for (from = end; from > 0 && path[from - 1] != '/'; from--) {
    }
    char name[256];
    snprintf(name, sizeof name, "%.*s", (int)(end - from < 255 ? end - from : 255), path + from);
    text_clean(name, out, size);
}
