"""The scene for onescan: `plant.toml` and `scenario.toml`, and a run of them."""

import subprocess
import tempfile
from pathlib import Path

import numpy as np

import scene as scenes
import space


class Refused(Exception):
    """onescan does not take or does not finish a scene."""


def value(given):
    if isinstance(given, bool):
        return "true" if given else "false"
    if isinstance(given, str):
        return f'"{given}"'
    if isinstance(given, (list, tuple, np.ndarray)):
        return "[" + ", ".join(value(one) for one in given) + "]"
    return repr(int(given)) if isinstance(given, int) else repr(float(given))


def table(_head, **keys):
    lines = [f"{key} = {value(given)}" for key, given in keys.items() if given is not None]
    return "\n".join([f"[[{_head}]]", *lines, ""])


def unit(kind, metres, radians):
    return metres if scenes.is_linear(kind) else radians


def body(one):
    keys = {key: one.get(key) for key in ("name", "kind", "shape", "size_m", "radius_m", "length_m", "position_m", "rpy_deg")}
    if one["kind"] == "dynamic":
        keys["mass_kg"] = one["mass_kg"]
        if any(one["velocity_m_s"]):
            keys["velocity_m_s"] = one["velocity_m_s"]
    return table("body", **keys, friction=one["friction"], friction_rule=one["friction_rule"], collides=one["collides"])


def joint(one):
    end = unit(one["kind"], "m", "rad")
    keys = {key: one.get(key) for key in ("name", "kind", "parent", "child", "anchor_m", "axis", "slide")}
    if scenes.has_coordinate(one):
        keys.update({f"{key}_{end}": one[key] for key in ("initial", "lower", "upper")})
    return table("joint", **keys)


def fitting(scene, one):
    kind = scenes.named(scene, "joints", one["joint"])["kind"]
    names = {
        "friction": unit(kind, "friction_n", "friction_nm"), "damping": unit(kind, "damping_n_s_m", "damping_nm_s_rad"),
        "spring": unit(kind, "spring_n_m", "spring_nm_rad"), "rest": unit(kind, "rest_m", "rest_rad"),
        "balance": unit(kind, "balance_n", "balance_nm"), "brake": unit(kind, "brake_n", "brake_nm"),
    }
    keys = {names[key]: given for key, given in one.items() if key in names}
    return table("fitting", name=f"fit_{one['joint']}", joint=one["joint"], **keys)


def coupling(scene, one):
    kind = scenes.named(scene, "joints", one["joint"])["kind"]
    keys = {unit(kind, "backlash_m", "backlash_rad"): one["backlash"] or None}
    return table("coupling", name=one["name"], joint=one["joint"], of=one["of"], ratio=one["ratio"], **keys)


def drive(scene, one):
    keys = {"name": f"drive_{one['joint']}", "joint": one["joint"], "current_loop_s": one["lag_s"]}
    if scenes.is_linear(scenes.named(scene, "joints", one["joint"])["kind"]):
        keys.update(kind="force_drive", force_max_n=1e6, speed_max_m_s=1000.0, command_n=one["effort"])
    else:
        keys.update(kind="torque_drive", torque_max_nm=1e6, speed_max_rad_s=1000.0, command_nm=one["effort"])
    return table("component", **keys)


def turntable(one):
    return table("component", name=f"drive_{one['joint']}", kind="turntable", joint=one["joint"], torque_max_nm=1e6,
                 speed_rad_s=one["speed"], acceleration_rad_s2=one["acceleration"], run=True)


def belt(one):
    return table("component", name=f"belt_{one['body']}", kind="conveyor", belt=one["body"], direction=one["direction"],
                 speed_m_s=one["speed"], acceleration_m_s2=one["acceleration"], run=True)


def sensors(scene):
    """Tables of the sensors, and the signals that they write."""
    tables, signals = [], []
    for one in scene["joints"]:
        if scenes.has_coordinate(one):
            name = one["name"]
            tables.append(table("component", name=f"enc_{name}", kind="axis_encoder", joint=name,
                                position_signal=f"{name}.q", velocity_signal=f"{name}.v"))
            signals += [f"{name}.q", f"{name}.v"]
    for one in scene["bodies"]:
        if one["kind"] != "dynamic":
            continue
        for place, point in enumerate(space.marks(one)):
            name = f"{one['name']}.p{place}"
            keys = {f"{axis}_m_signal": f"{name}.{axis}" for axis in "xyz"}
            if place == 0:
                keys.update({f"{axis}_m_s_signal": f"{name}.v{axis}" for axis in "xyz"})
            signals += keys.values()
            tables.append(table("component", name=f"pose_{one['name']}_{place}", kind="pose_sensor", body=one["name"],
                                point_m=point, **keys))
    return tables, signals


def machine(scene):
    """The scene without the sensors by which it is compared."""
    parts = [f"version = 1\ngravity_m_s2 = {value(scene['gravity_m_s2'])}\n"]
    belts = {one["body"] for one in scene["belts"]}
    for one in scene["bodies"]:
        parts.append(body({**one, "kind": "kinematic"} if one["name"] in belts else one))
    parts += [joint(one) for one in scene["joints"]]
    parts += [fitting(scene, one) for one in scene["fittings"]]
    parts += [coupling(scene, one) for one in scene["couplings"]]
    parts += [drive(scene, one) for one in scene["drives"]]
    parts += [turntable(one) for one in scene["turntables"]]
    parts += [belt(one) for one in scene["belts"]]
    return "\n".join(parts)


def plant(scene):
    return "\n".join([machine(scene), *sensors(scene)[0]])


def scenario(scene, step_us):
    lines = ["version = 1", 'title = "a twin"', f'step = "{step_us}us"', f'until = "{scene["until_ms"]}ms"', "", "[signals]"]
    lines += [f'"{name}" = {{ type = "LREAL", writer = "plant" }}' for name in sensors(scene)[1]]
    return "\n".join([*lines, "", "[clients.plant]", 'kind = "plant"', 'scene = "plant.toml"', ""])


def run(program, scene, step_us, every_us, seconds=120):
    """All signals at every multiple of `every_us`: a dictionary of arrays. Raises Refused."""
    with tempfile.TemporaryDirectory(prefix="twins-") as folder:
        folder = Path(folder)
        (folder / "plant.toml").write_text(plant(scene))
        (folder / "scenario.toml").write_text(scenario(scene, step_us))
        words = [program, "run", folder, "--record", folder / "rec", "--record-also", "csv"]
        try:
            done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=seconds)
        except subprocess.TimeoutExpired as late:
            raise Refused(f"no end within {seconds} s at {step_us} us") from late
        if done.returncode != 0:
            raise Refused(f"exit code {done.returncode} at {step_us} us: {done.stderr.strip()[-600:]}")
        lines = (folder / "rec" / "run-1" / "trajectory.csv").read_text().split("\n")
    names = lines[0].split(",")[1:]
    # the header, then the start, then one line for each step
    rows = [line.split(",")[1:] for line in lines[1::every_us // step_us] if line]
    wanted = scene["until_ms"] * 1000 // every_us + 1
    if len(rows) < wanted:
        raise Refused(f"{len(rows)} samples of {wanted} at {step_us} us")
    return dict(zip(names, np.array(rows, dtype=float).T))
