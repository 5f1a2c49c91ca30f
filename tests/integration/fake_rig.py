"""A rig without hardware for the tests: the process of drupe-fake-rig."""
import json
import random
import subprocess
import threading

from drupe import BIN, SAMPLE


class FakeRig:
    """A camera on the loopback network and a turntable on a pseudo-terminal. Obeys one line of text at a time."""

    def __init__(self, loss=0, seed=1, pictures="images"):
        number = random.SystemRandom().randrange(2, 60000)  # tests side by side see one another's cameras
        self.camera = f"Aravis-Fake-RUN{number}"
        command = [BIN / "drupe-fake-rig", "--pictures", SAMPLE / pictures, "--serial", f"RUN{number}",
                   "--address", f"127.9.{number // 256}.{number % 256}", "--loss", str(loss), "--seed", str(seed)]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.lock = threading.Lock()
        self.table = json.loads(self.process.stdout.readline())["table"]

    def tell(self, line):
        with self.lock:
            self.process.stdin.write(line + "\n")
            self.process.stdin.flush()
            return self.process.stdout.readline().strip()

    def close(self):
        self.process.stdin.close()
        self.process.wait(timeout=10)
        self.process.stdout.close()
