/* The library of beams of `beamroom transport`. */
#include <string.h>

#include "server/cli/transport_parts.h"

/* fir1-like: SERA 1C0, SeraMC/beam/FIR_SHRT_12.source (k12fantu: the filter of FiR 1, Otaniemi), currents of its groups
 * added up; no groups are made up.
 * goorley: J. T. Goorley, W. S. Kiger, R. G. Zamenhof, Med. Phys. 29, 145 (2002): 10 % thermal, 89 % epithermal, 1 %
 * fast, flat in lethargy, parallel, 5 cm in radius, 1e10 per cm2 and s.
 * mono-: one energy in the same disk, as in studies of the best energy (J. C. Yanch, X. L. Zhou, G. L. Brownell,
 * Radiat. Res. 126, 1 (1991)); for 1 keV the published peak of the thermal fluence in a head is at 3 cm. */
static const struct {
    const char *name, *text;
} library[] = {
    { "fir1-like",
      "{\"format\": \"beamroom-beam\", \"version\": 1, \"name\": \"FiR 1-like, 12 cm\", \"note\": \"21 "
      "neutron and 10 photon groups, condensed from the 47 and 20 of SERA 1C0's FIR_SHRT_12.source; one "
      "distribution of cosines; delimiter as in seraMC's FiR 1 geometry\", \"per\": \"250 kW-minute\", "
      "\"spectrum\": {\"radius_mm\": 100, \"distance_mm\": 50, \"cosines\": [0.9804, 0.9595, 0.9364, "
      "0.9097, 0.8808, 0.8519, 0.823, 0.7905, 0.727, 0.6414, 0.4733, 0], \"neutrons\": {\"energy_ev\": "
      "[1.733e7, 1e7, 4.9659e6, 3.0119e6, 1.9205e6, 1.3534e6, 820850, 497870, 297200, 111090, 40868, "
      "21875, 7101.7, 1584.6, 454, 101.3, 37.267, 10.67, 1.8553, 0.414, 0.1, 1e-5], \"share\": [2.337e-6, "
      "9.579e-5, 0.0002282, 0.0003218, 0.0004377, 0.0008756, 0.0007787, 0.0004603, 0.001026, 0.002347, "
      "0.001669, 0.03319, 0.09743, 0.1239, 0.1839, 0.1221, 0.141, 0.1574, 0.08121, 0.02749, 0.02403], "
      "\"per_cm2\": 1.9342e11}, \"photons\": {\"energy_ev\": [1.4e7, 1e7, 7e6, 5e6, 3e6, 2e6, 1e6, 600000, "
      "300000, 100000, 10000], \"share\": [1.238e-6, 0.027, 0.03704, 0.3053, 0.206, 0.1913, 0.06862, "
      "0.1274, 0.02081, 0.01647], \"per_cm2\": 1.147e9}}, \"delimiter\": {\"length_mm\": 50.52, "
      "\"exit_radius_mm\": 60, \"entrance_radius_mm\": 90, \"natural_lithium_from_radius_mm\": 135}}" },
    { "goorley", "{\"format\": \"beamroom-beam\", \"version\": 1, \"name\": \"Goorley 2002\", \"per\": \"minute\", "
                 "\"spectrum\": {\"radius_mm\": 50, \"neutrons\": {\"energy_ev\": [2e6, 10000, 0.5, 0.001], "
                 "\"share\": [0.01, 0.89, 0.1], \"per_cm2\": 6e11, \"by_lethargy\": true}}}" },
    { "mono-10ev",
      "{\"format\": \"beamroom-beam\", \"version\": 1, \"name\": \"10 eV, parallel\", \"per\": \"minute\", "
      "\"spectrum\": {\"radius_mm\": 50, \"neutrons\": {\"energy_ev\": [10.01, 10], \"share\": [1], "
      "\"per_cm2\": 6e11, \"by_lethargy\": true}}}" },
    { "mono-100ev", "{\"format\": \"beamroom-beam\", \"version\": 1, \"name\": \"100 eV, parallel\", \"per\": "
                    "\"minute\", \"spectrum\": {\"radius_mm\": 50, \"neutrons\": {\"energy_ev\": [100.1, 100], "
                    "\"share\": [1], \"per_cm2\": 6e11, \"by_lethargy\": true}}}" },
    { "mono-1kev",
      "{\"format\": \"beamroom-beam\", \"version\": 1, \"name\": \"1 keV, parallel\", \"per\": \"minute\", "
      "\"spectrum\": {\"radius_mm\": 50, \"neutrons\": {\"energy_ev\": [1001, 1000], \"share\": [1], "
      "\"per_cm2\": 6e11, \"by_lethargy\": true}}}" },
    { "mono-10kev", "{\"format\": \"beamroom-beam\", \"version\": 1, \"name\": \"10 keV, parallel\", \"per\": "
                    "\"minute\", \"spectrum\": {\"radius_mm\": 50, \"neutrons\": {\"energy_ev\": [10010, 10000], "
                    "\"share\": [1], \"per_cm2\": 6e11, \"by_lethargy\": true}}}" },
};

const char *transport_library_beam(const char *name)
{
    for (size_t i = 0; i < sizeof library / sizeof *library; i++)
        if (strcmp(name, library[i].name) == 0)
            return library[i].text;
    return NULL;
}

const char *transport_library_names(void)
{
    return "fir1-like, goorley, mono-10ev, mono-100ev, mono-1kev, mono-10kev";
}
