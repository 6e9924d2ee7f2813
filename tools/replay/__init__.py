"""Recordings of real receivers, replayed through the firmware and held against what is known about them and against RTKLIB."""
