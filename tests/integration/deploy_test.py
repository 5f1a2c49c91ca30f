#!/usr/bin/env python3
"""deploy/up and deploy/down: started twice, stopped twice, a port that is taken, a service that does not start. The secrets that
the compose files give their services."""
import os
import pathlib
import shutil
import socket
import subprocess
import tempfile
import unittest
import urllib.request

import yaml

from drupe import BIN, ROOT, free_port

SERVICES = ("capture", "reconstruction", "analysis")
WITH_TOKENS = ("compose.public.yml", "compose.rig.yml", "compose.compute.yml")


class DeployTest(unittest.TestCase):
    def setUp(self):
        self.data = pathlib.Path(tempfile.mkdtemp(prefix="drupe-deploy-"))
        self.ports = {service: free_port() for service in SERVICES}
        self.addCleanup(shutil.rmtree, self.data, ignore_errors=True)
        self.addCleanup(self.run_script, "down")

    def run_script(self, name, *arguments):
        environment = dict(os.environ, **{f"DRUPE_{s.upper()}_PORT": str(p) for s, p in self.ports.items()})
        command = [ROOT / "deploy" / name, "--data", self.data, *arguments]
        return subprocess.run(command, capture_output=True, text=True, cwd="/", env=environment, timeout=120, check=False)

    def up(self):
        return self.run_script("up", "--preset", BIN.parent.name)

    def pids(self):
        return {s: (self.data / "run" / f"{s}.pid").read_text() for s in SERVICES if (self.data / "run" / f"{s}.pid").exists()}

    def test_up_twice_and_down_twice(self):
        first = self.up()
        self.assertEqual(first.returncode, 0, first)
        for port in self.ports.values():
            with urllib.request.urlopen(f"http://127.0.0.1:{port}/readyz", timeout=5) as reply:
                self.assertEqual(reply.status, 200)
        pids = self.pids()
        again = self.up()
        self.assertEqual(again.returncode, 0, again)
        self.assertIn("runs already", again.stdout)
        self.assertEqual(self.pids(), pids)

        down = self.run_script("down")
        self.assertEqual((down.returncode, down.stdout), (0, "Drupe is stopped.\n"), down)
        self.assertEqual(self.pids(), {})
        for port in self.ports.values():
            with self.assertRaises(OSError):
                urllib.request.urlopen(f"http://127.0.0.1:{port}/healthz", timeout=5)
        self.assertEqual(self.run_script("down").stdout, "Drupe was not running.\n")

    def test_two_services_at_one_port(self):
        self.ports["analysis"] = self.ports["reconstruction"]
        up = self.up()
        self.assertEqual(up.returncode, 1, up)
        self.assertIn(f"have the same port {self.ports['analysis']}", up.stderr)
        self.assertEqual(self.pids(), {})

    def test_a_port_that_is_taken(self):
        with socket.socket() as other:
            other.bind(("127.0.0.1", self.ports["reconstruction"]))
            other.listen()
            up = self.up()
        self.assertEqual(up.returncode, 1, up)
        self.assertIn(f"port {self.ports['reconstruction']} is taken", up.stderr)
        self.assertIn("DRUPE_RECONSTRUCTION_PORT", up.stderr)
        self.assertEqual(self.pids(), {}, "what had started is stopped again")

    def test_a_service_that_cannot_start(self):
        (self.data / "reconstruction.db").mkdir()  # where its database should be
        up = self.up()
        self.assertEqual(up.returncode, 1, up)
        self.assertIn("drupe-reconstruction stopped at once", up.stderr)
        self.assertEqual(self.pids(), {})


class ComposeSecretsTest(unittest.TestCase):
    def setUp(self):
        self.files = {name: yaml.safe_load((ROOT / "deploy" / name).read_text()) for name in WITH_TOKENS}

    def test_services_that_make_jobs_and_their_workers_sign_webhooks(self):
        for name, file in self.files.items():
            for service in ("reconstruction", "analysis"):
                with self.subTest(file=name, service=service):
                    environment = file["services"][service]["environment"]
                    self.assertEqual(environment["DRUPE_WEBHOOK_SECRET"], "/run/secrets/webhook_secret")

    def test_an_empty_name_is_refused(self):
        made = pathlib.Path(tempfile.mkdtemp(prefix="drupe-secrets-"))
        self.addCleanup(shutil.rmtree, made)
        refused = subprocess.run([ROOT / "deploy/make-secrets", "--dir", made, ""], capture_output=True, text=True, check=False)
        self.assertEqual((refused.returncode, refused.stderr), (2, "deploy/make-secrets: a name is empty\n"))

    def test_every_secret_is_given_declared_and_made(self):
        made = pathlib.Path(tempfile.mkdtemp(prefix="drupe-secrets-"))
        self.addCleanup(shutil.rmtree, made)
        subprocess.run([ROOT / "deploy/make-secrets", "--dir", made, "plums.example.org"], check=True, capture_output=True)
        for name, file in self.files.items():
            for service, settings in file["services"].items():
                wanted = {value.rpartition("/")[2] for value in settings.get("environment", {}).values()
                          if str(value).startswith("/run/secrets/")}
                given = set(settings.get("secrets", []))
                self.assertLessEqual(wanted, given, (name, service))
                self.assertLessEqual(given, file["secrets"].keys(), (name, service))
            for secret in file["secrets"].values():
                directory, _, base = secret["file"].rpartition("/")
                self.assertEqual(directory, "${DRUPE_SECRETS:-./secrets}", name)
                self.assertTrue((made / base).is_file(), (name, base))


if __name__ == "__main__":
    unittest.main(verbosity=2)
