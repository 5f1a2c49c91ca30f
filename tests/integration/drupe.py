"""Real processes of the three services for the integration tests, and the means to talk to them.

Only Python's standard library. Each test module starts a System of its own in a temporary directory on free ports:

    class MyTest(DrupeTest):
        def test_it(self):
            reply = self.system.reconstruction.post_images(sample_images(12))
"""
import datetime
import http.client
import json
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import tempfile
import time
import unittest
import uuid

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(os.environ.get("DRUPE_BIN", ROOT / "build/release/bin"))
SAMPLE = ROOT / "tests/data/plum-s"
READY_TIMEOUT_S = 30
JOB_TIMEOUT_S = 240
ENDED = ("succeeded", "failed", "cancelled")

# Options with which a dozen pictures of the sample take seconds: the tests that use them look at the service, not at the
# accuracy, which happy_path_test.py checks with the defaults.
QUICK_OPTIONS = {"features": {"max_features": 1500}, "dense": {"level": 2}}


class Reply:
    """One reply: status, headers (names in lower case), body."""

    def __init__(self, status, headers, body):
        self.status = status
        self.headers = {name.lower(): value for name, value in headers}
        self.body = body

    def json(self):
        return json.loads(self.body)

    def error(self):
        """The error object of a refused request."""
        return self.json()["error"]

    def __repr__(self):
        return f"Reply({self.status}, {self.body[:300]!r})"


_given_ports = set()


def free_port():
    """A port that is free now; never the same twice."""
    while True:
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
        if port not in _given_ports:
            _given_ports.add(port)
            return port


def wait_for(what, condition, timeout_s, interval_s=0.05):
    """Polls until condition() is true and returns its value."""
    deadline = time.monotonic() + timeout_s
    while time.monotonic() < deadline:
        if value := condition():
            return value
        time.sleep(interval_s)
    raise AssertionError(f"{what}: not within {timeout_s} s")


def unix_s(time_of_reply):
    """Seconds since 1970 of a time as replies show it."""
    return datetime.datetime.fromisoformat(time_of_reply).timestamp()


def multipart(parts):
    """(body, content type) of multipart/form-data. A part is (name, file name or None, bytes or str or JSON value)."""
    boundary = uuid.uuid4().hex
    body = bytearray()
    for name, filename, content in parts:
        if isinstance(content, (dict, list)):
            content = json.dumps(content)
        if isinstance(content, str):
            content = content.encode()
        body += f'--{boundary}\r\nContent-Disposition: form-data; name="{name}"'.encode()
        if filename is not None:
            body += f'; filename="{filename}"\r\nContent-Type: application/octet-stream'.encode()
        body += b"\r\n\r\n" + content + b"\r\n"
    body += f"--{boundary}--\r\n".encode()
    return bytes(body), f"multipart/form-data; boundary={boundary}"


def sample_images(count, step=1):
    """(name, bytes) of the sample's first pictures, every `step`-th."""
    paths = sorted((SAMPLE / "images").glob("*.jpg"))[: count * step : step]
    return [(path.name, path.read_bytes()) for path in paths]


def sample_parts(images, options=None, with_calibration=True, with_board=True):
    """The parts of a POST /reconstruct with these pictures."""
    parts = [("images", name, content) for name, content in images]
    if with_calibration:
        parts.append(("calibration", None, (SAMPLE / "calibration.json").read_text()))
    if with_board:
        parts.append(("board", None, (SAMPLE / "board.json").read_text()))
    if options is not None:
        parts.append(("options", None, options))
    return parts


class Service:
    """One process of a service, restartable on the same port and data directory."""

    def __init__(self, name, directory, port, arguments=()):
        self.name = name
        self.port = port
        self.url = f"http://127.0.0.1:{port}"
        self.data = directory / name
        self.log_path = directory / f"{name}.log"
        self.arguments = list(arguments)
        self.process = None

    def start(self):
        command = [BIN / f"drupe-{self.name}", "--data", self.data, "--port", str(self.port), *self.arguments]
        with open(self.log_path, "ab") as log:
            self.process = subprocess.Popen(command, stdout=log, stderr=log, stdin=subprocess.DEVNULL)
        wait_for(f"drupe-{self.name} ready", self._is_ready, READY_TIMEOUT_S)
        return self

    def _is_ready(self):
        if self.process.poll() is not None:
            raise AssertionError(f"drupe-{self.name} ended with {self.process.returncode}: {self.log_tail()}")
        try:
            return self.get("/readyz").status == 200
        except OSError:
            return False

    def kill(self):
        """kill -9: no drain, no goodbye."""
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()

    def stop(self):
        """SIGTERM; returns the exit code."""
        if self.process is None or self.process.poll() is not None:
            return None
        self.process.send_signal(signal.SIGTERM)
        try:
            return self.process.wait(timeout=40)
        except subprocess.TimeoutExpired:
            self.kill()
            raise AssertionError(f"drupe-{self.name} did not stop after SIGTERM: {self.log_tail()}") from None

    def log_tail(self, lines=15):
        return "\n".join(self.log_path.read_text(errors="replace").splitlines()[-lines:])

    def is_alive(self):
        return self.process is not None and self.process.poll() is None

    def request(self, method, path, body=None, headers=None, timeout=60):
        """`path` is sent as it is, so that hostile ones arrive."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=timeout)
        try:
            connection.request(method, path, body=body, headers=headers or {})
            reply = connection.getresponse()
            return Reply(reply.status, reply.getheaders(), reply.read())
        finally:
            connection.close()

    def get(self, path, headers=None):
        return self.request("GET", path, headers=headers)

    def delete(self, path):
        return self.request("DELETE", path)

    def post_json(self, path, value, headers=None):
        body = value if isinstance(value, (str, bytes)) else json.dumps(value)
        return self.request("POST", path, body, {"Content-Type": "application/json", **(headers or {})})

    def post_parts(self, path, parts, headers=None):
        body, content_type = multipart(parts)
        return self.request("POST", path, body, {"Content-Type": content_type, **(headers or {})})

    def send_raw(self, text, timeout=10):
        """Sends bytes as they are; returns everything that comes back until the service closes or falls silent."""
        received = b""
        with socket.create_connection(("127.0.0.1", self.port), timeout=timeout) as stream:
            try:
                stream.sendall(text)
                while piece := stream.recv(65536):
                    received += piece
            except (TimeoutError, ConnectionError):
                pass
        return received


def worker_pid(job):
    """The process that a job of GET /jobs/ID is at, or was at last; workers are named KIND@HOST:PID-THREAD."""
    return int(job["worker"].rpartition(":")[2].partition("-")[0])


class System:
    """The three services, wired to one another, each with a data directory of its own unless they share one."""

    def __init__(self, reconstruction_arguments=(), shared_data=False):
        self.directory = pathlib.Path(tempfile.mkdtemp(prefix="drupe-test-"))
        ports = [free_port() for _ in range(3)]
        urls = [f"http://127.0.0.1:{port}" for port in ports]
        self.capture = Service("capture", self.directory, ports[0], ["--reconstruction-url", urls[1]])
        self.reconstruction = Service("reconstruction", self.directory, ports[1],
                                      ["--analysis-url", urls[2], *reconstruction_arguments])
        self.analysis = Service("analysis", self.directory, ports[2], ["--reconstruction-url", urls[1]])
        self.services = [self.capture, self.analysis, self.reconstruction]
        if shared_data:
            for service in self.services:
                service.data = self.directory / "data"

    def worker(self, name, number, arguments, directory=None):
        """A process that does a service's jobs, to be started: on the data of its front, or of its own in `directory`."""
        worker = Service(name, directory or self.directory, free_port(), ["--role", "worker", *arguments])
        worker.log_path = self.directory / f"{name}-worker-{number}.log"
        return worker

    def start(self, *names):
        for service in self.services:
            if not names or service.name in names:
                service.start()
        return self

    def close(self):
        try:
            for service in self.services:
                service.stop()
        finally:
            for service in self.services:
                if service.is_alive():
                    service.kill()
            shutil.rmtree(self.directory, ignore_errors=True)

    def submit(self, images, options=None, headers=None, **kwargs):
        """POSTs pictures to /reconstruct and returns the id of the job."""
        reply = self.reconstruction.post_parts("/reconstruct", sample_parts(images, options, **kwargs), headers)
        assert reply.status == 202, reply
        return reply.json()["id"]

    def status(self, job_id):
        reply = self.reconstruction.get(f"/reconstructions/{job_id}")
        assert reply.status == 200, reply
        return reply.json()

    def wait_until_ended(self, job_id, timeout_s=JOB_TIMEOUT_S):
        """The status once the job has ended."""

        def ended():
            status = self.status(job_id)
            return status if status["status"] in ENDED else None

        return wait_for(f"{job_id} ended", ended, timeout_s)

    def wait_for_report(self, job_id, timeout_s=60):
        def ready():
            reply = self.analysis.get(f"/reports/{job_id}")
            return reply if reply.status not in (202, 404) else None

        reply = wait_for(f"report of {job_id}", ready, timeout_s, 0.2)
        assert reply.status == 200, reply
        return reply.json()


class DrupeTest(unittest.TestCase):
    """A test with a running System; `services` names those that it needs (all of them when empty)."""

    services = ()
    reconstruction_arguments = ()
    shared_data = False

    @classmethod
    def setUpClass(cls):
        cls.system = System(cls.reconstruction_arguments, cls.shared_data)
        cls.addClassCleanup(cls.system.close)
        cls.system.start(*cls.services)

    def assert_refused(self, reply, status, code, *words):
        """A refusal has the status, the code, and a message that holds these words."""
        self.assertEqual(reply.status, status, reply)
        self.assertEqual(reply.headers.get("content-type"), "application/json", reply)
        error = reply.error()
        self.assertEqual(error["code"], code, reply)
        for word in words:
            self.assertIn(word, error["message"], reply)
