#pragma once
/* The phantom's particle tracks: a random walk that looks like transport but is not, in SERA's .pp text format. Knows
 * no files. Any thread. */
#include "core/base/error.h"
#include "core/track/track.h"

/* PHANTOM_MAX_TRACKS: as many as SERA's own viewer reads. */
enum { PHANTOM_MAX_TRACKS = 1000, PHANTOM_N_LOST = 6 };

/* Neutrons start in the beam's disk at its source plane, fly down, scatter, slow down, and are captured or leave. A
 * capture emits a gamma. A few particles are lost at the scalp, as happens in a real run. All eight classes occur.
 * Equal seeds give equal segments. Returns how many were made, at most PHANTOM_MAX_TRACKS. */
size_t phantom_make_tracks(uint64_t seed, struct track_segment segments[PHANTOM_MAX_TRACKS]);

/* Writes segments as a .pp file: three '#' lines; then per line the points from and to (RL, PA, IS; mm; six of %9.4f
 * separated by one blank), type and energy (%3d each). Types: 0 neutron, 1 gamma, 2 beam line, 3 lost. Energies: 1
 * high, 2 medium, 3 low. SERA writes energy 0 for gammas; here gammas have an energy like neutrons. The text is
 * NUL-terminated (not counted in n_bytes) and freed by the caller; NULL and ERROR_MEMORY on failure. */
NODISCARD char *phantom_tracks_text(const struct track_segment *segments, size_t n_segments, size_t *n_bytes,
                                    struct error *err);
