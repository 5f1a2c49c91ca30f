#!/usr/bin/env python3
"""A worker with a data directory of its own, whose objects lie on the front's disk and come over connections that break.

Front and worker meet in PostgreSQL; the worker reaches the front's /objects through a relay that cuts connections. The end of
the job is told to a webhook.
"""
import hashlib
import hmac
import http.server
import json
import pathlib
import queue
import socket
import sys
import threading
import unittest

from drupe import ENDED, QUICK_OPTIONS, ROOT, System, sample_images, sample_parts, wait_for

sys.path.insert(0, str(ROOT / "tests/postgres"))
from cluster import cluster_or_skip  # noqa: E402  (found through the line above)

TOKENS = {"worker": ["read", "submit", "store"], "user": ["read", "submit"]}
SECRET = "a secret that nobody knows"
CACHE_BYTES = 2 << 20
CUTS = 10
CUT_AFTER_BYTES = 40_000
IMAGES = 12


class CuttingRelay:
    """Passes connections on to a port, and cuts each of the first few that carry more than some bytes."""

    def __init__(self, target_port):
        self.target_port, self.cuts_left, self.lock = target_port, CUTS, threading.Lock()
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        threading.Thread(target=self._accept, daemon=True).start()

    def _accept(self):
        while True:
            try:
                client, _ = self.listener.accept()
            except OSError:
                return
            threading.Thread(target=self._serve, args=(client,), daemon=True).start()

    def _serve(self, client):
        with client, socket.create_connection(("127.0.0.1", self.target_port)) as service:
            back = threading.Thread(target=self._pass_on, args=(service, client), daemon=True)
            back.start()
            self._pass_on(client, service)
            back.join()

    def _pass_on(self, source, target):
        passed = 0
        try:
            while piece := source.recv(16384):
                passed += len(piece)
                if passed > CUT_AFTER_BYTES and self._may_cut():
                    break
                target.sendall(piece)
        except OSError:
            pass
        for end in (source, target):
            try:
                end.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass

    def _may_cut(self):
        with self.lock:
            self.cuts_left -= 1
            return self.cuts_left >= 0


class Receiver:
    """Takes webhooks, refusing the first one; `calls` has (headers, body)."""

    def __init__(self):
        calls = self.calls = queue.Queue()
        answers = iter([500])

        class Handler(http.server.BaseHTTPRequestHandler):
            def do_POST(self):
                body = self.rfile.read(int(self.headers["Content-Length"]))
                self.send_response(next(answers, 200))
                self.end_headers()
                calls.put((self.headers, body))

            def log_message(self, *_):
                pass

        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.url = f"http://127.0.0.1:{self.server.server_port}/done"
        threading.Thread(target=self.server.serve_forever, daemon=True).start()


class RemoteStoreTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.cluster = cluster_or_skip(cls.enterClassContext)
        cls.system = System()
        cls.addClassCleanup(cls.system.close)
        cls.receiver = Receiver()
        cls.addClassCleanup(cls.receiver.server.server_close)
        cls.addClassCleanup(cls.receiver.server.shutdown)
        cls.wire()

    @classmethod
    def wire(cls):
        system = cls.system
        cls.front = system.reconstruction
        shared = ["--jobs-url", cls.cluster.url, "--service-token", cls.secret_file("token", "worker"),
                  "--webhook-secret", cls.secret_file("secret", SECRET), "--webhook-allow", "127.0.0.1"]
        tokens = [{"name": name, "sha256": hashlib.sha256(name.encode()).hexdigest(), "scopes": scopes,
                   "requests_per_s": 1000, "max_concurrent": 64} for name, scopes in TOKENS.items()]
        cls.front.arguments += ["--role", "api", *shared,
                                "--tokens", cls.secret_file("tokens.json", json.dumps({"tokens": tokens}))]
        cls.relay = CuttingRelay(cls.front.port)
        cls.addClassCleanup(cls.relay.listener.close)
        remote = ["--store-url", f"http://127.0.0.1:{cls.relay.port}", "--store-cache-bytes", str(CACHE_BYTES)]
        cls.worker = system.worker("reconstruction", 0, [*shared, *remote], system.directory / "elsewhere")
        system.services = [cls.front, cls.worker]
        system.start()

    @classmethod
    def secret_file(cls, name, content):
        path = pathlib.Path(cls.system.directory) / name
        path.write_text(content)
        return str(path)

    def ask(self, method, path, body=None, headers=None, token="user"):
        return self.front.request(method, path, body, {"Authorization": f"Bearer {token}", **(headers or {})})

    def cached(self):
        files = [path for path in (self.worker.data / "object-cache").glob("??/*") if len(path.name) == 64]
        return [(path.name, path.stat().st_size) for path in files]

    def test_1_worker_finishes_a_job_whose_pictures_lie_elsewhere(self):
        options = {**QUICK_OPTIONS, "analyze": False, "webhook": self.receiver.url}
        reply = self.front.post_parts("/reconstruct", sample_parts(sample_images(IMAGES), options),
                                      {"Authorization": "Bearer user"})
        self.assertEqual(reply.status, 202, reply)
        job = reply.json()["id"]

        def ended():
            status = self.ask("GET", f"/reconstructions/{job}").json()
            return status if status["status"] in ENDED else None

        status = wait_for(f"{job} ended", ended, 240)
        self.assertEqual(status["status"], "succeeded", status)
        self.assertEqual(status["attempt"], 1, "broken connections cost no attempt")
        self.assertLess(self.relay.cuts_left, 0, "every cut was made")
        for artifact in status["artifacts"]:
            stored = self.ask("GET", f"/reconstructions/{job}/artifacts/{artifact['name']}").body
            self.assertEqual(hashlib.sha256(stored).hexdigest(), artifact["sha256"], artifact)
        self.assertFalse((self.worker.data / "objects").exists(), "the worker has no store of its own")
        sizes = [size for _, size in self.cached()]
        self.assertGreater(sum(sizes), 0)
        self.assertLessEqual(sum(sizes), max(CACHE_BYTES, *sizes))
        self.check_webhooks(job)

    def check_webhooks(self, job):
        """The first call was refused by the receiver, so that there are two, of one delivery."""
        calls = [self.receiver.calls.get(timeout=60) for _ in range(2)]
        for headers, body in calls:
            time, signature = (part.split("=", 1)[1] for part in headers["Drupe-Signature"].split(","))
            expected = hmac.new(SECRET.encode(), f"{time}.".encode() + body, hashlib.sha256).hexdigest()
            self.assertEqual(signature, expected)
            told = json.loads(body)
            self.assertEqual((told["id"], told["event"]), (job, "reconstruction.succeeded"))
        self.assertEqual(len({headers["Drupe-Delivery"] for headers, _ in calls}), 1)

    def test_2_objects_are_for_those_with_the_scope(self):
        digest = hashlib.sha256(b"plum").hexdigest()
        for method, path in (("GET", f"/objects/{digest}"), ("PUT", f"/objects/{digest}"), ("GET", "/objects"),
                             ("DELETE", f"/objects/{digest}"), ("PUT", "/object-roots/reconstruction")):
            self.assertEqual(self.ask(method, path, b"").error()["code"], "scope_missing", (method, path))
            self.assertEqual(self.front.request(method, path, b"").status, 401, (method, path))

    def test_3_upload_is_resumed_and_wrong_bytes_are_refused(self):
        digest = hashlib.sha256(b"plum").hexdigest()
        path = f"/objects/{digest}"

        def put(body, content_range=None):
            headers = {"Content-Range": content_range} if content_range else None
            return self.ask("PUT", path, body, headers, "worker")

        self.assertEqual(put(b"pl", "bytes 0-1/4").json(), {"received": 2, "complete": False})
        self.front.kill()
        self.front.start()
        self.assertEqual(put(b"", "bytes */4").json(), {"received": 2, "complete": False})
        self.assertEqual(put(b"plum").error()["code"], "upload_offset")
        self.assertEqual(put(b"xx", "bytes 2-3/4").error()["code"], "digest_mismatch")
        self.assertEqual(put(b"", "bytes */4").json()["received"], 0)
        self.assertEqual(put(b"plum").status, 201)
        part = self.ask("GET", path, headers={"Range": "bytes=1-2"}, token="worker")
        self.assertEqual((part.status, part.body), (206, b"lu"))

    def test_4_webhooks_reach_no_private_address(self):
        options = {"analyze": False, "webhook": "http://169.254.169.254/latest/meta-data/"}
        reply = self.front.post_parts("/reconstruct", sample_parts(sample_images(3), options),
                                      {"Authorization": "Bearer user"})
        self.assertEqual((reply.status, reply.error()["code"]), (403, "webhook_refused"), reply)


if __name__ == "__main__":
    unittest.main(verbosity=2)
