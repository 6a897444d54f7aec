"""Adds frames to an animated GIF (GIF89a), which is complete after each. Pillow alone writes a film only as a whole, from all frames in memory."""
import io
import os

from PIL import Image

HEADER = 13  # bytes of signature and logical screen
FOR_EVER = b"!\xff\x0bNETSCAPE2.0\x03\x01\x00\x00\x00"
TRAILER = b";"
_known = {}  # path: [size of the file, where its frames end]


def write(path, image, number, seconds):
    """Make an image (of PIL, RGB) frame `number` of the film at `path`, shown for `seconds`; frames from this number on are cut. Frame 0 begins a new
    file. If the file has fewer frames, the image becomes the next one. An image of another size than the film's is fitted to it."""
    ends = [] if number == 0 else _ends(path)[:number + 1]  # the first is the end of the header
    if not ends:
        header = b"GIF89a" + b"".join(side.to_bytes(2, "little") for side in image.size) + b"\x00\x00\x00" + FOR_EVER
        with open(path, "wb") as file:
            file.write(header + TRAILER)
        ends = [len(header)]
    with open(path, "r+b") as file:
        size = _size(file.read(HEADER))
        file.seek(ends[-1])
        file.write(_block(image if image.size == size else image.resize(size), seconds) + TRAILER)
        file.truncate()
        ends.append(file.tell() - len(TRAILER))
    _known[os.path.abspath(path)] = [ends[-1] + len(TRAILER), ends]


def _size(header):
    return int.from_bytes(header[6:8], "little"), int.from_bytes(header[8:10], "little")


def _block(image, seconds):
    """Return an image as a block of a film, with colours of its own."""
    alone = io.BytesIO()
    image.quantize(255, Image.Quantize.FASTOCTREE, dither=0).save(alone, format="GIF", interlace=False)  # 20 times as fast as the default
    data = alone.getvalue()
    start = HEADER + _table(data[10])
    while data[start:start + 1] == b"!":  # extensions
        start = _after(data, start + 2)
    colours = data[HEADER:HEADER + _table(data[10])]
    control = b"!\xf9\x04\x04" + max(2, round(100 * seconds)).to_bytes(2, "little") + b"\x00\x00"  # most programs show no frame for less than 0.02 s
    return control + data[start:start + 9] + bytes([0x80 | data[10] & 7]) + colours + data[start + 10:-1]


def _table(packed):
    """Return the length [bytes] of a table of colours, from the byte that describes it."""
    return 3 * 2**((packed & 7) + 1) if packed & 0x80 else 0


def _after(data, place):
    """Return the place behind the chain of blocks that begins at `place`."""
    while data[place]:
        place += data[place] + 1
    return place + 1


def _ends(path):
    """Return where the header and each frame of a film end [bytes]; an empty list if there is none or it is none of ours."""
    size, ends = _known.get(os.path.abspath(path), (None, []))
    try:
        if os.path.getsize(path) == size:
            return ends
        with open(path, "rb") as file:
            data = file.read()
    except OSError:
        return []
    if data[:6] != b"GIF89a" or data[HEADER:HEADER + len(FOR_EVER)] != FOR_EVER:
        return []
    ends = [HEADER + len(FOR_EVER)]
    try:
        while data[ends[-1]:ends[-1] + 1] == b"!":
            image = _after(data, ends[-1] + 2)
            ends.append(_after(data, image + 10 + _table(data[image + 9]) + 1))
    except IndexError:  # the process was killed while it wrote the last one
        pass
    return ends
