// Finds which fragments of compressed pixels make a frame. Source: DICOM PS3.5 A.4.
#include "core/formats/dicom/dicom_decode.hh"

bool dicom_find_frames(const dicom_layout &layout, const char *name, uint32_t n_frames,
                       std::vector<dicom_fragment> &fragments, std::vector<size_t> &first_fragments, error *err)
{
    size_t n = 0;
    if (!dicom_walk_fragments(&layout, name, nullptr, 0, &n, err))
        return false;
    fragments.resize(n);
    if (!dicom_walk_fragments(&layout, name, fragments.data(), n, &n, err))
        return false;
    if (n < 1 + size_t(n_frames))
        return error_set(err, ERROR_FORMAT, "%s: %zu fragments of compressed pixels for %u frames", name,
                         n > 0 ? n - 1 : 0, n_frames);
    first_fragments.clear();
    if (n_frames == 1 || n - 1 == n_frames) {
        for (size_t i = 0; i < n_frames; i++)
            first_fragments.push_back(1 + i);
    } else if (fragments[0].size == 0) { // no offset table: a frame begins where a start marker follows an end marker
        for (size_t i = 1; i < n; i++) {
            const dicom_fragment &own = fragments[i], &before = fragments[i - 1];
            if (dicom_begins_picture(layout.transfer_syntax, layout.data + own.at, own.size) &&
                (i == 1 || dicom_ends_picture(layout.data + before.at, before.size)))
                first_fragments.push_back(i);
        }
        if (first_fragments.size() != n_frames || first_fragments[0] != 1)
            return error_set(
                err, ERROR_FORMAT,
                "%s: %zu fragments for %u frames, and no table of offsets says which are whose; %zu of them begin "
                "a picture",
                name, n - 1, n_frames, first_fragments.size());
    } else { // by the offset table: positions counted from the tag of the first fragment
        const dicom_fragment table = fragments[0];
        size_t base = fragments[1].at - 8, fragment = 1;
        for (size_t i = 0; i < n_frames && 4 * i + 4 <= table.size; i++) {
            const uint8_t *p = layout.data + table.at + 4 * i;
            size_t at = base + (size_t(p[0]) | size_t(p[1]) << 8 | size_t(p[2]) << 16 | size_t(p[3]) << 24);
            while (fragment < n && fragments[fragment].at - 8 < at)
                fragment++;
            if (fragment < n && fragments[fragment].at - 8 == at)
                first_fragments.push_back(fragment);
        }
        if (first_fragments.size() != n_frames)
            return error_set(err, ERROR_FORMAT,
                             "%s: %zu fragments for %u frames, and the table of offsets does not say which are whose",
                             name, n - 1, n_frames);
    }
    first_fragments.push_back(n);
    return true;
}
