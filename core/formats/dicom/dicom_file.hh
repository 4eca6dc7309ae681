#pragma once
// Inside the DCMTK shim: a parsed file, shared by dicom_file.cc and dicom_pixels.cc, and the guard that stops
// exceptions.
extern "C" {
#include "core/formats/dicom/dicom_file.h"
#include "core/formats/dicom/dicom_walk.h"
}
#include <cstdlib>
#include <memory>
#include <new>
#include <string>
#include <unordered_map>
#include <vector>

#include <dcmtk/config/osconfig.h>

#include <dcmtk/dcmdata/dctk.h>

// Defines the struct that dicom_file.h declares: the data set or a sequence item, with the item around it.
struct dicom_item {
    DcmItem *item;
    dicom_file *file;
    const dicom_item *parent;
};

struct dicom_file {
    std::string name;
    dicom_layout layout{};
    DcmDataset data_set;
    dicom_item root{};
    std::unordered_map<const DcmObject *, std::vector<dicom_item>> sequences; // items of the sequences read so far
    bool has_broken_text = false;          // a text read so far has bytes without a meaning in its character set
    std::vector<dicom_fragment> fragments; // of compressed pixels, the offset table first
    std::vector<size_t> first_fragments;   // number of each frame's first fragment
    bool has_frames = false;
    dicom_decoded decoded{}; // of the last frame read
    ~dicom_file()
    {
        free(layout.inflated);
    }
};

// Runs `run`; an exception becomes the return value on_throw. Want of memory, which says nothing of the file, is
// counted: error_n_memory.
template <typename F, typename R> R guarded(R on_throw, F run) noexcept
{
    try {
        return run();
    } catch (const std::bad_alloc &) {
        error_set(nullptr, ERROR_MEMORY, "no memory to read an element");
        return on_throw;
    } catch (...) {
        return on_throw;
    }
}

// Like guarded, for a function that reports errors: an exception becomes an error that names the file.
template <typename F> bool guarded_call(const char *name, error *err, F run) noexcept
{
    try {
        return run();
    } catch (const std::bad_alloc &) {
        return error_set(err, ERROR_MEMORY, "%s: no memory for what the file holds", name);
    } catch (...) {
        return error_set(err, ERROR_FORMAT, "%s: cannot be read", name);
    }
}
