"""Checks the precision of the running YADE: Debian packages four, and their files are not interchangeable."""


def check():
    """Raise ImportError unless this YADE computes in double precision, as results, prepared states and the engine do."""
    from yade import config
    if config.highPrecisionName != "PrecisionDouble":
        raise ImportError(f"scenes, states and results are of YADE in double precision; this is {config.version} with "
                          f"{config.highPrecisionDecimalPlaces} decimal places, from {config.libDir}. Start `yade` or `yade-double`.")
