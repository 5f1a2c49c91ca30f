#!/usr/bin/env python3
"""api/openapi.yaml against the sources and against live replies of every route."""
import hashlib
import json
import unittest

import contract
import fake_rig
import pictures
from drupe import ENDED, QUICK_OPTIONS, SAMPLE, DrupeTest, multipart, sample_images, sample_parts, wait_for

UNKNOWN = "a" * 20
REPORT_FILES = ("report.json", "report.csv", "observations.json", "defects.ply")


class OpenApiTest(DrupeTest):
    """Talks to the services through `call`, which checks each reply against the contract and notes what it has seen."""

    shared_data = True  # so that there are pictures of defects too

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.contract = contract.Contract()
        cls.seen = set()  # (service, method, path template, status)

    def call(self, service, method, path, body=None, headers=None, expect=None):
        if isinstance(body, dict):
            body, headers = json.dumps(body), {"Content-Type": "application/json", **(headers or {})}
        reply = getattr(self.system, service).request(method, path, body, headers)
        operation = self.contract.find(service, method, path)
        self.assertIsNotNone(operation, f"{method} {path} of {service} is not described")
        template, description = operation
        self.assertEqual(self.contract.problems(description, reply), [], f"{method} {path}: {reply}")
        if expect is not None:
            self.assertEqual(reply.status, expect, f"{method} {path}: {reply}")
        self.seen.add((service, method.lower(), template, reply.status))
        return reply

    def post_parts(self, service, path, parts, expect):
        body, content_type = multipart(parts)
        return self.call(service, "POST", path, body, {"Content-Type": content_type}, expect)

    def test_1_every_registered_route_is_described_and_none_else(self):
        registered, described = contract.registered_routes(), self.contract.routes()
        self.assertEqual(registered - described, set(), "registered, but not in api/openapi.yaml")
        self.assertEqual(described - registered, set(), "in api/openapi.yaml, but not registered")

    def test_1_references_and_names(self):
        names = [operation["operationId"] for _, _, _, operation in self.contract.operations()]
        self.assertEqual(len(names), len(set(names)))
        for _, method, path, operation in self.contract.operations():
            self.assertTrue(operation["summary"], path)
            for response in operation["responses"].values():
                self.assertTrue(self.contract.resolve(response)["description"], (method, path))

    def test_1_examples_match_their_schemas(self):
        example = json.loads((contract.API / "examples/report.json").read_text())
        self.assertEqual(self.contract.schema_problems({"$ref": "schemas/report.schema.json"}, example), [])

    def test_2_operation(self):
        for service in ("capture", "reconstruction", "analysis"):
            for path in ("/healthz", "/readyz", "/metrics"):
                self.call(service, "GET", path, expect=200)
            self.assertEqual(self.call(service, "GET", "/openapi.yaml", expect=200).body.decode(), self.contract.text)
            self.check_objects_of(service)
            schema = self.call(service, "GET", "/schemas/report.schema.json", expect=200).json()
            self.assertEqual(schema, json.loads((contract.API / "schemas/report.schema.json").read_text()))

    def check_objects_of(self, service):
        content = f"object of {service}".encode()
        path, total = f"/objects/{hashlib.sha256(content).hexdigest()}", len(content)

        def put(body, content_range, expect):
            return self.call(service, "PUT", path, body, {"Content-Range": f"bytes {content_range}/{total}"}, expect)

        self.call(service, "GET", "/objects?bytes=10", expect=200)
        self.call(service, "GET", path, expect=404)
        put(content[:3], "0-2", 202)
        self.assertEqual(put(b"", "*", 200).json(), {"received": 3, "complete": False})
        put(content, f"0-{total - 1}", 409)
        put(content[:3], "3-4", 400)
        put(b"?" * (total - 3), f"3-{total - 1}", 422)
        self.call(service, "PUT", path, content, expect=201)
        self.call(service, "PUT", "/objects/none", content, expect=400)
        tag = self.call(service, "GET", path, expect=200).headers["etag"]
        self.call(service, "GET", path, headers={"If-None-Match": tag}, expect=304)
        self.call(service, "GET", path, headers={"Range": "bytes=1-2"}, expect=206)
        self.call(service, "GET", path, headers={"Range": "bytes=999-"}, expect=416)
        self.call(service, "PUT", "/object-roots/elsewhere", b"none", expect=400)
        self.call(service, "PUT", "/object-roots/elsewhere", path[-64:] + "\n", expect=204)
        self.call(service, "DELETE", path, expect=204)

    def test_3_reconstruction_and_report(self):
        accepted = self.post_parts("reconstruction", "/reconstruct", sample_parts(sample_images(12), QUICK_OPTIONS), 202)
        job = accepted.json()["id"]
        self.call("reconstruction", "GET", f"/reconstructions/{job}", expect=200)
        self.call("analysis", "GET", f"/reports/rec_{UNKNOWN}", expect=404)
        self.assertEqual(self.system.wait_until_ended(job)["status"], "succeeded")
        self.call("reconstruction", "GET", f"/reconstructions/{job}", expect=200)
        self.call("reconstruction", "GET", f"/reconstructions/{job}/events", expect=200)
        self.call("reconstruction", "DELETE", f"/reconstructions/{job}", expect=409)
        artifact = f"/reconstructions/{job}/artifacts/cameras.json"
        tag = self.call("reconstruction", "GET", artifact, expect=200).headers["etag"]
        self.call("reconstruction", "GET", artifact, headers={"If-None-Match": tag}, expect=304)
        self.call("reconstruction", "GET", artifact, headers={"Range": "bytes=0-9"}, expect=206)
        self.call("reconstruction", "GET", artifact, headers={"Range": "bytes=99999999-"}, expect=416)
        self.call("reconstruction", "GET", f"/reconstructions/{job}/artifacts/none.ply", expect=404)
        self.call("reconstruction", "GET", f"/reconstructions/{job}/artifacts", expect=200)
        self.call("reconstruction", "GET", f"/reconstructions/rec_{UNKNOWN}/artifacts", expect=404)
        self.call("reconstruction", "GET", "/reconstructions?status=succeeded&limit=1", expect=200)
        self.call("reconstruction", "GET", "/reconstructions?status=done", expect=400)

        self.system.wait_for_report(job)
        report = self.call("analysis", "GET", f"/reports/{job}", expect=200)
        self.call("analysis", "GET", f"/reports/{job}", headers={"If-None-Match": report.headers["etag"]}, expect=304)
        self.call("analysis", "GET", f"/reports/{job}.csv", expect=200)
        self.check_report_artifacts(job)
        self.call("analysis", "GET", "/reports?limit=1", expect=200)
        self.call("analysis", "GET", "/reports?limit=0", expect=400)
        self.call("analysis", "POST", "/analyze", {"reconstruction": job, "options": {}}, expect=202)

    def check_report_artifacts(self, job):
        folder = f"/reports/{job}/artifacts"
        listed = self.call("analysis", "GET", folder, expect=200).json()["artifacts"]
        names = {artifact["name"] for artifact in listed}
        self.assertLessEqual({*REPORT_FILES, "contact_sheet.png"}, names)
        for artifact in listed:
            reply = self.call("analysis", "GET", f"{folder}/{artifact['name']}", expect=200)
            self.assertEqual(hashlib.sha256(reply.body).hexdigest(), artifact["sha256"], artifact)
            self.assertEqual((len(reply.body), reply.headers["content-type"]), (artifact["bytes"], artifact["type"]))
        cloud, tag = f"{folder}/defects.ply", next(a["sha256"] for a in listed if a["name"] == "defects.ply")
        self.call("analysis", "GET", cloud, headers={"If-None-Match": f'"{tag}"'}, expect=304)
        self.assertEqual(self.call("analysis", "GET", cloud, headers={"Range": "bytes=0-2"}, expect=206).body, b"ply")
        self.call("analysis", "GET", cloud, headers={"Range": "bytes=99999999999-"}, expect=416)
        self.call("analysis", "GET", f"{folder}/none.ply", expect=404)
        self.call("analysis", "GET", f"/reports/rec_{UNKNOWN}/artifacts", expect=404)
        self.call("analysis", "GET", f"/reports/rec_{UNKNOWN}/artifacts/defects.ply", expect=404)

    def test_3_image_sets(self):
        set_id = self.call("reconstruction", "POST", "/image-sets", {}, expect=201).json()["id"]
        name, content = sample_images(1)[0]
        image = f"/image-sets/{set_id}/images/{name}"
        self.call("reconstruction", "PUT", image, content, {"Content-Type": "image/jpeg"}, 201)
        self.call("reconstruction", "PUT", image, content, {"Content-Type": "image/jpeg"}, 200)
        self.call("reconstruction", "PUT", image, b"text", {"Content-Type": "image/jpeg"}, 415)
        self.call("reconstruction", "PUT", image, pictures.png_bomb(), {"Content-Type": "image/png"}, 413)
        self.call("reconstruction", "GET", f"/image-sets/{set_id}", expect=200)
        self.call("reconstruction", "GET", "/image-sets/set_unknown", expect=404)
        self.call("reconstruction", "POST", "/reconstruct", {"image_set": set_id}, expect=400)
        self.call("reconstruction", "POST", "/reconstruct", {"image_set": "set_unknown"}, expect=404)
        self.call("reconstruction", "POST", "/reconstruct", {"image_set": 1}, expect=400)
        self.call("reconstruction", "POST", "/reconstruct", "x", {"Content-Type": "text/plain"}, 415)

    def test_3_cancel(self):
        job = self.system.submit(sample_images(36))
        self.call("reconstruction", "DELETE", f"/reconstructions/{job}")
        self.call("reconstruction", "DELETE", f"/reconstructions/rec_{UNKNOWN}", expect=404)

    def test_3_calibration(self):
        folder = SAMPLE / "calibration"
        parts = [("images", path.name, path.read_bytes()) for path in sorted(folder.glob("*.jpg"))]
        parts.append(("pattern", None, (folder / "pattern.json").read_text()))
        reply = self.post_parts("capture", "/calibrations", parts, None)
        path = f"/calibrations/{reply.json()['id']}"

        def ended():
            return self.call("capture", "GET", path).json()["status"] in ("succeeded", "failed")

        wait_for("calibration", ended, 120, 0.2)
        self.call("capture", "GET", path, expect=200)
        own = f"/calibrations/{self.call('capture', 'GET', path).json()['calibration_id']}"
        for folder in (path, own):
            self.call("capture", "GET", f"{folder}/calibration.json", expect=200)
            self.call("capture", "GET", f"{folder}/coverage.png", expect=200)
        self.call("capture", "GET", own, expect=200)
        self.call("capture", "GET", f"/calibrations/cal_{UNKNOWN}/coverage.png", expect=404)
        self.call("capture", "GET", f"/calibrations/cal_{UNKNOWN}", expect=404)
        self.call("capture", "GET", "/calibrations?status=succeeded&limit=1", expect=200)
        self.call("capture", "GET", "/calibrations?limit=0", expect=400)
        self.call("capture", "GET", "/cameras", expect=200)

    def test_3_models(self):
        cloud = ("cloud", "labelled.ply", pictures.labelled_ply())
        reply = self.post_parts("analysis", "/models", [cloud, ("options", None, {"name": "test"})], 202)
        path = f"/models/{reply.json()['id']}"
        wait_for("model", lambda: self.call("analysis", "GET", path).json()["status"] == "succeeded", 60, 0.1)
        self.call("analysis", "GET", f"{path}/model.json", expect=200)
        self.call("analysis", "GET", "/models/default", expect=200)
        self.call("analysis", "GET", "/models?limit=1", expect=200)
        self.call("analysis", "GET", "/models?limit=0", expect=400)
        self.call("analysis", "GET", f"/models/mdl_{UNKNOWN}", expect=404)
        self.call("analysis", "GET", f"/models/mdl_{UNKNOWN}/model.json", expect=404)
        self.post_parts("analysis", "/models", [("options", None, {})], 400)
        self.post_parts("analysis", "/models", [("cloud", "x.ply", b"ply\n")], 422)

    def start_capture_with_a_rig(self):
        rig = fake_rig.FakeRig()
        self.addCleanup(rig.close)
        capture = self.system.capture
        capture.stop()
        capture.arguments += ["--turntable-device", rig.table]
        capture.start()
        return rig

    def test_4_scan(self):
        rig = self.start_capture_with_a_rig()
        request = {"camera": rig.camera, "views": 6, "turntable": {"speed_deg_s": 90, "settle_ms": 0}, "reconstruct": False}
        path = f"/scans/{self.call('capture', 'POST', '/scans', request, expect=202).json()['id']}"

        def frames():
            scan = self.call("capture", "GET", path, expect=200).json()
            return scan["taken"] >= 2 and scan

        wait_for("two frames", frames, 60, 0.1)
        self.call("capture", "GET", f"{path}/preview.jpg", expect=200)
        stream = self.call("capture", "GET", f"{path}/preview.mjpeg", expect=200)  # to the scan's end
        self.assertTrue(stream.body.startswith(b"--frame\r\nContent-Type: image/jpeg\r\n"), stream)
        self.assertTrue(stream.body.endswith(b"--frame--\r\n"), stream)
        self.call("capture", "GET", f"/scans/scan_{UNKNOWN}/preview.mjpeg", expect=404)
        name = self.call("capture", "GET", path, expect=200).json()["frames"][0]["name"]
        tag = self.call("capture", "GET", f"{path}/frames/{name}", expect=200).headers["etag"]
        self.call("capture", "GET", f"{path}/frames/{name}", headers={"If-None-Match": tag}, expect=304)
        self.call("capture", "GET", f"{path}/frames/none.jpg", expect=404)
        self.call("capture", "POST", "/turntable/stop", {}, expect=200)
        self.call("capture", "GET", "/scans?limit=1", expect=200)
        self.call("capture", "GET", "/scans?limit=0", expect=400)
        self.call("capture", "GET", f"/scans/scan_{UNKNOWN}", expect=404)
        self.call("capture", "POST", "/scans", {"views": 1}, expect=400)
        self.call("capture", "POST", "/scans", {"calibration": "cal_unknown"}, expect=404)

    def test_5_calibration_session(self):
        rig = fake_rig.FakeRig(pictures="calibration")
        self.addCleanup(rig.close)
        pattern = json.loads((SAMPLE / "calibration/pattern.json").read_text())
        asked = {"camera": {"id": rig.camera}, "pattern": pattern, "lens": "25 mm"}
        path = f"/calibration-sessions/{self.call('capture', 'POST', '/calibration-sessions', asked, expect=201).json()['id']}"
        self.call("capture", "GET", f"{path}/preview.jpg", expect=404)
        taken = self.call("capture", "POST", f"{path}/frames", {}, expect=200).json()
        self.assertTrue(taken["kept"], taken)
        self.call("capture", "POST", f"{path}/finish", {}, expect=409)
        while len(taken["session"]["images"]) < 4:
            rig.tell("turn 36")  # to the next picture
            taken = self.call("capture", "POST", f"{path}/frames", {}, expect=200).json()
        self.assertFalse(taken["session"]["guidance"]["complete"])
        self.call("capture", "GET", path, expect=200)
        self.call("capture", "GET", f"{path}/preview.jpg", expect=200)
        self.call("capture", "POST", f"{path}/finish", {}, expect=202)
        self.call("capture", "DELETE", path, expect=204)
        self.call("capture", "GET", path, expect=404)
        self.call("capture", "POST", "/calibration-sessions", {"pattern": {"pattern": "circles"}}, expect=400)

    def test_5_cancelled_scan(self):
        absent = {"camera": "Nobody-Nothing-0", "turntable": "external"}
        path = f"/scans/{self.call('capture', 'POST', '/scans', absent, expect=202).json()['id']}"
        self.call("capture", "DELETE", path)
        wait_for("cancelled", lambda: self.call("capture", "GET", path).json()["status"] == "cancelled", 30, 0.1)
        self.call("capture", "POST", f"{path}/resume", {}, expect=202)
        self.call("capture", "DELETE", path)
        wait_for("cancelled", lambda: self.call("capture", "GET", path).json()["status"] == "cancelled", 30, 0.1)
        self.call("capture", "GET", f"{path}/events", expect=200)
        self.call("capture", "DELETE", path, expect=200)

    def check_jobs_of(self, service, job):
        """Cancels a job, at the first try or once it has been queued again, and tries it again."""
        path = f"/jobs/{job}"

        def ended():
            return self.call(service, "GET", path, expect=200).json()["status"] in ENDED

        for _ in range(20):
            if self.call(service, "POST", f"{path}/cancel").status == 200:
                break
            wait_for("the job's end", ended, 60)
            self.call(service, "POST", f"{path}/retry", expect=200)
        wait_for("the cancelled job's end", ended, 60)
        self.call(service, "POST", f"{path}/retry", expect=200)
        self.call(service, "POST", f"{path}/retry")
        self.call(service, "POST", f"{path}/cancel")
        self.call(service, "GET", "/jobs?state=queued&limit=1", expect=200)
        self.call(service, "GET", "/jobs?state=dead", expect=400)
        self.call(service, "GET", "/jobs/job_unknown", expect=404)

    def test_3_jobs(self):
        busy = self.system.submit(sample_images(36))
        self.call("analysis", "POST", "/analyze", {"reconstruction": busy}, expect=202)  # waits for it, so it can be met
        page = self.call("analysis", "GET", f"/jobs?subject={busy}", expect=200).json()
        self.check_jobs_of("analysis", page["jobs"][0]["id"])
        self.check_jobs_of("reconstruction", busy)
        folder = SAMPLE / "calibration"
        parts = [("images", path.name, path.read_bytes()) for path in sorted(folder.glob("*.jpg"))]
        parts.append(("pattern", None, (folder / "pattern.json").read_text()))
        self.check_jobs_of("capture", self.post_parts("capture", "/calibrations", parts, 202).json()["id"])

    def test_9_every_described_operation_has_succeeded(self):
        succeeded = {entry[:3] for entry in self.seen if entry[3] < 300}
        self.assertEqual(self.contract.routes() - succeeded, set(), "never seen to succeed")


if __name__ == "__main__":
    unittest.main(verbosity=2)
