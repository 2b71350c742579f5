"""Cuts a scene down for as long as it still differs in the same way."""

import numpy as np

import judge
import scene as scenes

MOST_TRIES = 120


def smallest(program, scene, what):
    """The smallest scene found that has the same kind of difference, and its verdict."""
    best, verdict, tries, again = scene, None, 0, True
    while again:
        again = False
        for smaller in candidates(best):
            if tries >= MOST_TRIES:
                break
            tries += 1
            found = judge.verdict(program, smaller)
            if found.kind == judge.FINDING and found.what == what:
                best, verdict, again = smaller, found, True
                break
    return best, verdict, tries


def candidates(scene):
    """Smaller scenes, those first that leave out most."""
    yield from without_bodies(scene)
    yield from without_entries(scene)
    yield from simpler_joints(scene)
    yield from simpler_bodies(scene)
    if scene["until_ms"] > 100:
        yield with_(scene, until_ms=max(100, scene["until_ms"] // 200 * 100))
    if scene["gravity_m_s2"] != [0.0, 0.0, -9.81] and any(scene["gravity_m_s2"]):
        yield with_(scene, gravity_m_s2=[0.0, 0.0, -9.81])
    if any(scene["gravity_m_s2"]) and not any(one["collides"] for one in scene["bodies"]):
        yield with_(scene, gravity_m_s2=[0.0, 0.0, 0.0])


def with_(scene, **keys):
    return {**scenes.changed(scene), **keys}


def without_bodies(scene):
    """Without a dynamic body that nothing hangs on."""
    parents = {one["parent"] for one in scene["joints"]}
    moving = [one["name"] for one in dynamic(scene)]
    if scenes.touching(scene):
        # what lies under others stays there
        moving = moving[-1:]
    for name in reversed(moving):
        closes = any(one["loop"] for one in scene["joints"] if name in (one["child"], one["parent"]))
        if name not in parents and len(dynamic(scene)) > 1 and not closes:
            yield cut(scene, name)


def dynamic(scene):
    return [one for one in scene["bodies"] if one["kind"] == "dynamic"]


def cut(scene, name):
    made = scenes.changed(scene)
    made["bodies"] = [one for one in made["bodies"] if one["name"] != name]
    gone = {one["name"] for one in made["joints"] if one["child"] == name}
    made["joints"] = [one for one in made["joints"] if one["name"] not in gone]
    for part in ("fittings", "drives", "turntables"):
        made[part] = [one for one in made[part] if one["joint"] not in gone]
    made["couplings"] = [one for one in made["couplings"] if not gone & {one["joint"], *one["of"]}]
    return made


def without_entries(scene):
    for part in ("couplings", "drives", "fittings"):
        for place in range(len(scene[part])):
            made = scenes.changed(scene)
            del made[part][place]
            yield made
    for place, one in enumerate(scene["fittings"]):
        keys = [key for key in ("spring", "damping", "balance", "friction", "brake") if key in one]
        for key in keys if len(keys) > 1 else []:
            made = scenes.changed(scene)
            del made["fittings"][place][key]
            made["fittings"][place].pop("rest" if key == "spring" else None, None)
            yield made
    for part, key in (("couplings", "backlash"), ("drives", "lag_s")):
        for place, one in enumerate(scene[part]):
            if one[key]:
                made = scenes.changed(scene)
                made[part][place][key] = 0.0
                yield made


def simpler_joints(scene):
    for place, one in enumerate(scene["joints"]):
        for keys in simpler_joint(one, scene):
            made = scenes.changed(scene)
            made["joints"][place].update(keys)
            yield made


def simpler_joint(one, scene):
    if one["lower"] is not None or one["upper"] is not None:
        yield {"lower": None, "upper": None}
    bound_to = any(one["name"] in (other["joint"], *other["of"]) for other in scene["couplings"])
    if one["initial"] and one["lower"] is None and one["upper"] is None and not bound_to:
        yield {"initial": 0.0}
    if "axis" in one and "slide" not in one and max(np.abs(one["axis"])) < 1.0:
        axis = [0.0, 0.0, 0.0]
        axis[int(np.argmax(np.abs(one["axis"])))] = 1.0
        yield {"axis": axis}


def simpler_bodies(scene):
    in_touch = any(one["collides"] for one in scene["bodies"])
    for place, one in enumerate(scene["bodies"]):
        for keys in simpler_body(one, in_touch):
            made = scenes.changed(scene)
            # what is joined goes on with one velocity, or its joint would be torn
            together = made["bodies"] if "velocity_m_s" in keys and scene["joints"] else [made["bodies"][place]]
            for body in together:
                body.update(keys)
            yield made


def simpler_body(one, in_touch):
    if one["kind"] == "dynamic" and one["mass_kg"] != 1.0:
        yield {"mass_kg": 1.0}
    if any(one["velocity_m_s"]):
        yield {"velocity_m_s": [0.0, 0.0, 0.0]}
        rounded = [round(x, 1) for x in one["velocity_m_s"]]
        if rounded != one["velocity_m_s"]:
            yield {"velocity_m_s": rounded}
    if not in_touch:
        if any(one["rpy_deg"]):
            yield {"rpy_deg": [0.0, 0.0, 0.0]}
        rounded = [round(x, 1) for x in one["position_m"]]
        if rounded != one["position_m"]:
            yield {"position_m": rounded}
    if one["friction_rule"] != "mean":
        yield {"friction_rule": "mean"}
