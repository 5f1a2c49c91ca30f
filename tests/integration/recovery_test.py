#!/usr/bin/env python3
"""kill -9 in every stage: the service that starts again finds its job and finishes it, once."""
import itertools
import time
import unittest

from drupe import JOB_TIMEOUT_S, QUICK_OPTIONS, DrupeTest, sample_images, unix_s, wait_for

STAGES = ("features", "matching", "sparse", "dense")  # those between them pass too quickly to be seen from outside
IMAGES = 12
TRIES = 10  # a stage may pass between two looks at it: the job is then submitted again


class RecoveryTest(DrupeTest):
    reconstruction_arguments = ("--drain-s", "0.1")  # so that SIGTERM gives a job back instead of finishing it
    feature_budgets = itertools.count(1500)

    def seen_in_stage(self, job_id, stage):
        """True once the job is seen in `stage`; False when it has succeeded without being seen there."""

        def state():
            status = self.system.status(job_id)
            if status["status"] == "succeeded":
                return "missed"
            self.assertIn(status["status"], ("queued", "running"), status)
            return "seen" if status["status"] == "running" and status["stage"] == stage else None

        return wait_for(f"stage {stage}", state, JOB_TIMEOUT_S, 0.005) == "seen"

    def submit_into_stage(self, stage, options=None):
        """Submits the sample and returns the id of the job once it is seen in `stage`.

        Features are kept by their options and shared by all jobs, so a budget of its own makes each job compute them.
        """
        for budget in itertools.islice(self.feature_budgets, TRIES):
            job_id = self.system.submit(sample_images(IMAGES),
                                        options or QUICK_OPTIONS | {"features": {"max_features": budget}})
            if self.seen_in_stage(job_id, stage):
                return job_id
        raise AssertionError(f"no job of {TRIES} was seen in the stage {stage}")

    def interrupt_in_stage(self, stage, stop, options=None):
        """The status of a job that has ended after its service was stopped in `stage` and started again.

        A job that its first attempt finished must have been finished when the service was gone; another one is tried then.
        """
        for _ in range(TRIES):
            job_id = self.submit_into_stage(stage, options)
            stop()
            gone_s = time.time()
            self.system.reconstruction.start()
            status = self.system.wait_until_ended(job_id)
            if status["attempt"] > 1:
                return status
            self.assertEqual(status["status"], "succeeded", status)
            self.assertLessEqual(unix_s(status["finished_at"]), gone_s, status)
        raise AssertionError(f"no job of {TRIES} was interrupted in the stage {stage}")

    def test_reconstruction_killed_in_each_stage(self):
        for stage in STAGES:
            with self.subTest(stage=stage):
                status = self.interrupt_in_stage(stage, self.system.reconstruction.kill)
                self.assertEqual((status["status"], status["attempt"]), ("succeeded", 2), status)
                self.assertEqual(self.system.wait_for_report(status["id"])["id"], status["id"])

    def test_reconstruction_killed_while_jobs_wait(self):
        ids = [self.system.submit(sample_images(3, 2)) for _ in range(3)]
        self.system.reconstruction.kill()
        self.system.reconstruction.start()
        for job_id in ids:
            self.assertIn(self.system.wait_until_ended(job_id)["status"], ("succeeded", "failed"))

    def test_the_result_is_that_of_an_undisturbed_run(self):
        calm = self.system.submit(sample_images(IMAGES), QUICK_OPTIONS)
        self.assertEqual(self.system.wait_until_ended(calm)["status"], "succeeded")
        disturbed = self.interrupt_in_stage("dense", self.system.reconstruction.kill, QUICK_OPTIONS)["id"]
        for name in ("cameras.json", "dense.ply"):
            tags = [self.system.reconstruction.get(f"/reconstructions/{job}/artifacts/{name}").headers["etag"]
                    for job in (calm, disturbed)]
            self.assertEqual(tags[0], tags[1], name)

    def test_analysis_killed_before_and_during_its_job(self):
        job_id = self.submit_into_stage("dense")
        self.system.analysis.kill()
        self.assertEqual(self.system.wait_until_ended(job_id)["status"], "succeeded")
        self.system.analysis.start()

        def known():
            return self.system.analysis.get(f"/reports/{job_id}").status in (200, 202)

        wait_for("the analysis has heard of the job", known, 60, 0.01)
        self.system.analysis.kill()
        self.system.analysis.start()
        self.assertEqual(self.system.wait_for_report(job_id)["id"], job_id)

    def test_sigterm_gives_a_running_job_back(self):
        def stop():
            self.assertEqual(self.system.reconstruction.stop(), 0)

        status = self.interrupt_in_stage("features", stop)
        self.assertEqual((status["status"], status["attempt"]), ("succeeded", 2), status)


if __name__ == "__main__":
    unittest.main(verbosity=2)
