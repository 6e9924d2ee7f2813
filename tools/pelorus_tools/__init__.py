"""What the desktop programs written in Python share: captures, output frames, truth, statistics, pictures."""

__version__ = "0.1.0"
