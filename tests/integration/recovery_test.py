#!/usr/bin/env python3
"""kill -9 in every stage: the service that starts again finds its job and finishes it, once."""
import unittest

from drupe import JOB_TIMEOUT_S, QUICK_OPTIONS, DrupeTest, sample_images, wait_for

STAGES = ("features", "matching", "sparse", "dense")  # those between them pass too quickly to be seen from outside
IMAGES = 12


class RecoveryTest(DrupeTest):
    reconstruction_arguments = ("--drain-s", "0.5")  # so that SIGTERM gives a job back instead of finishing it

    def wait_for_stage(self, job_id, stage):
        """Returns once the job is in `stage`; fails when it has ended before."""

        def in_stage():
            status = self.system.status(job_id)
            assert status["status"] in ("queued", "running"), status
            return status["status"] == "running" and status["stage"] == stage

        wait_for(f"stage {stage}", in_stage, JOB_TIMEOUT_S, 0.02)

    def test_reconstruction_killed_in_each_stage(self):
        for stage in STAGES:
            with self.subTest(stage=stage):
                job_id = self.system.submit(sample_images(IMAGES), QUICK_OPTIONS)
                self.wait_for_stage(job_id, stage)
                self.system.reconstruction.kill()
                self.system.reconstruction.start()
                status = self.system.wait_until_ended(job_id)
                self.assertEqual(status["status"], "succeeded", status)
                self.assertEqual(status["attempt"], 2, "it was killed in the middle, and repeated once")
                self.assertEqual(self.system.wait_for_report(job_id)["id"], job_id)

    def test_reconstruction_killed_while_jobs_wait(self):
        ids = [self.system.submit(sample_images(3, 2)) for _ in range(3)]
        self.system.reconstruction.kill()
        self.system.reconstruction.start()
        for job_id in ids:
            self.assertIn(self.system.wait_until_ended(job_id)["status"], ("succeeded", "failed"))

    def test_the_result_is_that_of_an_undisturbed_run(self):
        calm = self.system.submit(sample_images(IMAGES), QUICK_OPTIONS)
        self.assertEqual(self.system.wait_until_ended(calm)["status"], "succeeded")
        disturbed = self.system.submit(sample_images(IMAGES), QUICK_OPTIONS)
        self.wait_for_stage(disturbed, "dense")
        self.system.reconstruction.kill()
        self.system.reconstruction.start()
        self.system.wait_until_ended(disturbed)
        for name in ("cameras.json", "dense.ply"):
            tags = [self.system.reconstruction.get(f"/reconstructions/{job}/artifacts/{name}").headers["etag"]
                    for job in (calm, disturbed)]
            self.assertEqual(tags[0], tags[1], name)

    def test_analysis_killed_before_and_during_its_job(self):
        job_id = self.system.submit(sample_images(IMAGES), QUICK_OPTIONS)
        self.wait_for_stage(job_id, "dense")
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
        job_id = self.system.submit(sample_images(IMAGES), QUICK_OPTIONS)
        self.wait_for_stage(job_id, "features")
        self.assertEqual(self.system.reconstruction.stop(), 0)
        self.system.reconstruction.start()
        status = self.system.wait_until_ended(job_id)
        self.assertEqual((status["status"], status["attempt"]), ("succeeded", 2), status)


if __name__ == "__main__":
    unittest.main(verbosity=2)
