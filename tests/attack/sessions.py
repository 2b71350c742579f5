"""Sessions that are attacked: which programs are started for a listener, what they say, and what they take of the system."""

import collections
import json
import os
import pathlib
import re
import signal
import subprocess
import threading
import time

import listeners as near
import plc_listeners as plcs

ROOT = pathlib.Path(__file__).resolve().parents[2]
SHEAR = ROOT / "scenarios" / "shear"
HERE = "127.0.0.1:0"
STARTED_S = 20.0
# The blocks of the PLC with a reserve that is checked: bytes of strangers are not a block then.
LAYOUT = """system_words = true

[clients.plc.gateway.layout]
reserve_zero = true
to_plc = ["Position_1: LREAL", "Position_2: LREAL", "Alignment: Sensors", "Shear: Sensors", "PLC_Start: UDINT",
    "SDSP_Session: UDINT", "SDSP_Limit: UDINT", "SDSP_TV: LINT", "SDSP_Grant: UDINT"]
from_plc = ["SDSP_Joined: UDINT", "SDSP_Done: UDINT", "SDSP_Answer: INT", "SDSP_Layout: UDINT", "PLC_Boots: UDINT",
    "PLC_Running: BOOL", "Actuator_1_Down: BOOL", "Actuator_1_Up: BOOL", "Actuator_2_Down: BOOL", "Actuator_2_Up: BOOL",
    "Aligned: BOOL", "AlignedCount: DINT", "Strokes: DINT"]
structures.Sensors = ["Sensor_1: BOOL", "Sensor_2: BOOL"]
"""
PLC = ["plc-opcua", "plc-s7", "plc-modbus", "plc-ads", "plc-tcp"]
# Those that strangers come to.
LISTENERS = {"sessions": near.Lobby, "page": near.Page, "edit": near.Editor, "view": near.Page, "sessions-tls": near.SecuredLobby,
             "page-tls": near.SecuredPage, "run-opcua": plcs.OpcUa, "plc-opcua": plcs.OpcUa, "plc-s7": plcs.S7,
             "plc-modbus": plcs.Modbus, "plc-ads": plcs.Ads, "plc-tcp": plcs.RawTcp, "run-ads": plcs.SessionAds,
             "tcp-listen": plcs.TcpListen}


def scenario(folder):
    """The shear, with that layout."""
    folder.mkdir()
    text = (SHEAR / "scenario.toml").read_text()
    assert "system_words = true\n" in text
    (folder / "scenario.toml").write_text(text.replace("system_words = true\n", LAYOUT, 1))
    for file in ("plant.toml", "plc/shear.st", "plc/alignment.st"):
        (folder / file).parent.mkdir(exist_ok=True)
        (folder / file).write_bytes((SHEAR / file).read_bytes())
    return folder


class Program:
    """One program, and what it says."""

    def __init__(self, words, folder, name, unread):
        self.out, self.err, self.is_read = folder / f"{name}.out", folder / f"{name}.err", True
        words = [str(word) for word in words]
        with open(self.out, "wb") as out, open(self.err, "wb") as err:
            to = subprocess.PIPE if unread else err
            self.process = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=out, stderr=to)
        if unread:
            threading.Thread(target=self.read, daemon=True).start()

    def read(self):
        """Reads the log until somebody says that nobody does."""
        with open(self.err, "wb", 0) as err:
            while self.is_read and (piece := os.read(self.process.stderr.fileno(), 4096)):
                err.write(piece)

    def said(self, pattern):
        """What it says in this form, waited for."""
        until = time.monotonic() + STARTED_S
        while time.monotonic() < until:
            text = self.out.read_text(errors="replace") + self.err.read_text(errors="replace")
            if found := re.search(pattern, text):
                return found[1]
            if self.process.poll() is not None:
                raise RuntimeError(f"it has ended with {self.process.returncode}: {text.strip()[-300:]}")
            time.sleep(0.02)
        raise RuntimeError(f"it does not say {pattern}: {text.strip()[-300:]}")

    def family(self):
        """The process and those that it has started."""
        family = [self.process.pid]
        for pid in family:
            for children in pathlib.Path(f"/proc/{pid}/task").glob("*/children"):
                try:
                    family += map(int, children.read_text().split())
                except OSError:
                    pass
        return family

    def descriptors(self):
        return collections.Counter(kind for pid in self.family() for kind in kinds(pid))

    def peak_mib(self):
        """The sum of the peaks of the family, which is not less than its peak."""
        total = 0
        for pid in self.family():
            try:
                found = re.search(r"VmHWM:\s+(\d+) kB", pathlib.Path(f"/proc/{pid}/status").read_text())
                total += int(found[1]) if found else 0
            except OSError:
                pass
        return total / 1024

    def end(self, how):
        """Ends it as a user does; gives its exit code."""
        try:
            if how == "quit":
                self.process.stdin.write(b"quit\n")
                self.process.stdin.flush()
            elif how == "signal":
                self.process.send_signal(signal.SIGTERM)
            self.process.wait(timeout=20)
        except (subprocess.TimeoutExpired, OSError):
            self.kill()
        return self.process.returncode

    def kill(self):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()


def kinds(pid):
    """What its descriptors are; the recording's own files come and go."""
    for descriptor in pathlib.Path(f"/proc/{pid}/fd").glob("*"):
        try:
            at = os.readlink(descriptor)
        except OSError:
            continue
        if "/record/" not in at:
            yield re.sub(r"\d+", "", at)


class Session:
    """The programs of one listener: the run, where there is one, and what else it needs."""

    def __init__(self, program, listener, folder, shear, reference, until_s, unread=False):
        self.listener, self.folder, self.programs, self.ends = listener, folder, [], []
        self.record, self.program, self.shown, self.unread = None, program, [], unread
        if listener == "edit":
            edit = self.start([program, "edit", shear, "--web", HERE], "edit", "signal")
            self.address = edit.said(r"editor is at http://([^/]+)/")
        elif listener == "view":
            view = self.start([program, "view", reference, "--web", HERE], "view", "signal")
            self.address = view.said(r"recording is at http://([^/]+)/")
        else:
            self.begin(program, listener, shear, until_s)
        for started in self.programs:
            started.is_read = False

    def begin(self, program, listener, shear, until_s):
        """A run with its PLC, until its steps go."""
        self.record = self.folder / "record"
        run = [program, "run", shear, "--pace", "1", "--until", f"{until_s}s", "--format", "json", "--record", self.record,
               "--listen", HERE]
        if listener in PLC:
            protocol = listener.removeprefix("plc-")
            plc = self.start([program, "plc", shear, f"--{protocol}", HERE], "plc", "quit")
            url = plc.said(r"serving (\S+)")
            run += ["--gateway", f"plc={url}"]
            self.address = url.split("://")[1].split("/")[0]
        elif listener == "tcp-listen":
            run += ["--gateway", f"plc=tcp-listen://{HERE}"]
        else:
            if listener.endswith("-tls"):
                run += ["--access", self.access(LISTENERS[listener])]
            run += {"page": [f"--web={HERE}"], "page-tls": [f"--web={HERE}"], "run-opcua": ["--opcua", HERE],
                    "run-ads": ["--ads", HERE]}.get(listener, [])
        session = self.start(run, "run", "wait")
        # Addresses of the scenario's own links are no near.
        if listener == "tcp-listen":
            self.address = session.said(r"listening on tcp-listen://(\S+) for")
            self.start([program, "plc", shear, "--tcp-connect", self.address], "plc", "quit")
        self.operator = session.said(r"listening at (\S+) for operators")
        operators = r"listening at (\S+) for operators"
        own = {"sessions": operators, "sessions-tls": operators, "page": r"session is at http://([^/]+)/",
               "page-tls": r"session is at https://([^/]+)/", "run-opcua": r"session at opc.tcp://([^/]+)/",
               "run-ads": r"serving ads://(\S+)"}
        if listener in own:
            self.address = session.said(own[listener])
        until = time.monotonic() + STARTED_S
        while not self.goes():
            if time.monotonic() > until or session.process.poll() is not None:
                raise RuntimeError(f"the session does not begin: {session.err.read_text(errors='replace')[-300:]}")
            time.sleep(0.05)

    def access(self, kind):
        """A folder with a certificate and an operator's token, which the client shows."""
        folder = self.folder / "access"
        subprocess.run([self.program, "certificate", "new", "--access", folder], check=True, capture_output=True)
        words = [self.program, "token", "new", "anna", "--role", "operator", "--access", folder]
        said = subprocess.run(words, check=True, capture_output=True, text=True).stdout
        kind.authority, kind.token = folder / "ca.pem", re.search(r"onescan_\w+", said)[0]
        self.shown = ["--tls-ca", kind.authority, "--token", kind.token]
        return folder

    def goes(self):
        words = [self.program, "control", self.operator, "status", "--format", "json", *self.shown]
        said = subprocess.run(words, capture_output=True, text=True)
        return said.returncode == 0 and json.loads(said.stdout.splitlines()[-1]).get("steps", 0) > 0

    def start(self, words, name, ends):
        started = Program(words, self.folder, name, self.unread)
        self.programs.append(started)
        self.ends.append(ends)
        return started

    def end(self):
        """The exit codes, the last one that of the run."""
        codes = {}
        for program, how in sorted(zip(self.programs, self.ends), key=lambda each: each[1] != "wait"):
            codes[program.out.stem] = (program.end(how), 143 if how == "signal" else 0)
        return codes

    def log(self):
        return [line for program in self.programs for line in program.err.read_text(errors="replace").splitlines()]

    def kill(self):
        for program in self.programs:
            program.kill()
