#pragma once
/* A simple model of a meeting in a room: who presents, follows and looks on their own, and what each pane shows. It
 * shares no code with server/room. Of a view it knows size, camera target (x only), height and projection, of a scene
 * the slice positions and one region's opacity; numbers are NAN where they are not set. */
#include <stdbool.h>

#include "server/wire/document.h"

/* Kinds of panes: 3-D, the slices across the patient's axes, and the second 3-D view. */
enum { N_PEOPLE = 5, N_PANES = 4, N_SLICES = 3, SECOND_3D = SCENE_KIND_SAGITTAL + 1, N_PANE_KINDS };

struct shown {
    int size_px[2];
    bool is_parallel;
    double target_x_mm, height_mm, slices_mm[N_SLICES], opacity; /* slices and opacity: of the override */
};

struct pane {
    bool is_open, is_following;
    int kind, own_px[2]; /* the size that its member sent last */
    struct shown own;    /* while it does not follow */
};

struct seat {
    bool is_member, is_connected;
    double away_us; /* since when it is not connected */
    struct pane panes[N_PANES];
};

struct meeting {
    int presenter; /* -1: nobody */
    struct seat seats[N_PEOPLE];
    struct shared {
        bool exists;
        struct shown shown;
    } shared[N_PANE_KINDS];
    double slices_mm[N_SLICES], opacity; /* of the scene */
};

void meeting_start(struct meeting *meeting, double opacity);
/* A new view without camera and override. */
struct shown plain_view(const int size_px[2]);
/* An open pane that does not follow. */
struct pane own_pane(int kind, struct shown shown);
/* The view that the pane shows, to be changed. */
struct shown *shown_in(struct meeting *meeting, struct pane *pane);
bool meeting_follows(const struct meeting *meeting, int who);

/* The link is lost, and with it the panes. */
void meeting_lose(struct meeting *meeting, int who, double now_us);
/* A pane begins to follow; wanted: the document that its member would give a shared view. */
void meeting_join(struct meeting *meeting, int who, struct pane *pane, struct shown wanted);
/* All open panes follow. */
void meeting_follow(struct meeting *meeting, int who);
/* One pane leaves with a copy of the shared view. */
void meeting_leave(struct meeting *meeting, struct pane *pane);
/* The panes of the presenter become the room's. */
void meeting_share(struct meeting *meeting, int who);
/* Time has passed, or somebody came or went. */
void meeting_settle(struct meeting *meeting, double now_us);
