"""What Coulomb's law says of flat boxes on each other that are pushed along x: each slides on the one below or rides on it.

All forces between them are known, so each step is a small convex problem: of all velocities those in which friction takes least
energy out. It ends where a box would fall over or off.
"""

import numpy as np

import scene as scenes

STEP_S = 2e-4
SWEEPS = 200


def path(scene, every_us):
    """Places along x of all boxes at the samples up to which the law holds; None where it does not apply."""
    boxes = [one for one in scene["bodies"] if one["kind"] == "dynamic"]
    if scene["family"] != "stack" or any(any(one["rpy_deg"]) for one in boxes):
        return None
    if any(one["velocity_m_s"][1] or one["velocity_m_s"][2] for one in boxes):
        return None
    fine, coarse = (Layers(scene, boxes).run(every_us, step) for step in (STEP_S, 2 * STEP_S))
    count = min(len(fine), len(coarse))
    places = 2 * fine[:count] - coarse[:count]
    return {f"{one['name']}.p0.x": places[:, number] for number, one in enumerate(boxes)}


class Layers:
    def __init__(self, scene, boxes):
        self.scene = scene
        self.mass = np.array([one["mass_kg"] for one in boxes])
        self.half = np.array([one["size_m"][0] / 2 for one in boxes])
        self.height = np.array([one["position_m"][2] for one in boxes])
        self.foot = self.height - np.array([one["size_m"][2] / 2 for one in boxes])
        self.v = np.array([one["velocity_m_s"][0] for one in boxes])
        self.x = np.array([one["position_m"][0] for one in boxes])
        floor = next((one for one in scene["bodies"] if one.get("floor")), None)
        self.guided = floor is None
        below = [None if self.guided else floor, *boxes[:-1]]
        rub = [0.0 if under is None else scenes.pair_friction(under, one) for under, one in zip(below, boxes)]
        above = np.cumsum(self.mass[::-1])[::-1]
        self.limit = np.array(rub) * above * 9.81
        self.force = np.zeros(len(boxes))
        if scene["drives"]:
            self.force[0] = scene["drives"][0]["effort"]

    def run(self, every_us, step):
        found, steps = [self.x.copy()], round(every_us * 1e-6 / step)
        for number in range(1, self.scene["until_ms"] * 1000 // every_us * steps + 1):
            before = self.v.copy()
            self.advance(step)
            if not self.stands((self.v - before) / step):
                break
            if number % steps == 0:
                found.append(self.x.copy())
        return np.array(found)

    def advance(self, step):
        """Impulses between the layers, each within its limit, until none changes."""
        mass, limit = self.mass.tolist(), (self.limit * step).tolist()
        v = (self.v + self.force / self.mass * step).tolist()
        given = [0.0] * len(v)
        for _ in range(SWEEPS):
            change = 0.0
            for one, most in enumerate(limit):
                if not most:
                    continue
                slip = v[one] - (v[one - 1] if one else 0.0)
                light = 1 / mass[one] + (1 / mass[one - 1] if one else 0.0)
                wanted = min(most, max(-most, given[one] - slip / light))
                more, given[one] = wanted - given[one], wanted
                v[one] += more / mass[one]
                if one:
                    v[one - 1] -= more / mass[one - 1]
                change = max(change, abs(more))
            if change < 1e-13:
                break
        self.v = np.array(v)
        self.x = self.x + self.v * step

    def stands(self, acceleration):
        """Whether what lies on each joint of two layers presses within both."""
        for one in range(1 if self.guided else 0, len(self.mass)):
            part = slice(one, None)
            mass = self.mass[part]
            lever = mass * (9.81 * self.x[part] - acceleration[part] * (self.height[part] - self.foot[one]))
            place = lever.sum() / (9.81 * mass.sum())
            under = one and abs(place - self.x[one - 1]) > 0.98 * self.half[one - 1]
            if abs(place - self.x[one]) > 0.98 * self.half[one] or under:
                return False
        return True
