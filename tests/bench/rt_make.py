"""Adds a structure set of 12 regions and a dose to the CT series that dicom_make.py writes: rt_make.py FOLDER. Regions are stacks of
ellipses, 96 to 360 points each; the dose is 128 x 128 x 100 values of 16 bits."""
import math
import os
import sys

import numpy
import pydicom
from pydicom.dataset import Dataset, FileDataset, FileMetaDataset
from pydicom.sequence import Sequence
from pydicom.uid import ExplicitVRLittleEndian

folder = sys.argv[1]
study, series, frame = "1.2.826.0.1.3680043.8.498.5", "1.2.826.0.1.3680043.8.498.6", "1.2.826.0.1.3680043.8.498.8"
pitch_mm, first_mm, n_slices = 1.5, -150.0, 200


def start(sop_class, instance, modality):
    meta = FileMetaDataset()
    meta.MediaStorageSOPClassUID = sop_class
    meta.MediaStorageSOPInstanceUID = instance
    meta.TransferSyntaxUID = ExplicitVRLittleEndian
    one = FileDataset(None, {}, file_meta=meta, preamble=bytes(128))
    one.is_little_endian, one.is_implicit_VR = True, False
    one.SOPClassUID, one.SOPInstanceUID, one.Modality = sop_class, instance, modality
    one.StudyInstanceUID, one.SeriesInstanceUID, one.FrameOfReferenceUID = study, instance + ".1", frame
    one.PatientName, one.PatientID, one.StudyDate, one.StudyTime = "Made^Up", "0", "20200101", "120000"
    one.PatientBirthDate, one.PatientSex, one.Manufacturer, one.SeriesNumber, one.InstanceNumber = "", "O", "made up", 3, 1
    return one


def ellipse(center, radii, z, n):
    points = []
    for i in range(n):
        turn = 2 * math.pi * i / n
        points += [f"{center[0] + radii[0] * math.cos(turn):.3f}", f"{center[1] + radii[1] * math.sin(turn):.3f}", f"{z:.3f}"]
    return points


regions = [("Body", (0, 0, 0), (105, 88, 148), 360), ("Brain", (0, -4, 40), (70, 66, 60), 240), ("Target", (25, 10, 45), (22, 20, 18), 160),
           ("Tumour", (27, 10, 45), (14, 12, 11), 120), ("Brainstem", (0, 20, -5), (13, 12, 25), 120), ("Eye left", (32, -62, 15), (12, 12, 12), 96),
           ("Eye right", (-32, -62, 15), (12, 12, 12), 96), ("Parotid left", (55, 10, -30), (12, 20, 22), 120),
           ("Parotid right", (-55, 10, -30), (12, 20, 22), 120), ("Cord", (0, 40, -80), (6, 6, 60), 96), ("Mandible", (0, -35, -50), (40, 28, 18), 160),
           ("Larynx", (0, -10, -95), (16, 18, 22), 120)]
one = start("1.2.840.10008.5.1.4.1.1.481.3", "1.2.826.0.1.3680043.8.498.20", "RTSTRUCT")
one.StructureSetLabel = "twelve"
reference, of_study, of_series = Dataset(), Dataset(), Dataset()
of_series.SeriesInstanceUID = series
of_study.ReferencedSOPClassUID, of_study.ReferencedSOPInstanceUID = "1.2.840.10008.3.1.2.3.1", study
of_study.RTReferencedSeriesSequence = Sequence([of_series])
reference.FrameOfReferenceUID = frame
reference.RTReferencedStudySequence = Sequence([of_study])
one.ReferencedFrameOfReferenceSequence = Sequence([reference])
names, contours, notes = [], [], []
for number, (name, center, radii, n) in enumerate(regions, 1):
    roi, filled, note = Dataset(), Dataset(), Dataset()
    roi.ROINumber, roi.ReferencedFrameOfReferenceUID, roi.ROIName, roi.ROIGenerationAlgorithm = number, frame, name, ""
    filled.ReferencedROINumber, filled.ROIDisplayColor = number, [20 * number, 255 - 20 * number, 128]
    outlines = []
    for k in range(n_slices):
        z = first_mm + pitch_mm * k
        part = 1 - ((z - center[2]) / radii[2]) ** 2
        if part <= 0:
            continue
        outline = Dataset()
        outline.ContourGeometricType, outline.NumberOfContourPoints = "CLOSED_PLANAR", n
        outline.ContourData = ellipse(center, (radii[0] * math.sqrt(part), radii[1] * math.sqrt(part)), z, n)
        outlines.append(outline)
    filled.ContourSequence = Sequence(outlines)
    note.ObservationNumber = note.ReferencedROINumber = number
    note.RTROIInterpretedType, note.ROIInterpreter = "ORGAN", ""
    names.append(roi)
    contours.append(filled)
    notes.append(note)
one.StructureSetROISequence, one.ROIContourSequence, one.RTROIObservationsSequence = Sequence(names), Sequence(contours), Sequence(notes)
one.save_as(os.path.join(folder, "RS"), write_like_original=False)

dose = start("1.2.840.10008.5.1.4.1.1.481.2", "1.2.826.0.1.3680043.8.498.21", "RTDOSE")
size, step = (128, 128, 100), (2.0, 2.0, 3.0)
z, y, x = numpy.mgrid[0:size[2], 0:size[1], 0:size[0]]
far = ((x - 76) / 20) ** 2 + ((y - 68) / 18) ** 2 + ((z - 65) / 12) ** 2
dose.PixelData = (60000 * numpy.exp(-far)).astype("<u2").tobytes()
dose.Columns, dose.Rows, dose.NumberOfFrames = size
dose.ImagePositionPatient, dose.ImageOrientationPatient = [-127, -127, -149], [1, 0, 0, 0, 1, 0]
dose.PixelSpacing, dose.SliceThickness = [step[1], step[0]], step[2]
dose.GridFrameOffsetVector = [step[2] * k for k in range(size[2])]
dose.FrameIncrementPointer = pydicom.tag.Tag(0x3004000C)
dose.SamplesPerPixel, dose.PhotometricInterpretation = 1, "MONOCHROME2"
dose.BitsAllocated = dose.BitsStored = 16
dose.HighBit, dose.PixelRepresentation = 15, 0
dose.DoseUnits, dose.DoseType, dose.DoseSummationType, dose.DoseGridScaling = "GY", "PHYSICAL", "PLAN", "0.001"
dose.save_as(os.path.join(folder, "RD"), write_like_original=False)
