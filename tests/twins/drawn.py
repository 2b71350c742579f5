"""Random numbers of a scene, short ones, so that a scene can be read."""

import random

import numpy as np


class Draw:
    def __init__(self, seed, family):
        self.random = random.Random(f"{family} {seed}")

    def number(self, low, high, digits=3):
        return round(self.random.uniform(low, high), digits)

    def wide(self, low, high):
        """Evenly over the powers of ten."""
        return float(f"{10 ** self.random.uniform(np.log10(low), np.log10(high)):.3g}")

    def whole(self, low, high):
        return self.random.randint(low, high)

    def chance(self, share):
        return self.random.random() < share

    def one_of(self, choices):
        return self.random.choice(choices)

    def sign(self):
        return self.random.choice([-1.0, 1.0])

    def axis(self):
        """A direction: mostly one of the world's, else any."""
        if self.chance(0.6):
            axis = [0.0, 0.0, 0.0]
            axis[self.whole(0, 2)] = 1.0
            return axis
        return self.direction()

    def direction(self):
        while True:
            vector = np.array([self.random.uniform(-1, 1) for _ in range(3)])
            length = np.linalg.norm(vector)
            if 0.2 < length <= 1:
                return [float(x) for x in vector / length]

    def angles(self):
        if self.chance(0.5):
            return [0.0, 0.0, 0.0]
        return [self.number(-180, 180, 1), self.number(-85, 85, 1), self.number(-180, 180, 1)]

    def point(self, reach):
        return [self.number(-reach, reach) for _ in range(3)]

    def shape(self):
        """A shape of some decimetres and its mass."""
        kind = self.one_of(["box", "box", "sphere", "cylinder", "capsule"])
        keys = {"shape": kind, "mass_kg": self.wide(0.2, 5.0)}
        if kind == "box":
            return {**keys, "size_m": [self.number(0.04, 0.4) for _ in range(3)]}
        keys["radius_m"] = self.number(0.03, 0.15)
        if kind != "sphere":
            keys["length_m"] = self.number(0.05, 0.4)
        return keys

    def clock(self, scene, until=(3, 6)):
        """How long a scene is, and its coarsest step."""
        scene["until_ms"] = 100 * self.whole(*until)
        scene["step_us"] = 200 if scene["drives"] else self.one_of([200, 400, 1000])
