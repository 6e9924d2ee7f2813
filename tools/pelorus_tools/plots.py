"""Pictures of a run: quiet, vector, the same bytes for the same input."""

import io

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from pelorus_tools import earth, frames, stats

INK, MUTED, GRID = "#1f2a35", "#6b7783", "#e6eaee"
BLUE, BAND = "#24588c", "#d5e3f0"
STATUS_COLOUR = {"none": "#c4c9ce", "spp": "#7d97b0", "float": "#dfa03a", "fixed": "#2f8f5b", "coast": "#c0504d"}
CN0_MAP = LinearSegmentedColormap.from_list("cn0", ["#e3c9a2", "#8fb3c9", "#24588c", "#10304f"])
ROWS_OF_A_LINE = 1500     # points a line is thinned to, extremes kept

STYLE = {
    "font.family": "DejaVu Sans", "font.size": 8.5, "axes.edgecolor": "#b9c2ca", "axes.labelcolor": MUTED, "text.color": INK,
    "xtick.color": MUTED, "ytick.color": MUTED, "axes.grid": True, "grid.color": GRID, "grid.linewidth": 0.8,
    "axes.spines.top": False, "axes.spines.right": False, "axes.titlesize": 9, "axes.titleweight": "bold",
    "axes.titlelocation": "left", "axes.axisbelow": True, "lines.linewidth": 1.0, "legend.frameon": False,
    "legend.fontsize": 8, "svg.hashsalt": "pelorus", "svg.fonttype": "path", "figure.facecolor": "white",
    "xtick.major.size": 0, "ytick.major.size": 0, "axes.formatter.useoffset": False,
}


def figure(width, height):
    return Figure(figsize=(width, height), layout="constrained")


def svg(fig):
    out = io.StringIO()
    FigureCanvasSVG(fig).print_svg(out, metadata={"Date": None, "Creator": None})
    text = out.getvalue()
    return text[text.index("<svg"):]


def png(fig, path, dpi=110):
    FigureCanvasAgg(fig)
    fig.savefig(path, dpi=dpi, metadata={"Software": None})


def thin(x, y, n=ROWS_OF_A_LINE):
    """A line with at most about 2 n points: of each stretch its lowest and its highest, in order."""
    if x.size <= 2 * n:
        return x, y
    size = -(-x.size // n)
    m = x.size // size * size
    blocks = np.where(np.isfinite(y[:m]), y[:m], 0.0).reshape(-1, size)
    base = np.arange(blocks.shape[0]) * size
    pick = np.unique(np.concatenate([base + blocks.argmin(1), base + blocks.argmax(1), np.arange(m, x.size)[::max(size, 1)], [0, x.size - 1]]))
    return x[pick], y[pick]


def clock(t_s):
    """Minutes where a run is long, seconds where it is short: (values, label)."""
    return (t_s / 60.0, "minutes") if t_s.size and t_s[-1] > 600 else (t_s, "seconds")


def runs(codes):
    """(first, last, code) of each stretch of equal codes."""
    cut = np.flatnonzero(np.diff(codes)) + 1
    first = np.concatenate([[0], cut])
    last = np.concatenate([cut, [codes.size]]) - 1
    return list(zip(first.tolist(), last.tolist(), codes[first].tolist()))


class Picture:
    """What all pictures of one run share."""

    def __init__(self, run, errors, station):
        self.run, self.errors = run, errors
        sol = run.sol
        self.t = (sol["t_ns"] - sol["t_ns"][0]) * 1e-9
        self.x, self.unit = clock(self.t)
        self.have = sol["fix"] != 0
        k = np.flatnonzero(self.have)
        self.enu = np.full((sol.size, 3), np.nan)
        self.base_enu = None
        if k.size:
            # Plane of the first position; the base is drawn if it is not far outside the track.
            self.origin = sol["r_eb_e"][k[0]]
            self.C = earth.C_e_n(sol["lat_rad"][k[0]], sol["lon_rad"][k[0]])[[1, 0, 2]] * np.array([[1], [1], [-1]])
            self.enu[k] = (sol["r_eb_e"][k] - self.origin) @ self.C.T
            self.enu[k, 2] = sol["height_m"][k]
            if station is not None:
                self.base_enu = self.C @ (station - self.origin)

    def track(self, ax):
        sol, e, n = self.run.sol, self.enu[:, 0], self.enu[:, 1]
        span = np.nanmax([np.nanmax(e) - np.nanmin(e), np.nanmax(n) - np.nanmin(n), 1e-3]) if self.have.any() else 1.0
        scale, unit = (1e-3, "km") if span > 5000 else (1.0, "m")
        step = max(1, sol.size // 6000)
        keep = np.zeros(sol.size, bool)
        keep[::step] = True
        fix = sol["fix"]
        keep[1:] |= fix[1:] != fix[:-1]       # no short stretch of another status may be thinned away
        keep &= self.have
        k = np.flatnonzero(keep)
        points = np.stack([e[k], n[k]], -1) * scale
        segments = np.stack([points[:-1], points[1:]], 1)
        fixes = fix[k][1:]
        for i in (3, 2, 1, 4, 0):
            chosen = segments[fixes == i]
            if chosen.size:
                word = frames.FIX[i]
                ax.add_collection(LineCollection(chosen, colors=STATUS_COLOUR[word], linewidths=1.6 if i == 3 else 2.4, label=word, capstyle="round"))
        if k.size:
            ax.plot(*points[0], "o", ms=5, mfc="white", mec=INK, label="start", zorder=5)
            ax.plot(*points[-1], "s", ms=5, mfc=INK, mec=INK, label="end", zorder=5)
        if self.base_enu is not None and np.hypot(*self.base_enu[:2]) < 3 * span + 100:
            ax.plot(*(self.base_enu[:2] * scale), "^", ms=7, mfc="#8a5fa8", mec="none", label="base", zorder=5)
        ax.margins(0.06)
        ax.autoscale_view()
        ax.set_aspect("equal", adjustable="datalim")
        ax.set_xlabel(f"east, {unit}")
        ax.set_ylabel(f"north, {unit}")
        ax.legend(loc="best", ncols=2, handlelength=1.2)

    def map(self):
        sol = self.run.sol
        fig = figure(10.6, 4.7)
        grid = fig.add_gridspec(2, 2, width_ratios=[1.35, 1])
        ax = fig.add_subplot(grid[:, 0])
        ax.set_title("Track")
        self.track(ax)
        ax = fig.add_subplot(grid[0, 1])
        ax.set_title("Height above the ellipsoid, m")
        ax.plot(*thin(self.x[self.have], self.enu[self.have, 2]), color=BLUE)
        ax = fig.add_subplot(grid[1, 1])
        ax.set_title("Speed, m/s")
        v = np.linalg.norm(sol["v_ned"].astype(float), axis=1)
        ax.plot(*thin(self.x[self.have], v[self.have]), color=BLUE)
        ax.set_ylim(bottom=0)
        ax.set_xlabel(self.unit)
        return fig

    def status_strip(self, ax):
        for a, b, code in runs(self.run.sol["fix"]):
            right = self.x[min(b + 1, self.x.size - 1)]
            ax.axvspan(self.x[a], right, color=STATUS_COLOUR[frames.FIX[min(code, 4)]], lw=0)
        ax.set_yticks([])
        ax.grid(False)
        ax.set_xlim(self.x[0], self.x[-1] if self.x.size > 1 else self.x[0] + 1)

    def timeline(self):
        sol = self.run.sol
        epoch = (sol["flags"] & frames.SOL_AT_EPOCH) != 0
        epoch = epoch if epoch.any() else np.ones(sol.size, bool)
        fig = figure(10.6, 4.3)
        strip, ratio, count = fig.subplots(3, 1, sharex=True, height_ratios=[0.22, 1, 0.8])
        strip.set_title("Status")
        self.status_strip(strip)
        seen = [w for i, w in enumerate(frames.FIX) if (sol["fix"] == i).any()]
        handles = [matplotlib.patches.Patch(color=STATUS_COLOUR[w], label=w) for w in seen]
        strip.legend(handles=handles, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=len(seen), borderaxespad=0.1)
        ratio.set_title("Ratio of second best to best")
        tried = epoch & (sol["ratio"] > 0)
        if tried.any():
            r = np.minimum(sol["ratio"].astype(float), 1e4)
            ok = tried & (sol["fix"] == 3)
            ratio.plot(*thin(self.x[ok], r[ok]), ".", ms=2, color=STATUS_COLOUR["fixed"], label="fixed", rasterized=True)
            no = tried & ~ok
            if no.any():
                ratio.plot(self.x[no], r[no], ".", ms=3, color=STATUS_COLOUR["float"], label="not fixed", rasterized=True)
            ratio.set_yscale("log")
            for axis_format in (ratio.yaxis.set_major_formatter, ratio.yaxis.set_minor_formatter):
                axis_format(lambda y, _: f"{y:g}" if f"{y:e}"[0] in "125" else "")
            ratio.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.1, markerscale=3)
        else:
            nothing(ratio, "no integer search in this run")
        count.set_title("Satellites used, integers fixed")
        count.plot(self.x[epoch], sol["n_sat"][epoch], drawstyle="steps-post", color=BLUE, label="satellites")
        count.plot(self.x[epoch], sol["n_fixed"][epoch], drawstyle="steps-post", color=STATUS_COLOUR["fixed"], label="integers")
        count.set_ylim(bottom=0)
        count.yaxis.set_major_locator(MaxNLocator(integer=True, nbins=5))
        count.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.1)
        count.set_xlabel(self.unit)
        return fig

    def error_panel(self, ax, group, i, factor, colour=BLUE):
        """One component within its three-sigma band; frame chosen for the bulk, what leaves it is counted."""
        e, s = self.errors.err[group][:, i] * factor, self.errors.sd[group][:, i] * factor
        ok = np.isfinite(e)
        x, e, s = self.x[ok], e[ok], 3 * s[ok]
        if not x.size:
            nothing(ax, "nothing to compare")
            return
        size = max(1, x.size // ROWS_OF_A_LINE)
        m = x.size // size * size
        bx, bs = x[:m].reshape(-1, size).mean(1), np.nanmax(np.nan_to_num(s[:m]).reshape(-1, size), axis=1)
        ax.fill_between(bx, -bs, bs, color=BAND, lw=0)
        ax.plot(*thin(x, e), color=colour, lw=0.7)
        # Medians: minutes of settling at the start must not flatten the rest.
        top = max(1.7 * np.nanmedian(s) if np.isfinite(s).any() else 0.0, 1.25 * np.percentile(np.abs(e), 75), 1e-12)
        top = min(top, 6.0 * np.percentile(np.abs(e), 95) + 1e-12)      # a band far too wide must not hide the error
        largest = np.abs(e).max()
        top = 1.05 * largest if top < largest < 1.7 * top else top
        ax.set_ylim(-top, top)
        outside = int(np.sum(np.abs(e) > top))
        if outside:
            ax.text(1.0, 1.01, f"{outside} beyond the frame, largest {largest:.3g}", transform=ax.transAxes, ha="right", va="bottom", color=MUTED, fontsize=7.5)
        ax.margins(x=0.005)

    def error_figure(self, group):
        names, factor, unit, title = {
            "pos": (("north", "east", "down"), *_scale(self.errors.err["pos"], (("mm", 1e3), ("cm", 1e2), ("m", 1.0))), "Position error"),
            "vel": (("north", "east", "down"), *_scale(self.errors.err.get("vel"), (("mm/s", 1e3), ("cm/s", 1e2), ("m/s", 1.0))), "Velocity error"),
            "att": (("about north", "about east", "heading"), *_scale(self.errors.err.get("att"), (("arcsec", stats.ARCSEC), ("deg", np.degrees(1.0)))), "Attitude error"),
        }[group]
        fig = figure(10.6, 3.9)
        axes = fig.subplots(3, 1, sharex=True)
        for i, ax in enumerate(axes):
            self.error_panel(ax, group, i, factor)
            ax.set_ylabel(names[i])
        axes[0].set_title(f"{title}, {unit}; band: 3 sigma as claimed")
        axes[-1].set_xlabel(self.unit)
        return fig

    def innovations(self):
        sol, sats = self.run.sol, self.run.frames.satellites
        fig = figure(10.6, 4.4)
        top, bottom = fig.subfigures(2, 1, height_ratios=[1, 1])
        ax = top.subplots()
        ax.set_title("Normalised innovation squared over its degrees of freedom, each epoch; line: mean of 60")
        k = ((sol["flags"] & frames.SOL_AT_EPOCH) != 0) & (sol["nis_dof"] > 0)
        if k.any():
            x, nis, dof = self.x[k], sol["nis"][k].astype(float), sol["nis_dof"][k].astype(float)
            low, high = chi2_mean_band(float(np.median(dof)))
            ax.axhspan(low, high, color=BAND, lw=0)
            ax.plot(*thin(x, nis / dof), ".", ms=1.6, color="#9db4c8", rasterized=True)
            w = min(60, nis.size)
            mean = np.convolve(nis, np.ones(w), "valid") / np.convolve(dof, np.ones(w), "valid")
            ax.plot(*thin(x[w // 2:w // 2 + mean.size], mean), color=BLUE)
            ax.axhline(1.0, color=MUTED, lw=0.8)
            ax.set_ylim(0, max(2.0, np.percentile(nis / dof, 99) * 1.2))
            ax.set_xlabel(self.unit)
            ax.margins(x=0.005)
        else:
            nothing(ax, "no epoch with innovations")
        z = np.linspace(-4.5, 4.5, 200)
        for ax, (title, value, sd, flag) in zip(bottom.subplots(1, 3), (
                ("Code", "innov_code_m", "sd_code_m", frames.SAT_CODE), ("Phase", "innov_phase_m", "sd_phase_m", frames.SAT_PHASE),
                ("Doppler", "innov_doppler_mps", "sd_doppler_mps", frames.SAT_DOPPLER))):
            ok = ((sats["flags"] & flag) != 0) & ((sats["flags"] & frames.SAT_PIVOT) == 0) & (sats[sd] > 0)
            ax.set_title(f"{title}: innovation / sigma")
            if not ok.any():
                nothing(ax, "not used")
                continue
            q = sats[value][ok].astype(float) / sats[sd][ok]
            ax.hist(np.clip(q, -4.5, 4.5), bins=45, range=(-4.5, 4.5), density=True, color="#9db4c8")
            ax.plot(z, np.exp(-z * z / 2) / np.sqrt(2 * np.pi), color=INK, lw=1)
            ax.set_yticks([])
            ax.grid(False)
            ax.text(0.98, 0.95, f"{q.size} rows\nmean {q.mean():+.2f}\nsd {q.std():.2f}", transform=ax.transAxes, ha="right", va="top", color=MUTED, fontsize=7.5)
        return fig

    def sky(self):
        sats = self.run.frames.satellites
        fig = figure(10.6, 4.4)
        left, right = fig.subfigures(1, 2, width_ratios=[1, 1.15])
        ax = left.add_subplot(projection="polar")
        ax.set_theta_zero_location("N")
        ax.set_theta_direction(-1)
        ax.set_rlim(0, 90)
        ax.set_rgrids([30, 60, 90], labels=["60°", "30°", "0°"], color=MUTED, fontsize=7)
        ax.set_thetagrids([0, 90, 180, 270], labels=["N", "E", "S", "W"])
        ax2 = right.subplots()
        ax2.set_title("C/N0 against elevation, dB-Hz")
        one = sats[sats["el_rad"] > 0]
        if not one.size:
            nothing(ax2, "no satellites reported")
            return fig
        step = max(1, one.size // 6000)
        some = one[::step]
        el = np.degrees(some["el_rad"])
        known = some["cn0_dbhz"] > 0
        shown = ax.scatter(some["az_rad"], 90 - el, c=np.where(known, some["cn0_dbhz"], np.nan), s=4, cmap=CN0_MAP, vmin=25, vmax=55,
                           plotnonfinite=True, lw=0, rasterized=True)
        for key in sorted({(int(s["sys"]), int(s["prn"])) for s in one}):
            mine = one[(one["sys"] == key[0]) & (one["prn"] == key[1])]
            last = mine[-1]
            ax.annotate(f"{frames.SYSTEM_LETTERS[key[0]]}{key[1]:02d}", (last["az_rad"], 90 - np.degrees(last["el_rad"])), fontsize=6.5,
                        color=INK, ha="center", va="bottom", xytext=(0, 2), textcoords="offset points")
        slips = one[(one["flags"] & frames.SAT_SLIP) != 0]
        if slips.size:
            ax.plot(slips["az_rad"], 90 - np.degrees(slips["el_rad"]), "x", ms=4, color=STATUS_COLOUR["coast"], label="slip, or new")
            ax.legend(loc="lower left", bbox_to_anchor=(-0.1, -0.12))
        left.colorbar(shown, ax=ax, shrink=0.6, pad=0.1, label="C/N0, dB-Hz").outline.set_visible(False)
        for i, name in enumerate(frames.CARRIERS):
            mine = known & (some["carrier"] == i)
            if mine.any():
                ax2.plot(el[mine], some["cn0_dbhz"][mine], ".", ms=2, label=name, rasterized=True,
                         color=("#24588c", "#c77f2a", "#2f8f5b", "#8a5fa8", "#c0504d", "#5c6670", "#2a9d9d")[i])
        if known.any():
            ax2.legend(markerscale=4, loc="lower right")
            ax2.set_xlabel("elevation, degrees")
        else:
            nothing(ax2, "the receiver reports none")
        return fig

    def biases(self):
        sol, errors = self.run.sol, self.errors
        k = (sol["flags"] & frames.SOL_INS) != 0
        fig = figure(10.6, 4.6)
        axes = fig.subplots(3, 2, sharex=True)
        parts = (("b_g", "sd_b_g", np.degrees(1.0) * 3600.0, "deg/h", "Gyro error"), ("b_a", "sd_b_a", 1e6 / 9.80665, "ug", "Accelerometer error"))
        for col, (name, sd, factor, unit, title) in enumerate(parts):
            truth = getattr(errors, name) if errors is not None else None
            axes[0, col].set_title(f"{title} (estimate, 1 sigma{', truth' if truth is not None else ''}), {unit}")
            for i in range(3):
                ax = axes[i, col]
                b, s = sol[name][k, i].astype(float) * factor, sol[sd][k, i].astype(float) * factor
                x, y = thin(self.x[k], b)
                xs, low = thin(self.x[k], b - s, 400)
                at = np.searchsorted(self.x[k], xs)
                ax.fill_between(xs, low, low + 2 * s[np.minimum(at, s.size - 1)], color=BAND, lw=0)
                ax.plot(x, y, color=BLUE)
                if truth is not None:
                    ax.plot(*thin(self.x[k], truth[k, i] * factor), color="#c77f2a", lw=0.9)
                    y = np.concatenate([y, truth[k, i][np.isfinite(truth[k, i])] * factor])
                late = s[s.size // 2:]
                spread = 4 * np.median(late) if late.size else 0.0
                ax.set_ylim(np.percentile(y, 2) - spread - 1e-9, np.percentile(y, 98) + spread + 1e-9)
                ax.set_ylabel(("right", "forward", "up")[i])
                ax.margins(x=0.005)
            axes[2, col].set_xlabel(self.unit)
        return fig

    def summary(self, title):
        """The README's picture: where it flew, and its errors within what it claims."""
        fig = figure(11.0, 5.0)
        left, right = fig.subfigures(1, 2, width_ratios=[1, 1.25])
        ax = left.subplots()
        ax.set_title(title)
        self.track(ax)
        groups = [g for g in ("pos", "att") if self.errors is not None and g in self.errors.err and np.isfinite(self.errors.err[g]).any()]
        axes = right.subplots(len(groups) * 3 + 1, 1, sharex=True, height_ratios=[1] * (3 * len(groups)) + [0.28])
        axes = np.atleast_1d(axes)
        for g, group in enumerate(groups):
            factor, unit = (1e3, "mm") if group == "pos" else (stats.ARCSEC, "arcsec")
            for i in range(3):
                a = axes[3 * g + i]
                self.error_panel(a, group, i, factor)
                a.set_ylabel(("N", "E", "D")[i], rotation=0, va="center")
                a.yaxis.set_major_locator(MaxNLocator(3))
            axes[3 * g].set_title(f"{'Position' if group == 'pos' else 'Attitude'} error, {unit}; band: 3 sigma as claimed")
        self.status_strip(axes[-1])
        axes[-1].set_ylabel("status", rotation=0, ha="right", va="center")
        axes[-1].set_xlabel(self.unit)
        return fig


def _scale(err, choices):
    """(factor, unit): the first unit in which the typical error is below a few hundred."""
    typical = np.nanpercentile(np.abs(err), 90) if err is not None and np.isfinite(err).any() else 0.0
    for unit, factor in choices[:-1]:
        if typical * factor < 300:
            return factor, unit
    return choices[-1][1], choices[-1][0]


def chi2_mean_band(dof):
    """95 % band of a chi-square variable over its degrees of freedom (Wilson and Hilferty, 1931)."""
    k = 2.0 / (9.0 * max(dof, 1.0))
    return (1 - k - 1.959964 * np.sqrt(k)) ** 3, (1 - k + 1.959964 * np.sqrt(k)) ** 3


def nothing(ax, words):
    ax.text(0.5, 0.5, words, transform=ax.transAxes, ha="center", va="center", color=MUTED)
    ax.set_xticks([])
    ax.set_yticks([])
    ax.grid(False)


def style():
    matplotlib.rcParams.update(STYLE)
