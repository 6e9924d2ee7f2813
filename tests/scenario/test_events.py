"""Event marks of the survey leg: exterior orientation at each exposure, against the truth of that instant."""

import numpy as np
import runs
from pelorus_tools import earth, stats, truth


def rotation(omega, phi, kappa):
    """Rx(omega) Ry(phi) Rz(kappa), shape (n, 3, 3)."""
    zero, one = np.zeros_like(omega), np.ones_like(omega)
    stack = lambda rows: np.stack([np.stack(r, -1) for r in rows], -2)
    x = stack([(one, zero, zero), (zero, np.cos(omega), -np.sin(omega)), (zero, np.sin(omega), np.cos(omega))])
    y = stack([(np.cos(phi), zero, np.sin(phi)), (zero, one, zero), (-np.sin(phi), zero, np.cos(phi))])
    z = stack([(np.cos(kappa), -np.sin(kappa), zero), (np.sin(kappa), np.cos(kappa), zero), (zero, zero, one)])
    return x @ y @ z


def test_exterior_orientation_at_every_exposure(tmp_path):
    out, _ = runs.firmware(runs.simulate(tmp_path, "s5_leg"))
    r = runs.Result(out)
    e = r.run.frames.event
    at, covered = truth.from_events(r.run.truth_events, "out").at(e["t_ns"])
    assert e.size == 60 and covered.all() and len(set(e["id"].tolist())) == 60
    d = e["r_ec_e"] - at.r_e
    # The mapping frame is east, north, up at the event; its rows are those of NED in another order.
    to_m = earth.C_e_n(e["lat_rad"], e["lon_rad"])[:, [1, 0, 2]] * np.array([1, 1, -1])[:, None]
    C = rotation(*(e[f"{a}_rad"].astype(float) for a in ("omega", "phi", "kappa")))
    turn = earth.rotvec(C @ np.swapaxes(to_m @ at.C_b_e, 1, 2)) * stats.ARCSEC
    enu = earth.rotate(to_m, d) * 1e3
    print(f"\n{e.size} events: position {np.round(np.sqrt(np.mean(enu**2, 0)), 2)} mm, attitude {np.round(np.sqrt(np.mean(turn**2, 0)), 2)} arcsec rms ENU;"
          f" claimed {np.round(1e3 * np.sqrt(np.mean(e['sd_r_m'].astype(float)**2, 0)), 2)} mm, {np.round(stats.ARCSEC * np.sqrt(np.mean(e['sd_att_rad'].astype(float)**2, 0)), 2)} arcsec NED")
    assert (e["fix"] == 3).all()
    assert (np.sqrt(np.mean(enu**2, 0)) < (4, 4, 8)).all()
    assert (np.sqrt(np.mean(turn**2, 0)) < (2, 2, 4)).all()
