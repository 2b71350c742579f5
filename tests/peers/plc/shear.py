"""The shear's PLC and the shim's scheduler, written from scratch from their descriptions (docs/gateway.md).

Nothing here knows a protocol: `Plc.cycle` takes the words and inputs as a dictionary and gives words and outputs.
"""

PERIOD_NS = 10_000_000
LOWER_LIMIT_M = -0.10
REST_NS = 100_000_000

# Each program has inputs of its own, as in a real PLC: by signal, then by path.
INPUTS = [
    "Shear.Position_1",
    "Shear.Position_2",
    "Alignment.Sensor_1",
    "Shear.Sensor_1",
    "Alignment.Sensor_2",
    "Shear.Sensor_2",
]
WORDS_IN = ["SDSP_Session", "SDSP_Limit", "SDSP_TV", "SDSP_Grant"]
WORDS_OUT = ["SDSP_Joined", "SDSP_Done", "SDSP_Answer", "SDSP_Layout"]
OUTPUTS = [
    "Shear.Actuator_1_Down",
    "Shear.Actuator_1_Up",
    "Shear.Actuator_2_Down",
    "Shear.Actuator_2_Up",
    "Alignment.Aligned",
    "Alignment.AlignedCount",
    "Shear.Strokes",
]


class OnDelay:
    """TON on virtual time."""

    def __init__(self):
        self.q, self.was_in, self.since = False, False, 0

    def __call__(self, is_in, pt_ns, now_ns):
        if not is_in:
            self.q = False
        else:
            if not self.was_in:
                self.since = now_ns
            if now_ns - self.since >= pt_ns:
                self.q = True
        self.was_in = is_in
        return self.q


class RisingEdge:
    """R_TRIG."""

    def __init__(self):
        self.was = False

    def __call__(self, clk):
        q, self.was = clk and not self.was, clk
        return q


class Shear:
    """The programs Shear and Alignment, one scan a call."""

    def __init__(self):
        self.is_down = False
        self.dwell = OnDelay()
        self.a, self.b, self.c = RisingEdge(), RisingEdge(), RisingEdge()
        numbers = ("Alignment.AlignedCount", "Shear.Strokes")
        self.out = {name: 0 if name in numbers else False for name in OUTPUTS}

    def scan(self, now_ns, i):
        s1, s2 = bool(i["Shear.Sensor_1"]), bool(i["Shear.Sensor_2"])
        p1, p2 = i["Shear.Position_1"], i["Shear.Position_2"]
        if self.dwell(s1 and s2 and not self.is_down, REST_NS, now_ns):
            self.is_down = True
            self.out["Shear.Strokes"] += 1
        elif p1 <= LOWER_LIMIT_M and p2 <= LOWER_LIMIT_M:
            self.is_down = False
        self.out["Shear.Actuator_1_Up"] = not self.is_down and not s1
        self.out["Shear.Actuator_2_Up"] = not self.is_down and not s2
        self.out["Shear.Actuator_1_Down"] = self.is_down and p1 > LOWER_LIMIT_M
        self.out["Shear.Actuator_2_Down"] = self.is_down and p2 > LOWER_LIMIT_M
        a, b = self.a(bool(i["Alignment.Sensor_1"])), self.b(bool(i["Alignment.Sensor_2"]))
        self.out["Alignment.Aligned"] = self.c(a and b)
        self.out["Alignment.AlignedCount"] += self.out["Alignment.Aligned"]


class Plc:
    """Scheduler and programs. A grant takes two cycles, as in a PLC whose scheduler runs before its programs."""

    def __init__(self):
        self.shear = Shear()
        self.fresh, self.running = True, False
        self.joined = self.done = self.answer = 0
        self.last = self.due = 0

    def cycle(self, i):
        """One cycle; `i` has INPUTS and WORDS_IN. Gives OUTPUTS and WORDS_OUT."""
        session, limit, tv, grant = (i[word] for word in WORDS_IN)
        if self.running:
            self.running = False
            self.done += 1
        if session != self.joined:
            if session == 0:
                self.joined, self.answer = 0, 0
            elif self.joined == 0 and self.fresh:
                self.fresh, self.done, self.last, self.due = False, session, tv, tv + PERIOD_NS
                self.joined, self.answer = session, 0
            else:
                self.answer = 6
        elif self.joined == 0 or grant == self.done:
            self.answer = 0
        elif grant < self.done:
            self.answer = 2
        elif grant - self.done > 1:
            self.answer = 3
        elif grant > limit:
            self.answer = 4
        elif tv <= self.last:
            self.answer = 5
        else:
            self.last, self.running, self.answer = tv, True, 1
            if self.due <= tv:
                self.due += ((tv - self.due) // PERIOD_NS + 1) * PERIOD_NS
                self.shear.scan(tv, i)
        # It was made without a scenario: there is no number of a mapping.
        words = dict(zip(WORDS_OUT, (self.joined, self.done, self.answer, 0)))
        return {**self.shear.out, **words}
