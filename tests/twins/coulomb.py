"""A third opinion where there is one: a flat box that slides and does not turn, or a sphere, cylinder or capsule that rolls, on a
plane or on a belt, by Coulomb's law alone.

Friction is at its limit against the velocity of the contact, or what holds it. The velocity is that of the end of a step, so the
error is of first order; twice the result at a step less that at two steps has none of it. When a body lands would depend on the
phase of a step, by which it goes on with the wrong velocity, and nothing takes that out; so it falls to the very instant, and
steps begin there.
"""

import numpy as np

import scene as scenes
import space

STEP_S = 1e-4


def path(scene, every_us, late_s=0.0):
    """Positions of the one moving body at all samples; None where this law does not apply. What falls lands so much later."""
    moving = [one for one in scene["bodies"] if one["kind"] == "dynamic"]
    under = [one for one in scene["bodies"] if one["kind"] == "fixed"]
    if len(moving) != 1 or len(under) != 1 or scene["joints"] or len(scenes.touching(scene)) != 1:
        return None
    fine, coarse = (integrated(scene, moving[0], under[0], every_us, step, late_s) for step in (STEP_S, 2 * STEP_S))
    best = 2 * fine - coarse
    return {f"{moving[0]['name']}.p0.{axis}": best[:, number] for number, axis in enumerate("xyz")}


def inertia_share(body):
    """m R^2 / I of what rolls; 0 of a box, which does not turn."""
    shape, radius = body["shape"], body.get("radius_m", 0.0)
    if shape == "box":
        return 0.0
    if shape == "sphere":
        return 2.5
    if shape == "cylinder":
        return 2.0
    length = body["length_m"]
    # a capsule: a cylinder and two half spheres, by their volumes
    barrel, caps = length, 4 / 3 * radius
    return (barrel + caps) / (barrel / 2 + caps * 2 / 5)


def integrated(scene, body, under, every_us, step, late_s):
    turn = space.rotation(under["rpy_deg"])
    top = np.array(under["position_m"]) + turn @ [0, 0, under["size_m"][2] / 2]
    gravity = turn.T @ np.array(scene["gravity_m_s2"])
    place, velocity = turn.T @ (np.array(body["position_m"]) - top), turn.T @ np.array(body["velocity_m_s"])
    height = body["size_m"][2] / 2 if body["shape"] == "box" else body["radius_m"]
    belt = next(iter(scene["belts"]), None)
    contact = Contact(scenes.touching(scene)[0][2], inertia_share(body), belt and turn.T @ np.array(belt["direction"]), belt)
    lands = landing(height - place[2], velocity[2], gravity[2])
    lands += late_s if lands else 0.0
    rolled, began, now, found = np.zeros(3), (place, velocity), 0.0, []
    for sample in range(scene["until_ms"] * 1000 // every_us + 1):
        time = sample * every_us * 1e-6
        if time <= lands:
            found.append(began[0] + began[1] * time + gravity * time ** 2 / 2)
            continue
        if now < lands:
            place, velocity, now = began[0] + began[1] * lands + gravity * lands ** 2 / 2, began[1] + gravity * lands, lands
            velocity, rolled = contact.pressed(velocity, rolled, now)
        count = max(1, round((time - now) / step))
        part, start = (time - now) / count, now
        for number in range(1, count + 1):
            velocity, rolled = contact.pressed(velocity + gravity * part, rolled, start + number * part)
            place = place + velocity * part
        now = time
        found.append(place.copy())
    return np.array(found) @ turn.T + top


def landing(way, speed, gravity):
    """When what falls has gone this way, which is down: 0 for what lies."""
    if way > -1e-9:
        return 0.0
    return (-speed - np.sqrt(speed ** 2 + 2 * gravity * way)) / gravity


class Contact:
    """Of a body with a plane, or with a belt along it."""

    def __init__(self, friction, share, along, belt):
        self.friction, self.share, self.along, self.belt = friction, share, along, belt

    def pressed(self, velocity, rolled, time):
        """Velocities, of the centre and of the rim, once the plane has stopped the body and rubbed as far as it can."""
        pressed, velocity = max(0.0, -velocity[2]), np.array([*velocity[:2], max(0.0, velocity[2])])
        slip = velocity - rolled
        if self.belt:
            slip = slip - self.along * min(self.belt["speed"], self.belt["acceleration"] * time)
        slip[2] = 0.0
        size = np.linalg.norm(slip)
        if size == 0.0 or pressed == 0.0:
            return velocity, rolled
        impulse = -slip / size * min(self.friction * pressed, size / (1 + self.share))
        return velocity + impulse, rolled - self.share * impulse
