#!/usr/bin/env python3
"""Wrong and hostile input: each refused with its status, code and message, and the service is as well as before."""
import json
import re
import unittest

import pictures
from drupe import SAMPLE, DrupeTest, multipart, sample_images, sample_parts

IMAGES = sample_images(3)
CALIBRATION = json.loads((SAMPLE / "calibration.json").read_text())
BOARD = json.loads((SAMPLE / "board.json").read_text())
KNOWN_ID = "rec_" + "a" * 20


def with_images(*images):
    return [("images", name, content) for name, content in images]


def with_part(name, content):
    """Three good pictures and one more part."""
    return with_images(*IMAGES) + [(name, None, content)]


def nested(depth):
    return "[" * depth + "]" * depth


def deep(depth):
    return '{"a":' * depth + "1" + "}" * depth


class ReconstructFormTest(DrupeTest):
    """What is wrong with the parts of POST /reconstruct."""

    services = ("reconstruction",)

    def refuse(self, parts, status, code, *words):
        reply = self.system.reconstruction.post_parts("/reconstruct", parts)
        self.assert_refused(reply, status, code, *words)
        return reply.error()

    def tearDown(self):
        self.assertTrue(self.system.reconstruction.is_alive())
        self.assertEqual(self.system.reconstruction.get("/healthz").status, 200)

    def test_no_parts(self):
        self.refuse([], 400, "invalid_multipart")

    def test_no_images(self):
        self.refuse([("calibration", None, CALIBRATION)], 400, "too_few_images", "3")

    def test_two_images(self):
        self.refuse(with_images(*IMAGES[:2]), 400, "too_few_images", "3", "2")

    def test_nothing_is_an_image(self):
        error = self.refuse(with_images(*[(f"{i}.jpg", b"I am no picture") for i in range(3)]), 415, "unsupported_image", "JPEG")
        self.assertIn("0.jpg", json.dumps(error))

    def test_empty_image_files(self):
        self.refuse(with_images(*[(f"{i}.jpg", b"") for i in range(3)]), 422, "bad_image", "empty")

    def test_gif_and_svg(self):
        self.refuse(with_images(("a.gif", pictures.GIF), ("b.jpg", pictures.GIF), ("c.svg", pictures.SVG)), 415,
                    "unsupported_image", "JPEG")

    def test_png_bomb(self):
        bomb = pictures.png_bomb()
        self.assertLess(len(bomb), 1 << 20)
        self.refuse(with_images(*[(f"{i}.png", bomb) for i in range(3)]), 413, "image_too_large", "30000")

    def test_huge_declared_sizes(self):
        self.refuse(with_images(*[(f"{i}.png", pictures.png_with_lying_header()) for i in range(3)]), 413, "image_too_large")
        large = pictures.jpeg_with_size(IMAGES[0][1], 65500, 65500)
        self.refuse(with_images(*[(f"{i}.jpg", large) for i in range(3)]), 413, "image_too_large", "65500")

    def test_traversal_in_file_names(self):
        for name in ("../../etc/passwd", "..\\..\\boot.ini", "/etc/passwd", "a/b.jpg", ".hidden", "a\x00b.jpg", "ü.jpg", " "):
            with self.subTest(name=name):
                parts = with_images(*IMAGES) + with_images((name, IMAGES[0][1]))
                self.refuse(parts, 400, "invalid_name", "A-Za-z0-9")

    def test_over_long_file_name(self):
        self.refuse(with_images(*IMAGES, ("n" * 200 + ".jpg", IMAGES[0][1])), 400, "invalid_name", "128")

    def test_the_same_name_twice(self):
        self.refuse(with_images(*IMAGES, IMAGES[0]), 400, "duplicate_name", IMAGES[0][0])

    def test_too_many_images(self):
        tiny = pictures.png(1, 1)
        self.refuse(with_images(*[(f"{i}.png", tiny) for i in range(401)]), 413, "too_many_images", "400")

    def test_unknown_part(self):
        error = self.refuse(with_part("calibratoin", "{}"), 400, "unknown_part", "calibratoin")
        self.assertEqual(error["field"], "calibratoin")

    def test_calibration_is_not_json(self):
        self.refuse(with_part("calibration", "{width: 1280"), 400, "invalid_json", "byte")

    def test_calibration_without_what_it_needs(self):
        for key in ("width", "K"):
            with self.subTest(missing=key):
                error = self.refuse(with_part("calibration", {k: v for k, v in CALIBRATION.items() if k != key}), 400,
                                    "invalid_calibration", "must")
                self.assertIn(key, error["field"])

    def test_calibration_with_absurd_numbers(self):
        for change in ({"K": [[0, 0, 0]] * 3}, {"K": "identity"}, {"dist": [1e300] * 5}, {"width": -1280}, {"width": 1e18}):
            with self.subTest(change=change):
                self.refuse(with_part("calibration", {**CALIBRATION, **change}), 400, "invalid_calibration")

    def test_calibration_of_another_size(self):
        self.refuse(with_part("calibration", {**CALIBRATION, "width": 1920, "height": 1080}), 422,
                    "calibration_size_mismatch", "1920", "1280")

    def test_deep_json(self):
        self.refuse(with_part("options", deep(5000)), 400, "json_too_deep", "32")
        self.refuse(with_part("calibration", nested(200_000)), 400, "json_too_deep", "32")

    def test_huge_json(self):
        self.refuse(with_part("options", '{"a": "' + "x" * (2 << 20) + '"}'), 413, "json_too_large")

    def test_options_of_the_wrong_kind(self):
        self.refuse(with_part("options", "[1, 2]"), 400, "invalid_option")
        error = self.refuse(with_part("options", {"dense": {"level": "high"}}), 400, "invalid_option", "dense.level")
        self.assertIn("dense.level", error["field"])
        self.refuse(with_part("options", {"dense": {"wsize": 8}}), 400, "invalid_option", "wsize")
        self.refuse(with_part("options", '{"dense": {"level": 1e999}}'), 400, "invalid_json")

    def test_unknown_option(self):
        error = self.refuse(with_part("options", {"dense": {"lvel": 1}}), 400, "unknown_option", "lvel")
        self.assertIn("dense.lvel", error["field"])

    def test_bad_boards(self):
        corners = BOARD["corners_mm"]
        for change in ({"dictionary": "DICT_9X9_9000"}, {"corners_mm": {}}, {"corners_mm": {**corners, "-1": corners["0"]}},
                       {"corners_mm": {**corners, "0": [[0, 0, 0]] * 3}}, {"corners_mm": {**corners, "0": [[0, 0, 0]] * 4}}):
            with self.subTest(change=str(change)[:60]):
                self.refuse(with_part("board", {**BOARD, **change}), 400, "invalid_board")


class BadPicturesAmongGoodOnesTest(DrupeTest):
    """Pictures that cannot be used are left out by name, and the others are kept."""

    services = ("reconstruction",)

    def test_the_others_are_kept(self):
        bad = [("cut.jpg", IMAGES[0][1][:20_000]), ("text.jpg", b"hello"), ("gif.jpg", pictures.GIF),
               ("bomb.png", pictures.png_bomb())]
        reply = self.system.reconstruction.post_parts("/reconstruct", sample_parts(IMAGES + bad))
        self.assertEqual(reply.status, 202, reply)
        refused = {entry["name"]: entry["code"] for entry in reply.json()["refused_images"]}
        self.assertEqual(refused, {"cut.jpg": "bad_image", "text.jpg": "unsupported_image", "gif.jpg": "unsupported_image",
                                   "bomb.png": "image_too_large"})
        status = self.system.status(reply.json()["id"])
        self.assertEqual({entry["name"] for entry in status["refused_images"]}, set(refused))

    def test_too_few_remain(self):
        cut = [(name, content[:20_000]) for name, content in IMAGES[1:]]
        reply = self.system.reconstruction.post_parts("/reconstruct", sample_parts(IMAGES[:1] + cut))
        self.assert_refused(reply, 422, "bad_image", "01.jpg")


class ReconstructJsonTest(DrupeTest):
    """What is wrong with the JSON of POST /reconstruct and POST /analyze."""

    services = ("reconstruction", "analysis")

    def test_json_requests(self):
        for body, status, code in (
            ("", 400, "invalid_json"),
            ("{", 400, "invalid_json"),
            ("[]", 400, "invalid_request"),
            ("{}", 400, "invalid_request"),
            ('{"image_set": 7}', 400, "invalid_request"),
            ('{"image_set": "../../etc"}', 400, "invalid_id"),
            ('{"image_set": "set_unknown"}', 404, "image_set_not_found"),
            ('{"image_set": "set_unknown", "color": "red"}', 400, "unknown_option"),
            (deep(1000), 400, "json_too_deep"),
        ):
            with self.subTest(body=body[:50]):
                self.assert_refused(self.system.reconstruction.post_json("/reconstruct", body), status, code)

    def test_analyze_requests(self):
        for body, status, code in (
            ("{", 400, "invalid_json"),
            ("{}", 400, "invalid_request"),
            ('{"reconstruction": "../x"}', 400, "invalid_id"),
            (f'{{"reconstruction": "{KNOWN_ID}", "options": {{"plane": {{"x": 1}}}}}}', 400, "unknown_option"),
        ):
            with self.subTest(body=body[:50]):
                self.assert_refused(self.system.analysis.post_json("/analyze", body), status, code)

    def test_other_content_types(self):
        for content_type in ("text/plain", "application/x-www-form-urlencoded", "image/jpeg", ""):
            with self.subTest(content_type=content_type):
                headers = {"Content-Type": content_type} if content_type else {}
                reply = self.system.reconstruction.request("POST", "/reconstruct", b"x=1", headers)
                self.assert_refused(reply, 415, "unsupported_media_type")

    def test_malformed_multipart(self):
        body, content_type = multipart(sample_parts(IMAGES))
        boundary = content_type.split("=")[1].encode()
        for name, wrong_type, wrong_body in (
            ("no boundary", "multipart/form-data", body),
            ("another boundary", content_type + "x", body),
            ("cut in the middle", content_type, body[: len(body) // 2]),
            ("no closing line", content_type, body[: -len(boundary) - 8]),
            ("a part without a name", content_type, body.replace(b'name="images"', b"", 1)),
            ("no body at all", content_type, b""),
        ):
            with self.subTest(name):
                reply = self.system.reconstruction.request("POST", "/reconstruct", wrong_body, {"Content-Type": wrong_type})
                self.assert_refused(reply, 400, "invalid_multipart")

    def test_bad_list_parameters(self):
        for query in ("limit=0", "limit=x", "limit=100000", "cursor=%00", "grade=mouldy", "since=yesterday"):
            with self.subTest(query=query):
                reply = self.system.analysis.get(f"/reports?{query}")
                self.assertEqual(reply.status, 400, reply)
                self.assertIn("message", reply.error())


class PathsTest(DrupeTest):
    """Paths and ids that try to leave their place."""

    services = ("reconstruction", "analysis")

    def test_ids_that_are_none(self):
        for path in ("/reconstructions/..%2f..%2fetc%2fpasswd", "/reconstructions/%2e%2e%2f", "/reconstructions/" + "a" * 1000,
                     "/reconstructions/rec_%00", "/reconstructions/rec_a%zz", "/reconstructions/../../etc/passwd",
                     f"/reconstructions/{KNOWN_ID}/artifacts/%2e%2e%2fjobs.db", "/reconstructions/rec_';DROP TABLE jobs;--",
                     "/image-sets/%2e%2e/images/a.jpg", "//etc/passwd", "/"):
            with self.subTest(path=path):
                reply = self.system.reconstruction.request("GET", path.replace(" ", "%20"))
                self.assertIn(reply.status, (400, 404), reply)
                self.assertIn(reply.error()["code"], ("invalid_path", "unknown_route", "invalid_id", "job_not_found"))

    def test_unknown_ids(self):
        for service, path in ((self.system.reconstruction, f"/reconstructions/{KNOWN_ID}"),
                              (self.system.reconstruction, f"/reconstructions/{KNOWN_ID}/events"),
                              (self.system.reconstruction, f"/reconstructions/{KNOWN_ID}/artifacts/dense.ply"),
                              (self.system.reconstruction, "/image-sets/set_unknown"),
                              (self.system.analysis, f"/reports/{KNOWN_ID}"),
                              (self.system.analysis, f"/reports/{KNOWN_ID}.csv")):
            with self.subTest(path=path):
                reply = service.get(path)
                self.assertEqual(reply.status, 404, reply)
                self.assertIn("message", reply.error())

    def test_wrong_method(self):
        reply = self.system.reconstruction.request("PATCH", "/reconstruct")
        self.assert_refused(reply, 405, "method_not_allowed", "POST")
        self.assertEqual(reply.headers["allow"], "POST")

    def test_image_names_in_paths(self):
        set_id = self.system.reconstruction.post_json("/image-sets", {}).json()["id"]
        for name in ("..%2f..%2fx.jpg", "%2e%2e", ".hidden.jpg", "n" * 200 + ".jpg", "a%00.jpg", "a%5cb.jpg"):
            with self.subTest(name=name):
                reply = self.system.reconstruction.request("PUT", f"/image-sets/{set_id}/images/{name}", IMAGES[0][1],
                                                           {"Content-Type": "image/jpeg"})
                self.assertIn(reply.status, (400, 404), reply)
        self.assertEqual(self.system.reconstruction.get(f"/image-sets/{set_id}").json()["images"], [])


class ProtocolTest(DrupeTest):
    """Requests below the level of routes. Each would be read in two ways, or never end."""

    services = ("reconstruction",)

    def raw(self, text):
        """(status, text) of the reply to raw bytes."""
        received = self.system.reconstruction.send_raw(text if isinstance(text, bytes) else text.encode("latin-1"))
        self.assertTrue(received.startswith(b"HTTP/1.1 "), received[:100])
        self.assertEqual(len(re.findall(rb"^HTTP/1\.1 \d{3} ", received, re.MULTILINE)), 1, "one request, one reply")
        return int(received[9:12]), received.decode("latin-1")

    def assert_raw(self, text, status, code):
        found, reply = self.raw(text)
        self.assertEqual(found, status, reply)
        self.assertIn(f'"{code}"', reply)

    def post(self, *headers, body=""):
        return "\r\n".join(("POST /reconstruct HTTP/1.1", "Host: x", "Connection: close", *headers)) + "\r\n\r\n" + body

    def test_chunked_body(self):
        self.assert_raw(self.post("Content-Type: application/json", "Transfer-Encoding: chunked", body="2\r\n{}\r\n0\r\n\r\n"),
                        411, "length_required")

    def test_compressed_body(self):
        self.assert_raw(self.post("Content-Type: application/json", "Content-Encoding: gzip", "Content-Length: 2", body="{}"),
                        415, "unsupported_encoding")

    def test_too_large_a_length(self):
        self.assert_raw(self.post("Content-Type: application/json", "Content-Length: 999999999999", body="{}"), 413,
                        "body_too_large")

    def test_lengths_that_are_none(self):
        for length in ("-1", "abc", "1 1", "0x10", "18446744073709551616", ""):
            with self.subTest(length=length):
                self.assert_raw(self.post(f"Content-Length: {length}"), 400, "invalid_request")

    def test_two_lengths(self):
        self.assert_raw(self.post("Content-Length: 2", "Content-Length: 3", body="{}"), 400, "invalid_request")

    def test_length_and_chunks(self):
        self.assert_raw(self.post("Content-Length: 4", "Transfer-Encoding: chunked", body="0\r\n\r\nGET / HTTP/1.1\r\n\r\n"), 411,
                        "length_required")

    def test_an_unread_body_is_not_the_next_request(self):
        smuggled = "GET /healthz HTTP/1.1\r\nHost: x\r\n\r\n"
        request = f"POST /nowhere HTTP/1.1\r\nHost: x\r\nContent-Length: {len(smuggled)}\r\n\r\n{smuggled}"
        self.assertEqual(self.raw(request)[0], 404)

    def test_too_long_a_path(self):
        self.assert_raw("GET /" + "a" * 5000 + " HTTP/1.1\r\nHost: x\r\n\r\n", 414, "target_too_long")

    def test_too_many_headers(self):
        self.assert_raw("GET /healthz HTTP/1.1\r\nHost: x\r\n" + "A: b\r\n" * 500 + "\r\n", 431, "headers_too_large")

    def test_too_large_a_header(self):
        self.assert_raw("GET /healthz HTTP/1.1\r\nHost: x\r\nA: " + "b" * 70_000 + "\r\n\r\n", 431, "headers_too_large")

    def test_not_http(self):
        for text in ("hello\r\n\r\n", "\x16\x03\x01\x02\x00\x01\x00\r\n\r\n", "GET /healthz\r\n\r\n", "GET  HTTP/1.1\r\n\r\n"):
            with self.subTest(text=text):
                self.assertEqual(self.raw(text)[0], 400)

    def test_header_with_a_control_character(self):
        self.assert_raw("GET /healthz HTTP/1.1\r\nHost: x\r\nA: b\x00c\r\n\r\n", 400, "invalid_request")

    def test_http_2(self):
        self.assert_raw("GET /healthz HTTP/2.0\r\nHost: x\r\n\r\n", 505, "unsupported_version")

    def test_the_service_is_well_afterwards(self):
        self.assertEqual(self.system.reconstruction.get("/readyz").status, 200)


if __name__ == "__main__":
    unittest.main(verbosity=2)
