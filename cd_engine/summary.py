"""What ContactDynamics.summary() prints: how the engine is set and how its steps went, on one screen."""


def text(engine):
    """Return lines about the settings, the last step and all steps of an engine, as one text."""
    lines = [f"ContactDynamics: method {engine.method}, tolerance {engine.tolerance:g}, at most {engine.maxIterations} iterations a step, "
             f"restitution {engine.restitution:g}, gapCorrection {engine.gapCorrection:g} beyond {engine.allowedOverlap:g} radii, gravity {tuple(engine.gravity)} m/s^2"]
    if engine.fixedIterations:
        lines[0] += f", exactly {engine.fixedIterations} sweeps"
    if not engine.steps:
        return "\n".join(lines + ["No step yet."])
    lines += [
        f"Last step: {engine.status} after {engine.iterations} iterations (solved by {engine.solvedBy}); error of the contacts {engine.residual:.2g}, "
        f"of the bodies {engine.bodyError:.2g}",
        f"  {engine.contacts} contacts, {engine.loadedContacts} loaded, {engine.slidingContacts} sliding; {engine.islands} islands, {engine.sleeping} asleep; "
        f"overlap at most {engine.maxPenetration:.2g} m",
        f"All {engine.steps} steps: {engine.unconvergedSteps} missed the tolerance; {engine.totalIterations / engine.steps:.3g} iterations and "
        f"{1e3 * engine.solveTime / engine.steps:.3g} ms in the solver a step; overlap at most {engine.deepestPenetration:.2g} m; "
        f"{engine.dissipatedEnergy:.3g} J lost in friction and impacts",
    ]
    if engine.woken:
        lines.append(f"Woken last in {engine.woken}")
    if engine.handoverOverlap > 1e-12:  # else round-off
        lines.append(f"Overlaps of up to {engine.handoverOverlap:.2g} m were there at the start and count as touching")
    if engine.unsolvableContact:
        lines.insert(2, f"  no velocities keep bodies #{engine.unsolvableContact[0]} and #{engine.unsolvableContact[1]} apart")
    elif engine.worstBody >= 0 and not engine.converged:
        lines.insert(2, f"  the velocity of body #{engine.worstBody} may be the most wrong")
    return "\n".join(lines)
