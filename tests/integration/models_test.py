#!/usr/bin/env python3
"""Background models: trained over HTTP from clouds and pictures, refused when hostile, used by an analysis."""
import json
import subprocess
import unittest

import pictures
from drupe import QUICK_OPTIONS, DrupeTest, sample_images, sample_parts, wait_for

UNKNOWN = "mdl_" + "a" * 20


def cloud(content=None):
    return ("cloud", "labelled.ply", pictures.labelled_ply() if content is None else content)


def picture(width=40):
    """A green disc on grey, and its mask."""
    def inside(x, y):
        return (x - 20) ** 2 + (y - 20) ** 2 < 150

    image = pictures.colour_png(40, 40, lambda x, y: (134, 155 + x % 9, 67) if inside(x, y) else (90 + x % 9,) * 3)
    mask = pictures.colour_png(width, 40, lambda x, y: (255,) * 3 if inside(x, y) else (0,) * 3)
    return [("image", "a.png", image), ("mask", "a_mask.png", mask)]


def classifier(weight):
    """The file of a classifier of defects: the longer, the more of a scar."""
    names = ("log_area", "log_elongation", "roundness", "width_mm", "depth_mm", "change_l", "change_a", "change_b")
    table = [[0, 0], [0, 0]]
    return {"format": "drupe-class-model", "version": 1, "name": "long", "ridge": 1, "reports": 2,
            "features": [{"name": name, "mean": 0, "scale": 1} for name in names],
            "classes": [{"class": "rain_spot", "bias": 0, "weights": [0] * 8},
                        {"class": "scar", "bias": -1, "weights": [0, weight] + [0] * 6}],
            "confusion": {"training": table, "left_out": table}}


class ModelsTest(DrupeTest):
    services = ("reconstruction", "analysis")

    def train(self, parts):
        reply = self.system.analysis.post_parts("/models", parts)
        self.assertEqual(reply.status, 202, reply)
        path = f"/models/{reply.json()['id']}"
        self.assertEqual(reply.headers["location"], path)
        return wait_for("model", lambda: self.ended(path), 60, 0.1)

    def ended(self, path):
        model = self.system.analysis.get(path).json()
        return model if model["status"] in ("succeeded", "failed") else None

    def test_train_from_a_cloud(self):
        model = self.train([cloud(), ("options", None, {"name": "green", "recoloured": 2})])
        self.assertEqual(model["status"], "succeeded", model)
        self.assertEqual(model["options"]["name"], "green")
        table = model["confusion"]["test"]
        self.assertEqual(table["points"], 300)
        self.assertEqual(table["fruit_as_fruit"], 150)
        self.assertEqual(table["background_as_background"], 150)
        self.assertEqual(table["accuracy"], 1)
        file = self.system.analysis.get(f"/models/{model['id']}/model.json").json()
        self.assertEqual(file["format"], "drupe-colour-model")
        self.assertEqual(len(file["support_vectors"]), model["support_vectors"])
        listed = [entry["id"] for entry in self.system.analysis.get("/models").json()["models"]]
        self.assertIn(model["id"], listed)

    def test_train_from_a_picture_with_its_mask_by_curl(self):
        folder = self.system.directory
        for name, _, content in [("image.png", None, picture()[0][2]), ("mask.png", None, picture()[1][2])]:
            (folder / name).write_bytes(content)
        out = subprocess.run(["curl", "-sS", "-F", f"image=@{folder}/image.png", "-F", f"mask=@{folder}/mask.png", "-F",
                              'options={"colour_space": "rgb"}', self.system.analysis.url + "/models"],
                             capture_output=True, check=True, text=True).stdout
        model = wait_for("model", lambda: self.ended(f"/models/{json.loads(out)['id']}"), 60, 0.1)
        self.assertEqual(model["status"], "succeeded", model)
        self.assertGreater(model["confusion"]["training"]["accuracy"], 0.99)

    def test_one_class_fails_with_the_reason(self):
        head, body = pictures.labelled_ply().split(b"end_header\n")
        only_fruit = head + b"end_header\n" + b"".join(body[i:i + 15] + b"\1" for i in range(0, len(body), 16))
        model = self.train([cloud(only_fruit)])
        self.assertEqual(model["status"], "failed")
        self.assertEqual(model["error"]["code"], "one_class")
        reply = self.system.analysis.get(f"/models/{model['id']}/model.json")
        self.assertEqual((reply.status, reply.error()["code"]), (409, "model_not_ready"))

    def test_refusals(self):
        half = pictures.labelled_ply()[:-7]
        for parts, status, code in [
                ([], 400, "invalid_multipart"),
                ([("options", None, {"name": "x"})], 400, "missing_part"),
                ([cloud(b"ply\n")], 422, "bad_ply"),
                ([cloud(half)], 422, "bad_ply"),
                ([cloud(pictures.labelled_ply("class"))], 422, "no_labels"),
                ([cloud(), ("options", None, {"kernel": "poly"})], 400, "unknown_option"),
                ([cloud(), ("options", None, {"c": -1})], 400, "invalid_option"),
                ([cloud(), ("options", None, "{")], 400, "invalid_json"),
                ([cloud(), ("options", None, {"name": "../x"})], 400, "invalid_option"),
                ([cloud(), ("extra", None, "x")], 400, "unknown_part"),
                (picture()[:1], 400, "missing_part"),
                (picture(41), 422, "mask_size"),
                ([("image", "a.png", b"GIF89a"), ("mask", "b.png", b"")], 415, "unsupported_image"),
                ([("image", "a.png", pictures.png_bomb())], 413, "image_too_large"),
                ([cloud()] * 17, 413, "too_many_parts")]:
            reply = self.system.analysis.post_parts("/models", parts)
            self.assertEqual((reply.status, reply.error()["code"]), (status, code), f"{parts!r:.200} {reply}")
        self.assertEqual(self.system.analysis.get(f"/models/{UNKNOWN}").status, 404)
        self.assertEqual(self.system.analysis.get("/models/..%2f..%2fetc").status, 404)

    def test_an_analysis_uses_the_model_that_it_names(self):
        job = self.system.reconstruction.post_parts(
            "/reconstruct", sample_parts(sample_images(12), QUICK_OPTIONS)).json()["id"]
        self.system.wait_for_report(job)
        model = self.train([cloud()])
        for name, status in [(model["id"], 202), ("none", 202), (UNKNOWN, 404), ("green", 400)]:
            reply = self.system.analysis.post_json(
                "/analyze", {"reconstruction": job, "options": {"background": {"model": name}}})
            self.assertEqual(reply.status, status, reply)
            if status == 202:
                report = self.system.wait_for_report(job)
                self.assertEqual(report["provenance"]["options"]["analysis"]["background"]["model"], name)
        for model, status in [(classifier(1), 202), ("rules", 202), (classifier(1e30), 400), ("svm", 400)]:
            reply = self.system.analysis.post_json(
                "/analyze", {"reconstruction": job, "options": {"class": {"model": model}}})
            self.assertEqual(reply.status, status, reply)
            if status == 202:
                used = self.system.wait_for_report(job)["provenance"]["options"]["analysis"]["class"]["model"]
                self.assertEqual(used if model == "rules" else used["name"], "rules" if model == "rules" else "long")


if __name__ == "__main__":
    unittest.main(verbosity=2)
