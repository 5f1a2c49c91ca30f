#!/usr/bin/env python3
"""The command line as a user calls it."""
import json
import pathlib
import shutil
import struct
import subprocess
import tempfile
import unittest

import pictures
from drupe import BIN, QUICK_OPTIONS, SAMPLE, sample_images


class CliTest(unittest.TestCase):
    def setUp(self):
        self.directory = pathlib.Path(tempfile.mkdtemp(prefix="drupe-cli-"))
        self.addCleanup(shutil.rmtree, self.directory)

    def drupe(self, *arguments):
        return subprocess.run([BIN / "drupe", *map(str, arguments)], capture_output=True, text=True, timeout=240, check=False)

    def pictures(self, count, step=1):
        folder = self.directory / "images"
        folder.mkdir()
        for name, content in sample_images(count, step):
            (folder / name).write_bytes(content)
        return folder

    def run_18(self, options):
        """The run of every second picture of the sample with a mesh, and the folder of what it wrote."""
        out = self.directory / "out"
        run = self.drupe("run", self.pictures(18, step=2), "--calibration", SAMPLE / "calibration.json", "--board",
                         SAMPLE / "board.json", "--out", out, "--options", json.dumps(options), "--mesh")
        self.assertEqual(run.returncode, 0, run.stderr)
        return run, out

    def test_run(self):
        run, out = self.run_18(QUICK_OPTIONS)
        self.check_mesh(out / "mesh.ply", 0.05)
        for name in ("cameras.json", "sparse.ply", "dense.ply", "preview.ply", "report.json", "timings.json"):
            self.assertTrue((out / name).is_file(), name)
        cameras = json.loads((out / "cameras.json").read_text())
        self.assertEqual((cameras["unit"], cameras["scale_source"]), ("mm", "board"))
        self.assertEqual(sum(camera["registered"] for camera in cameras["cameras"]), 18)
        self.assertIn("dense", run.stderr, "stages are shown")
        self.assertNotIn("\x1b", run.stderr, "without a terminal, plain lines")

    def test_mesh_of_denser_points(self):
        self.check_mesh(self.run_18(QUICK_OPTIONS | {"dense": {"level": 1}})[1] / "mesh.ply", 0.03)

    def check_mesh(self, path, tolerance):
        """Closed, each edge in one triangle either way, and as large as the fruit but for that share of its volume."""
        header, body = path.read_bytes().split(b"end_header\n", 1)
        counts = [int(line.split()[2]) for line in header.splitlines() if line.startswith(b"element")]
        vertices = [struct.unpack_from("<3f", body, 12 * i) for i in range(counts[0])]
        faces = [struct.unpack_from("<B3I", body, 12 * counts[0] + 13 * i) for i in range(counts[1])]
        edges = {(face[a], face[b]) for face in faces for a, b in ((1, 2), (2, 3), (3, 1))}
        self.assertEqual(len(edges), 3 * len(faces))
        self.assertTrue(all((b, a) in edges for a, b in edges), "the mesh has a hole")
        volume = 0
        for _, *corners in faces:
            (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (vertices[corner] for corner in corners)
            volume += (ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)) / 6
        truth = json.loads((SAMPLE / "truth.json").read_text())["volume_mm3"]
        self.assertAlmostEqual(volume / truth, 1, delta=tolerance)

    def corrected_report(self, name, scale):
        """A report with three rain spots and two cracks, as a person has left it."""
        def defect(kind, length, width, roundness, lightness):
            return {"class": kind, "area_mm2": 0.785 * length * width, "length_mm": length, "width_mm": width,
                    "roundness": roundness, "depth_mm": 0.01, "lab_change": [lightness, 15, -20]}

        spots = [defect("rain_spot", size * scale, size * scale, 0.99, -15) for size in (1, 2, 3)]
        cracks = [defect("crack", size * scale, 0.5 * scale, 0.1, -25) for size in (8, 11)]
        file = self.directory / name
        file.write_text(json.dumps({"unit": "mm", "fruits": [{"defects": spots + cracks}]}))
        return file

    def test_train_a_classifier_from_corrected_reports(self):
        model, out = self.directory / "classes.json", self.directory / "out"
        reports = [self.corrected_report("a.json", 1), self.corrected_report("b.json", 1.2)]
        run = self.drupe("classifier", "train", *reports, "--name", "mine", "--out", model)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("Each report by a model of the others: 10 of 10 right", run.stdout)
        self.assertIn("log_elongation", self.drupe("classifier", "show", model).stdout)
        cloud = self.directory / "labelled.ply"
        cloud.write_bytes(pictures.labelled_ply())
        run = self.drupe("analyze", cloud, "--class-model", model, "--out", out)
        self.assertEqual(run.returncode, 0, run.stderr)
        report = json.loads((out / "report.json").read_text())
        self.assertEqual(report["provenance"]["options"]["class"]["model"]["name"], "mine")
        reports[0].write_text(reports[0].read_text().replace("crack", "bruise"))
        run = self.drupe("classifier", "train", *reports, "--out", model)
        self.assertEqual(run.returncode, 1)
        self.assertIn("fruits[0].defects[3].class", run.stderr)

    def test_train_a_model_and_analyse_a_cloud_with_it(self):
        cloud, model, out = (self.directory / name for name in ("labelled.ply", "model.json", "out"))
        cloud.write_bytes(pictures.labelled_ply())
        run = self.drupe("model", "train", "--cloud", cloud, "--labels", "property", "--options", '{"name": "mine"}', "--out", model)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("100.00 %", run.stdout)
        self.assertEqual(json.loads(model.read_text())["name"], "mine")
        self.assertIn("support vectors in lab", self.drupe("model", "show", "default").stdout)
        run = self.drupe("analyze", cloud, "--background-model", model, "--out", out)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("No fruit found", run.stdout)
        self.assertEqual(json.loads((out / "report.json").read_text())["fruits"], [])

    def test_analyse_and_train_refuse_with_the_reason(self):
        cloud = self.directory / "labelled.ply"
        cloud.write_bytes(pictures.labelled_ply())
        broken = self.directory / "broken.json"
        broken.write_text('{"format": "other"}')
        for arguments, reason in [
                (("analyze", cloud, "--background-model", broken, "--out", self.directory), "format"),
                (("analyze", cloud, "--options", '{"background": {"model": "mdl_0"}}', "--out", self.directory), "mdl_0"),
                (("analyze", self.directory / "none.ply", "--out", self.directory), "none.ply"),
                (("model", "train", "--cloud", cloud, "--out", broken), "labels"),
                (("model", "show", broken), "format")]:
            run = self.drupe(*arguments)
            self.assertEqual(run.returncode, 1, run.stdout)
            self.assertIn(reason, run.stderr)

    def test_calibrate(self):
        out = self.directory / "calibration.json"
        run = self.drupe("calibrate", SAMPLE / "calibration", "--pattern", SAMPLE / "calibration/pattern.json", "--out", out)
        self.assertEqual(run.returncode, 0, run.stderr)
        found, true = json.loads(out.read_text()), json.loads((SAMPLE / "calibration.json").read_text())
        self.assertEqual((found["width"], found["height"]), (1280, 720))
        self.assertAlmostEqual(found["K"][0][0] / true["K"][0][0], 1, delta=0.01)
        self.assertLess(found["rms_px"], 0.5)

    def test_vocabulary(self):
        images, words, out = self.pictures(3), self.directory / "words", self.directory / "out"
        trained = self.drupe("vocabulary", images, "--out", words, "--options", json.dumps(QUICK_OPTIONS))
        self.assertEqual(trained.returncode, 0, trained.stderr)

        def run(vocabulary):
            options = {**QUICK_OPTIONS, "run_dense": False, "similarity": {"vocabulary": str(vocabulary)}}
            return self.drupe("run", images, "--calibration", SAMPLE / "calibration.json", "--board",
                              SAMPLE / "board.json", "--out", out, "--options", json.dumps(options))

        self.assertEqual(run(words).returncode, 0)
        self.assertIn("file_not_found", run(self.directory / "none").stderr)
        words.write_bytes(words.read_bytes()[:-100])
        self.assertIn("bad_vocabulary", run(words).stderr)

    def test_board(self):
        run = self.drupe("board", "--out", self.directory)
        self.assertEqual(run.returncode, 0, run.stderr)
        suffixes = {path.suffix for path in self.directory.iterdir()}
        self.assertTrue({".svg", ".png"} <= suffixes, suffixes)

    def test_wrong_arguments(self):
        for arguments, words in ((["run"], "IMAGES_DIR"), (["fly"], "subcommand"), ([], "subcommand")):
            with self.subTest(arguments=arguments):
                run = self.drupe(*arguments)
                self.assertEqual(run.returncode, 2, run)
                self.assertIn(words.lower(), (run.stderr + run.stdout).lower())

    def test_work_that_cannot_be_done(self):
        for arguments, words in ((["run", self.directory / "none", "--out", self.directory], "none"),
                                 (["run", self.pictures(2), "--out", self.directory], "3")):
            with self.subTest(arguments=arguments):
                run = self.drupe(*arguments)
                self.assertIn(run.returncode, (1, 2), run)
                self.assertIn(words, run.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
