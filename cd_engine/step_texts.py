"""What ContactDynamics says of a step that went wrong, and what to do. Its plug-in decides when to say it, and prints it."""

DEEP = 0.01  # of the smallest radius: a larger overlap is no longer just an error of a time step
LOOSE = 1e-3  # tolerance above which pushing out the overlaps that it leaves would stir a packing


def unsolved(engine, step):
    """Return why a step is not solved."""
    begin = f"ContactDynamics: step {step} is not solved ({engine.status} after {engine.iterations} iterations): "
    tolerance, doubt = engine.stepTolerance, ""
    if engine.unsolvableContact:
        first, second = engine.unsolvableContact
        if engine.status == "no_solution":
            return begin + (f"bodies #{first} and #{second} are squeezed or wedged, and no solution was found. Look for boundaries that move towards "
                            "each other with disks between them; one that is to press with a force needs a mass, free directions and "
                            "O.forces.setPermF instead of a velocity. With friction there may still be a solution, which another method or seed may "
                            "find. Do not trust the steps that follow.")
        doubt = f" It may have no solution; the strongest sign of this is the contact of bodies #{first} and #{second}."
    if engine.residual <= tolerance and engine.bodyError <= tolerance:
        fault = "contacts that carry load still close." if doubt else "the error of the contact law weighted by W_nn is larger."
        return begin + (f"the error of the contact law, relative to all impulses, and that of the bodies are within the tolerance of {tolerance:g}, "
                        f"but {fault}{doubt} Take a smaller O.dt.")
    body = (f", and the velocity change of body #{engine.worstBody} may be wrong by {engine.bodyError:g}, relative to what acts on it"
            if engine.worstBody >= 0 else "")
    remedy = ("More iterations do not help: set a larger tolerance" if engine.status == "stagnated" else
              "Raise maxIterations or set a larger tolerance")
    return begin + (f"the error of the contact law is {engine.residual:g}, relative to all impulses{body}; the tolerance is {tolerance:g}. {remedy}, "
                    f"or take a smaller O.dt.{doubt}")


def lost(engine, step, body, place, speed):
    """Return that a body has left the scene, which it does not come back to."""
    return (f"ContactDynamics: step {step}: body #{body} has left the scene: it is at {place}, at {speed:g} m/s. Erase it "
            f"(O.bodies.erase({body})) or give the scene a boundary that holds it. Further bodies that leave are not reported.")


def fast(engine, step, body, other, radii, dt):
    """Return that a disk moves so many of its radii in a step relative to another body."""
    return (f"ContactDynamics: step {step}: body #{body} moves {radii:g} times its radius in a step relative to body #{other} and may jump over it. "
            f"O.dt is {dt:g} s: take a smaller one. cd_engine.timeStep() proposes one by sizes, speeds, gravity and permanent forces; it does not "
            "know others, which may grow without bound, such as a strong drag. Further such bodies are not reported.")


def penetration(engine, step, first, second, behind, grown, explained, smallest, longest, dt):
    """Return that two bodies overlap, and what to do. grown, explained: by how much in this step, and how much of that their speed explains [m];
    behind: in what way a body is behind a Wall of one side, or empty; longest: the longest way of a body in the step, in smallest radii."""
    overlap = engine.maxPenetration
    remedy = _against_overlap(engine, behind, grown, grown > explained, smallest, longest, dt)
    return (f"ContactDynamics: step {step}: bodies #{first} and #{second} overlap by {overlap:g} m, {overlap / smallest:g} of the smallest radius, "
            f"beyond what was there when Contact Dynamics began. {remedy}. The attribute deepestPenetration gives the largest overlap of all steps.")


def _against_overlap(engine, behind, grown, unexplained, smallest, longest, dt):
    """Return the reason of an overlap, and the remedy.

    e, relative to all impulses, is small long before a heavy body on a light one is carried; fixedIterations demand no error; small errors add up;
    and a step may be too long for the speed or rotation of the bodies."""
    at_once, misses = grown > 0.5 * DEEP * smallest, not engine.converged or engine.fixedIterations > 0
    sweeps = "fixedIterations" if engine.fixedIterations > 0 else "maxIterations"
    springs = engine.materialStiffness or engine.stiffness < float("inf")
    if at_once and unexplained and not (springs and engine.steps == 1):  # other springs may have left any overlap
        pushed = ", or set gapCorrection=0.1, which pushes overlaps out" if engine.gapCorrection == 0 and engine.maxPenetration < smallest else ""
        return "No speed explains it: " + (behind or "bodies were put there, moved, turned or resized, or have overlapped from the start "
                                                     f"(handover=False). Move them apart{pushed}")
    if springs:
        return "The springs are too soft for what presses on them, or the step is too long: raise the stiffness, or take a smaller O.dt"
    if engine.restitution > 0 and (at_once or not misses):
        return ("A contact that impulses of other contacts close rebounds only in the next step, and until then it overlaps by up to its closing "
                "speed times O.dt. Take a smaller O.dt")
    if at_once:
        # The step in which no disk moves by more than a quarter of a radius, or, if that is longer, leaves half of what is reported, since a small
        # overlap that comes at once is proportional to O.dt.
        shorter = dt * min(0.5, max(0.25 / longest if longest else float("inf"), 0.5 * DEEP * smallest / grown))
        return (f"It came in this one step, which is {'not solved, or ' if misses else ''}too long for the speed of the bodies: take a smaller O.dt, "
                f"about {shorter:.2g} s{f', or raise {sweeps}' if misses else ''}")
    if engine.fixedIterations > 0:
        return "The forces that hold them apart are too small: raise fixedIterations"
    if misses:
        return ("The forces that hold them apart are too small, since the step missed its tolerance: raise maxIterations. If that does not help, a "
                "body may be jammed, and rigid contacts cannot carry what moves on: set materialStiffness=True")
    if engine.stepTolerance > LOOSE:
        return "It grew step by step, since solver errors within the tolerance add up: lower tolerance to 1e-4 or less"
    if engine.gapCorrection > 0:
        return "It grew step by step by more than gapCorrection pushes out: take a smaller O.dt, or lower tolerance"
    return ("It grew step by step, since solver errors within the tolerance add up, a boundary changes its velocity (by the change times O.dt/2), or "
            "disks grow. Means over a flow bear overlaps of some hundredths of a radius; else take a smaller O.dt, lower tolerance, or set "
            "gapCorrection=0.1, which removes overlaps")
