"""Processor in the loop: a capture through the firmware on an emulated board, held against the same on the desktop."""
