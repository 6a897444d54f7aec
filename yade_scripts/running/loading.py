"""The stresses that the loading asks for, as functions of time; compression positive. Needs no YADE."""
import math


def goals(full, p0):
    """Return the function t -> (sigma1, sigma2) [Pa] that a full row of parameters asks for.

    ramp: the paper's eq. 1. cosine: its eq. 7. triangle: sigma2 rises linearly to P0 (1 + dSigma) in half a period t0 and falls at the same rate
    (text of its Fig. 4).
    """
    rise = {"ramp": lambda t: full["ramp_rate"] * t,
            "cosine": lambda t: full["delta_sigma"] / 2 * (1 - math.cos(2 * math.pi * t / full["period"])),
            "triangle": lambda t: full["delta_sigma"] * (1 - abs(1 - 2 * ((t / full["period"]) % 1.0)))}[full["loading"]]

    def sigma2(t):
        return p0 * (1 + rise(t))
    return (lambda t: (2 * p0 - sigma2(t), sigma2(t))) if full["stress_path"] == "mean" else lambda t: (p0, sigma2(t))
