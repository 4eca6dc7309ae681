// Wraps DCMTK in the plain C functions of dicom_file.h: elements, sequences, numbers, text. No exception leaves it.
// Pixels are in dicom_pixels.cc.
extern "C" {
#include "core/formats/dicom/dicom_file.h"
#include "core/formats/dicom/dicom_walk.h"
}
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <dcmtk/config/osconfig.h>

#include <dcmtk/dcmdata/dcistrmb.h>
#include <dcmtk/dcmdata/dctk.h>
#include <dcmtk/oflog/oflog.h>

#include "core/formats/dicom/dicom_charset.hh"
#include "core/formats/dicom/dicom_decode.hh"
#include "core/formats/dicom/dicom_file.hh"
#include "core/formats/dicom/dicom_text.hh"

namespace {

DcmTagKey key_of(uint32_t tag)
{
    return DcmTagKey(Uint16(tag >> 16), Uint16(tag & 0xFFFF));
}

DcmElement *find(const dicom_item *item, uint32_t tag)
{
    DcmElement *element = nullptr;
    if (!item || item->item->findAndGetElement(key_of(tag), element, OFFalse).bad())
        return nullptr;
    return element;
}

enum class values { none, text, binary };

values values_of(DcmElement &element)
{
    switch (element.ident()) {
    case EVR_AE:
    case EVR_AS:
    case EVR_CS:
    case EVR_DA:
    case EVR_DS:
    case EVR_DT:
    case EVR_IS:
    case EVR_LO:
    case EVR_LT:
    case EVR_PN:
    case EVR_SH:
    case EVR_ST:
    case EVR_TM:
    case EVR_UC:
    case EVR_UI:
    case EVR_UR:
    case EVR_UT: return values::text;
    case EVR_AT:
    case EVR_FD:
    case EVR_FL:
    case EVR_SL:
    case EVR_SS:
    case EVR_UL:
    case EVR_US:
    case EVR_up:
    case EVR_xs:
    case EVR_lt: return values::binary;
    default: return values::none;
    }
}

// The bytes of a text element in place.
bool raw_text(DcmElement &element, const char **text, size_t *size)
{
    if (values_of(element) == values::text) {
        char *found = nullptr;
        Uint32 length = 0;
        if (element.getString(found, length).bad() || !found)
            return false;
        *text = found;
        *size = length;
        return true;
    }
    if (element.ident() == EVR_UN || element.ident() == EVR_OB) { // VR unknown to the file
        Uint8 *found = nullptr;
        if (element.getUint8Array(found).bad() || !found)
            return false;
        *text = reinterpret_cast<const char *>(found);
        *size = element.getLength();
        return true;
    }
    return false;
}

// The character set in force in an item: its own, else that of the item around it.
std::string character_set_of(const dicom_item *item)
{
    for (; item; item = item->parent) {
        DcmElement *element = find(item, 0x00080005);
        const char *text;
        size_t size;
        if (element && raw_text(*element, &text, &size) && size > 0 && size < 1024)
            return std::string(text, size);
    }
    return "";
}

// Delimiters between values, and between parts of a person's name.
const char *delimiters_of(DcmElement &element)
{
    switch (element.ident()) {
    case EVR_PN: return "\\^=";
    case EVR_LT:
    case EVR_ST:
    case EVR_UT: return "";
    default: return "\\";
    }
}

std::string to_utf8(const dicom_item *item, DcmElement &element, const std::string &text)
{
    bool is_whole = true;
    std::string out = dicom_charset_to_utf8(character_set_of(item), text, delimiters_of(element), &is_whole);
    item->file->has_broken_text = item->file->has_broken_text || !is_whole;
    return out;
}

bool get_text(const dicom_item *item, uint32_t tag, bool is_one, size_t index, char *out, size_t size)
{
    if (size == 0)
        return false;
    out[0] = 0;
    DcmElement *element = find(item, tag);
    const char *raw;
    size_t raw_size;
    if (!element)
        return false;
    if (!raw_text(*element, &raw, &raw_size)) {
        double number;
        std::vector<double> all(is_one ? index + 1 : 1);
        if (values_of(*element) != values::binary || dicom_numbers(item, tag, all.data(), all.size()) < all.size())
            return false;
        number = all.back();
        return snprintf(out, size, "%.17g", number) > 0;
    }
    std::string text(raw, std::min<size_t>(raw_size, 1 << 20)); // 1 MiB: more than any description needs
    if (!dicom_text_is_ascii(text.data(), text.size()))
        text = to_utf8(item, *element, text);
    size_t from = 0;
    if (is_one) {
        for (; index > 0; index--) {
            from = text.find('\\', from);
            if (from == std::string::npos)
                return false;
            from++;
        }
        size_t end = text.find('\\', from);
        text = text.substr(from, end == std::string::npos ? end : end - from);
    }
    return dicom_text_put(text, out, size);
}

template <typename T> size_t copy_numbers(const T *from, size_t n_bytes, double *out, size_t most)
{
    size_t n = from ? n_bytes / sizeof(T) : 0;
    for (size_t i = 0; i < n && i < most; i++)
        out[i] = static_cast<double>(from[i]);
    return n;
}

size_t binary_numbers(DcmElement &element, double *out, size_t most)
{
    size_t bytes = element.getLength();
    switch (element.ident()) {
    case EVR_FD: {
        Float64 *p = nullptr;
        return element.getFloat64Array(p).good() ? copy_numbers(p, bytes, out, most) : 0;
    }
    case EVR_FL: {
        Float32 *p = nullptr;
        return element.getFloat32Array(p).good() ? copy_numbers(p, bytes, out, most) : 0;
    }
    case EVR_SL: {
        Sint32 *p = nullptr;
        return element.getSint32Array(p).good() ? copy_numbers(p, bytes, out, most) : 0;
    }
    case EVR_SS: {
        Sint16 *p = nullptr;
        return element.getSint16Array(p).good() ? copy_numbers(p, bytes, out, most) : 0;
    }
    case EVR_UL:
    case EVR_up: {
        Uint32 *p = nullptr;
        return element.getUint32Array(p).good() ? copy_numbers(p, bytes, out, most) : 0;
    }
    case EVR_US:
    case EVR_xs: {
        Uint16 *p = nullptr;
        return element.getUint16Array(p).good() ? copy_numbers(p, bytes, out, most) : 0;
    }
    case EVR_AT: {
        Uint16 *p = nullptr;
        size_t n = element.getUint16Array(p).good() && p ? bytes / 4 : 0;
        for (size_t i = 0; i < n && i < most; i++)
            out[i] = p[2 * i] * 65536.0 + p[2 * i + 1];
        return n;
    }
    default: return 0;
    }
}

struct bad_numbers {
    bool is_deep;
    uint32_t but_not;
    dicom_bad_number *bad;
    size_t most, n;
};

std::string tag_text(DcmObject &object)
{
    char text[16];
    snprintf(text, sizeof text, "(%04X,%04X)", object.getGTag(), object.getETag());
    return text;
}

void add_bad(bad_numbers &all, DcmElement &element, const std::string &inside, const char *value, size_t size)
{
    if (all.n++ >= all.most)
        return;
    dicom_bad_number &bad = all.bad[all.n - 1];
    std::string place = inside + tag_text(element);
    if (place.size() >= sizeof bad.place)
        place = "..." + place.substr(place.size() - sizeof bad.place + 4);
    bad.tag = uint32_t(element.getGTag()) << 16 | element.getETag();
    snprintf(bad.place, sizeof bad.place, "%s", place.c_str());
    size_t n = std::min(size, sizeof bad.found - 1);
    for (size_t i = 0; i < n; i++)
        bad.found[i] = value[i] >= 32 && value[i] < 127 ? value[i] : '?';
    bad.found[n] = 0;
}

// Checks each value between backslashes. An element without a value is not bad.
void check_numbers(bad_numbers &all, DcmElement &element, const std::string &inside)
{
    const char *text;
    size_t size;
    double value;
    if (!raw_text(element, &text, &size))
        return;
    while (size > 0 && (text[size - 1] == ' ' || text[size - 1] == 0))
        size--;
    const char *end = text + size;
    for (const char *from = text; size > 0;) {
        auto *found = static_cast<const char *>(std::memchr(from, '\\', size_t(end - from)));
        const char *stop = found ? found : end;
        size_t n = size_t(stop - from);
        if (dicom_text_numbers(from, n, &value, 1) != 1 || !std::isfinite(value) ||
            (element.ident() == EVR_IS && value != std::floor(value)))
            add_bad(all, element, inside, from, n);
        if (!found)
            return;
        from = found + 1;
    }
}

// Recursion is at most DICOM_MAX_DEPTH deep: the walk checked it.
void find_bad_numbers(bad_numbers &all, DcmItem &item, const std::string &inside)
{
    for (DcmObject *object = nullptr; (object = item.nextInContainer(object));) {
        if (object->getGTag() % 2 || (uint32_t(object->getGTag()) << 16 | object->getETag()) == all.but_not)
            continue;
        if (object->ident() == EVR_DS || object->ident() == EVR_IS)
            check_numbers(all, *static_cast<DcmElement *>(object), inside);
        if (object->ident() != EVR_SQ || !all.is_deep)
            continue;
        auto *sequence = static_cast<DcmSequenceOfItems *>(object);
        size_t at = 0;
        for (DcmObject *inner = nullptr; (inner = sequence->nextInContainer(inner));)
            find_bad_numbers(all, *static_cast<DcmItem *>(inner),
                             inside + tag_text(*object) + " item " + std::to_string(++at) + ", ");
    }
}

void prepare()
{
    static std::once_flag once;
    std::call_once(once, [] {
        OFLog::configure(OFLogger::OFF_LOG_LEVEL);
        dcmEnableUnknownVRConversion.set(OFTrue); // read UN elements of known tags as the dictionary says
        dcmEnableAutomaticInputDataCorrection.set(OFTrue);
        dcmEnableVRCheckerForStringValues.set(OFFalse);
        (void)dcmDataDict.isDictionaryLoaded(); // the first call loads it
        dicom_decoders_register();
    });
}

bool parse(dicom_file &file, const uint8_t *data, size_t size, dicom_extent extent, error *err)
{
    const char *name = file.name.c_str();
    if (!dicom_walk(data, size, name, extent, &file.layout, err))
        return false;
    const dicom_layout &layout = file.layout;
    if (layout.end > layout.begin) {
        DcmInputBufferStream stream;
        stream.setBuffer(layout.data + layout.begin, static_cast<offile_off_t>(layout.end - layout.begin));
        stream.setEos();
        E_TransferSyntax xfer = layout.is_implicit     ? EXS_LittleEndianImplicit
                                : layout.is_big_endian ? EXS_BigEndianExplicit
                                                       : EXS_LittleEndianExplicit;
        file.data_set.transferInit();
        OFCondition condition = file.data_set.read(stream, xfer, EGL_noChange);
        file.data_set.transferEnd();
        if (condition.bad())
            return error_set(err, condition == EC_MemoryExhausted ? ERROR_MEMORY : ERROR_FORMAT,
                             "%s: byte %lld: the data set cannot be read: %.80s", name,
                             static_cast<long long>(layout.begin) + static_cast<long long>(stream.tell()),
                             condition.text());
    }
    file.root = { &file.data_set, &file, nullptr };
    return true;
}

} // namespace

extern "C" {

void dicom_prepare(void)
{
    guarded(0, [] {
        prepare();
        return 0;
    });
}

struct dicom_file *dicom_file_parse(const uint8_t *data, size_t size, const char *name, enum dicom_extent extent,
                                    struct error *err)
{
    std::unique_ptr<dicom_file> file;
    bool is_parsed = guarded_call(name, err, [&] {
        prepare();
        file = std::make_unique<dicom_file>();
        file->name = name;
        return parse(*file, data, size, extent, err);
    });
    return is_parsed ? file.release() : nullptr;
}

void dicom_file_destroy(struct dicom_file *file)
{
    guarded(0, [&] {
        delete file;
        return 0;
    });
}

const struct dicom_item *dicom_root(const struct dicom_file *file)
{
    return &file->root;
}

const char *dicom_transfer_syntax(const struct dicom_file *file)
{
    return file->layout.transfer_syntax;
}

const char *dicom_uid_word(const char *uid)
{
    // newer than DCMTK's dictionary. Source: DICOM PS3.6, table A-1
    static const struct {
        const char *uid, *word;
    } newer[] = { { "1.2.840.10008.1.2.4.110", "JPEG XL lossless" },
                  { "1.2.840.10008.1.2.4.111", "JPEG XL recompressed JPEG" },
                  { "1.2.840.10008.1.2.4.112", "JPEG XL" },
                  { "1.2.840.10008.1.2.4.201", "High-Throughput JPEG 2000 lossless" },
                  { "1.2.840.10008.1.2.4.202", "High-Throughput JPEG 2000 lossless, RPCL" },
                  { "1.2.840.10008.1.2.4.203", "High-Throughput JPEG 2000" },
                  { "1.2.840.10008.1.2.8.1", "deflated image frames" },
                  { "1.2.840.10008.5.1.4.1.1.66.7", "LabelMapSegmentationStorage" },
                  { "1.2.840.10008.5.1.4.1.1.66.8", "HeightMapSegmentationStorage" } };
    const char *word = dcmFindNameOfUID(uid, "");
    for (const auto &each : newer)
        if ((!word || !word[0]) && std::strcmp(uid, each.uid) == 0)
            return each.word;
    return word ? word : "";
}

bool dicom_is_cut(const struct dicom_file *file)
{
    return file->layout.is_cut;
}

bool dicom_has(const struct dicom_item *item, uint32_t tag)
{
    if (item && !item->parent && (tag == 0x7FE00010 || tag == 0x7FE00008 || tag == 0x7FE00009))
        return tag == 0x7FE00010 ? item->file->layout.has_pixels : item->file->layout.has_float_pixels;
    return guarded(false, [&] { return find(item, tag) != nullptr; });
}

bool dicom_text(const struct dicom_item *item, uint32_t tag, char *out, size_t size)
{
    return guarded(false, [&] { return get_text(item, tag, false, 0, out, size); });
}

bool dicom_text_at(const struct dicom_item *item, uint32_t tag, size_t index, char *out, size_t size)
{
    return guarded(false, [&] { return get_text(item, tag, true, index, out, size); });
}

bool dicom_text_is_broken(const struct dicom_file *file)
{
    return file->has_broken_text;
}

size_t dicom_numbers(const struct dicom_item *item, uint32_t tag, double *out, size_t most)
{
    return guarded(size_t(0), [&]() -> size_t {
        DcmElement *element = find(item, tag);
        const char *text;
        size_t size;
        if (!element)
            return 0;
        if (values_of(*element) == values::binary)
            return binary_numbers(*element, out, most);
        return raw_text(*element, &text, &size) ? dicom_text_numbers(text, size, out, most) : 0;
    });
}

bool dicom_number(const struct dicom_item *item, uint32_t tag, double *value)
{
    double first;
    if (dicom_numbers(item, tag, &first, 1) < 1 || !std::isfinite(first))
        return false;
    *value = first;
    return true;
}

bool dicom_integer(const struct dicom_item *item, uint32_t tag, int64_t *value)
{
    double first;
    if (!dicom_number(item, tag, &first) || first != std::floor(first) || std::fabs(first) > 9007199254740992.0)
        return false;
    *value = static_cast<int64_t>(first);
    return true;
}

size_t dicom_bad_numbers(const struct dicom_item *item, bool is_deep, uint32_t but_not, struct dicom_bad_number *bad,
                         size_t most)
{
    return guarded(size_t(0), [&] {
        bad_numbers all{ is_deep, but_not, bad, most, 0 };
        find_bad_numbers(all, *item->item, "");
        return all.n;
    });
}

static std::vector<dicom_item> *items_of(const struct dicom_item *item, uint32_t tag)
{
    DcmElement *element = find(item, tag);
    if (!element || element->ident() != EVR_SQ)
        return nullptr;
    auto &sequences = item->file->sequences;
    auto known = sequences.find(element);
    if (known != sequences.end())
        return &known->second;
    auto &items = sequences[element];
    auto *sequence = static_cast<DcmSequenceOfItems *>(element);
    items.reserve(sequence->card());
    for (DcmObject *object = nullptr; (object = sequence->nextInContainer(object));)
        items.push_back({ static_cast<DcmItem *>(object), item->file, item });
    return &items;
}

size_t dicom_n_items(const struct dicom_item *item, uint32_t tag)
{
    return guarded(size_t(0), [&]() -> size_t {
        auto *items = items_of(item, tag);
        return items ? items->size() : 0;
    });
}

const struct dicom_item *dicom_item_at(const struct dicom_item *item, uint32_t tag, size_t index)
{
    return guarded(static_cast<const dicom_item *>(nullptr), [&]() -> const dicom_item * {
        auto *items = items_of(item, tag);
        return items && index < items->size() ? &(*items)[index] : nullptr;
    });
}

} // extern "C"
