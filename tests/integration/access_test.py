#!/usr/bin/env python3
"""Tokens with scopes, their limits and the audit log; one name for a request from the first service to the report."""
import hashlib
import json
import subprocess
import unittest

from drupe import BIN, QUICK_OPTIONS, DrupeTest, System, sample_images, sample_parts, wait_for

SECRETS = {"viewer": ("v" * 40, ["read"]), "rig": ("r" * 40, ["read", "submit"]), "boss": ("b" * 40, ["admin"])}


def bearer(name):
    return {"Authorization": f"Bearer {SECRETS[name][0]}"}


class AccessTest(DrupeTest):
    @classmethod
    def setUpClass(cls):
        cls.system = System()
        cls.addClassCleanup(cls.system.close)
        tokens = [{"name": name, "sha256": hashlib.sha256(secret.encode()).hexdigest(), "scopes": scopes}
                  for name, (secret, scopes) in SECRETS.items()]
        tokens.append({"name": "slow", "sha256": hashlib.sha256(b"slow").hexdigest(), "scopes": ["read"],
                       "requests_per_s": 0.5})
        file, own = cls.system.directory / "tokens.json", cls.system.directory / "own-token"
        file.write_text(json.dumps({"tokens": tokens}))
        own.write_text(SECRETS["rig"][0] + "\n")
        for service in cls.system.services:
            service.arguments += ["--tokens", file, "--service-token", own]
        cls.system.start("reconstruction", "analysis")

    def test_tokens_and_scopes(self):
        service = self.system.reconstruction
        for path in ("/healthz", "/readyz", "/openapi.yaml"):
            self.assertEqual(service.get(path).status, 200, path)
        reply = service.get("/reconstructions")
        self.assert_refused(reply, 401, "token_missing", "Bearer")
        self.assertEqual(reply.headers["www-authenticate"], "Bearer")
        self.assert_refused(service.get("/reconstructions", {"Authorization": "Bearer x"}), 401, "token_unknown")
        self.assertEqual(service.get("/reconstructions", bearer("viewer")).status, 200)
        self.assert_refused(service.post_json("/image-sets", {}, bearer("viewer")), 403, "scope_missing", "viewer")
        self.assertEqual(service.post_json("/image-sets", {}, bearer("rig")).status, 201)
        self.assert_refused(service.request("POST", "/jobs/job_x/retry", headers=bearer("rig")), 403, "scope_missing")
        self.assert_refused(service.request("POST", "/jobs/job_x/retry", headers=bearer("boss")), 404, "job_not_found")

    def test_rate_is_limited(self):
        slow = {"Authorization": "Bearer slow"}
        replies = [self.system.reconstruction.get("/reconstructions", slow) for _ in range(5)]
        self.assertEqual(replies[0].status, 200)
        self.assert_refused(replies[-1], 429, "rate_limited", "slow")
        self.assertIn("retry-after", replies[-1].headers)

    def test_audit_log_names_the_caller_and_never_the_token(self):
        self.system.reconstruction.post_json("/image-sets", {}, bearer("rig"))
        log = self.system.reconstruction.log_path.read_text()
        lines = [json.loads(line) for line in log.splitlines()]
        self.assertTrue(any(line["message"] == "audit" and line["caller"] == "rig" and line["status"] == 201
                            for line in lines))
        for secret, _ in SECRETS.values():
            self.assertNotIn(secret, log)

    def test_one_name_from_request_to_report(self):
        headers = {**bearer("rig"), "X-Request-Id": "turn-42"}
        reply = self.system.reconstruction.post_parts("/reconstruct", sample_parts(sample_images(12), QUICK_OPTIONS),
                                                      headers)
        self.assertEqual((reply.status, reply.headers["x-request-id"]), (202, "turn-42"), reply)
        job_id = reply.json()["id"]

        def report():
            answer = self.system.analysis.get(f"/reports/{job_id}", bearer("viewer"))
            return answer if answer.status == 200 else None

        wait_for("the report", report, 240, 0.5)
        for service in (self.system.reconstruction, self.system.analysis):
            lines = [json.loads(line) for line in service.log_path.read_text().splitlines()]
            ended = [line for line in lines if line["message"] == "job attempt ended" and line.get("trace") == "turn-42"]
            self.assertTrue(ended, f"{service.name} logs the job under the request's name")

    def test_no_listening_beyond_loopback_without_tokens(self):
        command = [BIN / "drupe-reconstruction", "--host", "0.0.0.0", "--port", "0", "--data", self.system.directory / "x"]
        ended = subprocess.run(command, capture_output=True, text=True, timeout=20)
        self.assertEqual(ended.returncode, 2)
        self.assertIn("--tokens", ended.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
