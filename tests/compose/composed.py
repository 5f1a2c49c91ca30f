"""Systems of containers for tests: projects of their own, on free ports, taken down at the end.

    engine = find_engine()                                      raises NoEngine where containers cannot be had
    with Composed("one", ["docker-compose.yml"], settings) as system: system.up() ...

Only Python's standard library, docker and docker-compose.
"""
import ipaddress
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/integration"))

from drupe import wait_for  # noqa: E402

BASE_IMAGE = "debian:bookworm-slim"
TAG = "test"
IMAGES = ("capture", "reconstruction", "analysis", "proxy", "database")
READY_TIMEOUT_S = 180
SKIPPED = 77  # exit status; ctest knows it


class NoEngine(Exception):
    """Containers cannot be had on this machine."""


def run(*command, timeout_s=120, **settings):
    """What the command prints; raises with its last words when it fails."""
    done = subprocess.run(command, capture_output=True, text=True, timeout=timeout_s, check=False, cwd=ROOT, **settings)
    if done.returncode != 0:
        words = " ".join(str(part) for part in command)
        raise RuntimeError(f"{words}: exit status {done.returncode}\n{(done.stdout + done.stderr)[-3000:]}")
    return done.stdout


def end_by_itself(seconds):
    """Lets what is started be taken down when the test is stopped or has had its time."""
    def leave(number, _):
        raise SystemExit(f"stopped by {signal.Signals(number).name}")
    for number in (signal.SIGTERM, signal.SIGALRM, signal.SIGHUP):
        signal.signal(number, leave)
    signal.alarm(seconds)


def works(*command):
    try:
        run(*command)
        return True
    except (OSError, RuntimeError, subprocess.TimeoutExpired):
        return False


def require_engine():
    """Raises NoEngine with the reason."""
    for program in ("docker", "docker-compose"):
        if not shutil.which(program):
            raise NoEngine(f"{program} is not installed")
    if not works("docker", "info"):
        raise NoEngine("no Docker engine answers")
    if not (works("docker", "image", "inspect", BASE_IMAGE) or works("docker", "pull", "-q", BASE_IMAGE)):
        raise NoEngine(f"{BASE_IMAGE} cannot be had")
    if not works("docker", "run", "--rm", BASE_IMAGE, "apt-get", "-o", "APT::Update::Error-Mode=any", "update"):
        raise NoEngine("no Debian mirror can be reached from a container")


def build_images(bin_directory):
    """Images of the programs in `bin_directory`; of those that Docker itself compiles when it is None."""
    environment = {**os.environ, "DRUPE_TAG": TAG, "DRUPE_PROGRAMS": "compiled"}
    if bin_directory:
        run("docker/gather-services", bin_directory, "build/gathered")
        environment["DRUPE_PROGRAMS"] = "gathered"
    for file, names in (("docker-compose.yml", ()), ("compose.rig.yml", ("database",))):
        run("docker-compose", "-f", f"deploy/{file}", "build", *names, timeout_s=3600, env=environment)


def image_mb(name):
    return int(run("docker", "image", "inspect", "-f", "{{.Size}}", f"drupe-{name}:{TAG}")) / 1e6


def bridge_address():
    """This machine's address in the network of containers."""
    config = json.loads(run("docker", "network", "inspect", "bridge", "-f", "{{json (index .IPAM.Config 0)}}"))
    # An engine that has just made the network does not name its gateway yet: it is the first address.
    return config.get("Gateway") or str(next(ipaddress.ip_network(config["Subnet"]).hosts()))


class Composed:
    """One project of docker-compose; its containers, networks and volumes go with it."""

    def __init__(self, name, files, settings):
        self.name = f"drupe-{name}-{os.getpid()}"
        self.files = files
        self.environment = {**os.environ, "COMPOSE_PROJECT_NAME": self.name, "DRUPE_TAG": TAG,
                            **{key: str(value) for key, value in settings.items()}}

    def __enter__(self):
        return self

    def __exit__(self, kind, *_):
        if kind is not None:
            print(self.logs(), flush=True)
        self.compose("down", "--volumes", "--timeout", "5")

    def compose(self, *arguments):
        files = [part for file in self.files for part in ("-f", f"deploy/{file}")]
        return run("docker-compose", *files, *arguments, timeout_s=300, env=self.environment)

    def up(self, *arguments):
        """Starts what is not started, and waits until every container is healthy."""
        self.compose("up", "-d", "--no-build", *arguments)
        wait_for(f"{self.name} ready", self.is_ready, READY_TIMEOUT_S, 0.5)

    def containers(self, service=None):
        return self.compose("ps", "-q", *([service] if service else [])).split()

    def is_ready(self):
        states = run("docker", "inspect", "-f", "{{.State.Health.Status}}", *self.containers()).split()
        return states and set(states) == {"healthy"}

    def logs(self, lines=20):
        return self.compose("logs", "--no-color", f"--tail={lines}")
