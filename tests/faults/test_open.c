/* Opening plans: every format, while a call of the system fails. */
#include "core/load/load.h"
#include "core/phantom/phantom.h"
#include "tests/check.h"
#include "tests/faults/walk.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/made_dose.h"
#include "tests/unit/made_series.h"
#include "tests/unit/rt_files.h"

#define TAG DICOM_TAG

static void add_volume(struct outcome *outcome, const struct volume *volume)
{
    outcome_add(outcome, volume->grid.size, sizeof volume->grid.size);
    outcome_add(outcome, &volume->grid.lps_mm_from_ijk, sizeof volume->grid.lps_mm_from_ijk);
    outcome_add(outcome, volume->voxels, grid_n_voxels(&volume->grid) * voxel_size(volume->type));
}

static void open_plan(void *context, struct outcome *outcome)
{
    struct plan *plan = plan_load(context, "p", NULL, &outcome->err);
    if (!plan)
        return;
    outcome->is_done = true;
    for (size_t i = 0; i < plan->n_images; i++)
        add_volume(outcome, plan->images[i].volume);
    for (size_t i = 0; i < plan->regions.n_layers; i++)
        add_volume(outcome, plan->regions.layers[i]);
    for (size_t i = 0; i < plan->regions.n_regions; i++) {
        outcome_add_text(outcome, plan->regions.regions[i].id);
        outcome_add_number(outcome, (double)plan->regions.regions[i].n_voxels);
        outcome_add_number(outcome, plan->regions.regions[i].parent);
    }
    for (size_t i = 0; i < plan->n_doses; i++)
        for (size_t c = 0; c < plan->doses[i].n_components; c++)
            add_volume(outcome, plan->doses[i].components[c].values);
    outcome_add_number(outcome, (double)plan->n_beams);
    outcome_add_number(outcome, (double)plan->tracks.n_segments);
    outcome_add_number(outcome, (double)plan->n_curves);
    outcome_add_number(outcome, (double)plan->preferences.n_levels);
    outcome_add_number(outcome, (double)plan->preferences.n_colors);
    for (size_t i = 0; i < plan->regions.n_regions; i++)
        outcome_add_number(outcome, plan->regions.regions[i].cbe_boron);
    for (size_t i = 0; i < plan->report.n_lines; i++) {
        outcome_add_text(outcome, plan->report.lines[i].code);
        outcome_add_text(outcome, plan->report.lines[i].where);
        outcome_add_text(outcome, plan->report.lines[i].sentence);
        outcome_note(outcome, plan->report.lines[i].sentence);
        /* a file that the disk does not give is left out, and so is a part for want of memory: the report says so */
        outcome->is_told |= strstr(plan->report.lines[i].sentence, "Input/output error") ||
                            strstr(plan->report.lines[i].sentence, "Too many open files") ||
                            strncmp(plan->report.lines[i].sentence, "Left out: ", 10) == 0 ||
                            strstr(plan->report.lines[i].sentence, "is shown without these preferences");
    }
    plan_destroy(plan);
}

static void walk_open(const char *name, char *folder)
{
    const struct walk walk = { .name = name,
                               .run = open_plan,
                               .context = folder,
                               .folder = folder,
                               .is_library_leaky = strstr(name, "DICOM") != NULL,
                               .kinds = { true, true, true, false, true, true } };
    walk_run(&walk);
}

static void walk_phantom(void)
{
    char root[256], folder[300];
    struct error err = { 0 };
    folder_make(root);
    snprintf(folder, sizeof folder, "%s/phantom", root);
    const struct phantom_options options = { { 20, 20, 16 }, 1 };
    if (!phantom_write(folder, &options, false, &err))
        abort();
    walk_open("a plan of NIfTI files opens", folder);
    folder_remove(root);
}

static void put_slices(const char *folder, int n)
{
    for (int k = 0; k < n; k++) {
        struct made_slice slice = made_slice_defaults;
        char name[32];
        slice.rows = slice.columns = 40;
        slice.spacing[0] = slice.spacing[1] = 2;
        slice.position[2] = 3.0 * k;
        slice.thickness = 3;
        slice.number = k + 1;
        slice.base = -1000;
        snprintf(name, sizeof name, "IM%04d", k);
        made_slice_put(folder, name, &slice);
    }
}

static void put_structures(const char *folder)
{
    struct made_dicom made;
    made_rt_begin(&made, "1.2.840.10008.5.1.4.1.1.481.3", "RTSTRUCT", NULL);
    made_sequence(&made, TAG(0x3006, 0x0020));
    for (int r = 0; r < 3; r++) {
        char name[16];
        snprintf(name, sizeof name, "Box %d", r);
        made_item(&made);
        made_integer(&made, TAG(0x3006, 0x0022), r);
        made_text(&made, TAG(0x3006, 0x0024), "UI", "1.2.9");
        made_text(&made, TAG(0x3006, 0x0026), "LO", name);
        made_item_end(&made);
    }
    made_sequence_end(&made);
    made_sequence(&made, TAG(0x3006, 0x0039));
    for (int r = 0; r < 3; r++) {
        made_item(&made);
        made_sequence(&made, TAG(0x3006, 0x0040));
        for (int k = 0; k < 4; k++) {
            double z = 3.0 * k, side = 4 + 6 * r;
            double box[] = { 39 - side, 40 - side, z, 39 + side, 40 - side, z,
                             39 + side, 40 + side, z, 39 - side, 40 + side, z };
            made_item(&made);
            made_text(&made, TAG(0x3006, 0x0042), "CS", "CLOSED_PLANAR");
            made_integer(&made, TAG(0x3006, 0x0046), 4);
            made_numbers(&made, TAG(0x3006, 0x0050), box, 12);
            made_item_end(&made);
        }
        made_sequence_end(&made);
        made_integer(&made, TAG(0x3006, 0x0084), r);
        made_item_end(&made);
    }
    made_sequence_end(&made);
    folder_put(folder, "rtstruct.dcm", made.data, made.size);
    made_finish(&made);
}

static void walk_dicom(void)
{
    char folder[256];
    struct made_dicom dose;
    folder_make(folder);
    put_slices(folder, 4);
    put_structures(folder);
    made_dose(&dose, 1);
    folder_put(folder, "rtdose.dcm", dose.data, dose.size);
    made_finish(&dose);
    walk_open("a plan of DICOM files opens", folder);
    folder_remove(folder);
}

static void walk_nrrd(void)
{
    char folder[256];
    folder_make(folder);
    static const char head[] =
        "NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 6 5 4\n"
        "space directions: (2,0,0) (0,2,0) (0,0,3)\nspace origin: (0,0,0)\nkinds: domain domain domain\nendian: little\n"
        "encoding: raw\n\n";
    static const char seg[] =
        "NRRD0004\ntype: unsigned char\ndimension: 3\nspace: left-posterior-superior\nsizes: 6 5 4\n"
        "space directions: (2,0,0) (0,2,0) (0,0,3)\nspace origin: (0,0,0)\nkinds: domain domain domain\n"
        "encoding: raw\nSegment0_ID:=a\nSegment0_Name:=First\nSegment0_LabelValue:=1\nSegment0_Layer:=0\n"
        "Segment1_ID:=b\nSegment1_Name:=Second\nSegment1_LabelValue:=2\nSegment1_Layer:=0\n\n";
    char bytes[2000];
    memcpy(bytes, head, sizeof head - 1);
    for (size_t i = 0; i < 240; i++)
        bytes[sizeof head - 1 + i] = (char)(i % 2 ? 0 : i);
    folder_put(folder, "ct.nrrd", bytes, sizeof head - 1 + 240);
    memcpy(bytes, seg, sizeof seg - 1);
    for (size_t i = 0; i < 120; i++)
        bytes[sizeof seg - 1 + i] = (char)(i % 3);
    folder_put(folder, "regions.seg.nrrd", bytes, sizeof seg - 1 + 120);
    walk_open("a plan of NRRD files opens", folder);
    folder_remove(folder);
}

/* Univels with tissues, colours and tracks, as SERA keeps them. */
static void walk_sera(void)
{
    static const char header[] =
        "Version: uvh2.0\nDimensionality: mm\nSliceOrientation: Axial\nImageRows: 16\nImageColumns: 16\nImageSlices: 2\n"
        "PixelSizeRows: 10\nPixelSizeColumns: 10\nPixelSizeSlices: 10\nRLaxisMin: -80\nRLaxisMax: 80\nPAaxisMin: -80\n"
        "PAaxisMax: 80\nISaxisMin: 0\nISaxisMax: 20\nImageRowAxis: PA-\nImageColumnAxis: RL+\nImageSliceAxis: IS+\n"
        "begin: brain\nuvval: 3\ntissue_to_blood: 2\nend\nbegin: tumor\nuvval: 4\nend\nbegin: bone\nuvval: 5\nend\n";
    static const char colors[] = "contour_level: 80 0 65535 0\nbrain_color: 257 514 771 30\n",
                      tissues[] = "begin: brain\ntissue_to_blood: 1\nboron_CF: 1.3\nend\n", map[] = "0 0 0\n255 0 0\n",
                      tracks[] = "0 0 0 10 0 0 0 1\n10 0 0 10 10 0 1 2\n";
    char folder[256];
    uint8_t univels[512];
    for (size_t i = 0; i < sizeof univels; i++)
        univels[i] = (uint8_t)(3 + i % 3);
    folder_make(folder);
    folder_put(folder, "a.uvh", header, sizeof header - 1);
    folder_put(folder, "a.uv", univels, sizeof univels);
    folder_put(folder, "S.rsc", colors, sizeof colors - 1);
    folder_put(folder, "body_data.txt", tissues, sizeof tissues - 1);
    folder_put(folder, "x.cmap", map, sizeof map - 1);
    folder_put(folder, "a.pp", tracks, sizeof tracks - 1);
    walk_open("a plan of SERA's files opens", folder);
    folder_remove(folder);
}

int main(void)
{
    walk_sera();
    walk_phantom();
    walk_dicom();
    walk_nrrd();
    return walks_end();
}
