"""Letters as FreeType draws them, called by ctypes, from the first font that has them: FONT:FONT SIZE TEXT WIDTH HEIGHT X BASELINE; prints the coverage in hex."""
import ctypes
import sys
from ctypes import POINTER, c_byte, c_int, c_long, c_short, c_ubyte, c_uint, c_ushort, c_void_p

try:
    library = ctypes.CDLL("libfreetype.so.6")
except OSError:
    sys.exit(77)


class Bitmap(ctypes.Structure):
    _fields_ = [("rows", c_uint), ("width", c_uint), ("pitch", c_int), ("buffer", POINTER(c_ubyte)), ("n_grays", c_ushort),
                ("pixel_mode", c_byte), ("palette_mode", c_byte), ("palette", c_void_p)]


class Slot(ctypes.Structure):
    _fields_ = [("owners", c_void_p * 3), ("glyph", c_uint), ("generic", c_void_p * 2), ("metrics", c_long * 8),
                ("linear", c_long * 2), ("advance", c_long * 2), ("format", c_int), ("bitmap", Bitmap), ("left", c_int),
                ("top", c_int)]


class Face(ctypes.Structure):
    _fields_ = [("longs", c_long * 5), ("names", c_void_p * 2), ("n_sizes", c_int), ("sizes", c_void_p), ("n_maps", c_int),
                ("maps", c_void_p), ("generic", c_void_p * 2), ("box", c_long * 4), ("shorts", c_short * 8), ("slot", POINTER(Slot))]


paths, text = sys.argv[1], sys.argv[3]
size, width, height, x, baseline = map(int, sys.argv[2:3] + sys.argv[4:])
ft, faces = c_void_p(), []
library.FT_Init_FreeType(ctypes.byref(ft))
for path in paths.split(":"):
    face = POINTER(Face)()
    if library.FT_New_Face(ft, path.encode(), c_long(0), ctypes.byref(face)):
        sys.exit(77)
    library.FT_Set_Pixel_Sizes(face, 0, size)
    faces.append(face)
grid = bytearray(width * height)
for character in text:
    face = next(face for face in faces if library.FT_Get_Char_Index(face, ctypes.c_ulong(ord(character))))
    library.FT_Load_Char(face, ctypes.c_ulong(ord(character)), 4 | 8 | 1 << 16)  # render, no bitmap, light hinting
    slot = face.contents.slot.contents
    for row in range(slot.bitmap.rows):
        for column in range(slot.bitmap.width):
            at = (baseline - slot.top + row) * width + x + slot.left + column
            grid[at] = max(grid[at], slot.bitmap.buffer[row * slot.bitmap.pitch + column])
    x += slot.advance[0] >> 6
print(grid.hex())
