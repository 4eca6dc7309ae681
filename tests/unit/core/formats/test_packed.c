/* Packed files that were damaged: single bits changed, cut, more behind the stream. Each is refused, or gives the very
 * voxels it held. */
#include <zlib.h>

#include "core/formats/gzip.h"
#include "core/formats/nifti.h"
#include "core/formats/nrrd.h"
#include "core/formats/sera/sera_qhd.h"
#include "core/formats/sera/sera_uvh.h"
#include "core/formats/zlib_stream.h"
#include "tests/check.h"
#include "tests/unit/nifti_bytes.h"
#include "tests/unit/plan_help.h"

enum { SIDE = 16, N_VOXELS = SIDE * SIDE * SIDE };

static const char nrrd_head[] = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 16 16 16\nencoding: gzip\nspace: LPS\n"
                                "space directions: (1,0,0) (0,1,0) (0,0,1)\n\n";
static const char uvh_head[] =
    "Version: uvh2.0\nDimensionality: mm\nSliceOrientation: Axial\nImageRows: 16\nImageColumns: 16\nImageSlices: 16\n"
    "PixelSizeRows: 20\nPixelSizeColumns: 20\nPixelSizeSlices: 20\nRLaxisMin: -160\nRLaxisMax: 160\n"
    "PAaxisMin: -160\nPAaxisMax: 160\nISaxisMin: 0\nISaxisMax: 320\nImageRowAxis: PA-\nImageColumnAxis: RL+\n"
    "ImageSliceAxis: IS+\nbegin: brain\nuvval: 3\nend\n";
static const char qhd_head[] =
    "Modality := MR\nSlice Orientation := Axial\nDimensionality := mm\nBytes Per Pixel := 1\nByte Order := big endian\n"
    "Number of Dimensions := 3\nSize of Dimension[0] := 16\nSize of Dimension[1] := 16\nSize of Dimension[2] := 16\n"
    "X Pixel Size := 20\nY Pixel Size := 20\nReference Location := 10\nUniform Spacing := 20\n";

static uint32_t random_state;
static uint32_t next_random(void) /* Marsaglia's xorshift: the same sequence everywhere */
{
    random_state ^= random_state << 13;
    random_state ^= random_state >> 17;
    random_state ^= random_state << 5;
    return random_state;
}

/* Noise on a slope, as an image has: literals and matches both. */
static void fill_bytes(uint8_t *out, size_t n)
{
    random_state = 7;
    for (size_t i = 0; i < n; i++)
        out[i] = (uint8_t)(i / 64 + (next_random() % 8 == 0 ? next_random() % 16 : 0));
}

/* window_bits as of zlib: 15 + 16 gzip with a header of name and time, 15 a bare stream. */
static struct bytes pack(const uint8_t *data, size_t size, int window_bits)
{
    struct bytes packed = { malloc(size + size / 2 + 1024), 0 };
    gz_header head = { .time = 1000000000, .name = (Bytef *)(uintptr_t) "head.nii", .os = 3 };
    z_stream stream = { .next_in = (Bytef *)(uintptr_t)data,
                        .avail_in = (uInt)size,
                        .next_out = packed.data,
                        .avail_out = (uInt)(size + size / 2 + 1024) };
    assert_int_equal(deflateInit2(&stream, 6, Z_DEFLATED, window_bits, 8, Z_DEFAULT_STRATEGY), Z_OK);
    if (window_bits > 15)
        assert_int_equal(deflateSetHeader(&stream, &head), Z_OK);
    assert_int_equal(deflate(&stream, Z_FINISH), Z_STREAM_END);
    packed.size = stream.total_out;
    deflateEnd(&stream);
    return packed;
}

/* ---- the files, each read as a plan reads it -------------------------------------------------------------------- */

enum kind { NIFTI_U8, NIFTI_I16, NIFTI_F32, NRRD_GZIP, UV_GZ, QIM_GZ, UV_SZ, QIM_SZ, N_KINDS };
static const char *const names[N_KINDS] = { "a.nii.gz", "b.nii.gz", "c.nii.gz", "d.nrrd",
                                            "e.uv.gz",  "f.qim.gz", "g.uv.sz",  "h.qim.sz" };

static struct bytes make_nifti(int datatype, int bits)
{
    struct nifti_bytes nifti = nifti_bytes_make(SIDE, SIDE, SIDE, datatype, bits, (size_t)(N_VOXELS * bits / 8), false);
    const double rows[3][4] = { { -1, 0, 0, 0 }, { 0, -1, 0, 0 }, { 0, 0, 1, 0 } };
    uint8_t *voxels = nifti.data + nifti.size - N_VOXELS * bits / 8;
    nifti_put_sform(&nifti, rows);
    fill_bytes(voxels, (size_t)(N_VOXELS * bits / 8));
    for (size_t i = 0; bits == 32 && i < N_VOXELS; i++) {
        float value = (float)voxels[i] * 0.25f;
        memcpy(voxels + 4 * i, &value, sizeof value);
    }
    struct bytes packed = pack(nifti.data, nifti.size, 15 + 16);
    nifti_bytes_free(&nifti);
    return packed;
}

/* stream_at: where the packed stream begins; text in front of it has no checksum. */
static struct bytes make_file(enum kind kind, size_t *stream_at)
{
    uint8_t voxels[N_VOXELS];
    *stream_at = 0;
    fill_bytes(voxels, sizeof voxels);
    switch (kind) {
    case NIFTI_U8: return make_nifti(2, 8);
    case NIFTI_I16: return make_nifti(4, 16);
    case NIFTI_F32: return make_nifti(16, 32);
    case NRRD_GZIP: {
        struct bytes packed = pack(voxels, sizeof voxels, 15 + 16),
                     file = { malloc(packed.size + sizeof nrrd_head), 0 };
        *stream_at = sizeof nrrd_head - 1;
        memcpy(file.data, nrrd_head, *stream_at);
        memcpy(file.data + *stream_at, packed.data, packed.size);
        file.size = *stream_at + packed.size;
        bytes_free(&packed);
        return file;
    }
    case UV_SZ:
    case QIM_SZ: return pack(voxels, sizeof voxels, 15);
    default: return pack(voxels, sizeof voxels, 15 + 16);
    }
}

static struct volume *read_file(enum kind kind, const struct bytes *file, struct report *report, struct error *err)
{
    struct volume *volume = NULL;
    const char *name = names[kind];
    *err = (struct error){ 0 };
    if (kind <= NIFTI_F32)
        return nifti_read(file, name, RAW_IMAGE, report, err);
    if (kind == NRRD_GZIP) {
        struct nrrd_header header = { 0 };
        if (nrrd_parse_header(file->data, file->size, name, &header, report, err))
            volume = nrrd_read(&header, file, name, RAW_IMAGE, report, err);
        nrrd_header_finish(&header);
        return volume;
    }
    if (kind == UV_GZ || kind == UV_SZ) {
        struct uvh uvh;
        assert_true(uvh_parse((const uint8_t *)uvh_head, sizeof uvh_head - 1, "e.uvh", &uvh, NULL, err));
        volume = uvh_read_univels(&uvh, file, name, err);
        uvh_finish(&uvh);
        return volume;
    }
    struct qhd qhd;
    bool is_doubtful;
    assert_true(qhd_parse((const uint8_t *)qhd_head, sizeof qhd_head - 1, "f.qhd", &qhd, NULL, err));
    volume = qhd_read_pixels(&qhd, file, "f.qhd", name, &is_doubtful, report, err);
    qhd_finish(&qhd);
    return volume;
}

static bool is_same(const struct volume *a, const struct volume *b)
{
    return a->type == b->type && memcmp(a->grid.size, b->grid.size, sizeof a->grid.size) == 0 &&
           memcmp(&a->grid.lps_mm_from_ijk, &b->grid.lps_mm_from_ijk, sizeof a->grid.lps_mm_from_ijk) == 0 &&
           a->slope == b->slope && a->offset == b->offset &&
           memcmp(a->voxels, b->voxels, N_VOXELS * voxel_size(a->type)) == 0;
}

/* Adler-32, all that a zlib stream has, is weak: the changes -1, -1, +4, -1, -1 to five voxels in a row leave it as it
 * is. */
static bool has_equal_sum(enum kind kind, const struct volume *a, const struct volume *b)
{
    return (kind == UV_SZ || kind == QIM_SZ) && memcmp(a->grid.size, b->grid.size, sizeof a->grid.size) == 0 &&
           adler32(1, a->voxels, N_VOXELS) == adler32(1, b->voxels, N_VOXELS);
}

/* A refusal names the file; what is not refused has the voxels of the file as it was. */
static bool is_silent(enum kind kind, const struct bytes *file, const struct volume *whole)
{
    struct error err;
    struct volume *volume = read_file(kind, file, NULL, &err);
    bool is_wrong =
        volume ? !is_same(volume, whole) && !has_equal_sum(kind, volume, whole) : !strstr(err.text, names[kind]);
    volume_unref(volume);
    return is_wrong;
}

/* ---- damage ----------------------------------------------------------------------------------------------------- */

/* Whether the file with one bit changed opens with other voxels; the bit is put back. */
static bool is_silent_without(enum kind kind, struct bytes *file, size_t bit, const struct volume *whole)
{
    uint8_t *byte = &file->data[bit / 8], mask = (uint8_t)(1 << bit % 8);
    *byte ^= mask;
    bool is_wrong = is_silent(kind, file, whole);
    *byte ^= mask;
    return is_wrong;
}

static void no_changed_bit_of_a_packed_file_gives_other_voxels(void **state)
{
    (void)state;
    enum { HEAD_BITS = 8 * 12, END_BITS = 8 * 8, FLIPS = 200 };
    int n_flips = 0;
    for (enum kind kind = NIFTI_U8; kind < N_KINDS; kind++) {
        size_t stream_at;
        struct error err;
        struct bytes file = make_file(kind, &stream_at);
        size_t first = 8 * stream_at, n_bits = 8 * (file.size - stream_at);
        struct volume *whole = read_file(kind, &file, NULL, &err);
        assert_string_equal(err.text, "");
        int n_silent = 0;
        for (size_t i = 0; i < HEAD_BITS; i++)
            n_silent += is_silent_without(kind, &file, first + i, whole);
        for (size_t i = 0; i < END_BITS; i++)
            n_silent += is_silent_without(kind, &file, first + n_bits - 1 - i, whole);
        random_state = 11 + (uint32_t)kind;
        for (int i = 0; i < FLIPS; i++)
            n_silent += is_silent_without(kind, &file, first + next_random() % n_bits, whole);
        n_flips += HEAD_BITS + END_BITS + FLIPS;
        volume_unref(whole);
        bytes_free(&file);
        if (n_silent > 0)
            fail_msg("%s: %d of %d changed bits gave other voxels", names[kind], n_silent,
                     HEAD_BITS + END_BITS + FLIPS);
    }
    assert_true(n_flips >= 1000);
}

static void a_packed_file_that_is_cut_anywhere_is_refused(void **state)
{
    (void)state;
    for (enum kind kind = NIFTI_U8; kind < N_KINDS; kind++) {
        size_t stream_at;
        struct error err;
        struct bytes file = make_file(kind, &stream_at);
        size_t size = file.size;
        for (size_t cut = 1; cut < size - stream_at; cut += cut < 16 ? 1 : 37) {
            struct bytes part = { malloc(size - cut),
                                  size - cut }; /* of exactly that size, for the address sanitizer */
            memcpy(part.data, file.data, size - cut);
            struct volume *volume = read_file(kind, &part, NULL, &err);
            if (volume || !strstr(err.text, names[kind]))
                fail_msg("%s without its last %zu bytes opened, or was refused without its name: %s", names[kind], cut,
                         err.text);
            free(part.data);
        }
        bytes_free(&file);
    }
}

static struct bytes with_tail(const struct bytes *file, const void *tail, size_t n)
{
    struct bytes all = { malloc(file->size + n), file->size + n };
    memcpy(all.data, file->data, file->size);
    memcpy(all.data + file->size, tail, n);
    return all;
}

/* Tapes and transfers fill up with zeros, and gzip(1) takes them; other bytes may be a member whose head was damaged.
 */
static void zeros_behind_a_stream_are_padding_and_other_bytes_are_refused_with_their_place(void **state)
{
    (void)state;
    for (enum kind kind = NIFTI_U8; kind < N_KINDS; kind++) {
        size_t stream_at;
        struct error err;
        char place[64];
        struct bytes file = make_file(kind, &stream_at), padded = with_tail(&file, (const uint8_t[600]){ 0 }, 600),
                     followed = with_tail(&file, (const uint8_t[]){ 0, 0, 'x' }, 3);
        struct volume *whole = read_file(kind, &file, NULL, &err), *volume = read_file(kind, &padded, NULL, &err);
        assert_string_equal(err.text, "");
        assert_true(is_same(whole, volume));
        volume_unref(volume);
        assert_null(read_file(kind, &followed, NULL, &err));
        assert_int_equal(err.code, ERROR_FORMAT);
        snprintf(place, sizeof place, "ends at byte %zu", file.size - stream_at);
        if (!strstr(err.text, place) || !strstr(err.text, "3 more bytes"))
            fail_msg("\"%s\" does not say \"%s\"", err.text, place);
        volume_unref(whole);
        bytes_free(&file);
        bytes_free(&padded);
        bytes_free(&followed);
    }
}

static void the_sentence_says_where_a_stream_is_damaged(void **state)
{
    (void)state;
    struct error err;
    size_t stream_at;
    struct bytes file = make_file(UV_GZ, &stream_at);
    file.data[file.size - 6] ^= 4; /* of the CRC-32 */
    assert_null(read_file(UV_GZ, &file, NULL, &err));
    assert_int_equal(err.code, ERROR_FORMAT);
    assert_non_null(strstr(err.text, "e.uv.gz: the gzip stream is damaged near byte "));
    assert_non_null(strstr(err.text, "after 4096 unpacked bytes: the checksum (CRC-32) does not fit"));
    file.data[file.size - 6] ^= 4;
    file.data[file.size - 3] ^= 1; /* of the length */
    assert_null(read_file(UV_GZ, &file, NULL, &err));
    assert_non_null(strstr(err.text, "after 4096 unpacked bytes: the length at its end is not"));
    file.data[file.size - 3] ^= 1;
    file.size--;
    assert_null(read_file(UV_GZ, &file, NULL, &err));
    assert_non_null(strstr(err.text, "e.uv.gz: the gzip stream is cut short at byte "));
    bytes_free(&file);
}

/* ---- several members -------------------------------------------------------------------------------------------- */

static void every_member_of_a_stream_is_read_and_checked(void **state)
{
    (void)state;
    uint8_t voxels[N_VOXELS], out[N_VOXELS];
    uint64_t n_more;
    struct error err = { 0 };
    fill_bytes(voxels, sizeof voxels);
    struct bytes first = pack(voxels, 1000, 15 + 16), second = pack(voxels + 1000, N_VOXELS - 1000, 15 + 16),
                 both = with_tail(&first, second.data, second.size), unpacked;
    assert_true(gzip_exact(both.data, both.size, "m", out, N_VOXELS, &n_more, &err));
    assert_memory_equal(out, voxels, N_VOXELS);
    assert_int_equal(n_more, 0);
    assert_true(gzip_all(both.data, both.size, "m", 1 << 20, &unpacked, &err));
    assert_int_equal(unpacked.size, N_VOXELS);
    assert_memory_equal(unpacked.data, voxels, N_VOXELS);
    bytes_free(&unpacked);
    static const size_t from_end[] = { 1, 8, 100 };
    for (size_t i = 0; i < 3; i++)
        for (int member = 0; member < 2; member++) {
            uint8_t *byte = &both.data[(member ? both.size : first.size) - from_end[i]];
            *byte ^= 16;
            assert_false(gzip_exact(both.data, both.size, "m", out, N_VOXELS, &n_more, &err));
            assert_int_equal(err.code, ERROR_FORMAT);
            assert_false(
                gzip_exact(both.data, both.size, "m", out, 1000, &n_more, &err)); /* also behind what is asked for */
            assert_int_equal(err.code, ERROR_FORMAT);
            assert_false(gzip_all(both.data, both.size, "m", 1 << 20, &unpacked, &err));
            *byte ^= 16;
        }
    for (int i = 0; i < 16; i++) { /* the two bytes that begin the second member */
        both.data[first.size + (size_t)i / 8] ^= (uint8_t)(1 << i % 8);
        assert_false(gzip_exact(both.data, both.size, "m", out, 1000, &n_more, &err));
        assert_int_equal(err.code, ERROR_FORMAT);
        assert_false(gzip_all(both.data, both.size, "m", 1 << 20, &unpacked, &err));
        assert_int_equal(err.code, ERROR_FORMAT);
        both.data[first.size + (size_t)i / 8] ^= (uint8_t)(1 << i % 8);
    }
    bytes_free(&first);
    bytes_free(&second);
    bytes_free(&both);
}

static void more_inside_than_asked_for_is_counted_checked_and_bounded(void **state)
{
    (void)state;
    uint8_t voxels[N_VOXELS], out[100];
    uint64_t n_more = 0;
    struct error err = { 0 };
    fill_bytes(voxels, sizeof voxels);
    struct bytes packed = pack(voxels, N_VOXELS, 15 + 16);
    assert_true(gzip_exact(packed.data, packed.size, "m", out, sizeof out, &n_more, &err));
    assert_int_equal(n_more, N_VOXELS - sizeof out);
    assert_memory_equal(out, voxels, sizeof out);
    bytes_free(&packed);
    size_t n_large = sizeof out + GZIP_MOST_MORE;
    uint8_t *large = calloc(n_large + 1, 1);
    assert_non_null(large);
    packed = pack(large, n_large, 15 + 16);
    assert_true(gzip_exact(packed.data, packed.size, "m", out, sizeof out, &n_more, &err));
    assert_int_equal(n_more, GZIP_MOST_MORE);
    bytes_free(&packed);
    packed = pack(large, n_large + 1, 15 + 16);
    assert_false(gzip_exact(packed.data, packed.size, "m", out, sizeof out, &n_more, &err));
    assert_int_equal(err.code, ERROR_LIMIT);
    bytes_free(&packed);
    free(large);
}

/* Packed or not: the voxels are those the header speaks of, and what follows them is said. */
static void bytes_behind_the_voxels_are_said_with_their_number(void **state)
{
    (void)state;
    struct nifti_bytes nifti = nifti_bytes_make(SIDE, SIDE, SIDE, 2, 8, N_VOXELS, false);
    uint8_t voxels[N_VOXELS + 5] = { 0 };
    fill_bytes(voxels, N_VOXELS);
    memcpy(nifti.data + nifti.size - N_VOXELS, voxels, N_VOXELS);
    struct bytes file = { nifti.data, nifti.size };
    struct bytes longer = with_tail(&file, "12345", 5), packed = pack(longer.data, longer.size, 15 + 16),
                 stream = pack(voxels, sizeof voxels, 15 + 16),
                 head = { (uint8_t *)(uintptr_t)nrrd_head, sizeof nrrd_head - 1 },
                 nrrd = with_tail(&head, stream.data, stream.size);
    const struct {
        enum kind kind;
        const struct bytes *file;
        bool is_longer;
    } cases[] = {
        { NIFTI_U8, &file, false }, { NIFTI_U8, &longer, true }, { NIFTI_U8, &packed, true }, { NRRD_GZIP, &nrrd, true }
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct report report = { 0 };
        struct error err;
        struct volume *volume = read_file(cases[i].kind, cases[i].file, &report, &err);
        assert_string_equal(err.text, "");
        assert_memory_equal(volume->voxels, voxels, N_VOXELS);
        assert_int_equal(report_has(&report, "image.bytes-behind"), cases[i].is_longer);
        if (cases[i].is_longer)
            assert_non_null(
                strstr(report_said(&report, "image.bytes-behind"), "5 bytes follow the 4096 bytes of voxels"));
        volume_unref(volume);
        report_finish(&report);
    }
    bytes_free(&longer);
    bytes_free(&packed);
    bytes_free(&stream);
    bytes_free(&nrrd);
    nifti_bytes_free(&nifti);
}

/* A file named as a packed one whose first bytes were changed is no raw file, however many bytes it has. */
static void a_name_that_says_packed_is_believed(void **state)
{
    (void)state;
    struct bytes raw = { malloc(N_VOXELS), N_VOXELS };
    struct error err;
    memset(raw.data, 3, N_VOXELS);
    assert_null(read_file(UV_GZ, &raw, NULL, &err));
    assert_int_equal(err.code, ERROR_FORMAT);
    assert_non_null(strstr(err.text, "e.uv.gz: begins with 03 03, expected a gzip stream, 1f 8b"));
    assert_null(read_file(QIM_GZ, &raw, NULL, &err));
    assert_non_null(strstr(err.text, "f.qim.gz: begins with 03 03"));
    bytes_free(&raw);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_changed_bit_of_a_packed_file_gives_other_voxels),
        cmocka_unit_test(a_packed_file_that_is_cut_anywhere_is_refused),
        cmocka_unit_test(zeros_behind_a_stream_are_padding_and_other_bytes_are_refused_with_their_place),
        cmocka_unit_test(the_sentence_says_where_a_stream_is_damaged),
        cmocka_unit_test(every_member_of_a_stream_is_read_and_checked),
        cmocka_unit_test(more_inside_than_asked_for_is_counted_checked_and_bounded),
        cmocka_unit_test(bytes_behind_the_voxels_are_said_with_their_number),
        cmocka_unit_test(a_name_that_says_packed_is_believed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
