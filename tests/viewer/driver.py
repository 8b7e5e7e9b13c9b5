# SPDX-License-Identifier: Apache-2.0
"""Drives the viewer as a person does: a mouse and a keyboard (XTest, by xdotool) on a display without a screen
(Xvfb), or on the one that is there. What the interface has seen, where its widgets are and when it shows what comes
from --trace; every event is waited for until the interface has seen it, however slow the machine is."""
import json
import os
import pathlib
import subprocess
import time

WAIT_S = 240  # the machine may be busy: nothing here is a limit on speed


class Display:
    """Xvfb with a display number that is free."""

    def __init__(self, size):
        read, write = os.pipe()
        self.process = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", f"{size[0]}x{size[1]}x24",
                                         "-noreset"], pass_fds=[write], stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as stream:
            self.name = ":" + stream.readline().strip()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait()


class Viewer:
    """A running viewer. Ends with the `with` block that it is made in."""

    def __init__(self, program, display_name, *options):
        self.environment = {**os.environ, "DISPLAY": display_name}
        self.trace_path = pathlib.Path("trace.jsonl")
        self.trace_path.unlink(missing_ok=True)
        self.read_to = 0
        self.events = []
        self.errors = open("viewer.err", "w+")
        self.start_s = time.monotonic()
        self.process = subprocess.Popen([program, "view", *map(str, options), "--forget", "--trace", self.trace_path],
                                        env=self.environment, stderr=self.errors)
        self.window = self.wait_for(self.find_window, "a window")
        self.xdo("windowfocus", "--sync", self.window)  # without a window manager nobody else does

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait()
        self.errors.close()

    def xdo(self, *arguments):
        done = subprocess.run(["xdotool", *map(str, arguments)], env=self.environment, capture_output=True,
                              text=True, timeout=WAIT_S)
        if done.stderr:
            raise AssertionError(f"xdotool {arguments}: {done.stderr}")
        return done.stdout.strip()

    def find_window(self):
        return self.xdo("search", "--onlyvisible", "--pid", self.process.pid, "--name", "nearfield").split("\n")[-1]

    def wait_for(self, find, what):
        """What find() gives once it is something."""
        end_s = time.monotonic() + WAIT_S
        while time.monotonic() < end_s:
            found = find()
            if found:
                return found
            if self.process.poll() is not None:
                self.errors.seek(0)
                raise AssertionError(f"the viewer ended before {what}: {self.errors.read()}")
            time.sleep(0.01)
        raise AssertionError(f"{what} did not come; last input: {self.last('input')}, last frame: {self.last('frame')}")

    def read_trace(self):
        """All lines that are complete."""
        if self.trace_path.exists():
            with self.trace_path.open("rb") as stream:
                stream.seek(self.read_to)
                complete = stream.read().rpartition(b"\n")[0]
            if complete:
                self.read_to += len(complete) + 1
                self.events += [json.loads(line) for line in complete.splitlines()]
        return self.events

    def all_of(self, kind):
        return [event for event in self.read_trace() if event["event"] == kind]

    def last(self, kind):
        return next((event for event in reversed(self.read_trace()) if event["event"] == kind), None)

    def wait_for_frame(self, after=0, is_final=True):
        """The last frame, refined or any, with a serial number above `after`."""
        def find():
            frame = self.last("frame")
            return frame and frame["serial"] > after and (frame["final"] or not is_final) and frame
        return self.wait_for(find, f"a picture after {after}")

    def asked(self):
        """The serial number of the last request."""
        request = self.last("request")
        return request["serial"] if request else 0

    def sees(self, what, **wanted):
        """Waits until the interface has this of mouse and keys."""
        def find():
            seen = self.last("input")
            return seen and all(abs(seen[key] - value) <= 1 if key in "xy" else seen[key] == value
                                for key, value in wanted.items())
        self.wait_for(find, f"the interface's view of {what}")

    def place(self, name):
        """Left, top, right and bottom of a widget."""
        return self.wait_for(lambda: (self.last("places") or {"places": {}})["places"].get(name), f"widget '{name}'")

    def move_to(self, x, y):
        x, y = round(x), round(y)
        self.xdo("mousemove", "--window", self.window, x, y)
        self.sees(f"the mouse at {x}, {y}", x=x, y=y)

    def press(self, is_down):
        self.xdo("mousedown" if is_down else "mouseup", 1)
        self.sees("the button", is_down=is_down)

    def click(self, name, at=0.5):
        left, top, right, bottom = self.place(name)
        self.click_at(left + at * (right - left), 0.5 * (top + bottom))

    def click_at(self, x, y):
        self.move_to(x, y)
        self.press(True)
        self.press(False)

    def key(self, names):
        """One key, or several held together: "ctrl+s"."""
        held = names.split("+")
        for count, name in enumerate(held, 1):
            self.xdo("keydown", name)
            self.wait_for(lambda wanted=count: len(self.last("input")["keys"]) == wanted, f"{name} down")
        for name in reversed(held):
            self.xdo("keyup", name)
        self.sees("keys", keys=[])

    def type_into(self, name, text):
        self.click(name, at=0.1)
        self.key("ctrl+a")
        self.xdo("type", "--delay", "20", "--", text)  # it may begin with a minus
        self.key("Return")

    def drag(self, start, by, steps=8, pause_s=0.0):
        self.move_to(*start)
        self.press(True)
        for k in range(1, steps + 1):
            self.move_to(start[0] + by[0] * k / steps, start[1] + by[1] * k / steps)
            time.sleep(pause_s)
        self.press(False)

    def cpu_s(self):
        """Processor time of the process so far."""
        fields = pathlib.Path(f"/proc/{self.process.pid}/stat").read_text().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def close(self):
        """The exit code."""
        self.xdo("key", "ctrl+q")
        return self.process.wait(timeout=WAIT_S)
