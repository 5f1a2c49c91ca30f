#!/usr/bin/env python3
"""Idempotent repeats, and cancelling jobs that wait, run and have ended."""
import concurrent.futures
import unittest

from drupe import QUICK_OPTIONS, DrupeTest, sample_images, sample_parts, wait_for

CANCEL_TIMEOUT_S = 15


class JobsTest(DrupeTest):
    services = ("reconstruction",)

    def post(self, key, images=None, options=QUICK_OPTIONS):
        parts = sample_parts(images or sample_images(12), options)
        return self.system.reconstruction.post_parts("/reconstruct", parts, {"Idempotency-Key": key})

    def cancel(self, job_id):
        return self.system.reconstruction.delete(f"/reconstructions/{job_id}")

    def test_the_same_key_is_the_same_job(self):
        first, second = self.post("repeat"), self.post("repeat")
        self.assertEqual((first.status, second.status), (202, 202), (first, second))
        self.assertEqual(first.json()["id"], second.json()["id"])
        self.cancel(first.json()["id"])

    def test_the_same_key_from_many_at_once_is_one_job(self):
        with concurrent.futures.ThreadPoolExecutor(6) as pool:
            replies = list(pool.map(lambda _: self.post("crowd"), range(6)))
        self.assertEqual({reply.status for reply in replies}, {202}, replies)
        self.assertEqual(len({reply.json()["id"] for reply in replies}), 1)
        self.cancel(replies[0].json()["id"])

    def test_the_same_key_with_another_request_is_refused(self):
        first = self.post("changed")
        self.assert_refused(self.post("changed", sample_images(11)), 409, "idempotency_key_reused")
        self.cancel(first.json()["id"])

    def test_without_a_key_every_request_is_a_job(self):
        ids = {self.system.submit(sample_images(3)) for _ in range(2)}
        self.assertEqual(len(ids), 2)
        for job_id in ids:
            self.cancel(job_id)

    def test_cancel_running_and_queued(self):
        running = self.system.submit(sample_images(36))
        queued = self.system.submit(sample_images(36))
        wait_for("running", lambda: self.system.status(running)["status"] == "running", CANCEL_TIMEOUT_S)
        self.assertEqual(self.system.status(queued)["status"], "queued")

        self.assertIn(self.cancel(queued).status, (200, 202))
        self.assertEqual(self.system.status(queued)["status"], "cancelled")
        self.assertIn(self.cancel(running).status, (200, 202))
        self.assertEqual(self.system.wait_until_ended(running, CANCEL_TIMEOUT_S)["status"], "cancelled")

        self.assertIn(self.cancel(running).status, (200, 202), "cancelling again is fine")
        self.assertEqual(self.system.reconstruction.get(f"/reconstructions/{running}/artifacts/cameras.json").status, 404)

    def test_cancel_after_the_end_is_refused(self):
        job_id = self.system.submit(sample_images(3))
        ended = self.system.wait_until_ended(job_id)
        self.assertIn(ended["status"], ("succeeded", "failed"))
        self.assert_refused(self.cancel(job_id), 409, "job_finished")

    def test_cancel_of_nothing(self):
        self.assert_refused(self.cancel("rec_doesnotexist"), 404, "job_not_found")


if __name__ == "__main__":
    unittest.main(verbosity=2)
