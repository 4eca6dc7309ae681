/* The command line of `beamroom render`. */
#include "server/cli/render_arguments.h"

#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "server/cli/command.h"
#include "server/cli/exit_code.h"

enum { DEFAULT_QUALITY = 92, DEFAULT_FPS = 24 };

static void print_help(void)
{
    printf(
        "usage: beamroom render DIR -o OUT.png|OUT.jpg|OUT.webm [OPTION]...\n"
        "Draws one picture of the plan in the folder DIR, the same that the daemon shows for the same scene and view.\n\n"
        "  -o, --output OUT  the picture; its ending says whether PNG, JPEG or, of --orbit, WebM\n"
        "  --scene JSON      what differs from the scene a new room starts with (a merge patch, RFC 7396): JSON in { }, or the\n"
        "                    name of a file of it\n"
        "  --view JSON       what differs from the view a new room starts with, 1024x768: camera, kind, size, override\n"
        "  --show REGIONS    ids with commas between: these regions alone, opaque or with the opacity in ID=0.3; none: no region\n"
        "  --slices SLICES   axial, coronal, sagittal, with commas between and perhaps =MM behind: these slices alone; none\n"
        "  --volume METHOD   the image as a volume: ray, slices, mip or average; METHOD=VALUE: without what is below VALUE\n"
        "  --plane N[@P]     an oblique plane with the direction N through the point P, else through where the slices meet,\n"
        "                    each X,Y,Z towards L, P and S: its own picture, or a slice in one whose kind is said\n"
        "  --clip PLANE=MM   cuts off what lies beyond: axial-low, axial-high, coronal-low, coronal-high, sagittal-low or\n"
        "                    sagittal-high, each at a position along S, P or L, or beam, across the beam at a distance from\n"
        "                    its entry, and what lies before; given again: one more plane\n"
        "  --no-caps         leaves cuts of --clip open, so that they show what is hollow\n"
        "  --window C/W[/G]  the image's window: centre and width, in its unit; gamma, above 1 brighter\n"
        "  --colors MAP      of the image: grey, viridis, cividis, inferno, magma, plasma, hot-iron, rainbow or turbo\n"
        "  --light A,E[,I]   where light comes from in 3-D: A degrees to the right of the eye, E up, I times as strong;\n"
        "                    patient:A,E from the front towards the patient's left, and towards superior\n"
        "  --ambient N       light from all sides in 3-D, 0 to 1\n"
        "  --background C    the ground of 3-D: white, black, or red, green and blue as #rrggbb\n");
    printf(
        "  --dose ID         the dose that is shown, alone unless --scene adds others\n"
        "  --accept A=B      uses two parts though they do not fit, such as dose:plan=image:ct; the caption says so; given\n"
        "                    again: one more pair\n"
        "  --quantity WORD   weighted, total, boron, nitrogen, fast, gamma, isoeffective and others of the scene\n"
        "  --ppm N           boron in blood; --tissue ID: the weights of this region everywhere\n"
        "  --reference R     what 100 %% is: body, file, value=N, region-max=ID, region-mean=ID or point=X,Y,Z\n"
        "  --level V[=COLOR] an isodose level, 95%% or 20Gy, alone; given again: one more\n"
        "  --wash STYLE      dose as colour on slices, caps and textures: bands or smooth, =OPACITY behind\n"
        "  --lines           isodose lines on slices and caps\n"
        "  --isodoses GRID   isodose surfaces of all levels, made in the grid of the dose or of the univels\n"
        "  --texture WHAT    what colours the regions shown: none, image or dose (of --wash)\n"
        "  --beam[=ID]       draws this beam, without ID the first, with its aperture, and chooses it; given again: one more is\n"
        "                    drawn\n"
        "  --draft E:T       a draft of a beam in its place, from an entry to a target, each X,Y,Z in mm towards L, P and S\n"
        "  --beam-slice MM   the image on the plane across the chosen beam, at this distance from its entry\n"
        "  --tracks[=LIST]   particle tracks, of these classes alone: neutron-low, neutron-medium, neutron-high, gamma-low,\n"
        "                    gamma-medium, gamma-high, lost, beam-line, with commas between; neutron, gamma: three each\n"
        "  --kind KIND       3d, axial, coronal, sagittal, oblique; beam: along the chosen beam; beam-slice: across it\n"
        "  --along MM        in a beam's-eye view: the eye's distance from the beam's entry; else the whole plan is seen\n"
        "  --ring MM         in a beam's-eye view: a ring of this diameter about its axis, in parallel projection\n"
        "  --from A,E        looks at the plan from A degrees off the front, towards the patient's left, and E degrees up\n"
        "  --orbit S[,FPS]   a film of one turn about the patient in S seconds, towards the patient's left, with FPS pictures a\n"
        "                    second, 24 if it is not said, at most 3600 in all\n"
        "  --size WxH        pixels, each 16 to 4096; before what --view says\n"
        "  --gl BACKEND      auto (default), egl-device, egl-surfaceless, osmesa or soft\n"
        "  --quality N       of a JPEG or a film, 1 to 100 (default %d)\n"
        "  --annotations     letters, scale bar and a caption below the picture, which makes the file higher; a PNG then\n"
        "                    carries scene and view, so that the page can show them again\n"
        "  --help            this text\n\n"
        "The fields of scene and view are those of the daemon's API. Equal plans, scenes and views give equal pictures on the\n"
        "same back end.\n",
        DEFAULT_QUALITY);
}

/* ---- words ------------------------------------------------------------------------------------------------------ */

static bool parse_between(const char **at, int low, int high, int *number)
{
    if (**at < '0' || **at > '9')
        return false;
    char *end;
    errno = 0;
    long value = strtol(*at, &end, 10);
    *at = end;
    *number = (int)value;
    return errno == 0 && value >= low && value <= high;
}

static bool parse_size(const char *text, int size_px[2])
{
    return parse_between(&text, 16, 4096, &size_px[0]) && *text++ == 'x' &&
           parse_between(&text, 16, 4096, &size_px[1]) && *text == 0;
}

static bool parse_from(const char *text, double from_deg[2])
{
    char *end;
    from_deg[0] = strtod(text, &end);
    if (end == text || *end++ != ',')
        return false;
    from_deg[1] = strtod(text = end, &end);
    return end != text && *end == 0 && fabs(from_deg[0]) <= 360 && fabs(from_deg[1]) <= 90;
}

static bool parse_quality(const char *text, int *quality)
{
    return parse_between(&text, 1, 100, quality) && *text == 0;
}

static bool parse_orbit(const char *text, struct render_arguments *arguments)
{
    char *end;
    arguments->orbit_s = strtod(text, &end);
    if (end == text || !(arguments->orbit_s > 0 && arguments->orbit_s <= VIDEO_MAX_FRAMES))
        return false;
    const char *at = end + 1;
    return (!*end || (*end == ',' && parse_between(&at, 1, VIDEO_MAX_FPS, &arguments->fps) && !*at)) &&
           arguments->orbit_s * arguments->fps <= VIDEO_MAX_FRAMES;
}

static bool is_film(const char *path)
{
    const char *dot = strrchr(path, '.');
    return dot && strcasecmp(dot, ".webm") == 0;
}

static bool codec_from_path(const char *path, enum encode_codec *codec)
{
    const char *dot = strrchr(path, '.');
    if (!dot)
        return false;
    *codec = strcasecmp(dot, ".png") == 0 ? ENCODE_PNG : ENCODE_JPEG;
    return *codec == ENCODE_PNG || strcasecmp(dot, ".jpg") == 0 || strcasecmp(dot, ".jpeg") == 0;
}

/* Checks the words of the options, before the plan is open. */
static bool check_words(const struct render_arguments *arguments, struct error *err)
{
    cJSON *nothing = cJSON_CreateObject(), *view = cJSON_CreateObject();
    cJSON *shown = render_show_patch(&arguments->show, nothing, err);
    cJSON *dosed = shown ? render_dose_patch(&arguments->dose, nothing, NULL, err) : NULL;
    cJSON *beam = dosed ? render_beam_patch(&arguments->beam, NULL, nothing, err) : NULL;
    bool is_good = beam && render_beam_add_view(&arguments->beam, view, err);
    cJSON_Delete(shown);
    cJSON_Delete(dosed);
    cJSON_Delete(beam);
    cJSON_Delete(view);
    cJSON_Delete(nothing);
    return is_good;
}

/* ---- the table -------------------------------------------------------------------------------------------------- */

struct option_row {
    const char *name;
    int argument; /* as getopt_long says it */
    size_t at;    /* of the word or flag in struct render_arguments */
    /* Takes the option; word NULL: an optional one that is not given. False: refused, with the reason written. */
    bool (*take)(struct render_arguments *arguments, const struct option_row *row, const char *word);
};

static bool take_word(struct render_arguments *arguments, const struct option_row *row, const char *word)
{
    *(const char **)((char *)arguments + row->at) = word ? word : "";
    return true;
}

static bool take_flag(struct render_arguments *arguments, const struct option_row *row, const char *word)
{
    (void)word;
    *(bool *)((char *)arguments + row->at) = true;
    return true;
}

/* Adds to one of the lists of words. */
static bool add_word(const char **words, int *n, int most, const struct option_row *row, const char *word)
{
    if (*n == most)
        return command_usage_error("render", "--%s is given more than %d times", row->name, most), false;
    words[(*n)++] = word ? word : "";
    return true;
}

static bool take_clip(struct render_arguments *arguments, const struct option_row *row, const char *word)
{
    struct render_show *show = &arguments->show;
    arguments->beam.has_clip = arguments->beam.has_clip || strncmp(word, "beam", 4) == 0;
    return add_word(show->clips, &show->n_clips, RENDER_SHOW_MAX_CLIPS, row, word);
}

static bool take_level(struct render_arguments *arguments, const struct option_row *row, const char *word)
{
    return add_word(arguments->dose.levels, &arguments->dose.n_levels, RENDER_DOSE_MAX_LEVELS, row, word);
}

static bool take_beam(struct render_arguments *arguments, const struct option_row *row, const char *word)
{
    return add_word(arguments->beam.beams, &arguments->beam.n_beams, RENDER_BEAM_MAX, row, word);
}

static bool take_acceptance(struct render_arguments *arguments, const struct option_row *row, const char *pair)
{
    (void)row;
    const char *equals = strchr(pair, '=');
    if (arguments->n_accepted == ACCEPTANCES_MAX || !equals || equals == pair || !equals[1]) {
        fprintf(stderr, "beamroom render: --accept '%.100s' is not THING=WITH, such as dose:plan=image:ct\n", pair);
        return false;
    }
    arguments->accepted[arguments->n_accepted++] = pair;
    return true;
}

static bool take_from(struct render_arguments *arguments, const struct option_row *row, const char *word)
{
    (void)row;
    arguments->has_from = true;
    if (parse_from(word, arguments->from_deg))
        return true;
    return command_usage_error("render", "--from '%s' is not of the form 30,12: degrees up to 360 and 90", word), false;
}

static bool take_size(struct render_arguments *arguments, const struct option_row *row, const char *word)
{
    (void)row;
    if (parse_size(word, arguments->size_px))
        return true;
    return command_usage_error("render", "--size '%s' is not of the form 1024x768, each 16 to 4096", word), false;
}

static bool take_orbit(struct render_arguments *arguments, const struct option_row *row, const char *word)
{
    (void)row;
    if (parse_orbit(word, arguments))
        return true;
    return command_usage_error(
               "render",
               "--orbit '%s' is not of the form 8 or 8,24: seconds, and 1 to %d pictures a second, at most %d", word,
               VIDEO_MAX_FPS, VIDEO_MAX_FRAMES),
           false;
}

static bool take_back_end(struct render_arguments *arguments, const struct option_row *row, const char *word)
{
    (void)row;
    if (render_back_end_from_word(word, &arguments->back_end))
        return true;
    return command_usage_error("render", "--gl '%s' is not auto, egl-device, egl-surfaceless, osmesa or soft", word),
           false;
}

static bool take_quality(struct render_arguments *arguments, const struct option_row *row, const char *word)
{
    (void)row;
    if (parse_quality(word, &arguments->quality))
        return true;
    return command_usage_error("render", "--quality '%s' is not 1 to 100", word), false;
}

#define WORD(name, field) \
    { \
        name, required_argument, offsetof(struct render_arguments, field), take_word \
    }
#define FLAG(name, field) \
    { \
        name, no_argument, offsetof(struct render_arguments, field), take_flag \
    }
static const struct option_row rows[] = {
    WORD("output", out),
    WORD("scene", scene),
    WORD("view", view),
    { "size", required_argument, 0, take_size },
    WORD("show", show.regions),
    WORD("slices", show.slices),
    WORD("volume", show.volume),
    WORD("plane", show.plane),
    WORD("window", show.window),
    WORD("colors", show.colors),
    WORD("light", show.light),
    WORD("ambient", show.ambient),
    WORD("background", show.background),
    { "from", required_argument, 0, take_from },
    { "orbit", required_argument, 0, take_orbit },
    { "clip", required_argument, 0, take_clip },
    FLAG("no-caps", show.is_uncapped),
    WORD("dose", dose.dose),
    { "accept", required_argument, 0, take_acceptance },
    WORD("quantity", dose.quantity),
    WORD("ppm", dose.ppm),
    WORD("tissue", dose.tissue),
    WORD("reference", dose.reference),
    { "level", required_argument, 0, take_level },
    WORD("wash", dose.wash),
    FLAG("lines", dose.has_lines),
    WORD("isodoses", dose.isodoses),
    WORD("texture", dose.texture),
    { "beam", optional_argument, 0, take_beam },
    WORD("draft", beam.draft),
    WORD("beam-slice", beam.slice),
    { "tracks", optional_argument, offsetof(struct render_arguments, beam.tracks), take_word },
    WORD("kind", beam.kind),
    WORD("along", beam.along),
    WORD("ring", beam.ring),
    { "gl", required_argument, 0, take_back_end },
    { "quality", required_argument, 0, take_quality },
    FLAG("annotations", has_annotations),
};
enum { N_ROWS = sizeof rows / sizeof rows[0], OUTPUT_ROW = 0, FIRST_LONG = 256 /* behind every letter */ };

/* Takes the options of the table. False when there is nothing to draw; *code is EXIT_DONE after --help. */
static bool take_options(int argc, char **argv, struct render_arguments *arguments, int *code)
{
    struct option options[N_ROWS + 2] = { { "help", no_argument, NULL, 'h' } };
    for (int i = 0; i < N_ROWS; i++)
        options[i + 1] = (struct option){ rows[i].name, rows[i].argument, NULL, FIRST_LONG + i };
    opterr = 0;
    for (int option; (option = getopt_long(argc, argv, "ho:", options, NULL)) != -1;) {
        if (option == 'h') {
            print_help();
            *code = EXIT_DONE;
            return false;
        }
        const int row = option == 'o' ? OUTPUT_ROW : option - FIRST_LONG;
        if (row < 0)
            return command_usage_error("render", "'%s' is not an option or lacks its value", argv[optind - 1]), false;
        if (!rows[row].take(arguments, &rows[row], optarg))
            return false;
    }
    return true;
}

bool render_arguments_parse(int argc, char **argv, struct render_arguments *arguments, int *code)
{
    *arguments = (struct render_arguments){ .back_end = RENDER_AUTO, .quality = DEFAULT_QUALITY, .fps = DEFAULT_FPS };
    *code = EXIT_USAGE;
    if (!take_options(argc, argv, arguments, code))
        return false;
    struct error err = { 0 };
    if (!check_words(arguments, &err))
        return command_usage_error("render", "%s", err.text), false;
    if (argc - optind != 1)
        return command_usage_error("render", "one folder is needed, %d are given", argc - optind), false;
    if (!arguments->out)
        return command_usage_error("render", "where to write is needed: -o OUT.png or -o OUT.jpg"), false;
    if (is_film(arguments->out) != (arguments->orbit_s > 0))
        return command_usage_error("render",
                                   arguments->orbit_s > 0 ? "-o '%s' does not end in .webm, as a film has to"
                                                          : "-o '%s' is a film: --orbit says of what",
                                   arguments->out),
               false;
    if (arguments->orbit_s == 0 && !codec_from_path(arguments->out, &arguments->codec))
        return command_usage_error("render", "-o '%s' does not end in .png, .jpg or .jpeg", arguments->out), false;
    arguments->folder = argv[optind];
    return true;
}
