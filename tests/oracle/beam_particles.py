"""Particles of beams, by struct alone: `sums FILE.mcpl...` prints what the files hold; `make FOLDER` writes MCPL in all
its arrangements and phase spaces of the IAEA of known particles. Directions in MCPL leave out their largest component."""
import gzip
import math
import struct
import sys


def read_mcpl(path):
    data = (gzip.open if path.endswith('.gz') else open)(path, 'rb').read()
    e = '<' if data[7:8] == b'L' else '>'
    n, n_comments, n_blobs, flags, polar, single, pdg, size, has_weight = struct.unpack(e + 'QIIIIIiII', data[8:48])
    at, weight = 48, None
    if has_weight:
        weight = struct.unpack(e + 'd', data[48:56])[0]
        at = 56
    for _ in range(1 + n_comments + 2 * n_blobs):
        at += 4 + struct.unpack(e + 'I', data[at:at + 4])[0]
    f = 'f' if single else 'd'
    layout = e + (3 * polar + 7) * f + ('' if has_weight else f) + ('' if pdg else 'i') + ('I' if flags else '')
    n = n or (len(data) - at) // size
    for i in range(n):
        values = list(struct.unpack_from(layout, data, at + i * size))
        values = values[3 * polar:]
        x, y, z, a, b, energy = values[:6]
        sign = math.copysign(1, energy)
        rest = values[7:]
        w = weight if has_weight else rest.pop(0)
        code = pdg or rest[0]
        left = lambda p, q: sign * math.sqrt(max(0, 1 - p * p - q * q))
        if abs(a) > 1:
            u, v, t = left(b, 1 / a), b, 1 / a
        elif abs(b) > 1:
            u, v, t = a, left(a, 1 / b), 1 / b
        else:
            u, v, t = a, b, left(a, b)
        yield code, abs(energy), w, (x, y, z), (u, v, t)


def sums(path):
    counts = {}
    total = [0.0] * 8
    for code, energy, weight, at, way in read_mcpl(path):
        counts[code] = counts.get(code, 0) + 1
        if code in (2112, 22):
            for i, value in enumerate((energy, weight, *at, *way)):
                total[i] += value
    others = sum(n for code, n in counts.items() if code not in (2112, 22))
    print(counts.get(2112, 0), counts.get(22, 0), others, *(repr(value) for value in total))


# kind, energy MeV, weight, place, direction; every octant and every largest component
S = math.sqrt(1 - 0.36 - 0.04)
MADE = [
    (2112, 1e-6, 1.0, (1, 2, 3), (0.6, 0.2, S)),
    (2112, 2.5, 0.25, (-1, 0.5, -3), (-0.6, -0.2, -S)),
    (22, 0.477, 2.0, (0, 0, 0), (-S, 0.2, -0.6)),
    (22, 2.2246, 4.0, (5, -5, 10), (0.2, -S, 0.6)),
    (11, 1.0, 1.0, (0, 0, 0), (0, 0, 1)),
    (2112, 0.0253e-6, 0.5, (7, 8, 9), (1, 0, 0)),
]


def pack_way(way):
    u, v, w = way
    if abs(w) >= max(abs(u), abs(v)):
        return u, v, w
    inverse = 1 / w if w else math.inf
    return (inverse, v, u) if abs(u) >= abs(v) else (u, inverse, v)


def write_mcpl(path, e, single, polar, flags, pdg, weight, made, count=None, blobs=1):
    f = 'f' if single else 'd'
    layout = e + (3 * polar + 7) * f + ('' if weight else f) + ('' if pdg else 'i') + ('I' if flags else '')
    size = struct.calcsize(layout)
    out = b'MCPL003' + (b'L' if e == '<' else b'B')
    out += struct.pack(e + 'QIIIIIiII', len(made) if count is None else count, 2, blobs, flags, polar, single, pdg, size,
                       1 if weight else 0)
    if weight:
        out += struct.pack(e + 'd', weight)
    for text in (b'made', b'a comment', b'', *([b'key'] * blobs), *([b'\0\1\2'] * blobs)):
        out += struct.pack(e + 'I', len(text)) + text
    for code, energy, own, at, way in made:
        a, b, sign = pack_way(way)
        values = [0.1] * (3 * polar) + [*at, a, b, math.copysign(energy, sign), 77.0]
        values += ([] if weight else [own]) + ([] if pdg else [code]) + ([5] if flags else [])
        out += struct.pack(layout, *values)
    (gzip.open if path.endswith('.gz') else open)(path, 'wb').write(out)


def write_iaea(stem, e, made, stored, constants, longs):
    order = {'<': 1234, '>': 4321}[e]
    kinds = {22: 1, 11: 2, 2112: 4}
    out = b''
    for i, (code, energy, weight, at, way) in enumerate(made):
        fields = [*at, *way, weight]
        kept = [value for k, value in enumerate(fields) if stored[k] and k != 5]
        out += struct.pack(e + 'b', -kinds[code] if way[2] < 0 else kinds[code])
        out += struct.pack(e + 'f', -energy if i % 2 == 0 else energy)
        out += struct.pack(e + '%df' % len(kept), *kept) + struct.pack(e + '%di' % longs, *([3] * longs))
    size = len(out) // len(made)
    names = ['X', 'Y', 'Z', 'U', 'V', 'W', 'Weight']
    text = '$IAEA_INDEX:\n0 // made\n\n$TITLE:\nmade of known particles\n\n$FILE_TYPE:\n0\n\n$CHECKSUM:\n%d\n\n' % len(out)
    text += '$RECORD_CONTENTS:\n' + ''.join('    %d     // %s is stored ?\n' % pair for pair in zip(stored, names))
    text += '    0     // Extra floats stored ?\n    %d     // Extra longs stored ?\n' % longs
    text += '    2     // LATCH\n' * longs + '\n$RECORD_CONSTANT:\n'
    text += ''.join('   %.4f     // Constant %s\n' % pair for pair in constants)
    text += '\n$RECORD_LENGTH:\n%d\n\n$BYTE_ORDER:\n%d\n\n$ORIG_HISTORIES:\n200\n\n$PARTICLES:\n%d\n' % (size, order, len(made))
    open(stem + '.IAEAheader', 'w').write(text)
    open(stem + '.IAEAphsp', 'wb').write(out)


def make(folder):
    for e in '<>':
        for single in (0, 1):
            for polar in (0, 1):
                for flags in (0, 1):
                    name = '%s/%s%d%d%d' % (folder, 'L' if e == '<' else 'B', single, polar, flags)
                    write_mcpl(name + '.mcpl', e, single, polar, flags, 0, 0, MADE)
    write_mcpl(folder + '/universal.mcpl.gz', '<', 1, 0, 0, 2112, 0.125, MADE)
    write_mcpl(folder + '/cut.mcpl', '<', 1, 0, 0, 0, 0, MADE, count=0)
    write_iaea(folder + '/all', '<', MADE, (1, 1, 1, 1, 1, 1, 1), [], 0)
    write_iaea(folder + '/big', '>', MADE, (1, 1, 1, 1, 1, 1, 1), [], 2)
    plane = [(code, energy, 1.0, (at[0], at[1], 26.5), way) for code, energy, _, at, way in MADE]
    write_iaea(folder + '/plane', '<', plane, (1, 1, 0, 1, 1, 1, 0), [(26.5, 'Z'), (1.0, 'Weight')], 1)


if sys.argv[1] == 'sums':
    for path in sys.argv[2:]:
        sums(path)
else:
    make(sys.argv[2])
