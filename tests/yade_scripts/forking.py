"""A YADE that starts once for many scripts, each in a fork of its own: to start takes a second, to fork some milliseconds.

    yade -n -x forking.py     reads a request a line, {"arguments": [script, ...], "folder": ..., "environment": {...}, "outputs": [two files]},
                              and answers each with a line: status, and the exit status

A script finds what it finds in a YADE started for it, also of names, and it ends as there. Of what is loaded before it, nothing is ours.
"""


def _next_script():
    """Return in a fork, with the script's code."""
    import gc
    import importlib
    import json
    import os
    import signal
    import sys
    for module in ("h5py", "numpy", "scipy.sparse.linalg"):  # cost as much as a short run
        importlib.import_module(module)
    gc.freeze()  # the children need not look through, and so copy, what will stay
    for line in sys.stdin:
        sys.stdout.flush()
        child = os.fork()
        if not child:
            break
        print("status", os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)
    else:
        sys.exit()
    signal.alarm(1200)  # ends a script that hangs
    request = json.loads(line)
    for number, name in enumerate((os.devnull, *request["outputs"])):
        os.dup2(os.open(name, os.O_RDWR | os.O_CREAT | os.O_TRUNC), number)
    os.chdir(request["folder"])
    os.environ.update(request["environment"])
    sys.argv[:] = request["arguments"]
    with open(sys.argv[0], encoding="utf-8") as text:
        return compile(text.read(), sys.argv[0], "exec")


exec(_next_script())
