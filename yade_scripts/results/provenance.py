"""The code and the processor that made a result."""
import functools
import glob
import hashlib
import pathlib
import platform
import subprocess


@functools.cache
def git_commit():
    """Return the commit of this project; 'unknown' outside a clone or without git.

    '-dirty' is appended if tracked files differ, if there are Python files that git does not know: a scene or study of one's own, or if the engine
    was built of other sources.
    """
    def git(*arguments):
        return subprocess.run(["git", "-C", str(pathlib.Path(__file__).parent), *arguments], capture_output=True, text=True).stdout.strip()

    try:
        commit = git("rev-parse", "--verify", "--quiet", "HEAD")
        own = git("ls-files", "--others", "--exclude-standard",
                  *(f":(top,glob){folder}/**/*.py" for folder in ("cd_engine", "yade_scripts", "analysis")))
        dirty = own or git("status", "--porcelain", "--untracked-files=no") or not _engine_is_of_these_sources()
        return commit + "-dirty" * bool(dirty) if commit else "unknown"
    except OSError:
        return "unknown"


def _engine_is_of_these_sources():
    """Tell whether the engine was built of the sources that are here, by the checksums that cd_engine/Makefile has written."""
    folder = pathlib.Path(__file__).parents[2] / "cd_engine"
    sources = sorted(name for pattern in ("Makefile", "**/*.[ch]pp", "**/*.inl") for name in glob.glob(pattern, root_dir=folder, recursive=True))
    built = folder / "build" / "sources.sha256"
    now = "".join(f"{hashlib.sha256((folder / name).read_bytes()).hexdigest()}  {name}\n" for name in sources)
    return now == (built.read_text(encoding="utf-8") if built.exists() else "")


def doubt(commits):
    """Return a predicate in words if results of these commits may come from other code than the present one, else an empty text."""
    now = git_commit()
    words = lambda commit: short(commit).replace("-dirty", " with changes that are not committed or not built")
    others = sorted({words(commit) for commit in commits if commit != now or commit.endswith(("-dirty", "unknown"))})
    today = f"; the code is at {words(now)}" * (others != [words(now)])
    return f"may come from other code (commit {', '.join(others)}{today}). Delete a file to run it again." if others else ""


def processor():
    """Return the processor's name as Linux reports it."""
    lines = pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), platform.machine())


def short(commit):
    """Return the first twelve digits of a commit's hash, with the suffix that follows the hash."""
    digits, dash, suffix = commit.partition("-")
    return digits[:12] + dash + suffix


def words(commits):
    """Return words for a figure's caption: the commit of the code that made it, or the number of commits."""
    return f"commit {short(*commits)}" if len(commits) == 1 else f"{len(commits)} different commits"
