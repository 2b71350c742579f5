"""Closed forms of two more scenes: a box that is pushed along a floor, and one that rides on a turntable."""

import numpy as np

import scene as scenes

# A box rides where friction is this much more than what its centre needs: its corners need more than that.
SURE = 1.5


def pushed(scene, every_us):
    """Pusher and box go on together with what friction at the floor leaves of the force. What the face carries of the box's
    weight is nothing: nothing lifts it."""
    if scene["family"] != "pusher" or len(scene["bodies"]) != 3 or not scene["drives"]:
        return None
    floor, box, pusher = (scenes.named(scene, "bodies", name) for name in ("floor", "box", "pusher"))
    left = scene["drives"][0]["effort"] - scenes.pair_friction(floor, box) * box["mass_kg"] * 9.81
    times = np.arange(scene["until_ms"] * 1000 // every_us + 1) * every_us * 1e-6
    way = max(0.0, left) / (box["mass_kg"] + pusher["mass_kg"]) * times ** 2 / 2
    return {f"{one['name']}.p0.x": one["position_m"][0] + way for one in (box, pusher)}


def riding(scene, every_us):
    """A box that lies on a turntable and does not slip turns with it."""
    if scene["family"] != "table" or len(scene["bodies"]) != 2:
        return None
    (table, box), drive = scene["bodies"], scene["turntables"][0]
    reach = np.hypot(*box["position_m"][:2]) + np.hypot(*box["size_m"][:2]) / 2
    needed = reach * np.hypot(drive["speed"] ** 2, drive["acceleration"])
    if scenes.pair_friction(table, box) * 9.81 < SURE * needed:
        return None
    times = np.arange(scene["until_ms"] * 1000 // every_us + 1) * every_us * 1e-6
    ramp = drive["speed"] / drive["acceleration"]
    angle = np.where(times < ramp, drive["acceleration"] * times ** 2 / 2, drive["speed"] * (times - ramp / 2))
    x, y = box["position_m"][:2]
    return {"box.p0.x": x * np.cos(angle) - y * np.sin(angle), "box.p0.y": x * np.sin(angle) + y * np.cos(angle),
            "axle.q": angle}


def path(scene, every_us):
    return pushed(scene, every_us) or riding(scene, every_us)
