"""Three satellites on the RDSS S band: cycles of 12 cm instead of 19 on BeiDou's first carrier, told by the configuration."""

import numpy as np
import runs


def flown(folder, name, text):
    source = folder / f"{name}.toml"
    source.write_text(text)
    capture = folder / f"{name}.log"
    runs.call("pelorus-sim", source, "-o", capture, "--duration", 900, "-q")
    return runs.Result(runs.firmware(capture)[0])


def test_another_wavelength_is_the_same_place(tmp_path):
    text = (runs.SCENARIOS / "s3_static.toml").read_text()
    sent = text.replace("[rover]\n", "[rover]\nrdss_mhz = 2491.75\n", 1)
    told = sent.replace("[navigator.gnss] ", "[navigator.gnss]\nrdss_mhz = 2491.75 ", 1)
    assert told != sent != text
    b1i, s_band, untold = (flown(tmp_path, n, t) for n, t in (("b1i", text), ("told", told), ("untold", sent)))
    same = np.linalg.norm(b1i.sol["r_eb_e"][-1] - s_band.sol["r_eb_e"][-1])
    print(f"end {b1i.errors.horizontal[-1]:.2f} m on B1I, {s_band.errors.horizontal[-1]:.2f} m on the S band, {same * 1e3:.1f} mm apart; "
          f"rows {s_band.run.counters['nav']['rows_used']}, not told {untold.run.counters['nav']['rows_used']}, slips {untold.run.counters['nav']['slip_ins']}")
    assert same < 0.02 and s_band.errors.horizontal[-1] < 3.0
    assert s_band.run.counters["nav"]["slip_ins"] <= b1i.run.counters["nav"]["slip_ins"]
    # Where it is not told, each clock step of the receiver looks like a slip or pulls the place away.
    assert untold.run.counters["nav"]["slip_ins"] > 100 or untold.errors.horizontal[-1] > 10.0
