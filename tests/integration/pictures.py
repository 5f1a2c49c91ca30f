"""Picture files that lie, made byte by byte."""
import struct
import zlib


def png_chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(width, height, depth=8, rows=None):
    """A grey PNG. `rows` are compressed pixel rows, each with its filter byte; black when absent."""
    header = struct.pack(">IIBBBBB", width, height, depth, 0, 0, 0, 0)
    if rows is None:
        row = bytes(1 + (width * depth + 7) // 8)
        packer = zlib.compressobj(9)
        rows = b"".join(packer.compress(row) for _ in range(height)) + packer.flush()
    return b"\x89PNG\r\n\x1a\n" + png_chunk(b"IHDR", header) + png_chunk(b"IDAT", rows) + png_chunk(b"IEND", b"")


def png_bomb():
    """Some hundred kilobytes that decode to 900 million pixels."""
    return png(30000, 30000, depth=1)


def png_with_lying_header():
    """Declares 2^31 - 1 pixels a side and holds a single row."""
    return png(0x7FFFFFFF, 0x7FFFFFFF, rows=zlib.compress(bytes(64)))


def jpeg_with_size(jpeg, width, height):
    """`jpeg` with other dimensions written into its frame header."""
    position = 2
    while position < len(jpeg):
        marker, length = jpeg[position + 1], struct.unpack(">H", jpeg[position + 2:position + 4])[0]
        if 0xC0 <= marker <= 0xC2:
            return jpeg[:position + 5] + struct.pack(">HH", height, width) + jpeg[position + 9:]
        position += 2 + length
    raise ValueError("no frame header")


GIF = b"GIF89a\x01\x00\x01\x00\x80\x00\x00\x00\x00\x00\xff\xff\xff!\xf9\x04\x00\x00\x00\x00\x00,\x00\x00\x00\x00\x01\x00\x01\x00\x00\x02\x02D\x01\x00;"
SVG = b'<svg xmlns="http://www.w3.org/2000/svg"><image href="file:///etc/passwd"/></svg>'


def colour_png(width, height, pixel):
    """A PNG in colour; `pixel(x, y)` gives (red, green, blue)."""
    rows = b"".join(b"\0" + b"".join(bytes(pixel(x, y)) for x in range(width)) for y in range(height))
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + png_chunk(b"IHDR", header) + png_chunk(b"IDAT", zlib.compress(rows))
            + png_chunk(b"IEND", b""))


def labelled_ply(label="label", fruit=(134, 155, 67), count=600):
    """A cloud of two classes for the training of a background model: a fruit's colour, and a board's black and white."""
    vertices = b""
    for k in range(count):
        vertices += struct.pack("<3f4B", k, 0, 0, *(channel + k % 7 for channel in fruit), 1)
        vertices += struct.pack("<3f4B", k, 1, 0, *([20 + k % 7] * 3 if k % 2 else [230 + k % 7] * 3), 0)
    names = "".join(f"property float {axis}\n" for axis in "xyz")
    names += "".join(f"property uchar {name}\n" for name in ("red", "green", "blue", label))
    return f"ply\nformat binary_little_endian 1.0\nelement vertex {2 * count}\n{names}end_header\n".encode() + vertices
