/* Tells what a file that is not read most likely is. */
#include "core/load/file_kind.h"

#include "core/formats/text.h"
#include "core/load/part_names.h"

struct kind {
    const char *mark, *words;
};

static const char *by_name(const char *base)
{
    static const struct kind names[] = { { "meshtal", "a mesh tally of MCNP" },
                                         { "mctal", "a tally of MCNP" },
                                         { "plan.json", "the plan.json of another plan" },
                                         { "dicomdir", "the directory of a DICOM medium" },
                                         { "makefile", "a makefile" } };
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (part_name_has_whole_word(base, names[i].mark))
            return names[i].words;
    return NULL;
}

static const char *by_ending(const char *base)
{
    static const struct kind endings[] = {
        { ".stl", "a surface mesh" },
        { ".obj", "a surface mesh" },
        { ".ply", "a surface mesh" },
        { ".glb", "a surface mesh" },
        { ".vtp", "a surface mesh of VTK" },
        { ".vti", "a grid of VTK" },
        { ".vtk", "data of VTK" },
        { ".vtu", "a mesh of VTK" },
        { ".vtr", "a grid of VTK" },
        { ".mat", "data of MATLAB" },
        { ".mgz", "an image of FreeSurfer" },
        { ".mgh", "an image of FreeSurfer" },
        { ".mnc", "an image of MINC" },
        { ".3ddose", "a dose of EGSnrc" },
        { ".h5", "data of HDF5" },
        { ".hdf5", "data of HDF5" },
        { ".npy", "data of NumPy" },
        { ".npz", "data of NumPy" },
        { ".root", "data of ROOT" },
        { ".csv", "a table without the columns of tracks" },
        { ".tsv", "a table" },
        { ".xls", "a spreadsheet" },
        { ".xlsx", "a spreadsheet" },
        { ".ods", "a spreadsheet" },
        { ".pdf", "a document" },
        { ".doc", "a document" },
        { ".docx", "a document" },
        { ".odt", "a document" },
        { ".rtf", "a document" },
        { ".html", "a document" },
        { ".md", "a document" },
        { ".txt", "a text" },
        { ".png", "a picture" },
        { ".jpg", "a picture" },
        { ".jpeg", "a picture" },
        { ".tif", "a picture" },
        { ".tiff", "a picture" },
        { ".bmp", "a picture" },
        { ".gif", "a picture" },
        { ".json", "a JSON text" },
        { ".xml", "an XML text" },
        { ".inp", "the input of a program" },
        { ".out", "the output of a program" },
        { ".log", "a log" },
        { ".py", "a program" },
        { ".m", "a program" },
        { ".sh", "a program" },
        { ".db", "a database" },
        { ".zip", "an archive" },
        { ".tar", "an archive" },
        { ".tgz", "an archive" },
        { ".xz", "compressed data" },
        { ".7z", "an archive" },
        { ".rar", "an archive" },
    };
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++)
        if (text_has_ending(base, endings[i].mark))
            return endings[i].words;
    return NULL;
}

static const char *by_first_bytes(const struct folder *folder, const char *name)
{
    uint8_t head[512];
    struct folder_part part;
    if (!folder_open_part(folder, name, &part, NULL))
        return "a file that cannot be opened";
    size_t n = part.n_bytes < sizeof head ? (size_t)part.n_bytes : sizeof head;
    bool is_read = folder_read_part(&part, name, 0, head, n, NULL);
    folder_close_part(&part);
    if (!is_read)
        return "a file that cannot be read";
    if (n == 0)
        return "an empty file";
    for (size_t i = 0; i < n; i++)
        if (head[i] == 0 || (head[i] < ' ' && head[i] != '\t' && head[i] != '\n' && head[i] != '\r' && head[i] != '\f'))
            return "binary data of an unknown kind";
    return "a text of an unknown kind";
}

const char *file_kind_words(const struct folder *folder, const char *name)
{
    const char *base = part_base_name(name), *words = by_name(base);
    words = words ? words : by_ending(base);
    return words ? words : by_first_bytes(folder, name);
}
