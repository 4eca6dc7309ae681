/* A bucket for each caller and kind, which fills at a steady rate. */
#include "server/http/api_rates.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

enum { KEY_SIZE = IDENTITY_MAX_USER + 2, WAYS = 8 /* places that a caller may have: by its hash */ };

static const struct {
    double burst, per_s;
    const char *what;
} limits[API_N_RATES] = {
    [API_RATE_CALLS] = { 2000, 200, "calls" },
    [API_RATE_ROOMS] = { 40, 0.5, "new rooms" },
    [API_RATE_UPLOADS] = { 40, 0.5, "uploads" },
    [API_RATE_STREAMS] = { 60, 2, "streams" },
};

struct caller {
    char key[KEY_SIZE]; /* '@' and the address, or '=' and the user; "": free */
    int64_t seen_us;
    double left[API_N_RATES];
};

struct api_rates {
    struct caller callers[API_MAX_CALLERS];
};

struct api_rates *api_rates_create(void)
{
    return mem_new(sizeof(struct api_rates));
}

void api_rates_destroy(struct api_rates *rates)
{
    free(rates);
}

/* The caller, with what has flowed into its buckets since it was seen. */
static struct caller *find(struct api_rates *rates, const struct call *call, int64_t now_us)
{
    char key[KEY_SIZE];
    const bool is_user = call->identity.user[0] != 0;
    (void)snprintf(key, sizeof key, "%c%s", is_user ? '=' : '@', is_user ? call->identity.user : call->client);
    uint32_t hash = 2166136261U; /* FNV-1a */
    for (const char *at = key; *at; at++)
        hash = (hash ^ (unsigned char)*at) * 16777619U;
    struct caller *const places = &rates->callers[hash % (API_MAX_CALLERS / WAYS) * WAYS];
    struct caller *found = NULL, *oldest = places;
    for (size_t i = 0; i < WAYS && !found; i++) {
        struct caller *caller = &places[i];
        if (strcmp(caller->key, key) == 0)
            found = caller;
        else if (caller->seen_us < oldest->seen_us)
            oldest = caller;
    }
    const bool is_new = !found;
    if (is_new) {
        found = oldest;
        *found = (struct caller){ .seen_us = now_us };
        (void)snprintf(found->key, sizeof found->key, "%s", key);
    }
    for (int i = 0; i < API_N_RATES; i++) {
        const double filled = found->left[i] + limits[i].per_s * 1e-6 * (double)(now_us - found->seen_us);
        found->left[i] = is_new || filled > limits[i].burst ? limits[i].burst : filled;
    }
    found->seen_us = now_us;
    return found;
}

bool api_rates_take(struct api_rates *rates, const struct call *call, enum api_rate rate, int64_t now_us,
                    struct problem *problem)
{
    struct caller *caller = find(rates, call, now_us);
    if (caller->left[rate] >= 1) {
        caller->left[rate]--;
        return true;
    }
    problem_set(problem, PROBLEM_LIMIT, "", "rate",
                "too many %s at once: at most %.0f, and %.3g a second in the long run", limits[rate].what,
                limits[rate].burst, limits[rate].per_s);
    problem->retry_after_ms = (int)(1e3 * (1 - caller->left[rate]) / limits[rate].per_s) + 1;
    return false;
}
