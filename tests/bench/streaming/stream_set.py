#!/usr/bin/env python3
"""Uploads a set picture by picture, as a rig does, and prints how long after the last one the sparse model was there.

    ./deploy/build && tests/bench/streaming/stream_set.py SET_DIR [--seconds-per-picture 2] [--silent]

SET_DIR has images/, calibration.json and, where there is a board, board.json. A service of its own is started in a
temporary directory. --silent announces nothing with the set, so that only features are found in advance."""
import argparse
import json
import pathlib
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "integration"))
from drupe import System  # noqa: E402


def read_json(path):
    return json.loads(path.read_text()) if path.exists() else None


def documents_of(directory):
    found = {name: read_json(directory / f"{name}.json") for name in ("calibration", "board")}
    return {**{name: value for name, value in found.items() if value}, "options": {"run_dense": False}}


def upload(service, set_id, paths, seconds_per_picture):
    """PUTs a picture whenever its time has come; returns the longest time that one took."""
    begin, longest = time.monotonic(), 0
    for number, path in enumerate(paths):
        time.sleep(max(0, begin + number * seconds_per_picture - time.monotonic()))
        sent = time.monotonic()
        reply = service.request("PUT", f"/image-sets/{set_id}/images/{path.name}", path.read_bytes())
        assert reply.status == 201, reply
        longest = max(longest, time.monotonic() - sent)
    return longest


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("set_dir", type=pathlib.Path)
    parser.add_argument("--seconds-per-picture", type=float, default=2)
    parser.add_argument("--silent", action="store_true")
    arguments = parser.parse_args()
    documents = documents_of(arguments.set_dir)
    paths = sorted((arguments.set_dir / "images").iterdir())

    system = System().start("reconstruction")
    try:
        service = system.reconstruction
        set_id = service.post_json("/image-sets", {} if arguments.silent else documents).json()["id"]
        longest = upload(service, set_id, paths, arguments.seconds_per_picture)
        last = time.monotonic()
        reply = service.post_json("/reconstruct", {"image_set": set_id, "analyze": False, **documents})
        status = system.wait_until_ended(reply.json()["id"], 600)
        assert status["status"] == "succeeded", status
        wait = time.monotonic() - last
        model = service.get(f"/reconstructions/{status['id']}/artifacts/cameras.json").json()
        registered = sum(camera["registered"] for camera in model["cameras"])
        stages = ", ".join(f"{stage['name']} {stage['wall_s']:.1f} ({stage['cpu_s']:.1f} CPU)" for stage in status["timings"]["stages"])
        print(f"{arguments.set_dir.name}: {len(paths)} pictures, one every {arguments.seconds_per_picture:g} s, "
              f"longest upload {longest:.2f} s; {registered} registered; sparse model {wait:.1f} s after the last picture: "
              f"{stages}")
    finally:
        system.close()


if __name__ == "__main__":
    main()
