"""Errors against truth, and the figures people judge a run by."""

import numpy as np

from pelorus_tools import earth, frames

WRONG_FIX_M = 0.08        # a fixed epoch farther than this from truth, horizontally, is a wrong fix
ARCSEC = np.degrees(1.0) * 3600.0

# Groups of three components each: name, axis names, unit of the figures, factor from SI, words for people.
GROUPS = (("pos", ("n", "e", "d"), "m", 1.0, "position"),
          ("vel", ("n", "e", "d"), "mps", 1.0, "velocity"),
          ("att", ("n", "e", "d"), "arcsec", ARCSEC, "attitude"))


class Errors:
    """Solution minus truth in local NED with the sigma the solution claims: err[group] and sd[group], both (n, 3).

    Attitude errors are the small rotation about north, east and down that takes the true attitude to the computed one,
    so they do not depend on how angles are counted. NaN where there is nothing to compare. Without IMU a solution is the
    antenna's, so truth of the simulator is moved there by the lever arm (body axes, m).
    """

    def __init__(self, sol, truth, remove_mean=False, lever_ba_b=(0.0, 0.0, 0.0)):
        at, covered = truth.at(sol["t_ns"])
        if at.C_b_e is not None and at.omega_e is not None and np.any(lever_ba_b):
            antenna = ((sol["flags"] & frames.SOL_INS) == 0)[:, None]
            arm = at.C_b_e @ np.asarray(lever_ba_b, float)
            at.r_e = at.r_e + antenna * arm
            at.v_e = at.v_e + antenna * np.cross(at.omega_e, arm)
        lat, lon = sol["lat_rad"], sol["lon_rad"]
        to_n = earth.C_e_n(lat, lon)
        have = covered & (sol["fix"] != 0)
        self.t_ns, self.have = sol["t_ns"], have
        self.err, self.sd = {}, {}

        def put(name, values, cov, where):
            self.err[name] = np.where(where[:, None], values, np.nan)
            c = sol[cov][:, (0, 3, 5)].astype(float)
            self.sd[name] = np.where(where[:, None] & (c > 0), np.sqrt(np.maximum(c, 0)), np.nan)

        put("pos", earth.rotate(to_n, sol["r_eb_e"] - at.r_e), "cov_r_ned", have)
        self.mean_offset = np.zeros(3)
        if remove_mean and have.any():
            self.mean_offset = np.nanmean(self.err["pos"], axis=0)
            self.err["pos"] = self.err["pos"] - self.mean_offset
        if at.v_e is not None:
            put("vel", sol["v_ned"] - earth.rotate(to_n, at.v_e), "cov_v_ned", have)
        if at.C_b_e is not None:
            # Between times attitude interpolated without its rate is no reference for arc seconds.
            known = have & at.attitude_good & ((sol["flags"] & frames.SOL_HEADING) != 0)
            C = earth.rpy_to_C_b_n(*(sol[n].astype(float) for n in ("roll_rad", "pitch_rad", "heading_rad")))
            put("att", earth.rotvec(C @ np.swapaxes(to_n @ at.C_b_e, -1, -2)), "cov_att", known)
        self.b_g, self.b_a = at.b_g, at.b_a
        self.horizontal = np.hypot(self.err["pos"][:, 0], self.err["pos"][:, 1])


def nees(sol, errors, group):
    """e' P^-1 e of each solution with the full 3 x 3 covariance; nan where there is nothing to compare."""
    packed = sol[{"pos": "cov_r_ned", "vel": "cov_v_ned", "att": "cov_att"}[group]].astype(float)
    P = packed[:, (0, 1, 2, 1, 3, 4, 2, 4, 5)].reshape(-1, 3, 3)
    e = errors.err[group]
    good = np.isfinite(e).all(1) & (np.abs(np.linalg.det(P)) > 0)
    out = np.full(len(e), np.nan)
    out[good] = np.einsum("ni,ni->n", e[good], np.linalg.solve(P[good], e[good][..., None])[..., 0])
    return out


def rms(x):
    return float(np.sqrt(np.mean(np.square(x)))) if x.size else float("nan")


def component(err, sd):
    """rms, max, mean sigma (rms), rms over sigma, 95th percentile of one component; None if there is nothing."""
    ok = np.isfinite(err)
    if not ok.any():
        return None
    e = err[ok]
    s = rms(sd[ok & np.isfinite(sd)])
    return {"rms": rms(e), "max": float(np.max(np.abs(e))), "sigma": s, "ratio": rms(e) / s if s > 0 else float("nan"),
            "p95": float(np.percentile(np.abs(e), 95)), "mean": float(np.mean(e)), "n": int(e.size)}


class Stats:
    """All figures of one run inside a window of seconds after its first solution."""

    def __init__(self, run, errors=None, window=None):
        sol = run.sol
        t = (sol["t_ns"] - sol["t_ns"][0]) * 1e-9
        inside = np.ones(sol.size, bool) if window is None else (t >= window[0]) & (t <= window[1])
        self.window, self.inside = window, inside
        self.duration_s = float(t[-1])
        self.solutions = int(inside.sum())
        epoch = inside & ((sol["flags"] & frames.SOL_AT_EPOCH) != 0)
        if not epoch.any():
            epoch = inside      # a log without epoch marks: every solution counts
        fixed = epoch & (sol["fix"] == 3)
        self.epochs, self.fixed = int(epoch.sum()), int(fixed.sum())
        self.fixed_share = self.fixed / self.epochs if self.epochs else float("nan")
        self.status_share = {w: float(np.mean(sol["fix"][inside] == i)) if inside.any() else 0.0 for i, w in enumerate(frames.FIX)}
        self.table, self.wrong, self.compared_fixed = {}, None, 0
        if errors is not None:
            for name, axes, _, _, _ in GROUPS:
                if name in errors.err:
                    for i, axis in enumerate(axes):
                        c = component(errors.err[name][inside, i], errors.sd[name][inside, i])
                        if c:
                            self.table[name, axis] = c
            compared = fixed & np.isfinite(errors.horizontal)
            self.compared_fixed = int(compared.sum())
            self.wrong = int(np.sum(errors.horizontal[compared] > WRONG_FIX_M))
            h = errors.horizontal[inside & np.isfinite(errors.horizontal)]
            self.horizontal_rms, self.horizontal_max = rms(h), float(h.max()) if h.size else float("nan")
        with_nis = epoch & (sol["nis_dof"] > 0)
        dof = int(sol["nis_dof"][with_nis].sum())
        self.nis_ratio = float(sol["nis"][with_nis].sum(dtype=float)) / dof if dof else float("nan")
        self.nis_dof = dof

    def flat(self):
        """Every figure under one name: what --csv-stats prints and --limit compares."""
        out = {"duration_s": self.duration_s, "solutions": self.solutions, "epochs": self.epochs,
               "fixed_epochs": self.fixed, "fixed_share": self.fixed_share, "nis_ratio": self.nis_ratio}
        for w, share in self.status_share.items():
            out[f"share_{w}"] = share
        if self.wrong is not None:
            out["wrong_fixes"] = self.wrong
            out["wrong_fix_share"] = self.wrong / self.compared_fixed if self.compared_fixed else 0.0
            out["pos_h_rms_m"], out["pos_h_max_m"] = self.horizontal_rms, self.horizontal_max
        for name, axes, unit, factor, _ in GROUPS:
            for axis in axes:
                c = self.table.get((name, axis))
                if c:
                    for k in ("rms", "max", "sigma", "p95", "mean"):
                        out[f"{name}_{axis}_{k}_{unit}"] = c[k] * factor
                    out[f"{name}_{axis}_ratio"] = c["ratio"]
        return out


AT_LEAST = {"fixed_share", "fixed_epochs", "epochs", "solutions", "duration_s", "share_fixed"}


class Limit:
    """'NAME=VALUE' (at most; at least for shares and counts of good things) or 'NAME=LOW..HIGH'."""

    def __init__(self, words):
        self.name, sep, value = words.partition("=")
        low, dots, high = value.partition("..")
        try:
            if not sep:
                raise ValueError
            if dots:
                self.low, self.high = float(low), float(high)
            elif self.name in AT_LEAST:
                self.low, self.high = float(value), float("inf")
            else:
                self.low, self.high = float("-inf"), float(value)
        except ValueError:
            raise ValueError(f"'{words}' is not NAME=VALUE or NAME=LOW..HIGH") from None

    def check(self, flat):
        """(met, value); a figure that could not be computed misses its limit."""
        value = flat.get(self.name, float("nan"))
        return self.low <= value <= self.high, value

    def words(self):
        if self.low == float("-inf"):
            return f"{self.name} <= {self.high:g}"
        if self.high == float("inf"):
            return f"{self.name} >= {self.low:g}"
        return f"{self.name} in [{self.low:g}, {self.high:g}]"
