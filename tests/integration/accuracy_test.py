#!/usr/bin/env python3
"""The judge itself: results made from the truth, moved, scaled and spoiled by known amounts."""
import json
import math
import unittest

import accuracy
from drupe import SAMPLE

ANGLE, SCALE, SHIFT = 0.7, 0.8, [3, -2, 5]
TURN = [[math.cos(ANGLE), -math.sin(ANGLE), 0], [math.sin(ANGLE), math.cos(ANGLE), 0], [0, 0, 1]]
TRUTH = json.loads((SAMPLE / "truth.json").read_text())


def moved(point):
    return [SCALE * x + s for x, s in zip(accuracy.apply(TURN, point), SHIFT)]


def moved_camera(view, error_mm=0.0):
    centre = moved(accuracy.camera_centre(view))
    centre[0] += error_mm * SCALE
    rotation = [accuracy.apply(TURN, row) for row in view["R"]]
    return {"image": view["image"], "R": rotation, "t": [-x for x in accuracy.apply(rotation, centre)], "registered": True}


def report(defects, area_factor=1.0):
    return {"fruits": [{"defects": [{"centre_mm": moved(d["centre_mm"]), "area_mm2": d["area_mm2"] * area_factor}
                                    for d in defects]}]}


class AccuracyTest(unittest.TestCase):
    def setUp(self):
        self.cameras = {"cameras": [moved_camera(view) for view in TRUTH["views"]]}
        self.figures, self.alignment = accuracy.pose_figures(TRUTH, self.cameras)

    def test_the_truth_moved_is_without_error(self):
        self.assertEqual(self.figures["registered"], 36)
        self.assertAlmostEqual(self.figures["scale_needed"], 1 / SCALE, 9)
        self.assertLess(self.figures["centre_error_mm"], 1e-9)

    def test_errors_of_poses_are_seen(self):
        cameras = {"cameras": [moved_camera(view, 0.5 * (i % 2)) for i, view in enumerate(TRUTH["views"])]}
        self.assertAlmostEqual(accuracy.pose_figures(TRUTH, cameras)[0]["centre_error_mm"], 0.25, delta=0.01)

    def test_unregistered_views_do_not_count(self):
        self.cameras["cameras"][3]["registered"] = False
        self.assertEqual(accuracy.pose_figures(TRUTH, self.cameras)[0]["registered"], 35)

    def test_defects_found_missed_and_false(self):
        every = TRUTH["defects"]
        right = accuracy.defect_figures(TRUTH, report(every, 1.05), self.alignment)
        self.assertEqual((right["found"], right["false"]), (7, 0))
        self.assertAlmostEqual(right["median_area_error"], 0.05)
        elsewhere = {"centre_mm": TRUTH["centre_mm"], "area_mm2": 1}
        wrong = accuracy.defect_figures(TRUTH, report(every[:5] + [elsewhere]), self.alignment)
        self.assertEqual((wrong["found"], wrong["false"]), (5, 1))

    def test_cloud_errors_are_seen(self):
        surface = accuracy.read_ply_points(SAMPLE / "surface.ply")
        centre = TRUTH["centre_mm"]
        for error_mm in (0.0, 0.2):
            blown = [[c + (x - c) * (1 + error_mm / accuracy.norm(accuracy.subtract(p, centre))) for x, c in zip(p, centre)]
                     for p in surface[::40]]
            far = [[500.0, 0.0, 0.0]]
            found = accuracy.cloud_figures(TRUTH, surface, [moved(p) for p in blown + far], self.alignment)
            self.assertEqual(found["on_fruit"], len(blown))
            self.assertAlmostEqual(found["median_error_mm"], error_mm, delta=0.02)


if __name__ == "__main__":
    unittest.main(verbosity=2)
