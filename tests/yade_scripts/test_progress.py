"""The time left is shown only once it can be estimated."""
from yade_scripts.running import progress


def test_no_time_is_told_from_the_first_steps(capsys):
    """They may take a hundred times as long as others."""
    show = progress.Progress("run")
    show.bar.mininterval = 0
    for fraction in (0.5, 0.501, 0.51, 0.53, 0.6):
        show(fraction)
    show.close()
    told = {line.split(",")[0]: line for line in capsys.readouterr().out.replace("\r", "\n").splitlines() if line.startswith("run")}
    assert told["run: 51 %"].endswith("? left") and "? left" not in told["run: 53 %"] and "? left" not in told["run: 60 %"]
