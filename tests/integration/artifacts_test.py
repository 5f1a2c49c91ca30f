#!/usr/bin/env python3
"""ETag and Range on artifacts, and the server-sent events of a job."""
import http.client
import json
import unittest

from drupe import QUICK_OPTIONS, DrupeTest, sample_images


class ArtifactsTest(DrupeTest):
    services = ("reconstruction",)

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.id = cls.system.submit(sample_images(12), QUICK_OPTIONS)
        cls.events = list(cls.follow(cls.id))
        cls.path = f"/reconstructions/{cls.id}/artifacts/dense.ply"
        cls.whole = cls.system.reconstruction.get(cls.path)

    @classmethod
    def follow(cls, job_id):
        """Yields (event, data) until the service ends the stream."""
        connection = http.client.HTTPConnection("127.0.0.1", cls.system.reconstruction.port, timeout=120)
        connection.request("GET", f"/reconstructions/{job_id}/events", headers={"Accept": "text/event-stream"})
        reply = connection.getresponse()
        assert reply.status == 200 and reply.getheader("Content-Type").startswith("text/event-stream"), reply.status
        event = None
        for line in (raw.decode().rstrip("\r\n") for raw in reply):
            if line.startswith("event:"):
                event = line[6:].strip()
            elif line.startswith("data:"):
                yield event, json.loads(line[5:])
        connection.close()

    def get(self, **headers):
        return self.system.reconstruction.get(self.path, {name.replace("_", "-"): value for name, value in headers.items()})

    def test_events_tell_the_stages_and_the_end(self):
        statuses = [data for _, data in self.events]
        self.assertEqual(statuses[-1]["status"], "succeeded", statuses[-1])
        stages = [status.get("stage") for status in statuses]
        self.assertIn("dense", stages)
        progress = [status["progress"] for status in statuses]
        self.assertEqual(progress, sorted(progress))
        self.assertEqual(progress[-1], 1)

    def test_events_of_an_ended_job_end_at_once(self):
        events = list(self.follow(self.id))
        self.assertEqual(len(events), 1, events)
        self.assertEqual(events[0][1]["status"], "succeeded")

    def test_whole_has_etag_and_length(self):
        self.assertEqual(self.whole.status, 200, self.whole)
        self.assertTrue(self.whole.body.startswith(b"ply\n"))
        self.assertEqual(int(self.whole.headers["content-length"]), len(self.whole.body))
        self.assertRegex(self.whole.headers["etag"], r'^"[0-9a-f]{64}"$')
        self.assertEqual(self.whole.headers["accept-ranges"], "bytes")

    def test_known_etag_is_not_sent_again(self):
        reply = self.get(If_None_Match=self.whole.headers["etag"])
        self.assertEqual((reply.status, reply.body), (304, b""))
        self.assertEqual(self.get(If_None_Match='"other"').status, 200)

    def test_head_has_the_headers_alone(self):
        reply = self.system.reconstruction.request("HEAD", self.path)
        self.assertEqual((reply.status, reply.body), (200, b""))
        self.assertEqual(reply.headers["etag"], self.whole.headers["etag"])
        self.assertEqual(int(reply.headers["content-length"]), len(self.whole.body))

    def test_ranges(self):
        size = len(self.whole.body)
        for asked, start, end in (("0-99", 0, 100), ("100-199", 100, 200), (f"{size - 10}-", size - 10, size),
                                  ("-10", size - 10, size), (f"0-{size * 2}", 0, size)):
            with self.subTest(range=asked):
                reply = self.get(Range=f"bytes={asked}")
                self.assertEqual(reply.status, 206, reply)
                self.assertEqual(reply.body, self.whole.body[start:end])
                self.assertEqual(reply.headers["content-range"], f"bytes {start}-{end - 1}/{size}")

    def test_parts_make_the_whole(self):
        half = len(self.whole.body) // 2
        first = self.get(Range=f"bytes=0-{half - 1}")
        rest = self.get(Range=f"bytes={half}-", If_Range=self.whole.headers["etag"])
        self.assertEqual(rest.status, 206, rest)
        self.assertEqual(first.body + rest.body, self.whole.body)

    def test_a_range_of_other_bytes_gives_the_whole(self):
        self.assertEqual(self.get(Range="bytes=0-9", If_Range='"other"').status, 200)

    def test_bad_ranges(self):
        size = len(self.whole.body)
        for asked in (f"bytes={size}-", "bytes=-0", "bytes=0-1,5-6"):
            with self.subTest(range=asked):
                reply = self.get(Range=asked)
                self.assert_refused(reply, 416, "range_not_satisfiable")
                self.assertEqual(reply.headers["content-range"], f"bytes */{size}")
        for asked in ("bytes=9-1", "bytes=x-y", "lines=0-1"):
            with self.subTest(range=asked):
                self.assertEqual(self.get(Range=asked).status, 200)

    def test_unknown_artifacts(self):
        for name in ("secret.json", "cameras", "dense.ply%00", "..%2fjobs.db"):
            with self.subTest(name=name):
                reply = self.system.reconstruction.get(f"/reconstructions/{self.id}/artifacts/{name}")
                self.assertIn(reply.status, (400, 404), reply)
                self.assertIn("message", reply.error())


if __name__ == "__main__":
    unittest.main(verbosity=2)
