"""Runs a Slurm of the tests on this machine: one controller, node daemons n0 and n1 with one core each, keys and state in one folder.

Everything runs as the calling user, in the foreground, under this process; a Slurm of the machine is neither read nor changed.
"""
import getpass
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import time

SERVERS = os.pathsep.join([os.environ.get("PATH", ""), "/usr/sbin", "/sbin"])
NODES = ("n0", "n1")
CONFIGURATION = """\
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
# A task of a node that died may start again after cred_expire; the default is two minutes.
AuthInfo=socket={folder}/munge/socket,cred_expire=10
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerType=sched/builtin
SchedulerParameters=sched_interval=1,batch_sched_delay=0
SlurmdTimeout=10
KillWait=2
SlurmdParameters=config_overrides
NodeName=n[0-1] NodeHostname={host} NodeAddr=127.0.0.1 Port=[{ports[1]}-{ports[2]}] CPUs=1
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""

# Nothing is confined by control groups; with this plugin slurmd also starts where none are mounted, in a change of root for one.
CGROUPS = "CgroupPlugin=cgroup/v1\n"


def missing():
    """Programs that a Slurm needs and that are not here."""
    return [name for name in ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "scontrol") if shutil.which(name, path=SERVERS) is None]


def until(condition, seconds, what):
    """Wait for a condition; its value."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        value = condition()
        if value:
            return value
        time.sleep(0.3)
    raise TimeoutError(f"after {seconds} s: no {what}")


def _ports():
    """One free port, and two free ones in a row."""
    for first in range(20000 + os.getpid() % 10000, 60000, 3):
        try:
            for port in range(first, first + 3):
                with socket.socket() as probe:
                    probe.bind(("127.0.0.1", port))
        except OSError:
            continue
        return first, first + 1, first + 2


class Cluster:
    """Context: the servers run; `environment` leads Slurm's commands to them."""

    def __init__(self, folder):
        self.folder, self.servers = pathlib.Path(folder), {}
        self.environment = os.environ | {"SLURM_CONF": str(self.folder / "slurm.conf")}

    def __enter__(self):
        for name in ("munge", "state", *NODES):
            (self.folder / name).mkdir(parents=True, mode=0o700)
        (self.folder / "slurm.conf").write_text(CONFIGURATION.format(host=socket.gethostname(), user=getpass.getuser(), folder=self.folder,
                                                                     ports=_ports()))
        (self.folder / "cgroup.conf").write_text(CGROUPS)
        key = self.folder / "munge" / "key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o600)
        files = {"socket": "socket", "key-file": "key", "pid-file": "pid", "seed-file": "seed", "log-file": "log"}
        try:
            # --force: munged only warns of folders above the socket that others may write to.
            self._start("munged", "--foreground", "--force", *(f"--{option}={self.folder}/munge/{file}" for option, file in files.items()))
            until((self.folder / "munge" / "socket").exists, 20, "socket of munged")
            self._start("slurmctld", "-D", "-i")
            for node in NODES:
                self._start("slurmd", "-D", "-N", node, name=node)
            until(self._idle, 40, "idle nodes")
        except BaseException:
            self.__exit__()
            raise
        return self

    def _idle(self):
        """Whether all nodes wait for work; RuntimeError, with its last words, if a server has ended."""
        for name, server in self.servers.items():
            if server.poll() is not None:
                last = (self.folder / f"{name}.out").read_text().splitlines()[-5:]
                raise RuntimeError(f"{name} of the test's Slurm ended with {server.returncode}:\n" + "\n".join(last))
        return self.ask("sinfo", "-h", "-N", "-o", "%T").split() == ["idle"] * len(NODES)

    def _start(self, program, *arguments, name=None):
        with open(self.folder / f"{name or program}.out", "w") as log:
            self.servers[name or program] = subprocess.Popen([shutil.which(program, path=SERVERS), *arguments], env=self.environment,
                                                             stdin=subprocess.DEVNULL,
                                                             stdout=log, stderr=subprocess.STDOUT)

    def __exit__(self, *_):
        for node in NODES:
            self._end_work(node)
        for server in self.servers.values():
            server.kill()
            server.wait()

    def ask(self, *command):
        """What a command of Slurm prints."""
        return subprocess.run(command, env=self.environment, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60).stdout

    def tasks(self):
        """{index in its array: (state, node)} of what is in the queue."""
        lines = self.ask("squeue", "-h", "-r", "-o", "%K %T %N").splitlines()
        return {int(words[0]): (words[1], words[2] if len(words) > 2 else None) for words in map(str.split, lines)}

    def kill(self, node):
        """What a power cut does: the daemon and all that it runs end at once, without a word to the controller."""
        self.servers[node].kill()
        self.servers[node].wait()
        self._end_work(node)

    def _end_work(self, node):
        """Kill what runs on a node, its stewards (slurmstepd) first, so that they report nothing."""
        mine = [f"SLURMD_NODENAME={node}".encode(), f"SLURM_CONF={self.folder}/slurm.conf".encode()]
        work = [process for process in pathlib.Path("/proc").glob("[0-9]*") if all(text in _read(process / "environ").split(b"\0") for text in mine)]
        parents = {_parent(process) for process in work} - {None}
        stewards = [process for process in parents if _read(process / "cmdline").startswith(b"slurmstepd")]
        for process in stewards + work:
            try:
                os.kill(int(process.name), signal.SIGKILL)
            except ProcessLookupError:
                pass


def _read(path):
    try:
        return path.read_bytes()
    except OSError:
        return b""


def _parent(process):
    words = _read(process / "stat").rpartition(b")")[2].split()
    return pathlib.Path("/proc", words[1].decode()) if len(words) > 1 else None
