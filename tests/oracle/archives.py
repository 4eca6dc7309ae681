"""Archives of every kind for the tests of unpacking, made by Python's zipfile and tarfile: valid ones, and one for each reason of refusal.

usage: archives.py FOLDER [seeds]      seeds: only small ones, as seeds of the fuzz target
"""
import bz2
import gzip
import io
import lzma
import os
import random
import stat
import struct
import sys
import tarfile
import warnings
import zipfile

warnings.simplefilter("ignore")
folder = sys.argv[1]
FILES = {"plan/plan.json": b"{}", "plan/ct/1.dcm": b"one" * 1000, "plan/ct/2.dcm": bytes(random.Random(1).randbytes(70000))}
SMALL = {"plan/plan.json": b"{}", "plan/ct/1.dcm": b"one" * 100}


def put(name, data):
    with open(os.path.join(folder, name), "wb") as file:
        file.write(data)
    return data


def make_zip(files, method=zipfile.ZIP_DEFLATED, change=None):
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", method) as archive:
        for name, data in files.items() if isinstance(files, dict) else files:
            info = zipfile.ZipInfo("x")
            info.filename = name
            info.compress_type = method
            info.external_attr = (stat.S_IFREG | 0o644) << 16
            if change:
                change(info)
            archive.writestr(info, data)
    return out.getvalue()


def make_tar(members, form=tarfile.PAX_FORMAT):
    out = io.BytesIO()
    with tarfile.open(fileobj=out, mode="w", format=form, encoding="utf-8", errors="surrogateescape") as archive:
        for name, data, *more in members.items() if isinstance(members, dict) else members:
            info = tarfile.TarInfo(name)
            info.size = len(data) if data else 0
            for key, value in (more[0] if more else {}).items():
                setattr(info, key, value)
            archive.addfile(info, io.BytesIO(data) if data else None)
    return out.getvalue()


def zstd(data):  # Zstandard (RFC 8878): one frame of raw blocks
    blocks = [data[i:i + 60000] for i in range(0, len(data), 60000)]
    body = b"".join(struct.pack("<I", (i == len(blocks) - 1) | len(b) << 3)[:3] + b for i, b in enumerate(blocks))
    return b"\x28\xb5\x2f\xfd\xa0" + struct.pack("<I", len(data)) + body


def zip_link(info):
    info.external_attr = (stat.S_IFLNK | 0o777) << 16


def with_method(data, number):  # the method of compression of the first entry, in the local header and in the directory (APPNOTE 4.4.5)
    at = data.index(b"PK\1\2")
    return data[:8] + struct.pack("<H", number) + data[10:at + 10] + struct.pack("<H", number) + data[at + 12:]


def encrypted(data):  # bit 0 of the flags, in the local header and in the directory (APPNOTE 4.4.4)
    data = bytearray(data)
    data[6] |= 1
    at = data.index(b"PK\1\2")
    data[at + 8] |= 1
    return bytes(data)


small_tar = make_tar(SMALL)
if len(sys.argv) > 2:
    put("zip-deflated", make_zip(SMALL))
    put("zip-stored", make_zip(SMALL, zipfile.ZIP_STORED))
    put("tar-gnu-long", make_tar([("n" * 150, b"x")], tarfile.GNU_FORMAT)[:4096])
    put("tar-pax", make_tar({"plan/" + "\u00fc" * 60: b"x"})[:4096])
    put("tar-gz", gzip.compress(small_tar, mtime=0))
    put("tar-xz", lzma.compress(small_tar))
    put("tar-bz2", bz2.compress(small_tar))
    put("tar-link", make_tar([("a", None, {"type": tarfile.SYMTYPE, "linkname": "b"})], tarfile.USTAR_FORMAT)[:1536])
    sys.exit(0)

# ---- valid
tar = make_tar(FILES)
put("good.zip", make_zip(FILES))
put("stored.zip", make_zip(FILES, zipfile.ZIP_STORED))
put("pax.tar", tar)
put("ustar.tar", make_tar(FILES, tarfile.USTAR_FORMAT))
put("gnu.tar", make_tar(FILES, tarfile.GNU_FORMAT))
put("good.tar.gz", gzip.compress(tar))
put("members.tar.gz", gzip.compress(tar[:3000]) + gzip.compress(tar[3000:]))
put("good.tar.bz2", bz2.compress(tar))
put("good.tar.xz", lzma.compress(tar))
put("good.tar.zst", zstd(tar))
put("dots.tar", make_tar([("./", None, {"type": tarfile.DIRTYPE})] + [("./" + n, d) for n, d in FILES.items()]))
put("litter.zip", make_zip({**FILES, "__MACOSX/plan/._1.dcm": b"x", "plan/.DS_Store": b"x", "plan/ct/Thumbs.db": b"x", "plan/._2": b"x",
                            "desktop.ini": b"x"}))
put("back.zip", make_zip({n.replace("/", "\\"): d for n, d in FILES.items()}))
put("same-top.zip", make_zip({"plan/plan/a": b"1", "plan/b": b"22"}))
put("two-tops.zip", make_zip({"a/x": b"1", "b/y": b"22"}))
put("latin.tar", make_tar([(b"M\xfcller".decode("utf-8", "surrogateescape"), b"x"), ("Ü/é", b"yy")], tarfile.GNU_FORMAT))
put("utf8.zip", make_zip({"Größe/ñ.txt": b"x", "b": b"yy"}))
put("nested.zip", make_zip({"inner.zip": make_zip(SMALL), "b": b"x"}))
put("many.zip", make_zip({"series%d/%d" % (i % 7, i): b"x" for i in range(20000)}, zipfile.ZIP_STORED))
put("deep.tar", make_tar({"/".join("abcdefghijklmnop"): b"x", "q": b"y"}))
put("longest.tar", make_tar({"n" * 255: b"x", "m" * 255 + "/" + "o" * 255: b"y"}))

# ---- names
for name, bad in (("absolute", "/etc/passwd"), ("dotdot", "a/../../b"), ("dotdot-first", "../b"), ("empty-part", "a//b"), ("control", "a\nb"),
                  ("escape", "a\x1b[2Jb"), ("drive", "C:/x"), ("part", "n" * 256), ("name", "/".join(["n" * 200] * 3)),
                  ("deep", "/".join("abcdefghijklmnopq"))):
    put("name-%s.tar" % name, make_tar([("ok", b"x"), (bad, b"x")]))
    put("name-%s.zip" % name, make_zip([("ok", b"x"), (bad, b"x")]))
put("name-back.zip", make_zip([("ok", b"x"), ("a\\..\\..\\b", b"x")]))
put("twice.tar", make_tar([("a/x", b"1"), ("a/x", b"2")]))
put("twice.zip", make_zip([("a/x", b"1"), ("a/x", b"2")]))
put("case.zip", make_zip([("a/plan", b"1"), ("a/PLAN", b"2")]))
put("case-folder.tar", make_tar([("A/x", b"1"), ("a/y", b"2")]))
put("case-umlaut.tar", make_tar([("ÄRZTE", b"1"), ("ärzte", b"2")]))
put("both.tar", make_tar([("a", b"1"), ("a/b", b"2")]))
put("both-back.tar", make_tar([("a/b", b"1"), ("a", b"2")]))

# ---- kinds
for name, kind in (("symlink", tarfile.SYMTYPE), ("hardlink", tarfile.LNKTYPE), ("char", tarfile.CHRTYPE), ("block", tarfile.BLKTYPE),
                   ("fifo", tarfile.FIFOTYPE)):
    put("kind-%s.tar" % name, make_tar([("ok", b"x"), ("bad", None, {"type": kind, "linkname": "ok"})]))
put("link-through.tar", make_tar([("out", None, {"type": tarfile.SYMTYPE, "linkname": "/tmp"}), ("out/beamroom-escaped", b"x")]))
put("link-through.zip", make_zip([("out", b"/tmp")], change=zip_link))
put("socket.zip", make_zip([("s", b"x")], change=lambda info: setattr(info, "external_attr", (stat.S_IFSOCK | 0o644) << 16)))
put("sparse.tar", make_tar([("holes", b"x" * 512, {"pax_headers": {"GNU.sparse.name": "holes",
                                                                   "GNU.sparse.map": "1000000000000,512", "GNU.sparse.size": "1000000000512",
                                                                   "GNU.sparse.numblocks": "1"}})]))
put("deflate64.zip", with_method(make_zip({"a": b"one two three" * 10}), 9))
put("imploded.zip", with_method(make_zip({"a": b"one two three" * 10}), 6))
put("encrypted.zip", encrypted(make_zip({"a": b"secret" * 10})))

# ---- damage
stored = make_zip({"a": b"one two three" * 10, "b": b"x"}, zipfile.ZIP_STORED)
put("crc.zip", stored.replace(b"one two three", b"one twO three", 1))
packed = bytearray(make_zip(FILES))
packed[len(packed) // 2] ^= 4
put("flip.zip", bytes(packed))
put("cut.zip", make_zip(FILES)[:-30])
whole = make_zip({"a": b"one two three" * 10}, zipfile.ZIP_STORED)
at = whole.index(b"PK\1\2")
put("size.zip", whole[:at + 20] + struct.pack("<II", 60, 60) + whole[at + 28:])  # the directory's sizes (APPNOTE 4.3.12)
deflated = make_zip({"a": b"one two three" * 10})
at = deflated.index(b"PK\1\2")
put("size-both.zip", deflated[:22] + struct.pack("<I", 60) + deflated[26:at + 24] + struct.pack("<I", 60) + deflated[at + 28:])
put("cut.tar", tar[:5000])
put("cut-between.tar", make_tar({"a": b"x" * 512, "b": b"y"})[:1024])
put("header.tar", tar[:100] + b"\xff" + tar[101:])
flipped = bytearray(gzip.compress(tar, 0))
flipped[3500] ^= 1  # within a file's data, stored: only the checksum shows it
put("crc.tar.gz", bytes(flipped))
put("cut.tar.gz", gzip.compress(tar)[:-9])
put("no-sum.tar.gz", gzip.compress(tar)[:-4])
put("junk.tar.gz", gzip.compress(tar) + b"junk")
for name, data in (("bz2", bz2.compress(tar)), ("xz", lzma.compress(tar))):
    put("cut.tar." + name, data[:len(data) - 40])
    broken = bytearray(data)
    broken[len(data) // 2] ^= 16
    put("flip.tar." + name, bytes(broken))
put("cut.tar.zst", zstd(tar)[:-100])

# ---- nothing, or something else
put("empty", b"")
put("text", b"a plan, they said\n" * 100)
put("some.rar", b"Rar!\x1a\7\0" + bytes(100))
put("text.gz", gzip.compress(b"a plan\n" * 100))
put("no-file.tar", make_tar([("a/", None, {"type": tarfile.DIRTYPE})]))
put("no-entry.zip", make_zip({}))
put("only-litter.zip", make_zip({"__MACOSX/a": b"x"}))
put("twice.tar.gz.xz", lzma.compress(gzip.compress(tar)))
put("twice.tar.xz.gz", gzip.compress(lzma.compress(tar)))
put("twice.tar.xz.bz2", bz2.compress(lzma.compress(tar)))
put("cpio", b"070707" + b"0" * 70)

# ---- bombs
put("entries.tar", tarfile.TarInfo("__MACOSX").tobuf(tarfile.USTAR_FORMAT) * 100001 + bytes(1024))
put("many-folders.tar", b"".join(tarfile.TarInfo("%d/b/c/d/e/f/g/h/i/j/k/l/m" % i).tobuf(tarfile.USTAR_FORMAT) for i in range(8400)) + bytes(1024))
zeros = gzip.compress(bytes(16 << 20), 6) * 64  # 1 GiB, as gzip members one after the other
put("zeros.gz", zeros)
info = tarfile.TarInfo("zeros")
info.size = 1 << 30
put("zeros.tar.gz", gzip.compress(info.tobuf(tarfile.USTAR_FORMAT)) + zeros + gzip.compress(bytes(1024)))
put("zeros.tar.bz2", bz2.compress(make_tar({"zeros": bytes(70 << 20)})))
put("litter-bomb.zip", make_zip({"__MACOSX/zeros": bytes(80 << 20), "a": b"x"}))
# flat, overlapping: every entry of the directory points at one and the same local file (D. Fifield, A better zip bomb, WOOT 2019)
one = make_zip({"a": bytes(1 << 20)})
at = one.index(b"PK\1\2")
local, entry = one[:at], one[at:at + 47]
count = 200
put("overlap.zip", local + entry * count + b"PK\5\6" + struct.pack("<HHHHIIH", 0, 0, count, count, 47 * count, len(local), 0))

# ---- position of the refused entry, as Python's own readers see it: archive, name, number from 1, offset of a tar's entry or -1
with open(os.path.join(folder, "places.txt"), "w") as places:
    for name in sorted(os.listdir(folder)):
        path = os.path.join(folder, name)
        if not name.startswith(("name-", "kind-", "twice.tar", "twice.zip", "link-through", "both", "case", "socket")) or name.count(".") > 1:
            continue
        if name.endswith(".zip"):
            entries = [-1 for _ in zipfile.ZipFile(path).infolist()]
        else:
            entries = [member.offset for member in tarfile.open(path).getmembers()]
        bad = 0 if name.startswith(("link-through", "socket")) else 1  # the first or the second of one or two
        places.write("%s %d %d\n" % (name, bad + 1, entries[bad]))
