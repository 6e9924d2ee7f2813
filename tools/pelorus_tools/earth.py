"""WGS-84 and rotations, vectorised over rows. Frames and signs as in firmware/include/pelorus/earth.h; local axes are NED here."""

import numpy as np

A = 6378137.0
F = 1.0 / 298.257223563
E2 = F * (2.0 - F)


def llh_to_ecef(lat, lon, h):
    """Geodetic (rad, rad, m) -> ECEF, m, shape (..., 3)."""
    lat, lon, h = np.broadcast_arrays(lat, lon, h)
    n = A / np.sqrt(1.0 - E2 * np.sin(lat) ** 2)
    return np.stack([(n + h) * np.cos(lat) * np.cos(lon), (n + h) * np.cos(lat) * np.sin(lon),
                     (n * (1.0 - E2) + h) * np.sin(lat)], axis=-1)


def ecef_to_llh(r):
    """ECEF (..., 3) -> geodetic latitude, longitude (rad), height (m); Bowring with two refinements, below 1e-9 m."""
    x, y, z = r[..., 0], r[..., 1], r[..., 2]
    p = np.hypot(x, y)
    b = A * (1.0 - F)
    beta = np.arctan2(z * A, p * b)
    for _ in range(3):
        lat = np.arctan2(z + E2 / (1.0 - E2) * b * np.sin(beta) ** 3, p - E2 * A * np.cos(beta) ** 3)
        beta = np.arctan2((1.0 - F) * np.sin(lat), np.cos(lat))
    n = A / np.sqrt(1.0 - E2 * np.sin(lat) ** 2)
    h = p * np.cos(lat) + (z + E2 * n * np.sin(lat)) * np.sin(lat) - n
    return lat, np.arctan2(y, x), h


def C_e_n(lat, lon):
    """ECEF -> NED, shape (..., 3, 3): x_n = C x_e."""
    sl, cl, so, co = np.sin(lat), np.cos(lat), np.sin(lon), np.cos(lon)
    zero = np.zeros_like(sl)
    return np.stack([np.stack([-sl * co, -sl * so, cl], -1), np.stack([-so, co, zero], -1),
                     np.stack([-cl * co, -cl * so, -sl], -1)], -2)


def rotate(C, v):
    """C (..., 3, 3) applied to v (..., 3)."""
    return np.einsum("...ij,...j->...i", C, v)


def rpy_to_C_b_n(roll, pitch, heading):
    """Roll (right side down), pitch (nose up), heading (from north, clockwise) -> body (right, forward, up) to NED."""
    sr, cr, sp, cp = np.sin(roll), np.cos(roll), np.sin(pitch), np.cos(pitch)
    sh, ch = np.sin(heading), np.cos(heading)
    forward = np.stack([cp * ch, cp * sh, -sp], -1)
    right = np.stack([sr * sp * ch - cr * sh, sr * sp * sh + cr * ch, sr * cp], -1)
    up = -np.stack([cr * sp * ch + sr * sh, cr * sp * sh - sr * ch, cr * cp], -1)
    return np.stack([right, forward, up], -1)


def C_b_n_to_rpy(C):
    """Inverse of rpy_to_C_b_n, heading in [0, 2 pi)."""
    forward, right, up = C[..., :, 1], C[..., :, 0], C[..., :, 2]
    pitch = np.arctan2(-forward[..., 2], np.hypot(forward[..., 0], forward[..., 1]))
    roll = np.arctan2(right[..., 2], -up[..., 2])
    return roll, pitch, np.mod(np.arctan2(forward[..., 1], forward[..., 0]), 2.0 * np.pi)


def rotvec(C):
    """Rotation vector of C (..., 3, 3), good down to 1e-15 rad; angles up to pi."""
    axis = 0.5 * np.stack([C[..., 2, 1] - C[..., 1, 2], C[..., 0, 2] - C[..., 2, 0], C[..., 1, 0] - C[..., 0, 1]], -1)
    s = np.linalg.norm(axis, axis=-1)
    c = 0.5 * (np.trace(C, axis1=-2, axis2=-1) - 1.0)
    angle = np.arctan2(s, c)
    return axis * np.where(s > 1e-12, angle / np.where(s > 1e-12, s, 1.0), 1.0)[..., None]


def rotvec_to_dcm(v):
    """exp([v x]), shape (..., 3, 3)."""
    a2 = np.sum(v * v, axis=-1)
    a = np.sqrt(a2)
    small = a < 1e-4
    safe = np.where(small, 1.0, a)
    s = np.where(small, 1.0 - a2 / 6.0, np.sin(safe) / safe)
    k = np.where(small, 0.5 - a2 / 24.0, (1.0 - np.cos(safe)) / safe ** 2)
    zero = np.zeros_like(a)
    X = np.stack([np.stack([zero, -v[..., 2], v[..., 1]], -1), np.stack([v[..., 2], zero, -v[..., 0]], -1),
                  np.stack([-v[..., 1], v[..., 0], zero], -1)], -2)
    return np.eye(3) + s[..., None, None] * X + k[..., None, None] * (X @ X)
