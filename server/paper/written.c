/* Text, numbers and times as they stand on paper. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/base/invisible.h"
#include "server/paper/blocks.h"

/* One character of UTF-8; '?' for what is none, as where a text was cut. */
static uint32_t next_character(const char **at)
{
    const unsigned char *bytes = (const unsigned char *)*at;
    const int n = bytes[0] < 0xc0 ? 1 : bytes[0] < 0xe0 ? 2 : bytes[0] < 0xf0 ? 3 : 4;
    uint32_t character = n == 1 ? bytes[0] : bytes[0] & (0x7fu >> n);
    int i = 1;
    for (; i < n && (bytes[i] & 0xc0) == 0x80; i++)
        character = character << 6 | (bytes[i] & 0x3f);
    *at += i;
    return i == n && (n > 1 || bytes[0] < 0x80) ? character : '?';
}

cJSON *written(const char *text)
{
    const char *at = text ? text : "";
    char *out = malloc(8 * strlen(at) + 8), *to = out; /* a tag takes at most eight bytes for two or three */
    if (!out)
        return cJSON_CreateString("");
    for (int n = 0; *at && n < PAPER_MAX_TEXT; n++) {
        const char *from = at;
        const uint32_t character = next_character(&at);
        const char *tag = invisible_tag(character);
        if (tag)
            to += snprintf(to, 8, "[%s]", tag);
        else if (character != '\n' && (character < 0x20 || (character >= 0x7f && character < 0xa0)))
            *to++ = ' ';
        else if (character == '?')
            *to++ = '?';
        else
            to = (char *)memcpy(to, from, (size_t)(at - from)) + (at - from);
    }
    (void)snprintf(to, 4, "%s", *at ? "\xe2\x80\xa6" : "");
    cJSON *json = cJSON_CreateString(out);
    free(out);
    return json;
}

cJSON *written_format(const char *format, ...)
{
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return written(text);
}

const char *written_number(double value, char text[PAPER_NUMBER])
{
    const double size = fabs(value);
    if (!isfinite(value))
        (void)snprintf(text, PAPER_NUMBER, "\xe2\x80\x93");
    else if (size >= 1e6 || (size > 0 && size < 0.001))
        (void)snprintf(text, PAPER_NUMBER, "%.3g", value);
    else
        (void)snprintf(text, PAPER_NUMBER, "%.*f",
                       size >= 100              ? 0
                       : size >= 10             ? 1
                       : size >= 1 || size == 0 ? 2
                                                : 3,
                       value);
    return text;
}

const char *written_place(const cJSON *point, char text[PAPER_PLACE])
{
    static const char letters[3][2] = { { 'L', 'R' }, { 'P', 'A' }, { 'S', 'I' } };
    size_t n = 0;
    text[0] = 0;
    for (int axis = 0; axis < 3; axis++) {
        const cJSON *value = cJSON_GetArrayItem(point, axis);
        if (!cJSON_IsNumber(value))
            return (text[0] = 0, text);
        n += (size_t)snprintf(text + n, PAPER_PLACE - n, "%s%c %.1f", axis ? ", " : "",
                              letters[axis][value->valuedouble < 0], fmin(fabs(value->valuedouble), 1e6));
    }
    (void)snprintf(text + n, PAPER_PLACE - n, " mm");
    return text;
}

static const char *const months[] = {
    "Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"
};

static bool split(double ms, int offset_min, struct tm *parts)
{
    const time_t at = (time_t)(ms / 1000) + (time_t)offset_min * 60;
    return isfinite(ms) && fabs(ms) < 1e15 && gmtime_r(&at, parts);
}

const char *written_time(const struct paper *paper, double ms, char text[PAPER_TIME])
{
    struct tm at;
    text[0] = 0;
    if (split(ms, paper->offset_min, &at))
        (void)snprintf(text, PAPER_TIME, "%d %s %d, %02d:%02d", at.tm_mday, months[at.tm_mon], at.tm_year + 1900,
                       at.tm_hour, at.tm_min);
    return text;
}

const char *written_exact(double ms, int offset_min, const char *zone, char text[PAPER_TIME])
{
    struct tm at;
    char minutes[8] = "";
    const int size = abs(offset_min);
    text[0] = 0;
    if (size % 60)
        (void)snprintf(minutes, sizeof minutes, ":%02d", size % 60);
    if (split(ms, offset_min, &at))
        (void)snprintf(text, PAPER_TIME, "%d %s %d, %02d:%02d:%02d %.8s (UTC%c%d%s)", at.tm_mday, months[at.tm_mon],
                       at.tm_year + 1900, at.tm_hour, at.tm_min, at.tm_sec, zone, offset_min < 0 ? '-' : '+', size / 60,
                       minutes);
    return text;
}

cJSON *written_person(const cJSON *row, const char *name_field, const char *user_field)
{
    const char *name = json_text(row, name_field), *user = json_text(row, user_field);
    if (json_flag(row, "is_guest", false))
        return written_format("%.300s (guest)", name ? name : "");
    if (user && user[0])
        return written_format("%.300s (%.80s)", name ? name : "", user);
    return written_format("\xe2\x80\x9c%.300s\xe2\x80\x9d", name ? name : "");
}
