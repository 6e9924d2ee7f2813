"""A made-up run with known errors: output frames and TRUTH as the firmware and the simulator would write them.

Errors are drawn with exactly the sigma that the solutions claim, so every figure of a report on it is known beforehand.
"""

import json
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from pelorus_tools import earth, eventlog, frames, gpstime, truth  # noqa: E402

T0 = gpstime.from_calendar(2026, 6, 1, 21, 30, 0.0)
SETUP = """[scenario]
name = "made-up flight"
seed = 7
command = "pelorus-sim made_up.toml --seed 7 -o CAPTURE"
[navigator.mount]
lever_arm_m = [0.6, 1.0, 2.764]
"""


class Flight:
    """A weaving flight at 10 Hz solutions, with an epoch every whole second."""

    def __init__(self, seconds=120, seed=1, wrong_at=(), outage=(), ins=True, clean=False):
        rng = np.random.default_rng(seed)
        n = seconds * 10 + 1
        self.t_ns = T0 + np.arange(n) * 100_000_000
        t = np.arange(n) * 0.1
        lat, lon, h = np.radians(30.5) + 139 * t / 6.37e6, np.radians(114.3) + 2e-5 * np.sin(t / 30), 1500 + 5 * np.sin(t / 20)
        self.r_e = earth.llh_to_ecef(lat, lon, h)
        self.C_e_n = earth.C_e_n(lat, lon)
        roll, pitch, heading = np.radians(20) * np.sin(t / 15), np.radians(2) * np.sin(t / 7), np.mod(np.radians(300) + t / 60, 2 * np.pi)
        self.C_b_n = earth.rpy_to_C_b_n(roll, pitch, heading)
        self.v_e = np.gradient(self.r_e, 0.1, axis=0)
        v_n = earth.rotate(self.C_e_n, self.v_e)
        self.b_g, self.b_a = np.full((n, 3), 5e-8), np.full((n, 3), 1e-4)

        sol = np.zeros(n, frames.SOLUTION_DTYPE)
        sd_r, sd_v, sd_a = np.array([1.3, 1.6, 3.4]) * 1e-3, np.full(3, 3e-4), np.array([0.75, 0.75, 1.6]) / 206265
        k = 0.0 if clean else 1.0
        dr, dv, da = (k * rng.standard_normal((n, 3)) * s for s in (sd_r, sd_v, sd_a))
        for second in wrong_at:
            dr[second * 10] += [0.19, 0.0, 0.0]
        r = self.r_e + earth.rotate(np.swapaxes(self.C_e_n, 1, 2), dr)
        sol["t_ns"], sol["r_eb_e"] = self.t_ns, r
        sol["lat_rad"], sol["lon_rad"], sol["height_m"] = earth.ecef_to_llh(r)
        sol["v_ned"] = v_n + dv
        rpy = earth.C_b_n_to_rpy(earth.rotvec_to_dcm(da) @ self.C_b_n)
        sol["roll_rad"], sol["pitch_rad"], sol["heading_rad"] = rpy
        for name, sd in (("cov_r_ned", sd_r), ("cov_v_ned", sd_v), ("cov_att", sd_a)):
            sol[name][:, (0, 3, 5)] = sd**2
        sol["sd_roll_rad"] = sol["sd_pitch_rad"] = sd_a[0]
        sol["sd_heading_rad"] = sd_a[2]
        sol["fix"], sol["flags"] = 3, frames.SOL_INS | frames.SOL_ATTITUDE | frames.SOL_HEADING
        epoch = np.arange(n) % 10 == 0
        sol["flags"][epoch] |= frames.SOL_AT_EPOCH
        if outage:
            sol["fix"][(t >= outage[0]) & (t < outage[1])] = 4
        if not ins:
            sol["flags"] &= frames.SOL_AT_EPOCH
            sol["fix"] = 1
        sol["hpl_m"], sol["vpl_m"], sol["base_age_s"], sol["success_rate"] = 0.02, 0.04, 0.0, 0.999
        sol["ratio"] = np.where(epoch, 10 ** rng.uniform(0.6, 3, n), 0)
        sol["nis_dof"], sol["nis"] = np.where(epoch, 30, 0), np.where(epoch, rng.chisquare(30, n), 0)
        sol["n_sat"], sol["n_fixed"], sol["n_amb"] = 7, np.where(epoch, 12, 0), 12
        sol["b_g"], sol["sd_b_g"] = self.b_g + rng.standard_normal((n, 3)) * 1e-9, 2e-8
        sol["b_a"], sol["sd_b_a"] = self.b_a, 2e-5
        self.sol = sol
        self.sats = [self.satellites(t_ns, i, rng) for i, t_ns in enumerate(self.t_ns[epoch])]

    @staticmethod
    def satellites(t_ns, i, rng):
        s = np.zeros(14, frames.SAT_DTYPE)
        s["prn"], s["carrier"] = np.repeat([3, 7, 9, 14, 19, 22, 31], 2), np.tile([0, 1], 7)
        s["az_rad"] = np.repeat(np.linspace(0, 5.6, 7), 2) + i * 1e-4
        s["el_rad"] = np.repeat(np.radians([75, 52, 40, 33, 25, 18, 12]), 2)
        s["cn0_dbhz"] = 36 + 14 * np.sin(s["el_rad"]) + rng.standard_normal(14) - 3 * s["carrier"]
        s["flags"] = np.where(s["prn"] == 3, frames.SAT_PIVOT, frames.SAT_CODE | frames.SAT_PHASE | frames.SAT_DOPPLER | frames.SAT_FIXED)
        for kind, sd in (("code_m", 6.0), ("phase_m", 0.006), ("doppler_mps", 0.06)):
            s[f"sd_{kind}"], s[f"innov_{kind}"] = sd, rng.standard_normal(14) * sd
        return t_ns, s

    def used(self):
        u = np.zeros(1, frames.USED_DTYPE)
        u["t_ns"], u["preset_used"], u["imu_seen"], u["imu_used"], u["base_seen"], u["base_used"] = T0, 4, 1, 1, 1, 1
        u["imu_rate_hz"], u["arw_rad_rts"], u["vrw_mps_rts"], u["sd_bg_radps"], u["sd_ba_mps2"] = 500, 2.9e-7, 1e-5, 4.8e-8, 9.8e-5
        u["rover_seen"][0, :3], u["base_carriers"][0, 0], u["carriers_used"][0, 0], u["sys_why"][0, 2] = (3, 0, 1), 3, 3, 1
        u["r_station_e"] = self.r_e[0] + [800.0, 300.0, -900.0]
        return u.tobytes()

    def counters(self):
        c = np.zeros(1, frames.COUNTERS_DTYPE)
        c["t_ns"], c["nav"]["epochs_used"], c["nav"]["imu_used"], c["nav"]["slip_lock"], c["rover"]["bad_checksum"] = self.t_ns[-1], 120, 60000, 2, 1
        return c.tobytes()

    def event(self):
        e = np.zeros(1, frames.EVENT_DTYPE)
        e["t_ns"], e["id"], e["fix"], e["r_ec_e"] = T0 + 5_000_000_000, 17, 3, self.r_e[50]
        e["lat_rad"], e["lon_rad"], e["height_m"] = earth.ecef_to_llh(self.r_e[50])
        return e.tobytes()

    def uart(self):
        """(t_ns, bytes) in the order a board would send them."""
        out = [(T0, frames.encode(frames.USED, self.used()))]
        sats = dict(self.sats)
        for s in self.sol:
            block = frames.encode(frames.SOLUTION, s.tobytes())
            if int(s["t_ns"]) in sats:
                reports = sats[int(s["t_ns"])]
                block += frames.encode(frames.SATELLITES, frames.satellites_payload(int(s["t_ns"]), reports))
            out.append((int(s["t_ns"]), block))
        out.append((int(self.t_ns[-1]), frames.encode(frames.EVENT, self.event()) + frames.encode(frames.COUNTERS, self.counters())))
        return out

    def truth_rows(self):
        a = np.zeros(self.t_ns.size, truth.TRUTH_DTYPE)
        a["t_ns"], a["r_eb_e"], a["v_eb_e"], a["C_b_e"] = self.t_ns, self.r_e, self.v_e, np.swapaxes(self.C_e_n, 1, 2) @ self.C_b_n
        omega_e = earth.rotvec(a["C_b_e"][1:] @ np.swapaxes(a["C_b_e"][:-1], 1, 2)) / 0.1
        a["omega_ib_b"] = earth.rotate(np.swapaxes(a["C_b_e"], 1, 2).astype(float), np.vstack([omega_e, omega_e[-1:]]) + truth.OMEGA_IE)
        a["b_g"], a["b_a"] = self.b_g, self.b_a
        return a

    def write(self, path, with_truth=True, damage=b""):
        us = lambda t_ns: (int(t_ns) // 1000) + gpstime.UNIX_AT_GPS_EPOCH * 10**6
        rows = [(us(T0), "SETUP", SETUP.encode())]
        rows.append((us(T0), "RUN", json.dumps({"capture": "made_up.log", "command": "pelorus-sil made_up.log -o made_up.out"}).encode()))
        rows += [(us(t), "UART_OUT", data) for t, data in self.uart()]
        if damage:
            rows.insert(len(rows) // 2, (rows[len(rows) // 2][0], "UART_OUT", damage))
        if with_truth:
            rows += [(us(a["t_ns"]), "TRUTH", a.tobytes()) for a in self.truth_rows()]
        eventlog.write(path, rows)
        return path


if __name__ == "__main__":
    Flight(seconds=int(sys.argv[2]) if len(sys.argv) > 2 else 300).write(sys.argv[1])
