"""Whether bytes are a picture of a kind and a size that can be shown to a person."""

import io

from PIL import Image

PNG, JPEG = "image/png", "image/jpeg"
#: Pixels of a picture that is shown, at most: a small file may unpack to gigabytes in a browser.
MOST_PIXELS = 40_000_000


def is_picture(kind: str, data: bytes) -> bool:
    """Whether these bytes are a picture of a kind, and not too large; no pixel is decoded."""
    try:
        with Image.open(io.BytesIO(data), formats=["PNG", "JPEG"]) as image:
            image.verify()
            is_small = image.width * image.height <= MOST_PIXELS
            return is_small and Image.MIME[image.format or ""] == kind
    # Its readers raise whatever a damaged file leads them to.
    except Exception:
        return False
