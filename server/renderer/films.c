/* Films that are being made, by their numbers. */
#include "server/renderer/films.h"

#include <stdlib.h>

#include "core/annotate/annotate.h"
#include "core/base/mem.h"
#include "server/wire/json.h"

enum { ENCODER_THREADS = 2 /* the pictures of rooms go on beside a film */, BUSY_RETRY_MS = 500 };

struct films_entry {
    int64_t number, n_pictures; /* number 0: free */
    struct film *film;          /* a reference */
    bool is_busy;               /* a picture is under way */
    uint64_t used;              /* grows with each picture that began or ended */
};
struct films {
    struct films_entry entries[FILMS_MAX];
    uint64_t n_uses;
};

struct films *films_create(void)
{
    return mem_new(sizeof(struct films));
}

static void forget(struct films_entry *entry)
{
    film_unref(entry->film);
    *entry = (struct films_entry){ .number = 0 };
}

void films_destroy(struct films *films)
{
    for (size_t i = 0; films && i < FILMS_MAX; i++)
        forget(&films->entries[i]);
    free(films);
}

static struct films_entry *find(struct films *films, int64_t number)
{
    for (size_t i = 0; i < FILMS_MAX; i++)
        if (films->entries[i].number == number)
            return &films->entries[i];
    return NULL;
}

/* A free place, or that of the film which has waited longest for its next picture: whoever made it may be gone. NULL:
 * each has a picture under way. */
static struct films_entry *find_place(struct films *films)
{
    struct films_entry *place = find(films, 0);
    for (size_t i = 0; !place && i < FILMS_MAX; i++)
        if (!films->entries[i].is_busy)
            place = &films->entries[i];
    for (size_t i = 0; place && place->number && i < FILMS_MAX; i++)
        if (!films->entries[i].is_busy && films->entries[i].used < place->used)
            place = &films->entries[i];
    return place;
}

/* A line is less than twice as high as its text. */
static int spare_px(const struct packet_render *render)
{
    const double width_px =
        cJSON_GetNumberValue(cJSON_GetArrayItem(cJSON_GetObjectItemCaseSensitive(render->shown.view, "size_px"), 0));
    if (!render->words[0] || !(width_px > 0))
        return 2 * FILM_SPARE_LINES * annotate_text_px(ANNOTATE_MIN_WIDTH_PX);
    return 2 * FILM_SPARE_LINES_WORDS * annotate_text_px((int)width_px);
}

static bool begin(struct films_entry *entry, const struct packet_render *render, struct problem *problem)
{
    struct error err = { 0 };
    const struct film_options options = { .fps = (int)render->film_fps,
                                          .quality = (int)render->quality,
                                          .n_threads = ENCODER_THREADS,
                                          .spare_px = spare_px(render),
                                          .max_bytes = FILM_MAX_BYTES };
    forget(entry);
    *entry = (struct films_entry){ .number = render->film, .film = film_create(&options, &err) };
    if (entry->film)
        return true;
    entry->number = 0;
    return problem_from_error(problem, &err);
}

struct film *films_begin_picture(struct films *films, const struct packet_render *render, struct problem *problem)
{
    struct films_entry *entry = find(films, render->film);
    if (!entry && render->film_at == 0) {
        entry = find_place(films);
        if (!entry) {
            (void)problem_set(problem, PROBLEM_BUSY, "", "", "%d films are being made of this plan already", FILMS_MAX);
            problem->retry_after_ms = BUSY_RETRY_MS;
            return NULL;
        }
        if (!begin(entry, render, problem))
            return NULL;
    }
    if (!entry || entry->is_busy || entry->n_pictures != render->film_at) {
        (void)problem_set(problem, PROBLEM_NOT_FOUND, "/film_at", "", "the renderer has no film with %lld pictures",
                          (long long)render->film_at);
        return NULL;
    }
    entry->is_busy = true;
    entry->used = ++films->n_uses;
    return film_ref(entry->film);
}

void films_end_picture(struct films *films, int64_t number, bool is_added, bool is_whole)
{
    struct films_entry *entry = number ? find(films, number) : NULL;
    if (!entry)
        return;
    entry->is_busy = false;
    entry->used = ++films->n_uses;
    entry->n_pictures++;
    if (!is_added || is_whole)
        forget(entry);
}

void films_put_off_picture(struct films *films, int64_t number)
{
    struct films_entry *entry = number ? find(films, number) : NULL;
    if (entry)
        entry->is_busy = false;
}

void films_drop(struct films *films, int64_t number)
{
    struct films_entry *entry = number ? find(films, number) : NULL;
    if (entry)
        forget(entry);
}
