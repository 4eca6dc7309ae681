"""Writes a CT series of 200 slices of 512 x 512 to a folder: dicom_make.py FOLDER. A head of noise in air; every voxel differs from slice to
slice. Names run against the positions."""
import os
import sys

import numpy
import pydicom
from pydicom.dataset import FileDataset, FileMetaDataset
from pydicom.uid import ExplicitVRLittleEndian

folder = sys.argv[1]
side, n_slices, spacing_mm, pitch_mm = 512, 200, 0.5, 1.5
os.makedirs(folder, exist_ok=True)
random = numpy.random.default_rng(5)
y, x = numpy.mgrid[0:side, 0:side]
for k in range(n_slices):
    radius = 220 - 0.02 * (k - 100) ** 2
    inside = (x - 256) ** 2 + (1.2 * (y - 256)) ** 2 < radius ** 2
    values = numpy.where(inside, 1064 + random.normal(0, 20, (side, side)), 24 + random.normal(0, 8, (side, side))).astype("<i2")
    meta = FileMetaDataset()
    meta.MediaStorageSOPClassUID = pydicom.uid.CTImageStorage
    meta.MediaStorageSOPInstanceUID = f"1.2.826.0.1.3680043.8.498.7.{k + 1}"
    meta.TransferSyntaxUID = ExplicitVRLittleEndian
    one = FileDataset(None, {}, file_meta=meta, preamble=bytes(128))
    one.is_little_endian, one.is_implicit_VR = True, False
    one.SpecificCharacterSet = "ISO_IR 192"
    one.ImageType = ["ORIGINAL", "PRIMARY", "AXIAL"]
    one.SOPClassUID = meta.MediaStorageSOPClassUID
    one.SOPInstanceUID = meta.MediaStorageSOPInstanceUID
    one.StudyDate = one.SeriesDate = one.AcquisitionDate = one.ContentDate = "20200101"
    one.StudyTime = one.SeriesTime = one.AcquisitionTime = one.ContentTime = "120000"
    one.AccessionNumber = ""
    one.Modality = "CT"
    one.Manufacturer = "made up"
    one.StudyDescription = "benchmark"
    one.SeriesDescription = "200 slices"
    one.PatientName = "Made^Up"
    one.PatientID = "0"
    one.PatientBirthDate = ""
    one.PatientSex = "O"
    one.SliceThickness = pitch_mm
    one.KVP = 120
    one.PatientPosition = "HFS"
    one.StudyInstanceUID = "1.2.826.0.1.3680043.8.498.5"
    one.SeriesInstanceUID = "1.2.826.0.1.3680043.8.498.6"
    one.FrameOfReferenceUID = "1.2.826.0.1.3680043.8.498.8"
    one.StudyID = "1"
    one.SeriesNumber = 2
    one.AcquisitionNumber = 1
    one.InstanceNumber = k + 1
    one.ImagePositionPatient = [-128, -128, pitch_mm * k - 150]
    one.ImageOrientationPatient = [1, 0, 0, 0, 1, 0]
    one.SamplesPerPixel = 1
    one.PhotometricInterpretation = "MONOCHROME2"
    one.Rows = one.Columns = side
    one.PixelSpacing = [spacing_mm, spacing_mm]
    one.BitsAllocated = one.BitsStored = 16
    one.HighBit = 15
    one.PixelRepresentation = 1
    one.WindowCenter, one.WindowWidth = 40, 400
    one.RescaleIntercept, one.RescaleSlope = -1024, 1
    one.PixelData = values.tobytes()
    one.save_as(os.path.join(folder, f"IM{n_slices - k:04d}"), write_like_original=False)
