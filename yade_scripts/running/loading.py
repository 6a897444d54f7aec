"""The stresses that the loading asks for, as functions of time; compression positive. Plain functions, no YADE."""
import math


def cosine(t, p0, delta_sigma, t0):
    """Return sigma2 [Pa] of the paper's eq. 7: P0 [1 + dSigma/2 (1 - cos(2 pi t/t0))]."""
    return p0 * (1 + delta_sigma / 2 * (1 - math.cos(2 * math.pi * t / t0)))


def triangle(t, p0, delta_sigma, t0):
    """Return sigma2 [Pa] rising linearly from P0 to P0 (1 + dSigma) in half a period and falling at the same rate (text of the paper's Fig. 4)."""
    phase = (t / t0) % 1.0
    return p0 * (1 + delta_sigma * (1 - abs(1 - 2 * phase)))


def ramp(t, p0, alpha):
    """Return sigma2 [Pa] of the paper's eq. 1: P0 (1 + alpha t)."""
    return p0 * (1 + alpha * t)


def goals(full, p0):
    """Return the function t -> (sigma1, sigma2) [Pa] that a full row of parameters asks for."""
    sigma2 = {"ramp": lambda t: ramp(t, p0, full["ramp_rate"]), "cosine": lambda t: cosine(t, p0, full["delta_sigma"], full["period"]),
              "triangle": lambda t: triangle(t, p0, full["delta_sigma"], full["period"])}[full["loading"]]
    return (lambda t: (2 * p0 - sigma2(t), sigma2(t))) if full["stress_path"] == "mean" else lambda t: (p0, sigma2(t))
