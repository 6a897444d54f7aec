"""Runs a scene to its end and draws it: disks with their speeds and rotation, boundaries, and the forces between them.

    yade -n -x yade_scripts/picture.py scene=drum method=CD disks=500
    yade -n -x yade_scripts/picture.py scene=collapse --film=0.02        also a film, with a frame for each 0.02 s of the scene

The picture lies where the run's result file would: results/<scene>-<method>-<hash of the row>.png, the film beside it as .gif. No result is written
or read. For pictures of another look start the scene at the console (console.py), and see help(cd_engine.picture).
Exit status: 0 done, 1 the run ended early, and the picture shows its last state, 2 the row cannot be run.
"""
import pathlib
import sys

if __name__ == "__main__":
    file = sys._getframe().f_code.co_filename  # YADE sets no __file__
    sys.path.insert(0, str(pathlib.Path(file).resolve().parents[1]))
    from yade_scripts import commands
    commands.script("yade_scripts.picture", file)

from yade_scripts import commands, parameters, results, tables


def show(full, folder=results.FOLDER, film=None):
    """Run the scene of a full row and write its picture, and a film with a frame for each `film` [s]. Return the exit status."""
    from yade import O

    import cd_engine
    from yade_scripts import scenes
    results.make(folder)
    path, status = results.path_of(full, folder), 0
    scene = scenes.build(full, folder)
    if film:
        O.engines = O.engines + [cd_engine.film(path.with_suffix(".gif"), every=film)]
    try:
        scenes.method(full).run(scene)
    except RuntimeError as error:
        print(f"picture: the run ended at {O.time:g} s: {error}", file=sys.stderr)
        status = 1
    cd_engine.picture(path.with_suffix(".png"))
    print(*(path.with_suffix(ending) for ending in (".png", ".gif")[:2 if film else 1]), sep="\n")
    return status


@commands.command("picture")
def main(arguments=None):
    parser = commands.parser(__doc__, "row", "--results")
    parser.add_argument("--film", type=commands.positive, metavar="SECONDS", help="time of the scene between two frames of a film (default: no film)")
    options = parser.parse_intermixed_args(arguments)
    return show(parameters.complete(tables.given(options.row)), options.results, options.film)

