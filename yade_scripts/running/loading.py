"""The stresses that the loading asks for, as settings of cd_engine.PlateLoads, whose signs are YADE's: compression negative. Needs no YADE."""

from yade_scripts import parameters


def of_row(full, p0):
    """Return the settings that a full row of parameters asks for, sigma1 = sigma2 = p0 [Pa] at first.

    ramp: the paper's eq. 1. cosine: its eq. 7. triangle: sigma2 rises linearly to P0 (1 + dSigma) in half a period t0 and falls at the same rate
    (text of its Fig. 4).
    """
    rise = full["ramp_rate" if full["loading"] == "ramp" else "delta_sigma"]
    return constant(p0, parameters.in_space(full)) | {"loading": full["loading"], "rise": (0, rise, 0), "period": full["period"],
                                                      "holdMean": full["stress_path"] == "mean"}


def constant(p0, space=False):
    """Return the settings for sigma1 = sigma2 = p0 [Pa], in space sigma3, too."""
    return {"goals": (-p0, -p0, -p0 if space else 0)}
