"""A film over a run: a PyRunner whose command holds all that a frame needs, so that O.save keeps it.

Frame number k is that of the k-th call of the engine. YADE counts these calls (nDone) and saves their number, so a film needs no memory: where it
holds more than k frames, as after O.reload, it is cut first. The scales that grow with the frames are kept in the command, too.
"""
import atexit
import importlib.util
import os
import shutil
import subprocess

from . import scene

CALL = "__import__('cd_engine.pictures.frames', fromlist=['frame']).frame("  # needs no name in the user's program
ROOM = 0.1  # room added on each side of a view that has to grow, in parts of its larger side
_encoders = {}  # path of an mp4: (process of ffmpeg, number of frames that it has)


def check(path):
    """Raise ImportError or ValueError if films of this ending cannot be written here."""
    if path.lower().endswith(".gif"):
        if not importlib.util.find_spec("PIL"):
            raise ImportError("film: a .gif needs the Python package PIL, on Debian python3-pil")
    elif path.lower().endswith(".mp4") and not shutil.which("ffmpeg"):
        raise ValueError(f"film: {path!r} needs the program ffmpeg, which is not installed. Install Debian's package ffmpeg, or write a .gif")


def engine(path, every, options):
    """Return the PyRunner of a film. options: of a figure, and those of `frame`."""
    from yade.wrapper import PyRunner
    return PyRunner(command=_command(path, options, {}), virtPeriod=every, initRun=True)


def _command(path, options, scales):
    return f"{CALL}{path!r}, {options!r}, {scales!r})"


def frame(path, options, scales):
    """Add the next frame to the film at `path`; its engine calls this. Before the first disk is there, and after the last one has gone, it adds
    none. options: those of the film. scales: what has grown so far, see _grown."""
    from yade import O

    from . import layout
    runner = next(one for one in O.engines if getattr(one, "command", "").startswith(f"{CALL}{path!r}, "))
    try:
        seen = scene.read(options["look"])
    except scene.NoDisk:
        return
    scales = _grown(layout, seen, options, scales)
    runner.command = _command(path, options, scales)
    shown = options | scales
    fps, dpi, *_ = (shown.pop(name) for name in ("fps", "dpi", "size", "look"))
    fig = layout.figure(seen, **shown)
    fig.set_dpi(dpi)
    ending = os.path.splitext(path)[1].lower()
    {".gif": _add_to_gif, ".mp4": _add_to_mp4, ".png": _add_picture}[ending](path, fig, runner.nDone - 1, fps)


def _grown(layout, seen, options, scales):
    """Return the scales large enough for this frame and for those before, where the user has not given them, and the shape of the first frame."""
    drawing, new = layout.drawing, {}
    if options["view"] is None:
        new["view"] = _view(drawing, seen, scales.get("view"))
    if "shape" not in scales:
        new["shape"] = layout.shape_of(options["view"] or new["view"], options["size"])
    if options["limits"] is None and options["colour"] is not None:
        limits = layout.colour_range(seen, options["colour"], layout.coloured(seen, options["colour"])[1])
        old = scales.get("limits", limits)
        new["limits"] = min(old[0], limits[0]), max(old[1], limits[1])
    if options["strongest"] is None and len(seen.link_force):
        new["strongest"] = max(scales.get("strongest", 0), drawing.scale(seen.link_force))
    return scales | {name: tuple(map(float, value)) if isinstance(value, tuple) else float(value) for name, value in new.items()}


def _view(drawing, seen, former):
    """Return the former view, or a larger one with room to spare if a disk has left it."""
    if former is None:
        return drawing.bounds(seen.position, seen.radius, seen.boxes, seen.walls)
    (left, bottom), (right, top) = drawing.hull(seen.position, seen.radius)
    room = ROOM * max(former[1] - former[0], former[3] - former[2])
    return tuple(old + sign * (room + sign * (now - old)) if sign * (now - old) > 0 else old
                 for old, now, sign in zip(former, (left, right, bottom, top), (-1, 1, -1, 1)))


def _pixels(fig):
    """Return a figure as an array of RGBA pixels."""
    fig.canvas.draw()
    return fig.canvas.buffer_rgba()


def _add_to_gif(path, fig, number, fps):
    from PIL import Image

    from . import gif
    pixels = _pixels(fig)
    gif.write(path, Image.frombuffer("RGBA", pixels.shape[1::-1], pixels, "raw", "RGBA", 0, 1).convert("RGB"), number, 1 / fps)


def _add_picture(path, fig, number, fps):
    """Write frame number 3 of drum.png to drum-00003.png. Those with higher numbers, of a longer run before, are removed."""
    stem, ending = os.path.splitext(path)
    fig.savefig(f"{stem}-{number:05}{ending}")
    while os.path.exists(later := f"{stem}-{(number := number + 1):05}{ending}"):
        os.remove(later)


def _add_to_mp4(path, fig, number, fps):
    """Give a frame to ffmpeg, which this process keeps running for each film. It completes the film when its input ends, as when YADE is killed."""
    process, count = _encoders.get(path, (None, 0))
    if process is None or number != count:  # as in a scene that was loaded
        if process:
            _finish(path)
        height, width = _pixels(fig).shape[:2]
        process = subprocess.Popen(
            ["ffmpeg", "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgba", "-s", f"{width}x{height}", "-r", f"{fps:g}", "-i", "-",
             "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p", "-g", "10", "-movflags", "frag_keyframe+empty_moov", path],
            stdin=subprocess.PIPE, start_new_session=True)  # a Ctrl-C at YADE's console does not end it
        if not _encoders:
            atexit.register(lambda: [_finish(one) for one in list(_encoders)])
    process.stdin.write(_pixels(fig))
    process.stdin.flush()
    _encoders[path] = process, number + 1


def _finish(path):
    process, _ = _encoders.pop(path)
    process.stdin.close()
    process.wait()
