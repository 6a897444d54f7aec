"""Python text that runs in a process of its own, with the repository on the path. Both functions return the finished process."""
import os
import subprocess
import sys

from ..conftest import ROOT


def in_yade(folder, text, command="yade"):
    """Run it as a script of YADE in this folder."""
    (folder / "script.py").write_text(f"import sys\nsys.path.insert(0, {str(ROOT)!r})\n{text}")
    return subprocess.run([command, "-n", "-x", "script.py"], cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=600)


def in_python(text, **environment):
    """Run it in Debian's Python, where it can import YADE."""
    return subprocess.run([sys.executable, "-c", f"import sys\nsys.path[:0] = {sys.path!r}\n{text}"], env=os.environ | environment,
                          capture_output=True, text=True, timeout=600)
