#!/usr/bin/env python3
"""A PostgreSQL server for tests: in a directory of its own, on a Unix socket, by a user that is not root.

    tests/postgres/cluster.py DIR     runs one in DIR, which must not exist, until standard input ends; then removes DIR.
                                      DIR/url holds its URL once it is ready, or DIR/skip why there is none.

From Python: `with Cluster() as cluster: ... cluster.url ...`. Debian's package postgresql-15 brings the server.
"""
import glob
import os
import pathlib
import pwd
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

OLDEST = 15
READY_TIMEOUT_S = 60


class NoServer(Exception):
    """There is no PostgreSQL server on this machine."""


def find_programs():
    """The directory of initdb and postgres, of the newest version that is installed."""
    found = {int(path.split("/")[4]): path for path in glob.glob("/usr/lib/postgresql/[0-9]*/bin") if
             os.path.exists(f"{path}/postgres")}
    if not found or max(found) < OLDEST:
        raise NoServer(f"no PostgreSQL server (version {OLDEST} or later) is installed; see deploy/packages.txt")
    return pathlib.Path(found[max(found)])


def run_as():
    """How to start a program that refuses to run as root: arguments of subprocess."""
    if os.geteuid() != 0:
        return {}
    for name in ("postgres", "nobody"):
        try:
            user = pwd.getpwnam(name)
            return {"user": user.pw_uid, "group": user.pw_gid, "extra_groups": []}
        except KeyError:
            continue
    raise NoServer("PostgreSQL does not run as root, and there is no other user to run it as")


class Cluster:
    """A running server; `url` reaches it as its superuser."""

    def __init__(self, directory=None):
        self.programs = find_programs()
        self.owner = run_as()
        self.directory = pathlib.Path(directory or tempfile.mkdtemp(prefix="drupe-pg-"))
        self.directory.mkdir(mode=0o755, exist_ok=True)
        self.directory.chmod(0o755)
        self.url = f"postgres://drupe@/postgres?host={self.directory}/socket"
        self.server = None

    def __enter__(self):
        try:
            self._initialise()
            self.start()
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        self.stop()
        shutil.rmtree(self.directory, ignore_errors=True)

    def _initialise(self):
        for name in ("data", "socket"):
            (self.directory / name).mkdir()
            if self.owner:
                os.chown(self.directory / name, self.owner["user"], self.owner["group"])
        self._run("initdb", "-D", self.directory / "data", "-U", "drupe", "-A", "trust", "-E", "UTF8", "--locale=C",
                  "--no-sync", "--no-instructions")

    def _run(self, program, *arguments):
        subprocess.run([self.programs / program, *arguments], check=True, cwd=self.directory, stdin=subprocess.DEVNULL,
                       stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, **self.owner)

    def start(self):
        with open(self.directory / "log", "ab") as log:
            self.server = subprocess.Popen(
                [self.programs / "postgres", "-D", self.directory / "data", "-k", self.directory / "socket",
                 "-c", "listen_addresses=", "-c", "max_connections=100", "-c", "shared_buffers=32MB"],
                cwd=self.directory, stdin=subprocess.DEVNULL, stdout=log, stderr=log, **self.owner)
        deadline = time.monotonic() + READY_TIMEOUT_S
        while subprocess.run([self.programs / "pg_isready", "-q", "-h", self.directory / "socket"]).returncode != 0:
            if self.server.poll() is not None or time.monotonic() > deadline:
                raise RuntimeError("PostgreSQL did not start: " + (self.directory / "log").read_text()[-2000:])
            time.sleep(0.05)

    def stop(self, how=signal.SIGINT):
        """Ends the server; its data stay. SIGQUIT is what a crash is like: the next start recovers."""
        if self.server is None or self.server.poll() is not None:
            return
        self.server.send_signal(how)
        try:
            self.server.wait(timeout=20)
        except subprocess.TimeoutExpired:
            self.server.kill()
            self.server.wait()


def cluster_or_skip(enter_context):
    """A cluster that lives as long as a test or its class, by its enterContext; the test is skipped where there is no server."""
    try:
        return enter_context(Cluster())
    except NoServer as reason:
        raise unittest.SkipTest(str(reason)) from None


def main():
    directory = pathlib.Path(sys.argv[1])
    directory.mkdir()
    try:
        with Cluster(directory) as cluster:
            (directory / "url.new").write_text(cluster.url)
            (directory / "url.new").rename(directory / "url")
            sys.stdin.read()
    except NoServer as reason:
        (directory / "skip.new").write_text(str(reason))
        (directory / "skip.new").rename(directory / "skip")
        sys.stdin.read()
        shutil.rmtree(directory, ignore_errors=True)


if __name__ == "__main__":
    main()
