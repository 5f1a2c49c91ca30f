#!/usr/bin/env python3
"""Uploading picture by picture, over an interruption, and reconstructing the set."""
import hashlib
import json
import unittest

import pictures
from drupe import QUICK_OPTIONS, SAMPLE, DrupeTest, sample_images

CALIBRATION = json.loads((SAMPLE / "calibration.json").read_text())
BOARD = json.loads((SAMPLE / "board.json").read_text())


class ImageSetsTest(DrupeTest):
    services = ("reconstruction", "analysis")

    def new_set(self):
        reply = self.system.reconstruction.post_json("/image-sets", {})
        self.assertEqual(reply.status, 201, reply)
        set_id = reply.json()["id"]
        self.assertEqual(reply.headers["location"], f"/image-sets/{set_id}")
        return set_id

    def put(self, set_id, name, content, headers=None):
        return self.system.reconstruction.request("PUT", f"/image-sets/{set_id}/images/{name}", content,
                                                  {"Content-Type": "image/jpeg", **(headers or {})})

    def names(self, set_id):
        return [image["name"] for image in self.system.reconstruction.get(f"/image-sets/{set_id}").json()["images"]]

    def test_upload_goes_on_after_an_interruption(self):
        images = sample_images(12)
        set_id = self.new_set()
        for name, content in images[:5]:
            reply = self.put(set_id, name, content)
            self.assertEqual(reply.status, 201, reply)
            self.assertEqual(reply.json()["sha256"], hashlib.sha256(content).hexdigest())
        self.system.reconstruction.kill()
        self.system.reconstruction.start()

        kept = self.names(set_id)
        self.assertEqual(kept, [name for name, _ in images[:5]], "acknowledged pictures survive kill -9")
        for name, content in images:
            if name not in kept:
                self.assertEqual(self.put(set_id, name, content).status, 201)
        self.assertEqual(self.names(set_id), [name for name, _ in images])

        request = {"image_set": set_id, "calibration": CALIBRATION, "board": BOARD, "options": QUICK_OPTIONS}
        reply = self.system.reconstruction.post_json("/reconstruct", request)
        self.assertEqual(reply.status, 202, reply)
        job_id = reply.json()["id"]
        self.assertEqual(self.system.wait_until_ended(job_id)["status"], "succeeded")
        self.assertEqual(self.system.wait_for_report(job_id)["provenance"]["image_set"], set_id)

    def test_repeating_a_picture_is_fine(self):
        name, content = sample_images(1)[0]
        set_id = self.new_set()
        self.assertEqual(self.put(set_id, name, content).status, 201)
        self.assertEqual(self.put(set_id, name, content).status, 200)
        self.assertEqual(self.names(set_id), [name])

    def test_a_picture_that_is_none_is_refused_and_not_kept(self):
        set_id = self.new_set()
        whole = sample_images(1)[0][1]
        self.assert_refused(self.put(set_id, "a.jpg", b"no picture"), 415, "unsupported_image", "JPEG")
        self.assert_refused(self.put(set_id, "a.jpg", whole[:9000]), 422, "bad_image")
        self.assert_refused(self.put(set_id, "a.png", pictures.png_bomb()), 413, "image_too_large", "30000")
        self.assertEqual(self.names(set_id), [])

    def test_an_upload_that_breaks_off_leaves_nothing(self):
        set_id = self.new_set()
        content = sample_images(1)[0][1]
        head = f"PUT /image-sets/{set_id}/images/a.jpg HTTP/1.1\r\nHost: x\r\nContent-Length: {len(content)}\r\n\r\n"
        self.system.reconstruction.send_raw(head.encode() + content[: len(content) // 2], timeout=0.5)
        self.assertEqual(self.names(set_id), [])

    def test_a_set_that_cannot_be_reconstructed(self):
        set_id = self.new_set()
        for name, content in sample_images(2):
            self.put(set_id, name, content)
        reply = self.system.reconstruction.post_json("/reconstruct", {"image_set": set_id})
        self.assert_refused(reply, 400, "too_few_images", "3", "2")

    def test_upload_to_no_set(self):
        name, content = sample_images(1)[0]
        self.assert_refused(self.put("set_unknown", name, content), 404, "image_set_not_found")


if __name__ == "__main__":
    unittest.main(verbosity=2)
