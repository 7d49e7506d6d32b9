"""A check that bytes are a picture that is safe to show to a person."""

import io

from PIL import Image

PNG, JPEG = "image/png", "image/jpeg"
#: The most pixels of a picture that we show. A small file may unpack to gigabytes in a browser.
MOST_PIXELS = 40_000_000


def is_picture(kind: str, data: bytes) -> bool:
    """Check without decoding a pixel that bytes are a picture of this kind and not too large."""
    try:
        with Image.open(io.BytesIO(data), formats=["PNG", "JPEG"]) as image:
            image.verify()
            is_small = image.width * image.height <= MOST_PIXELS
            return is_small and Image.MIME[image.format or ""] == kind
    # Pillow's readers raise all kinds of exceptions for damaged files.
    except Exception:
        return False
