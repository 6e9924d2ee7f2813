"""cost.bin: what hal/pil/cost.c counted. Times of the emulated board become instructions."""

import dataclasses
import struct

import numpy as np

NS_PER_INSTRUCTION = 1024  # of -icount shift=10
KINDS = ("imu step", "epoch", "row", "slice", "integers", "orbits", "receive", "imu byte", "report", "other")


@dataclasses.dataclass
class Cost:
    samples: dict   # kind -> instructions of each piece of work, for the sampled kinds
    total: dict     # kind -> instructions altogether
    count: dict     # kind -> pieces of work
    stack: int      # bytes ever used

    def per(self, kind):
        """(mean, 99 %, maximum), or None where there was none."""
        s = self.samples.get(kind)
        if s is None or not s.size:
            return None
        return int(round(s.mean())), int(round(np.percentile(s, 99))), int(s.max())


def load(path):
    data = path.read_bytes()
    stack, kinds = struct.unpack_from("<QQ", data, len(data) - 16)
    if kinds != len(KINDS):
        raise ValueError(f"{path}: {kinds} kinds of work, expected {len(KINDS)}")
    table = np.frombuffer(data[len(data) - 16 - 16 * kinds:-16], "<u8").reshape(2, kinds)
    words = np.frombuffer(data[:len(data) - 16 - 16 * kinds], "<u8")
    kind = (words >> np.uint64(56)).astype(int)
    instructions = (words & np.uint64((1 << 56) - 1)).astype(float) / NS_PER_INSTRUCTION
    return Cost({KINDS[k]: np.rint(instructions[kind == k]) for k in range(kinds)},
                {KINDS[k]: float(table[0, k]) / NS_PER_INSTRUCTION for k in range(kinds)},
                {KINDS[k]: int(table[1, k]) for k in range(kinds)}, int(stack))
