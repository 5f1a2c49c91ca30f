#!/usr/bin/env python3
"""Front and workers as processes of their own that meet in PostgreSQL; one of two workers is killed at its work."""
import hashlib
import sys
import unittest

from drupe import JOB_TIMEOUT_S, QUICK_OPTIONS, ROOT, Service, System, free_port, sample_images, wait_for, worker_pid

sys.path.insert(0, str(ROOT / "tests/postgres"))
from cluster import cluster_or_skip  # noqa: E402  (found through the line above)

LEASE_S = 3
IMAGES = 12


class WorkersTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.cluster = cluster_or_skip(cls.enterClassContext)
        cls.system = System()
        cls.addClassCleanup(cls.system.close)
        cls.wire()
        cls.system.start()

    @classmethod
    def wire(cls):
        """Fronts at the ports of the System; workers on one data directory with them, as on a shared disk."""
        system = cls.system
        shared = ["--jobs-url", cls.cluster.url, "--lease-s", str(LEASE_S)]
        system.services = [system.analysis, system.reconstruction]
        for service in (system.analysis, system.reconstruction):
            service.arguments += ["--role", "api", *shared]
        cls.workers = [system.worker("reconstruction", number, [*shared, "--analysis-url", system.analysis.url])
                       for number in range(2)]
        analysis_worker = system.worker("analysis", 0, [*shared, "--reconstruction-url", system.reconstruction.url])
        system.services += [*cls.workers, analysis_worker]

    def running_worker(self, job_id):
        """The worker process that a running job is at."""
        job = self.system.reconstruction.get(f"/jobs/{job_id}").json()
        if job["status"] != "running":
            return None
        return next(worker for worker in self.workers if worker.process.pid == worker_pid(job))

    def test_1_front_and_workers_make_a_report(self):
        job_id = self.system.submit(sample_images(IMAGES), QUICK_OPTIONS)
        self.assertEqual(self.system.wait_until_ended(job_id)["status"], "succeeded")
        self.assertEqual(self.system.wait_for_report(job_id)["id"], job_id)

    def test_2_other_worker_takes_the_job_of_a_killed_one(self):
        job_id = self.system.submit(sample_images(IMAGES, 2), QUICK_OPTIONS)
        killed = wait_for("a worker has the job", lambda: self.running_worker(job_id), JOB_TIMEOUT_S, 0.01)
        killed.kill()
        status = self.system.wait_until_ended(job_id)
        self.assertEqual(status["status"], "succeeded", status)
        self.assertEqual(status["attempt"], 2)
        history = self.system.reconstruction.get(f"/jobs/{job_id}").json()["history"]
        self.assertIn("retry: lease_expired", [event["reason"] for event in history])
        self.assertEqual([event["status"] for event in history].count("succeeded"), 1, "ended exactly once")
        self.assertEqual(self.system.wait_for_report(job_id)["id"], job_id)
        killed.start()

    def test_3_cancel_reaches_a_worker_of_another_process(self):
        job_id = self.system.submit(sample_images(IMAGES, 3), QUICK_OPTIONS)
        wait_for("a worker has the job", lambda: self.running_worker(job_id), JOB_TIMEOUT_S, 0.01)
        self.assertEqual(self.system.reconstruction.delete(f"/reconstructions/{job_id}").status, 202)
        self.assertEqual(self.system.wait_until_ended(job_id, 30)["status"], "cancelled")

    def test_4_image_sets_are_known_to_every_front(self):
        other = Service("reconstruction", self.system.directory, free_port(), self.system.reconstruction.arguments)
        set_id = self.system.reconstruction.post_json("/image-sets", {}).json()["id"]
        other.start()
        self.addCleanup(other.stop)
        self.assertEqual(other.get(f"/image-sets/{set_id}").status, 200)
        name, content = sample_images(1)[0]
        self.assertEqual(other.request("PUT", f"/image-sets/{set_id}/images/{name}", content).status, 201)
        images = self.system.reconstruction.get(f"/image-sets/{set_id}").json()["images"]
        self.assertEqual([image["name"] for image in images], [name])

    def test_5_database_that_is_restarted_costs_no_job(self):
        job_id = self.system.submit(sample_images(IMAGES, 2), QUICK_OPTIONS)
        wait_for("a worker has the job", lambda: self.running_worker(job_id), JOB_TIMEOUT_S, 0.01)
        self.cluster.stop()
        self.assertEqual(self.system.reconstruction.get("/readyz").status, 503)
        self.cluster.start()
        status = self.system.wait_until_ended(job_id)
        self.assertEqual(status["status"], "succeeded", status)

    def test_6_two_workers_share_one_job(self):
        """The same bytes as from one worker, and the other one has done a part at least."""
        options = {**QUICK_OPTIONS, "dense": {**QUICK_OPTIONS.get("dense", {}), "level": 1}}
        alone = self.system.submit(sample_images(IMAGES), options)
        self.assertEqual(self.system.wait_until_ended(alone)["status"], "succeeded")
        wanted = self.dense_sha256(alone)
        parts = {"sparse": {"parts": True}, "dense": {**options["dense"], "parts": 12}}
        for _ in range(5):
            shared = self.system.submit(sample_images(IMAGES), {**options, **parts})
            status = self.system.wait_until_ended(shared)
            self.assertEqual(status["status"], "succeeded", status)
            self.assertEqual(self.dense_sha256(shared), wanted)
            jobs = self.system.reconstruction.get(f"/jobs?kind=part&subject={shared}&limit=100").json()["jobs"]
            self.assertGreaterEqual(len(jobs), 12)
            if any(job["status"] == "succeeded" for job in jobs):
                return
        self.fail("the other worker took no part of five jobs")

    def dense_sha256(self, job_id):
        return hashlib.sha256(self.system.reconstruction.get(f"/reconstructions/{job_id}/dense.ply").body).hexdigest()


if __name__ == "__main__":
    unittest.main(verbosity=2)
