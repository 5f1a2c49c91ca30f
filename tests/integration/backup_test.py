#!/usr/bin/env python3
"""Backup and restore as deploy/README.md tells them, and `drupe store` on what comes back."""
import hashlib
import shutil
import subprocess
import sys
import unittest

from drupe import BIN, QUICK_OPTIONS, ROOT, Service, System, free_port, sample_images

sys.path.insert(0, str(ROOT / "tests/postgres"))
from cluster import cluster_or_skip  # noqa: E402  (found through the line above)


def drupe_store(*arguments):
    return subprocess.run([BIN / "drupe", "store", *map(str, arguments)], capture_output=True, text=True, timeout=60)


class BackupTest(unittest.TestCase):
    def setUp(self):
        self.system = System()
        self.addCleanup(self.system.close)
        self.system.services = [self.system.reconstruction]
        self.service = self.system.reconstruction

    def artifact_of_a_finished_job(self):
        job_id = self.system.submit(sample_images(12), QUICK_OPTIONS)
        self.assertEqual(self.system.wait_until_ended(job_id)["status"], "succeeded")
        path = f"/reconstructions/{job_id}/artifacts/dense.ply"
        return path, self.service.get(path).body

    def test_sqlite_stopped_copied_and_back(self):
        self.system.start()
        path, cloud = self.artifact_of_a_finished_job()
        self.service.stop()
        backup = self.system.directory / "backup"
        shutil.copytree(self.service.data, backup)
        shutil.rmtree(self.service.data)
        shutil.copytree(backup, self.service.data)
        self.service.start()
        self.assertEqual(self.service.get(path).body, cloud)

    def test_postgres_dumped_while_it_works_then_restored_elsewhere(self):
        cluster, other = (cluster_or_skip(self.enterContext) for _ in range(2))
        self.service.arguments += ["--jobs-url", cluster.url]
        self.system.start()
        path, cloud = self.artifact_of_a_finished_job()
        dump, backup = self.system.directory / "jobs.dump", self.system.directory / "backup"
        # The database first: every object that a row names was there before the row.
        subprocess.run([cluster.programs / "pg_dump", "-Fc", "-f", dump, cluster.url], check=True)
        shutil.copytree(self.service.data / "objects", backup / "objects")
        subprocess.run([other.programs / "pg_restore", "-d", other.url, dump], check=True)
        restored = Service("reconstruction", self.system.directory / "restored", free_port(), ["--jobs-url", other.url])
        restored.log_path.parent.mkdir()
        shutil.copytree(backup, restored.data)
        self.addCleanup(restored.stop)
        restored.start()
        self.assertEqual(restored.get(path).body, cloud)

    def test_damage_is_found_set_aside_and_mended_from_a_backup(self):
        self.system.start()
        path, cloud = self.artifact_of_a_finished_job()
        digest = self.service.get(path).headers["etag"].strip('"')
        self.service.stop()
        stored = self.service.data / "objects" / digest[:2] / digest
        stored.write_bytes(cloud[:-1] + b"\x00" if cloud[-1:] != b"\x00" else cloud[:-1] + b"\x01")
        found = drupe_store("check", "--data", self.service.data)
        self.assertEqual(found.returncode, 1, found)
        self.assertIn(digest, found.stdout)
        self.assertEqual(drupe_store("repair", "--data", self.service.data).returncode, 0)
        self.service.start()
        self.assertFalse(stored.exists())
        self.assertGreaterEqual(self.service.get(path).status, 400, "never the damaged bytes")
        stored.write_bytes(cloud)
        self.assertEqual(self.service.get(path).body, cloud)

    def test_garbage_goes_and_what_is_referred_to_stays(self):
        self.system.start()
        path, cloud = self.artifact_of_a_finished_job()
        running = drupe_store("gc", "--data", self.service.data, "--min-age-h", 0)
        self.assertEqual(running.returncode, 1, "not while a service owns the database")
        self.assertIn("another running process", running.stderr)
        self.service.stop()
        digest = hashlib.sha256(b"garbage").hexdigest()
        garbage = self.service.data / "objects" / digest[:2] / digest
        garbage.write_bytes(b"garbage")
        self.assertEqual(drupe_store("gc", "--data", self.service.data).returncode, 0)
        self.assertTrue(garbage.exists(), "younger than a day")
        self.assertEqual(drupe_store("gc", "--data", self.service.data, "--min-age-h", 0).returncode, 0)
        self.assertFalse(garbage.exists())
        self.service.start()
        self.assertEqual(self.service.get(path).body, cloud)


if __name__ == "__main__":
    unittest.main(verbosity=2)
