"""Runs a scene to its end and draws it: disks with their speeds and rotation, boundaries, and the forces between them.

    yade -n -x yade_scripts/picture.py scene=drum method=CD disks=500
    yade -n -x yade_scripts/picture.py scene=collapse --film=0.02        also a film, with a frame for each 0.02 s of the scene

The picture lies where the run's result file would, results/<scene>-<method>-<hash of the row>.png, the film beside it as .gif. No result is written
or read. Pictures of another look: start the scene at the console (console.py), and see help(cd_engine.picture).
"""
import pathlib
import sys

if __name__ == "__main__":
    sys.path.insert(0, str(pathlib.Path(sys.argv[0]).resolve().parent.parent))

from yade_scripts import commands, parameters, results


@commands.command("picture")
def main(arguments=None):
    from yade import O

    import cd_engine
    from yade_scripts import scenes
    from yade_scripts.running import wall_check
    parser = commands.parser(__doc__, "row", "--results")
    parser.add_argument("--film", type=commands.positive, metavar="SECONDS", help="time of the scene between two frames of a film (default: no film)")
    options = parser.parse_intermixed_args(arguments)
    full = parameters.complete(parameters.from_arguments(options.row))
    results.make(options.results)
    path = results.path_of(full, options.results)
    scene = scenes.build(full, options.results)
    if options.film:
        O.engines = O.engines + [cd_engine.film(str(path.with_suffix(".gif")), every=options.film)]
    try:
        scenes.method(full).run(scene)
    except wall_check.Collapse as event:
        print(f"{path.stem}: collapsed: {event}")
    cd_engine.picture(path.with_suffix(".png"))
    print(*(path.with_suffix(ending) for ending in (".png", ".gif")[:1 + bool(options.film)]), sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
