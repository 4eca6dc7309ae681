/* DICOM Segmentations: made-up ones whose voxels follow a rule, contradictory ones, and real ones with a reference. */
#include "core/formats/dicom/dicom_seg.h"

#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/made_seg.h"
#include "tests/unit/made_series.h"
#include "tests/unit/plan_help.h"
#include "tests/unit/rt_files.h"

#define TAG DICOM_TAG

/* In random sequence; plane -2 of segment 1 is missing (empty), and planes 1 and 4 of segment 2; both segments
 * overlap. */
static const struct made_seg_frame frames[] = { { 2, -5 }, { 1, 4 }, { 1, -5 }, { 2, -2 }, { 1, 1 } };
static const struct made_seg two_parts = { .frames = frames, .n_frames = 5, .n_segments = 3 };

static bool read_seg(const struct made_dicom *made, const char *only, struct nrrd_layers *layers, struct report *report,
                     struct error *err)
{
    struct rt_file file = rt_file_of(made);
    *err = (struct error){ 0 };
    bool is_read = dicom_seg_read(file.file, "made.dcm", only, layers, report, err);
    rt_file_close(&file);
    return is_read;
}

static const struct label_name *name_of(const struct nrrd_layers *layers, const char *name, size_t *layer)
{
    for (*layer = 0; *layer < layers->n; ++*layer)
        for (size_t i = 0; i < layers->names[*layer].n; i++)
            if (strcmp(layers->names[*layer].labels[i].name, name) == 0)
                return &layers->names[*layer].labels[i];
    fail_msg("no segment %s", name);
    return NULL;
}

static bool has_frame(const struct made_seg *seg, int segment, double z_mm)
{
    for (int f = 0; f < seg->n_frames; f++)
        if (seg->frames[f].segment == segment && seg->frames[f].z_mm == z_mm)
            return true;
    return false;
}

/* Compares every voxel by its patient position. */
static void check_segment(const struct nrrd_layers *layers, const struct made_seg *seg, int segment)
{
    char name[16];
    size_t layer;
    snprintf(name, sizeof name, "Part %d", segment);
    const struct label_name *label = name_of(layers, name, &layer);
    const struct volume *volume = layers->volumes[layer];
    for (double z = -5; z <= 4; z += 3)
        for (int y = 0; y < MADE_SEG_ROWS; y++)
            for (int x = 0; x < MADE_SEG_COLUMNS; x++) {
                uint32_t ijk[3];
                assert_true(volume_voxel_at(volume, made_seg_lps_mm(seg, z, x, y), ijk));
                bool is_set = volume_label(volume, ijk[0], ijk[1], ijk[2]) == label->value;
                assert_int_equal(is_set, has_frame(seg, segment, z) && made_seg_is_set(segment, z, x, y));
            }
}

static void segments_have_the_voxels_of_their_frames_whatever_their_order(void **state)
{
    (void)state;
    for (int way = 0; way < 4; way++) { /* binary and fractional, with and without a plane distance */
        struct made_seg seg = two_parts;
        struct made_dicom made;
        struct nrrd_layers layers;
        struct report report = { 0 };
        struct error err;
        seg.is_fractional = way & 1;
        seg.between_mm = way & 2 ? 3 : 0;
        made_seg_bytes(&made, &seg);
        if (!read_seg(&made, "", &layers, &report, &err))
            fail_msg("%s", err.text);
        const struct grid *grid = &layers.volumes[0]->grid;
        assert_int_equal(grid->size[0], MADE_SEG_COLUMNS);
        assert_int_equal(grid->size[1], MADE_SEG_ROWS);
        assert_int_equal(grid->size[2], 1 + 4 + 1);
        assert_close(vec3_length(vec3_sub(grid->lps_mm_from_ijk.origin, vec3(10, 20, -5 - 3))), 0, 1e-9);
        check_segment(&layers, &seg, 1);
        check_segment(&layers, &seg, 2);
        size_t first, second;
        const struct label_name *one = name_of(&layers, "Part 1", &first), *two = name_of(&layers, "Part 2", &second);
        assert_true(one->has_color && one->rgb[0] >= 254 && one->rgb[1] <= 1 && one->rgb[2] <= 1);
        assert_false(two->has_color);
        assert_int_equal(layers.n, 1); /* they share no voxel */
        assert_int_equal(first, second);
        assert_non_null(strstr(report_said(&report, "region.unused-names"),
                               "1 of 3 segments have no voxel and are not listed: Part 3"));
        assert_int_equal(report_has(&report, "mask.fractional"), seg.is_fractional);
        if (seg.is_fractional)
            assert_non_null(
                strstr(report_said(&report, "mask.fractional"), "(PROBABILITY): voxels of 100 of 200 and more"));
        nrrd_layers_finish(&layers);
        report_finish(&report);
        made_finish(&made);
    }
}

static void segments_that_overlap_lie_on_layers_of_their_own(void **state)
{
    (void)state;
    static const struct made_seg_frame same[] = { { 1, 0 },
                                                  { 6, 0 },
                                                  { 2, 0 } }; /* 1 and 6: the same voxels; 2: others */
    const struct made_seg seg = { .frames = same, .n_frames = 3, .n_segments = 6 };
    struct made_dicom made;
    struct nrrd_layers layers;
    struct report report = { 0 };
    struct error err;
    made_seg_bytes(&made, &seg);
    assert_true(read_seg(&made, "", &layers, &report, &err));
    size_t one, two, six;
    (void)name_of(&layers, "Part 1", &one);
    (void)name_of(&layers, "Part 2", &two);
    (void)name_of(&layers, "Part 6", &six);
    assert_int_equal(layers.n, 2);
    assert_int_equal(one, two);
    assert_int_not_equal(one, six);
    nrrd_layers_finish(&layers);
    assert_true(read_seg(&made, "part 6", &layers, &report, &err)); /* a single one, by its label */
    assert_int_equal(layers.n, 1);
    assert_int_equal(layers.names[0].n, 1);
    nrrd_layers_finish(&layers);
    assert_false(read_seg(&made, "Liver", &layers, &report, &err));
    assert_non_null(strstr(err.text, "no segment is called \"Liver\""));
    made_finish(&made);
    report_finish(&report);
}

static void segments_lie_where_the_directions_of_their_frames_say(void **state)
{
    (void)state;
    static const double directions[][6] = { { 1, 0, 0, 0, 0, -1 }, { -1, 0, 0, 0, 1, 0 } }; /* coronal; mirrored */
    for (size_t i = 0; i < 2; i++) {
        struct made_seg seg = two_parts;
        struct made_dicom made;
        struct nrrd_layers layers;
        struct report report = { 0 };
        struct error err;
        seg.cosines = directions[i];
        made_seg_bytes(&made, &seg);
        assert_true(read_seg(&made, "", &layers, &report, &err));
        check_segment(&layers, &seg, 1);
        check_segment(&layers, &seg, 2);
        nrrd_layers_finish(&layers);
        report_finish(&report);
        made_finish(&made);
    }
}

/* 165 bits in 21 bytes: the last byte is the upper half of the eleventh word. */
static void bits_in_big_endian_words_are_read_and_half_a_word_is_refused(void **state)
{
    (void)state;
    struct made_seg seg = two_parts;
    struct made_dicom made;
    struct nrrd_layers layers;
    struct report report = { 0 };
    struct error err;
    seg.is_big_endian = true;
    made_seg_bytes(&made, &seg);
    assert_true(read_seg(&made, "", &layers, &report, &err));
    check_segment(&layers, &seg, 1);
    check_segment(&layers, &seg, 2);
    nrrd_layers_finish(&layers);
    made.data[made.size - 22 - 1] = 21;
    made.size--;
    assert_false(read_seg(&made, "", &layers, &report, &err));
    assert_non_null(strstr(err.text, "pixel data of 21 bytes; 11 x 3 x 5 pixels of 1 bit need 22"));
    report_finish(&report);
    made_finish(&made);
}

/* Frames closer than a thousandth of a millimetre share a position, and each is on a plane of the grid. */
static void frames_nearly_at_one_place_stay_inside_the_grid(void **state)
{
    (void)state;
    enum { MANY = 400 };
    static struct made_seg_frame chain[MANY];
    static const struct made_seg_frame two[] = { { 1, 0 }, { 1, 0.0009 } };
    for (int f = 0; f < MANY; f++)
        chain[f] = (struct made_seg_frame){ 1, 0.0009 * f };
    const struct made_seg near = { .frames = two, .n_frames = 2, .n_segments = 1, .between_mm = 0.0002 };
    const struct made_seg chained = { .frames = chain, .n_frames = MANY, .n_segments = 1, .thickness_mm = 0.005 };
    struct made_dicom made;
    struct nrrd_layers layers;
    struct report report = { 0 };
    struct error err;
    made_seg_bytes(&made, &near);
    assert_true(read_seg(&made, "", &layers, &report, &err));
    assert_int_equal(layers.volumes[0]->grid.size[2], 3);
    nrrd_layers_finish(&layers);
    made_finish(&made);
    made_seg_bytes(&made, &chained);
    assert_false(read_seg(&made, "", &layers, &report, &err));
    assert_non_null(strstr(err.text, "planes that are not even: 200 places, the nearest 0.0018 mm apart"));
    made_finish(&made);
    report_finish(&report);
}

static void a_thickness_that_the_file_does_not_give_is_said(void **state)
{
    (void)state;
    static const struct made_seg_frame frames_apart[] = { { 1, 1 }, { 1, 7 } };
    static const struct {
        int n_frames;
        double thickness_mm, between_mm;
        const char *code, *words;
    } cases[] = { { 1, 0, 0, "geometry.assumed", "1 mm was taken as its thickness" },
                  { 1, 3, 0, "geometry.assumed", "" },
                  { 1, 0, 2, "geometry.assumed", "" },
                  { 2, 3, 0, "image.thickness-differs", "Frames are 3 mm thick (0018,0050) and lie 6 mm apart" },
                  { 2, 6, 0, "image.thickness-differs", "" },
                  { 2, 3, 6, "image.thickness-differs", "" },
                  { 2, 0, 0, "image.thickness-differs", "" } };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct made_seg seg = { .frames = frames_apart,
                                .n_frames = cases[i].n_frames,
                                .n_segments = 1,
                                .thickness_mm = cases[i].thickness_mm,
                                .between_mm = cases[i].between_mm };
        struct made_dicom made;
        struct nrrd_layers layers;
        struct report report = { 0 };
        struct error err;
        made_seg_bytes(&made, &seg);
        assert_true(read_seg(&made, "", &layers, &report, &err));
        assert_int_equal(report_has(&report, cases[i].code), cases[i].words[0] != 0);
        assert_non_null(strstr(report_said(&report, cases[i].code), cases[i].words));
        nrrd_layers_finish(&layers);
        report_finish(&report);
        made_finish(&made);
    }
}

/* Two frames of 33 pixels 84 mm apart, planes 3 mm apart: 29 planes and one empty one at either end. */
static void the_size_of_a_segmentation_counts_its_empty_planes(void **state)
{
    (void)state;
    static const struct made_seg_frame apart[] = { { 1, 0 }, { 1, 84 } };
    const struct made_seg seg = { .frames = apart, .n_frames = 2, .n_segments = 2, .between_mm = 3 };
    struct made_dicom made;
    uint64_t n_voxels;
    size_t n_segments;
    made_seg_bytes(&made, &seg);
    struct rt_file file = rt_file_of(&made);
    assert_true(dicom_seg_measure(file.file, &n_voxels, &n_segments));
    assert_int_equal(n_voxels, 33 * (1 + 29 + 1));
    assert_int_equal(n_segments, 2);
    rt_file_close(&file);
    made_finish(&made);
}

/* Two lesions of three planes, 3 mm apart, with 300 empty planes between them: two grids of 1 + 3 + 1 planes. */
static void segments_far_apart_take_no_memory_between_them(void **state)
{
    (void)state;
    static const struct made_seg_frame apart[] = { { 1, 0 }, { 1, 3 }, { 1, 6 }, { 2, 909 }, { 2, 912 }, { 2, 915 } };
    const struct made_seg seg = { .frames = apart, .n_frames = 6, .n_segments = 2, .between_mm = 3 };
    struct made_dicom made;
    struct nrrd_layers layers;
    struct report report = { 0 };
    struct error err;
    uint64_t n_voxels;
    size_t n_segments, one, two;
    made_seg_bytes(&made, &seg);
    struct rt_file file = rt_file_of(&made);
    assert_true(dicom_seg_measure(file.file, &n_voxels, &n_segments));
    assert_int_equal(n_voxels, 2 * 33 * 5);
    rt_file_close(&file);
    if (!read_seg(&made, "", &layers, &report, &err))
        fail_msg("%s", err.text);
    assert_int_equal(layers.n, 2);
    (void)name_of(&layers, "Part 1", &one);
    (void)name_of(&layers, "Part 2", &two);
    assert_int_equal(layers.volumes[one]->grid.size[2], 5);
    assert_int_equal(layers.volumes[two]->grid.size[2], 5);
    assert_close(layers.volumes[one]->grid.lps_mm_from_ijk.origin.z, -3, 1e-9);
    assert_close(layers.volumes[two]->grid.lps_mm_from_ijk.origin.z, 906, 1e-9);
    for (int z = 0; z < 3; z++)
        for (int y = 0; y < MADE_SEG_ROWS; y++)
            for (int x = 0; x < MADE_SEG_COLUMNS; x++) {
                uint32_t at[3] = { (uint32_t)x, (uint32_t)y, (uint32_t)z + 1 };
                assert_int_equal(volume_label(layers.volumes[one], at[0], at[1], at[2]) > 0,
                                 made_seg_is_set(1, 3 * z, x, y));
                assert_int_equal(volume_label(layers.volumes[two], at[0], at[1], at[2]) > 0,
                                 made_seg_is_set(2, 909 + 3 * z, x, y));
            }
    nrrd_layers_finish(&layers);
    report_finish(&report);
    made_finish(&made);
}

static void single_frames_far_apart_are_as_thick_as_they_say(void **state)
{
    (void)state;
    static const struct made_seg_frame apart[] = { { 1, 0 }, { 2, 90 } };
    const struct made_seg seg = { .frames = apart, .n_frames = 2, .n_segments = 2, .thickness_mm = 3 };
    struct made_dicom made;
    struct nrrd_layers layers;
    struct report report = { 0 };
    struct error err;
    made_seg_bytes(&made, &seg);
    assert_true(read_seg(&made, "", &layers, &report, &err));
    assert_int_equal(layers.n, 2);
    assert_close(layers.volumes[0]->grid.lps_mm_from_ijk.columns[2].z, 3, 1e-9);
    nrrd_layers_finish(&layers);
    report_finish(&report);
    made_finish(&made);
}

static void segments_beyond_the_limit_are_left_out_and_named(void **state)
{
    (void)state;
    enum { N = 1500 };
    static struct made_seg_frame many[N];
    for (int i = 0; i < N; i++)
        many[i] = (struct made_seg_frame){ i + 1, 3 * i };
    const struct made_seg seg = { .frames = many, .n_frames = N, .n_segments = N, .between_mm = 3 };
    struct made_dicom made;
    struct nrrd_layers layers;
    struct report report = { 0 };
    struct error err;
    made_seg_bytes(&made, &seg);
    assert_true(read_seg(&made, "", &layers, &report, &err));
    size_t n = 0;
    for (size_t i = 0; i < layers.n; i++)
        n += layers.names[i].n;
    assert_int_equal(n, 1024);
    assert_non_null(strstr(report_said(&report, "region.too-many"),
                           "476 of 1500 segments were left out, as at most 1024 are read: Part 1025, Part 1026"));
    nrrd_layers_finish(&layers);
    report_finish(&report);
    made_finish(&made);
}

static void colors_are_those_of_lindbloom_s_tables(void **state)
{
    (void)state;
    static const struct {
        double lab[3]; /* white point D50 */
        int rgb[3];
    } colors[] = { { { 54.29, 80.81, 69.89 }, { 255, 0, 0 } },
                   { { 87.82, -79.29, 80.99 }, { 0, 255, 0 } },
                   { { 29.57, 68.30, -112.03 }, { 0, 0, 255 } },
                   { { 100, 0, 0 }, { 255, 255, 255 } },
                   { { 0, 0, 0 }, { 0, 0, 0 } },
                   { { 53.585, 0, 0 }, { 128, 128, 128 } } };
    for (size_t i = 0; i < sizeof colors / sizeof colors[0]; i++) {
        const double *lab = colors[i].lab;
        uint16_t stored[3] = { (uint16_t)lround(lab[0] * 655.35), (uint16_t)lround((lab[1] + 128) * 257),
                               (uint16_t)lround((lab[2] + 128) * 257) };
        uint8_t rgb[3];
        dicom_seg_color(stored, rgb);
        for (int c = 0; c < 3; c++)
            assert_true(abs(rgb[c] - colors[i].rgb[c]) <= 1); /* the tables have two decimals */
    }
}

static void what_contradicts_itself_is_refused_by_name(void **state)
{
    (void)state;
    static const struct made_seg_frame uneven[] = { { 1, 0 }, { 1, 3 }, { 1, 7 } },
                                       far[] = { { 1, 0 }, { 1, 0.01 }, { 1, 900 } };
    static const struct made_seg_frame unknown[] = { { 1, 0 }, { 9, 3 } };
    struct {
        struct made_seg seg;
        size_t cut;
        const char *words;
    } cases[] = {
        { { .frames = uneven, .n_frames = 3, .n_segments = 1 },
          0,
          "planes that are not even: 3 places, the nearest 3 mm apart over 7 mm" },
        { { .frames = far, .n_frames = 3, .n_segments = 1 }, 0, "0.01 mm apart: 90001 planes; at most 4094 are read" },
        { { .frames = unknown, .n_frames = 2, .n_segments = 0 }, 0, "no Segment Sequence (0062,0002)" },
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct made_dicom made;
        struct nrrd_layers layers;
        struct report report = { 0 };
        struct error err;
        made_seg_bytes(&made, &cases[i].seg);
        assert_false(read_seg(&made, "", &layers, &report, &err));
        if (!strstr(err.text, cases[i].words))
            fail_msg("\"%s\" does not say \"%s\"", err.text, cases[i].words);
        made_finish(&made);
        report_finish(&report);
    }
    struct made_seg seg = { .frames = unknown, .n_frames = 2, .n_segments = 1 }; /* a frame of an undefined segment */
    struct made_dicom made;
    struct nrrd_layers layers;
    struct report report = { 0 };
    struct error err;
    made_seg_bytes(&made, &seg);
    assert_true(read_seg(&made, "", &layers, &report, &err));
    assert_non_null(strstr(report_said(&report, "region.roi-number"),
                           "1 frames belong to segments (0062,000B) that the file does not describe (the first: 9)"));
    nrrd_layers_finish(&layers);
    report_finish(&report);
    made.data[made.size - 10 - 4] = 6; /* 66 pixels need 9 bytes, padded to 10: the length says 6 */
    made.size -= 4;
    struct dicom_file *file = dicom_file_parse(made.data, made.size, "cut.dcm", DICOM_WHOLE, &err);
    bool is_read = file && dicom_seg_read(file, "cut.dcm", "", &layers, &report, &err);
    assert_false(is_read);
    assert_non_null(strstr(err.text, "pixel data of 6 bytes; 11 x 3 x 2 pixels of 1 bit need 9"));
    dicom_file_destroy(file);
    made_finish(&made);
    report_finish(&report);
}

static void a_folder_with_a_segmentation_has_its_regions(void **state)
{
    (void)state;
    for (int way = 0; way < 3; way++) { /* of the series; of another one; in another frame of reference */
        char folder[256];
        struct error err;
        struct made_dicom made;
        struct made_seg seg = two_parts;
        seg.series = way == 0 ? "1.2.3" : "1.2.77";
        seg.frame_of_reference = way == 2 ? "1.2.99" : "1.2.9";
        folder_make(folder);
        for (int k = 0; k < 4; k++) {
            struct made_slice slice = made_slice_defaults;
            char name[16];
            slice.position[2] = -5 + 3 * k;
            slice.number = k + 1;
            slice.base = -1000;
            snprintf(name, sizeof name, "ct%d", k);
            made_slice_put(folder, name, &slice);
        }
        made_seg_bytes(&made, &seg);
        folder_put(folder, "seg.dcm", made.data, made.size);
        made_finish(&made);
        struct plan *plan = plan_of_folder(folder, &err);
        assert_string_equal(err.text, "");
        assert_int_equal(plan->regions.n_regions, 2);
        const struct region *one = region_of(plan, "part-1");
        assert_true(one->has_file_color);
        assert_close(one->rgb[0], 255, 1);
        uint64_t n_expected = 0;
        for (int i = 0; i < 3 * MADE_SEG_ROWS * MADE_SEG_COLUMNS; i++)
            n_expected += made_seg_is_set(1, (const double[]){ -5, 1, 4 }[i % 3], i / 3 % MADE_SEG_COLUMNS,
                                          i / 3 / MADE_SEG_COLUMNS);
        assert_int_equal(one->n_voxels, n_expected);
        assert_int_equal(report_has(&plan->report, "region.image-chosen"), way == 1);
        assert_int_equal(report_has(&plan->report, "region.frame-differs"), way == 2);
        assert_false(report_has(&plan->report, "dicom.not-used"));
        plan_destroy(plan);
        folder_remove(folder);
    }
}

/* ---- real ones -------------------------------------------------------------------------------------------------- */

static void a_real_liver_is_the_one_of_its_nrrd_voxel_for_voxel(void **state)
{
    (void)state;
    char folder[256], from[300];
    if (!rt_unpack("dicom-seg/seg.tar.xz", folder))
        skip();
    static const char *const names[] = { "seg/liver.dcm", "seg/liver_seg.nrrd" };
    struct plan *plans[2];
    for (int i = 0; i < 2; i++) {
        char alone[256];
        struct error err;
        folder_make(alone);
        snprintf(from, sizeof from, "%s/%s", folder, names[i]);
        size_t size;
        uint8_t *bytes = file_bytes(from, &size);
        folder_put(alone, i ? "liver_seg.nrrd" : "liver.dcm", bytes, size);
        if (i == 1)
            folder_put_text(
                alone, "plan.json",
                "{\"format\": \"beamroom-plan\", \"version\": 1, \"regions\": [{\"path\": \"liver_seg.nrrd\"}]}");
        free(bytes);
        plans[i] = plan_of_folder(alone, &err);
        assert_string_equal(err.text, "");
        folder_remove(alone);
    }
    const struct region *region = region_of(plans[0], "liver");
    const struct volume *seg = plans[0]->regions.layers[region->layer], *nrrd = plans[1]->regions.layers[0];
    assert_int_equal(region->n_voxels, 107098);
    assert_false(region->touches_edge); /* the writer omitted empty frames; the scan does not cut the liver */
    struct affine first = seg->grid.lps_mm_from_ijk;
    first.origin = affine_point(&first, vec3(0, 0, 1)); /* one empty plane before the first frame, one after the last */
    struct grid inner;
    assert_true(
        grid_init(&inner, (uint32_t[]){ seg->grid.size[0], seg->grid.size[1], seg->grid.size[2] - 2 }, &first, NULL));
    assert_true(grid_is_same(&inner, &nrrd->grid));
    for (uint32_t k = 0; k < 3; k++)
        for (uint32_t j = 0; j < 512; j++)
            for (uint32_t i = 0; i < 512; i++)
                if ((volume_label(seg, i, j, k + 1) == region->label) != (volume_label(nrrd, i, j, k) == 1))
                    fail_msg("voxel %u %u %u", i, j, k);
    plan_destroy(plans[0]);
    plan_destroy(plans[1]);
    folder_remove(folder);
}

static void real_segments_that_overlap_have_the_voxels_that_pydicom_and_numpy_count(void **state)
{
    (void)state;
    static const struct {
        const char *id;
        uint64_t n;
    } counts[] = {
        { "green", 9602 }, { "orange", 11888 }, { "purple", 10743 }, { "light-blue", 6693 }, { "dark-blue", 4713 }
    };
    char folder[256], from[300], alone[256];
    struct error err;
    if (!rt_unpack("dicom-seg/seg.tar.xz", folder))
        skip();
    snprintf(from, sizeof from, "%s/seg/partial_overlaps.dcm", folder);
    size_t size;
    uint8_t *bytes = file_bytes(from, &size);
    folder_make(alone);
    folder_put(alone, "seg.dcm", bytes, size);
    free(bytes);
    struct plan *plan = plan_of_folder(alone, &err);
    assert_string_equal(err.text, "");
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++)
        assert_int_equal(region_of(plan, counts[i].id)->n_voxels, counts[i].n);
    plan_destroy(plan);
    folder_remove(alone);
    folder_remove(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(segments_have_the_voxels_of_their_frames_whatever_their_order),
        cmocka_unit_test(segments_that_overlap_lie_on_layers_of_their_own),
        cmocka_unit_test(segments_lie_where_the_directions_of_their_frames_say),
        cmocka_unit_test(bits_in_big_endian_words_are_read_and_half_a_word_is_refused),
        cmocka_unit_test(frames_nearly_at_one_place_stay_inside_the_grid),
        cmocka_unit_test(a_thickness_that_the_file_does_not_give_is_said),
        cmocka_unit_test(the_size_of_a_segmentation_counts_its_empty_planes),
        cmocka_unit_test(segments_far_apart_take_no_memory_between_them),
        cmocka_unit_test(single_frames_far_apart_are_as_thick_as_they_say),
        cmocka_unit_test(segments_beyond_the_limit_are_left_out_and_named),
        cmocka_unit_test(colors_are_those_of_lindbloom_s_tables),
        cmocka_unit_test(what_contradicts_itself_is_refused_by_name),
        cmocka_unit_test(a_folder_with_a_segmentation_has_its_regions),
        cmocka_unit_test(a_real_liver_is_the_one_of_its_nrrd_voxel_for_voxel),
        cmocka_unit_test(real_segments_that_overlap_have_the_voxels_that_pydicom_and_numpy_count),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
