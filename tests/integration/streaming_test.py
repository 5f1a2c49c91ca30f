#!/usr/bin/env python3
"""Pictures that are prepared while they arrive: the job finds there what it needs of them, and gives the same bytes."""
import json
import re
import unittest

from drupe import QUICK_OPTIONS, SAMPLE, DrupeTest, System, sample_images, wait_for

CALIBRATION = json.loads((SAMPLE / "calibration.json").read_text())
BOARD = json.loads((SAMPLE / "board.json").read_text())
OPTIONS = {**QUICK_OPTIONS, "run_dense": False}
DOCUMENTS = {"calibration": CALIBRATION, "board": BOARD, "options": OPTIONS}
IMAGES = 8
PREPARE_TIMEOUT_S = 60

# More pictures than are matched each with each, so that likeness decides what is matched.
TRAINED_ON = 5
COMPARED = sample_images(14)
COMPARING = {**DOCUMENTS, "options": {"features": {"first_octave": 0, "max_features": 1500}, "run_dense": False,
                                      "similarity": {"training_images": TRAINED_ON},
                                      "clusters": {"exhaustive_max_images": 0, "sequence_window": 1}}}
SPARSE = ("cameras.json", "sparse.ply")


def metric(service, name):
    return float(re.search(rf"^{name} (\S+)", service.get("/metrics").body.decode(), re.MULTILINE).group(1))


def stream(system, images, announced):
    """A new set with these pictures."""
    set_id = system.reconstruction.post_json("/image-sets", announced).json()["id"]
    for name, content in images:
        reply = system.reconstruction.request("PUT", f"/image-sets/{set_id}/images/{name}", content)
        assert reply.status == 201, reply
    return set_id


def reconstruct(system, set_id, documents):
    """cameras.json of the set."""
    return artifacts(system, set_id, documents, "cameras.json")[0]


def artifacts(system, set_id, documents, *names):
    """These files of a reconstruction of the set."""
    reply = system.reconstruction.post_json("/reconstruct", {"image_set": set_id, "analyze": False, **documents})
    assert reply.status == 202, reply
    job_id = reply.json()["id"]
    status = system.wait_until_ended(job_id)
    assert status["status"] == "succeeded", status
    return [system.reconstruction.get(f"/reconstructions/{job_id}/artifacts/{name}").body for name in names]


def wait_until_prepared(system):
    """Nothing is left to do while the next picture, or the request, is awaited."""
    def left():
        return sum(metric(system.reconstruction, f"drupe_jobs_{state}") for state in ("queued", "running"))

    wait_for("all that is done ahead", lambda: left() == 0, PREPARE_TIMEOUT_S)


def wait_for_misses(system, count):
    wait_for(f"{count} things computed of pictures",
             lambda: metric(system.reconstruction, "drupe_derived_misses") >= count, PREPARE_TIMEOUT_S)


class StreamingTest(DrupeTest):
    services = ("reconstruction",)

    def new_system(self, *arguments):
        """A service with an empty memory."""
        system = System(arguments)
        self.addCleanup(system.close)
        return system.start("reconstruction")

    def assert_known(self, system, hits, misses):
        self.assertEqual(metric(system.reconstruction, "drupe_derived_hits"), hits)
        self.assertEqual(metric(system.reconstruction, "drupe_derived_misses"), misses)

    def assert_prepared(self, system, set_id):
        """The set tells what was found in every picture."""
        def prepared():
            pictures = system.reconstruction.get(f"/image-sets/{set_id}").json()["images"]
            return [picture["prepared"] for picture in pictures if "prepared" in picture]

        wait_for("every picture to be prepared", lambda: len(prepared()) == IMAGES, PREPARE_TIMEOUT_S)
        for one in prepared():
            self.assertGreater(one["features"], 100)

    def test_the_job_finds_everything_there_and_gives_the_same_bytes(self):
        images, parts = sample_images(IMAGES), 2 * IMAGES  # features and board of each
        system = self.new_system()
        set_id = stream(system, images, DOCUMENTS)
        wait_for_misses(system, parts)
        self.assert_prepared(system, set_id)
        streamed = reconstruct(system, set_id, {})
        self.assert_known(system, parts, parts)

        system.reconstruction.kill()
        system.reconstruction.start()
        again = reconstruct(system, set_id, {})
        self.assert_known(system, parts, 0)

        forgetful = self.new_system("--prepare-workers", "0", "--cache-mb", "0")
        alone = reconstruct(forgetful, stream(forgetful, images, {}), DOCUMENTS)
        self.assert_known(forgetful, 0, parts)
        self.assertEqual(streamed, alone)
        self.assertEqual(again, alone)

    def test_what_pictures_look_like_is_known_when_the_last_has_come(self):
        system = self.new_system()
        set_id = stream(system, COMPARED, COMPARING)
        count = len(COMPARED)
        parts = 2 * count + 1 + count  # features and board, the words, descriptions
        pairs = count - 1              # at least: each with the one before it
        wait_until_prepared(system)
        hits, misses = (metric(system.reconstruction, f"drupe_derived_{what}") for what in ("hits", "misses"))
        self.assertGreaterEqual(misses, parts + count + pairs)  # what stands still in each, and the pairs
        streamed = artifacts(system, set_id, {}, *SPARSE)
        self.assertEqual(metric(system.reconstruction, "drupe_derived_misses"), misses)
        self.assertGreaterEqual(metric(system.reconstruction, "drupe_derived_hits"), hits + parts + pairs)

        forgetful = self.new_system("--prepare-workers", "0", "--cache-mb", "0")
        batch = artifacts(forgetful, stream(forgetful, COMPARED, {}), COMPARING, *SPARSE)
        self.assertEqual(streamed, batch)

        reverse = self.new_system()
        set_id = stream(reverse, [(COMPARED[0][0], COMPARED[-1][1]), *reversed(COMPARED[1:])], COMPARING)
        name, content = COMPARED[0]  # which was another picture till now
        put = f"/image-sets/{set_id}/images/{name}"
        self.assertEqual([reverse.reconstruction.request("PUT", put, content).status for _ in range(2)], [200, 200])
        self.assertEqual(artifacts(reverse, set_id, {}, *SPARSE), batch)

    def test_another_request_than_announced_is_obeyed(self):
        set_id = stream(self.system, sample_images(IMAGES), {"options": OPTIONS})
        reply = self.system.reconstruction.post_json(
            "/reconstruct", {"image_set": set_id, "options": {**OPTIONS, "features": {"max_features": 1000}}})
        status = self.system.wait_until_ended(reply.json()["id"])
        self.assertEqual(status["status"], "succeeded", status)

    def test_a_kill_while_pictures_are_prepared_loses_none(self):
        # The whole sample, with features of its own: sent far quicker than they are computed.
        options = {"features": {"max_features": 1200}, "run_dense": False}
        set_id = stream(self.system, sample_images(36), {**DOCUMENTS, "options": options})
        self.system.reconstruction.kill()
        self.system.reconstruction.start()
        wait_for_misses(self.system, 1)  # those that were queued are still done
        self.assertEqual(len(json.loads(reconstruct(self.system, set_id, {}))["cameras"]), 36)

    def test_what_is_announced_is_checked(self):
        post = self.system.reconstruction.post_json
        self.assert_refused(post("/image-sets", {"colour": "red"}), 400, "unknown_option", "colour")
        self.assert_refused(post("/image-sets", {"calibration": {"width": 3}}), 400, "invalid_calibration")
        self.assert_refused(post("/image-sets", {"options": {"features": {"max_features": 0}}}), 400, "invalid_option")
        self.assert_refused(post("/image-sets", []), 400, "invalid_request")


if __name__ == "__main__":
    unittest.main(verbosity=2)
