#!/usr/bin/env python3
"""The sample image set, with the defaults, from photographs to the report, and how far that lies from the truth."""
import csv
import io
import json
import unittest

import accuracy
import contract
from drupe import SAMPLE, DrupeTest, sample_images, sample_parts

ARTIFACTS = ("cameras.json", "sparse.ply", "dense.ply", "preview.ply", "colmap.zip", "model.nvm", "timings.json")


class HappyPathTest(DrupeTest):
    shared_data = True  # as deploy/up starts them; the pictures of defects need the photographs

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.images = sample_images(36)
        cls.accepted = cls.system.reconstruction.post_parts("/reconstruct", sample_parts(cls.images))
        cls.id = cls.accepted.json()["id"]
        cls.status = cls.system.wait_until_ended(cls.id)
        cls.report = cls.system.wait_for_report(cls.id)

    def test_request_is_accepted_at_once(self):
        self.assertEqual(self.accepted.status, 202)
        self.assertEqual(self.accepted.json()["status"], "queued")
        self.assertEqual(self.accepted.headers["location"], f"/reconstructions/{self.id}")

    def test_job_succeeds_with_timings_and_quality(self):
        self.assertEqual(self.status["status"], "succeeded", self.status)
        self.assertEqual(self.status["progress"], 1)
        self.assertEqual(self.status["quality"]["registered"], 36)
        self.assertGreater(self.status["timings"]["total_wall_s"], 0)

    def test_report_follows_its_schema(self):
        problems = contract.Contract().schema_problems({"$ref": "schemas/report.schema.json"}, self.report)
        self.assertEqual(problems, [])

    def test_report_names_its_reconstruction_and_inputs(self):
        self.assertEqual(self.report["id"], self.id)
        self.assertEqual(self.report["unit"], "mm")
        self.assertEqual(self.report["scale_source"], "board")
        self.assertEqual(len(self.report["provenance"]["image_sha256"]), 36)
        self.assertEqual(len(self.report["fruits"]), 1)
        self.assertEqual(self.report["fruits"][0]["grade"], "rain_spot")

    def test_report_as_csv_has_a_line_a_defect(self):
        reply = self.system.analysis.get(f"/reports/{self.id}.csv")
        self.assertEqual(reply.status, 200, reply)
        self.assertTrue(reply.headers["content-type"].startswith("text/csv"), reply.headers)
        rows = list(csv.DictReader(io.StringIO(reply.body.decode())))
        self.assertEqual(len(rows), len(self.report["fruits"][0]["defects"]))

    def test_report_is_listed(self):
        listed = self.system.analysis.get("/reports?grade=rain_spot&limit=10").json()["reports"]
        self.assertEqual([entry["id"] for entry in listed], [self.id])
        self.assertEqual(self.system.analysis.get("/reports?grade=decay").json()["reports"], [])

    def test_every_artifact_is_there(self):
        for name in ARTIFACTS:
            reply = self.system.reconstruction.get(f"/reconstructions/{self.id}/artifacts/{name}")
            self.assertEqual(reply.status, 200, (name, reply))
            self.assertGreater(len(reply.body), 100, name)

    def test_report_has_its_pictures_and_clouds(self):
        folder = f"/reports/{self.id}/artifacts"
        names = {artifact["name"] for artifact in self.system.analysis.get(folder).json()["artifacts"]}
        pictures = {f"defect_{fruit['id']}_{defect['id']}.png"
                    for fruit in self.report["fruits"] for defect in fruit["defects"]}
        self.assertGreater(len(pictures & names), len(pictures) / 2, names)  # some may have no view that shows them whole
        for name in {"contact_sheet.png"} | pictures & names:
            picture = self.system.analysis.get(f"{folder}/{name}")
            self.assertEqual(picture.headers["content-type"], "image/png")
            self.assertTrue(picture.body.startswith(b"\x89PNG\r\n\x1a\n"), name)
        self.assertTrue(self.system.analysis.get(f"{folder}/defects.ply").body.startswith(b"ply\nformat binary_little_endian"))
        samples = self.system.analysis.get(f"{folder}/observations.json").json()["observations"]
        self.assertEqual(len(samples), 1 + len(pictures))

    def test_result_is_accurate(self):
        artifacts = f"/reconstructions/{self.id}/artifacts"
        cameras = self.system.reconstruction.get(f"{artifacts}/cameras.json").json()
        cloud = self.system.directory / "dense.ply"
        cloud.write_bytes(self.system.reconstruction.get(f"{artifacts}/dense.ply").body)
        found = accuracy.figures(SAMPLE, cameras, self.report, cloud)
        print(json.dumps(found))
        self.assertEqual(found["poses"]["registered"], 36)
        self.assertLessEqual(found["poses"]["centre_error_mm"], 0.1)
        self.assertAlmostEqual(found["poses"]["scale_needed"], 1, delta=0.003)
        self.assertGreaterEqual(found["cloud"]["on_fruit"], 60_000)
        self.assertLessEqual(found["cloud"]["median_error_mm"], 0.1)
        self.assertEqual(found["defects"]["found"], found["defects"]["true"])
        self.assertEqual(found["defects"]["false"], 0)
        self.assertLessEqual(found["defects"]["median_area_error"], 0.10)


if __name__ == "__main__":
    unittest.main(verbosity=2)
