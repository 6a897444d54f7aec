"""The console, driven through a pseudo-terminal as a user would."""
import os
import pty
import re
import select
import subprocess
import time

from .conftest import SCRIPTS


def read_until(terminal, pattern, seconds=600):
    """What the terminal shows up to `pattern`; answers its questions for the cursor's place on the way."""
    shown, end = "", time.monotonic() + seconds
    while not re.search(pattern, shown):
        assert time.monotonic() < end, f"{pattern!r} never came; the terminal shows:\n{shown}"
        if select.select([terminal], [], [], 0.5)[0]:
            piece = os.read(terminal, 65536).decode(errors="replace")
            shown += piece
            if "\x1b[6n" in piece:
                os.write(terminal, b"\x1b[1;1R")
    return shown


def test_console_is_ready_for_o_run(yade60):
    """Greeting, 100 CD steps, a switch to MD, and the end. What is typed is echoed, so the answers are computed."""
    master, slave = pty.openpty()
    environment = {name: value for name, value in os.environ.items() if name != "DISPLAY"} | {"TERM": "xterm"}
    console = subprocess.Popen(["yade", str(SCRIPTS / "console.py"), "disks=60"], stdin=slave, stdout=slave, stderr=slave,
                               cwd=yade60.folder, env=environment, start_new_session=True)
    os.close(slave)
    try:
        assert "contact_dynamics" in read_until(master, r"In \[")
        for line, answer in (
                ("O.run(100, True); print('made', 2 * O.iter, contact_dynamics.converged)", "made 200 True"),
                ("s = start(friction=0.2); O.run(30, True); print('still', 2 * O.iter, contact_dynamics.tolerance > 0)", "still 60 True"),
                ("print(len(help.__class__.__name__), 'To set' in cd_engine.ContactDynamics.__doc__, plot.__name__)", "True yade.plot"),
                ("s = start(method='MD'); O.run(70, True); print('now', 2 * O.iter, len(O.engines), row['friction'])", r"now 140 \d+ 0.2"),
                ("s = start(scene='cradle', gap=0.1, disks=3); s = start(scene='stack'); print('gap' in row, row['scene'])", "False stack"),
                ("s = start(friktion=0.2); print('kept', 2 * O.iter, row['scene'])", r"did you mean friction[\s\S]*kept 0 stack"),
                ("s = start(scene='nope'); print('same', row['scene'])", r"scene = 'nope': must be one of [\s\S]*same stack")):
            os.write(master, line.encode() + b"\r")
            read_until(master, answer)
        os.write(master, b"exit()\r")
        deadline = time.monotonic() + 30
        while console.poll() is None and time.monotonic() < deadline:
            if select.select([master], [], [], 0.2)[0]:
                try:
                    os.read(master, 65536)
                except OSError:
                    break
        assert console.wait(10) == 0
    finally:
        if console.poll() is None:
            console.kill()
        os.close(master)


def test_a_mistake_ends_the_console_as_any_command(tmp_path):
    done = subprocess.run(["yade", str(SCRIPTS / "console.py"), "nonsense=1"], cwd=tmp_path, stdin=subprocess.DEVNULL, capture_output=True, text=True)
    assert done.returncode == 2 and "console: unknown parameter 'nonsense'" in done.stderr
