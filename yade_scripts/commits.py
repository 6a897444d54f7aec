"""Which code a result was made by. Needs no YADE."""
import pathlib
import subprocess


def git_commit():
    """Commit of this project, '-dirty' added where tracked files differ, 'unknown' outside a clone."""
    def git(*arguments):
        return subprocess.run(["git", "-C", str(pathlib.Path(__file__).parent), *arguments], capture_output=True, text=True).stdout.strip()

    commit = git("rev-parse", "--verify", "--quiet", "HEAD")
    return (commit + ("-dirty" if git("status", "--porcelain", "--untracked-files=no") else "")) or "unknown"
