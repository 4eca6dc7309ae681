"""Texts of DICOM character sets as pydicom decodes them: VR SETS HEX...; prints one line of UTF-8 for each three."""
import sys

try:
    from pydicom.charset import convert_encodings, decode_bytes
    from pydicom.valuerep import PN_DELIMS, TEXT_VR_DELIMS, PersonName
except ImportError:
    sys.exit(77)

arguments = sys.argv[1:]
for vr, sets, text in zip(arguments[::3], arguments[1::3], arguments[2::3]):
    encodings = convert_encodings(sets.split("\\"))
    raw = bytes.fromhex(text)
    if vr == "PN":
        decoded = str(PersonName(raw, encodings).decode())
    else:
        decoded = decode_bytes(raw, encodings, TEXT_VR_DELIMS)
    sys.stdout.buffer.write(decoded.encode() + b"\n")
