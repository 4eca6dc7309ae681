/* Reads patients, and compares them. */
#include "core/formats/dicom/dicom_patients.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

enum {
    PATIENT_NAME = DICOM_TAG(0x0010, 0x0010),
    PATIENT_ID = DICOM_TAG(0x0010, 0x0020),
    ISSUER = DICOM_TAG(0x0010, 0x0021),
    BIRTH_DATE = DICOM_TAG(0x0010, 0x0030),
    SEX = DICOM_TAG(0x0010, 0x0040)
};

/* Reads YYYYMMDD; also YYYY.MM.DD, the form before DICOM 3. */
static void read_date(const struct dicom_item *root, char out[9])
{
    char found[24];
    size_t n = 0;
    (void)dicom_text(root, BIRTH_DATE, found, sizeof found);
    for (const char *at = found; *at && n < 8; at++)
        if (*at != '.')
            out[n++] = *at;
    out[n] = 0;
}

struct dicom_patient *dicom_patient_read(const struct dicom_item *root)
{
    struct dicom_patient read = { 0 };
    bool has_id = dicom_text(root, PATIENT_ID, read.id, sizeof read.id);
    bool has_name = dicom_text(root, PATIENT_NAME, read.name, sizeof read.name) &&
                    strspn(read.name, "^= ") < strlen(read.name); /* not only separators */
    if (!has_name)
        read.name[0] = 0;
    if (!has_id && !has_name)
        return NULL;
    (void)dicom_text(root, ISSUER, read.issuer, sizeof read.issuer);
    (void)dicom_text(root, SEX, read.sex, sizeof read.sex);
    read_date(root, read.birth_date);
    struct dicom_patient *patient = mem_new(sizeof *patient);
    *patient = read;
    return patient;
}

enum { NAME_SIZE = sizeof((struct dicom_patient *)NULL)->name };

/* Writes group number `group` of a person's name (alphabetic, ideographic, phonetic) in lower case, one blank for each
 * run of separators, none at the ends. */
static void plain_group(const char *name, int group, char out[NAME_SIZE])
{
    size_t n = 0;
    while (*name && group > 0)
        group -= *name++ == '=';
    for (; *name && *name != '='; name++) {
        char c = *name >= 'A' && *name <= 'Z' ? (char)(*name - 'A' + 'a') : *name;
        if (c != '^' && c != ' ')
            out[n++] = c;
        else if (n > 0 && out[n - 1] != ' ')
            out[n++] = ' ';
    }
    while (n > 0 && out[n - 1] == ' ')
        n--;
    out[n] = 0;
}

static bool names_differ(const char *a, const char *b)
{
    char left[NAME_SIZE], right[NAME_SIZE];
    for (int group = 0; group < 3; group++) {
        plain_group(a, group, left);
        plain_group(b, group, right);
        if (left[0] && right[0])
            return strcmp(left, right) != 0;
    }
    return false;
}

static bool texts_differ(const char *a, const char *b)
{
    return a[0] && b[0] && strcmp(a, b) != 0;
}

static bool has_same_id(const struct dicom_patient *a, const struct dicom_patient *b)
{
    return a->id[0] && strcmp(a->id, b->id) == 0 && !texts_differ(a->issuer, b->issuer);
}

static bool is_same(const struct dicom_patient *a, const struct dicom_patient *b)
{
    bool is_named_alike = !a->id[0] && !b->id[0];
    return (has_same_id(a, b) || is_named_alike) && !names_differ(a->name, b->name) &&
           !texts_differ(a->birth_date, b->birth_date);
}

/* Takes over what another file of the patient says and the first did not. */
static void complete(struct dicom_patient *patient, const struct dicom_patient *other)
{
    if (!patient->issuer[0])
        memcpy(patient->issuer, other->issuer, sizeof patient->issuer);
    if (!patient->name[0])
        memcpy(patient->name, other->name, sizeof patient->name);
    if (!patient->birth_date[0])
        memcpy(patient->birth_date, other->birth_date, sizeof patient->birth_date);
    if (!patient->sex[0])
        memcpy(patient->sex, other->sex, sizeof patient->sex);
}

int dicom_patients_add(struct dicom_index *index, const struct dicom_patient *patient)
{
    for (size_t i = 0; i < index->n_patients; i++)
        if (is_same(&index->patients[i], patient)) {
            complete(&index->patients[i], patient);
            return (int)i;
        }
    if (index->n_patients == DICOM_MAX_PATIENTS)
        return -1;
    struct dicom_patient *added = &index->patients[index->n_patients];
    *added = *patient;
    for (size_t i = 0; i < index->n_patients; i++)
        if (has_same_id(&index->patients[i], patient))
            index->patients[i].has_conflict = added->has_conflict = true;
    return (int)index->n_patients++;
}
