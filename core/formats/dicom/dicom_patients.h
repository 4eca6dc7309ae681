#pragma once
/* Reads the patient of a DICOM file, and tells which files of a folder are of one patient. Writes no name anywhere. */
#include "core/formats/dicom/dicom_object.h"

/* Reads patient ID, issuer, name, birth date and sex. Returns NULL if the file has neither ID nor name; else the caller
 * frees the result. source: DICOM PS3.3 C.7.1.1 */
struct dicom_patient *dicom_patient_read(const struct dicom_item *root);

/* Gives the number of the patient in the index, and adds the patient if new. Two files are of one patient if ID, issuer
 * (where both give one), name and birth date (where both give one) agree; without an ID if the names agree. Names are
 * compared without case and without the separators '^' and ' ', by the first group of characters that both have. Under
 * one ID with other names or birth dates there are several patients, each with has_conflict.
 *
 *   returns  -1: the index holds DICOM_MAX_PATIENTS others already */
int dicom_patients_add(struct dicom_index *index, const struct dicom_patient *patient);
