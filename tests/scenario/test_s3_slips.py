"""Three satellites, one silent slip of a cycle a minute on any of them: each is found, and the place at the end hardly knows (S3 section 12.7)."""

import random

import runs

SLIPS = range(320, 2040, 60)


def flown(folder, name, text, seed):
    source = folder / f"{name}.toml"
    source.write_text(text)
    capture = folder / f"{name}.log"
    runs.call("pelorus-sim", source, "-o", capture, "--seed", seed, "-q")
    result = runs.Result(runs.firmware(capture)[0])
    return result.errors.horizontal[-1], result.run.counters["nav"]


def test_every_silent_slip_is_found_and_costs_little(tmp_path):
    dice = random.Random(1)
    text = (runs.SCENARIOS / "s3_static.toml").read_text()
    slips = "".join(f'[[slip]]\nwho = "C{dice.choice((1, 2, 3))}"\nat_s = {t + 20 * dice.random():.1f}\ncycles = {dice.choice((-1, 1))}\nsilent = true\n\n'
                    for t in SLIPS)
    calm_m, calm = flown(tmp_path, "calm", text, 1)
    slipped_m, slipped = flown(tmp_path, "slipped", text.replace("[navigator]\n", slips + "[navigator]\n", 1), 1)
    print(f"{len(SLIPS)} slips: found {int(slipped['slip_ins']) - int(calm['slip_ins'])}, {slipped_m:.3f} m at the end, without them {calm_m:.3f} m")
    assert int(slipped["slip_ins"]) - int(calm["slip_ins"]) == len(SLIPS)
    assert slipped_m < 1.2 * max(calm_m, 1.0)
