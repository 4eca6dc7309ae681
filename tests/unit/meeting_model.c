/* The rules of following, leaving, presenting and taking over, written as short as they go. */
#include "tests/unit/meeting_model.h"

#include <math.h>
#include <string.h>

static const double kept_us = 30e6, known_us = 300e6; /* a presenter, a member without a connection */

void meeting_start(struct meeting *meeting, double opacity)
{
    memset(meeting, 0, sizeof *meeting);
    meeting->presenter = -1;
    meeting->opacity = opacity;
}

struct shown plain_view(const int size_px[2])
{
    return (struct shown){ { size_px[0], size_px[1] }, false, NAN, NAN, { NAN, NAN, NAN }, NAN };
}

struct pane own_pane(int kind, struct shown shown)
{
    return (struct pane){ true, false, kind, { shown.size_px[0], shown.size_px[1] }, shown };
}

struct shown *shown_in(struct meeting *meeting, struct pane *pane)
{
    return pane->is_following ? &meeting->shared[pane->kind].shown : &pane->own;
}

static int smaller(const int size_px[2])
{
    return size_px[0] < size_px[1] ? size_px[0] : size_px[1];
}

/* The view with which a person who leaves goes on. */
static struct shown copy_for(const struct meeting *meeting, const struct pane *pane)
{
    struct shown own = meeting->shared[pane->kind].shown;
    if ((pane->kind != SCENE_KIND_3D && pane->kind != SECOND_3D) ||
        own.is_parallel) /* as many pixels to a millimetre as before */
        own.height_mm = fmin(fmax(own.height_mm * smaller(pane->own_px) / smaller(own.size_px), 0.1), 10000);
    if (isnan(meeting->shared[pane->kind].shown.height_mm))
        own.height_mm = NAN;
    memcpy(own.size_px, pane->own_px, sizeof own.size_px);
    for (int i = 0; i < N_SLICES; i++)
        own.slices_mm[i] = isnan(own.slices_mm[i]) ? meeting->slices_mm[i] : own.slices_mm[i];
    return own;
}

void meeting_lose(struct meeting *meeting, int who, double now_us)
{
    meeting->seats[who] = (struct seat){ .is_member = true, .away_us = now_us };
}

void meeting_join(struct meeting *meeting, int who, struct pane *pane, struct shown wanted)
{
    struct shared *to = &meeting->shared[pane->kind];
    if (!to->exists)
        *to = (struct shared){ true, who == meeting->presenter ? wanted : plain_view(wanted.size_px) };
    if (who == meeting->presenter)
        memcpy(to->shown.size_px, pane->own_px, sizeof pane->own_px);
    pane->is_following = true;
}

void meeting_share(struct meeting *meeting, int who)
{
    struct seat *seat = &meeting->seats[who];
    bool is_taken[N_PANE_KINDS] = { false };
    for (int p = 0; p < N_PANES; p++) {
        struct pane *pane = &seat->panes[p];
        if (!pane->is_open || pane->is_following)
            continue;
        for (int i = 0; i < N_SLICES; i++)
            if (!isnan(pane->own.slices_mm[i]))
                meeting->slices_mm[i] = pane->own.slices_mm[i];
        if (!isnan(pane->own.opacity))
            meeting->opacity = pane->own.opacity;
    }
    for (int p = 0; p < N_PANES; p++) {
        struct pane *pane = &seat->panes[p];
        if (!pane->is_open)
            continue;
        struct shown to = pane->is_following ? meeting->shared[pane->kind].shown : pane->own;
        if (!pane->is_following)
            to.slices_mm[0] = to.slices_mm[1] = to.slices_mm[2] = to.opacity = NAN; /* in the scene now */
        memcpy(to.size_px, pane->own_px, sizeof to.size_px);
        if (!is_taken[pane->kind])
            meeting->shared[pane->kind] = (struct shared){ true, to };
        is_taken[pane->kind] = true;
        pane->is_following = true;
    }
}

void meeting_follow(struct meeting *meeting, int who)
{
    for (int p = 0; p < N_PANES; p++)
        if (meeting->seats[who].panes[p].is_open)
            meeting_join(meeting, who, &meeting->seats[who].panes[p],
                         *shown_in(meeting, &meeting->seats[who].panes[p]));
}

void meeting_settle(struct meeting *meeting, double now_us)
{
    int only = -1, n = 0;
    if (meeting->presenter >= 0 && !meeting->seats[meeting->presenter].is_connected &&
        now_us - meeting->seats[meeting->presenter].away_us >= kept_us)
        meeting->presenter = -1;
    for (int who = 0; who < N_PEOPLE; who++)
        if (meeting->seats[who].is_connected) {
            only = who;
            n++;
        }
    if (meeting->presenter < 0 && n == 1) {
        meeting->presenter = only;
        meeting_share(meeting, only);
    }
    for (int who = 0; who < N_PEOPLE; who++)
        if (meeting->seats[who].is_member && !meeting->seats[who].is_connected &&
            now_us - meeting->seats[who].away_us >= known_us)
            meeting->seats[who].is_member = false;
}

void meeting_leave(struct meeting *meeting, struct pane *pane)
{
    pane->own = copy_for(meeting, pane);
    pane->is_following = false;
}

bool meeting_follows(const struct meeting *meeting, int who)
{
    for (int p = 0; p < N_PANES && who != meeting->presenter; p++)
        if (meeting->seats[who].panes[p].is_following)
            return true;
    return false;
}
