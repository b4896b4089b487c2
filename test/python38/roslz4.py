"""roslz4 as rosbag uses it, on top of PyPI's lz4: the distribution's own is compiled for another Python."""

import lz4.frame

decompress = lz4.frame.decompress


class LZ4Compressor(lz4.frame.LZ4FrameCompressor):
    """A frame compressor that begins its frame by itself, as that of roslz4 does."""

    def compress(self, data: bytes) -> bytes:
        """Return the compressed bytes that are ready so far."""
        header = b"" if self.started() else self.begin()
        return header + super().compress(data)
