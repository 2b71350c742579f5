"""Rotations and shapes, as plant.toml has them."""

import numpy as np


def rotation(rpy_deg):
    """Roll about x, then pitch about y, then yaw about z, as a matrix."""
    roll, pitch, yaw = np.radians(rpy_deg)
    about_x = np.array([[1, 0, 0], [0, np.cos(roll), -np.sin(roll)], [0, np.sin(roll), np.cos(roll)]])
    about_y = np.array([[np.cos(pitch), 0, np.sin(pitch)], [0, 1, 0], [-np.sin(pitch), 0, np.cos(pitch)]])
    about_z = np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
    return about_z @ about_y @ about_x


def quaternion(matrix):
    """The same as w, x, y, z, by the largest of the four."""
    squares = np.array([1 + np.trace(matrix), *(1 + 2 * matrix[i, i] - np.trace(matrix) for i in range(3))])
    place = int(np.argmax(squares))
    half = np.sqrt(squares[place]) / 2
    skew = [matrix[2, 1] - matrix[1, 2], matrix[0, 2] - matrix[2, 0], matrix[1, 0] - matrix[0, 1]]
    if place == 0:
        return np.array([half, *(value / (4 * half) for value in skew)])
    axis = place - 1
    found = [0.0] * 4
    found[0] = skew[axis] / (4 * half)
    found[place] = half
    for other in range(3):
        if other != axis:
            found[other + 1] = (matrix[axis, other] + matrix[other, axis]) / (4 * half)
    return np.array(found)


def corners(body):
    """Points of the hull of a box in world coordinates; the ends of the axis of what is round."""
    turn, position = rotation(body["rpy_deg"]), np.array(body["position_m"])
    if body["shape"] == "box":
        half = np.array(body["size_m"]) / 2
        signs = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
        return [position + turn @ (half * sign) for sign in signs]
    reach = body["radius_m"] if body["shape"] == "sphere" else body["length_m"] / 2
    return [position + turn @ [0, 0, sign * reach] for sign in (-1, 1)]


def marks(body):
    """Points by which the pose of a body is compared: its origin, and two more where it may turn."""
    turn, position = rotation(body["rpy_deg"]), np.array(body["position_m"])
    reach = max(body.get("size_m", [2 * body.get("radius_m", 0.05)])) / 2
    return [position, position + turn @ [reach, 0, 0], position + turn @ [0, reach, 0]]
