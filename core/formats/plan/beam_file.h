#pragma once
/* Reads a beam file, "beamroom-beam": what a beam brings, where it comes from, and the materials of regions, for a
 * simulation. Its keys are told in docs/live-dose.md. Opens no file. */
#include "core/beam/beam_source.h"
#include "core/formats/folder.h"
#include "core/math/vec.h"
#include "core/report/report.h"

enum { BEAM_FILE_MAX_BYTES = 1 << 20, BEAM_FILE_MAX_MATERIALS = 32, BEAM_FILE_MAX_ELEMENTS = 16 };

struct beam_file_material {
    char region[128];
    char word[24]; /* of a tissue, "air" included; "" own: density and elements */
    double g_cm3;
    struct {
        char symbol[4];
        double fraction; /* by weight */
    } elements[BEAM_FILE_MAX_ELEMENTS];
    size_t n_elements;
    double boron_ppm; /* 0 to 1e6 */
};
/* A file of particles, and what it does not say: how many real ones it stands for, and where the beam lies in it. */
struct beam_file_particles {
    char path[FOLDER_NAME_SIZE];   /* relative to the beam file's folder; "": none */
    double neutrons_per_unit;      /* all neutrons of the file together; 0: histories_per_unit says it */
    double histories_per_unit;     /* primary particles of the run that wrote it */
    double histories;              /* that the file comes of; 0: as the file itself says */
    struct vec3 origin_mm;         /* centre of the aperture plane, in the file's axes */
    struct vec3 direction, across; /* of the beam, and its x axis, in the file's axes */
    bool has_across_lps;
    struct vec3 across_lps; /* where the beam's x axis goes in the patient */
};
struct beam_file {
    char name[128], per[64];            /* "" none */
    char source_path[FOLDER_NAME_SIZE]; /* SERA's .source, relative to the file's folder; "": source holds a spectrum */
    struct beam_file_particles particles; /* instead of a source */
    struct beam_source source;            /* its delimiter in any case */
    bool has_pose;
    struct vec3 entry_lps_mm, target_lps_mm; /* centre of the aperture plane; a point that the axis goes through */
    struct beam_file_material materials[BEAM_FILE_MAX_MATERIALS];
    size_t n_materials;
};

/* A file of particles of which nothing is said: its beam goes to +z from the origin. */
struct beam_file_particles beam_file_particles_of(const char *path);

/* report gets a note for each key that is not known.
 *   errors  ERROR_FORMAT, ERROR_RANGE, ERROR_LIMIT, ERROR_UNSUPPORTED another version; the text names file and place;
 *           ERROR_MEMORY */
NODISCARD bool beam_file_parse(const uint8_t *data, size_t size, const char *name, struct beam_file *file,
                               struct report *report, struct error *err);
