"""A graph of poses: what lies between two of them was measured, and all are moved until they fit it best.

G. Grisetti, R. Kuemmerle, C. Stachniss, W. Burgard, A Tutorial on Graph-Based SLAM, IEEE Intelligent Transportation
Systems Magazine (2010); dense, since a home has few hundred nodes. A loop that fits badly weighs less, as in P. Agarwal
et al., Robust Map Optimization using Dynamic Covariance Scaling, ICRA 2013.
"""

import math
from collections.abc import Sequence
from typing import Any, Final, NamedTuple

import numpy as np

from giraff_core.kinematics.pose import Pose
from giraff_maps.scan.match import Floats, rotated

_EVERY: Final = 4  # key turns from node to node
_MOST_NODES: Final = 400
_ROUNDS: Final = 6
_SETTLED: Final = 5e-4  # m or rad of a round, after which none follows
_DOUBTED: Final = 25.0  # squared deviations from which on a loop weighs less


class Edge(NamedTuple):
    """A measurement between two key turns."""

    begin: int
    end: int
    seen: Pose
    """Pose of the end, seen from the beginning."""
    information: Any
    """Inverse covariance of `seen`: 3 x 3; m, m, rad."""
    is_loop: bool = False


def seen_in(yaw: float, information: Any) -> Floats:
    """Return an information, or a covariance, along axes that are turned by so many rad."""
    turn = np.eye(3)
    turn[:2, :2] = rotated(yaw, np.eye(2))
    found: Floats = turn @ information @ turn.T
    return found


def optimised(poses: Sequence[Pose], edges: Sequence[Edge]) -> list[Pose]:
    """Return the poses that fit the edges best; the first one stays.

    Each fourth one is a node; those between are carried along. The edges that are no loops are a chain through all.
    """
    every = max(_EVERY, math.ceil(len(poses) / _MOST_NODES))
    nodes = sorted({*range(0, len(poses), every), len(poses) - 1})
    at_or_before = np.searchsorted(nodes, range(len(poses)), side="right") - 1
    reduced = _chain([edge for edge in edges if not edge.is_loop], set(nodes))
    for edge in (edge for edge in edges if edge.is_loop):
        begin, end = int(at_or_before[edge.begin]), int(at_or_before[edge.end])
        seen = edge.seen.placed_in(poses[edge.begin].seen_from(poses[nodes[begin]]))
        seen = poses[nodes[end]].seen_from(poses[edge.end]).placed_in(seen)
        reduced.append(Edge(begin, end, seen, edge.information, is_loop=True))
    moved = _solved(np.array([poses[node] for node in nodes]), reduced)
    found = []
    for number, pose in enumerate(poses):
        node = int(at_or_before[number])
        here = pose.seen_from(poses[nodes[node]]).placed_in(moved[node])
        if node + 1 < len(nodes):  # what is left at the next node is shared out
            end = poses[nodes[node + 1]].seen_from(poses[nodes[node]]).placed_in(moved[node])
            part = (number - nodes[node]) / (nodes[node + 1] - nodes[node])
            left = [part * (there - reached) for there, reached in zip(moved[node + 1][:2], end[:2], strict=True)]
            turn = part * math.remainder(moved[node + 1].yaw - end.yaw, math.tau)
            here = Pose(here.x + left[0], here.y + left[1], here.yaw + turn)
        found.append(here)
    return found


def _chain(edges: Sequence[Edge], nodes: set[int]) -> list[Edge]:
    """Join the edges from node to node."""
    joined: list[Edge] = []
    seen, covariance = Pose(0.0, 0.0, 0.0), np.zeros((3, 3))
    for edge in edges:
        covariance = covariance + seen_in(-seen.yaw, np.linalg.inv(edge.information))
        seen = edge.seen.placed_in(seen)
        if edge.end in nodes:
            joined.append(Edge(len(joined), len(joined) + 1, seen, np.linalg.inv(covariance)))
            seen, covariance = Pose(0.0, 0.0, 0.0), np.zeros((3, 3))
    return joined


def _solved(poses: Floats, edges: Sequence[Edge]) -> list[Pose]:
    """Return the poses by Gauss and Newton."""
    count = len(poses)
    begin, end = np.array([edge[:2] for edge in edges], int).T
    seen, information = np.array([edge.seen for edge in edges]), np.array([edge.information for edge in edges])
    is_loop = np.array([edge.is_loop for edge in edges])
    for _ in range(_ROUNDS):
        error, by_begin, by_end = _errors(poses[begin], poses[end], seen)
        squared = np.einsum("ni,nij,nj->n", error, information, error)
        weight = np.where(is_loop, np.minimum(1.0, 2.0 * _DOUBTED / (_DOUBTED + squared)) ** 2, 1.0)
        weighed = information * weight[:, None, None]
        left, right = by_begin.transpose(0, 2, 1) @ weighed, by_end.transpose(0, 2, 1) @ weighed
        system, slope = np.zeros((count, count, 3, 3)), np.zeros((count, 3))
        for rows, columns, block in (
            (begin, begin, left @ by_begin),
            (end, end, right @ by_end),
            (begin, end, left @ by_end),
            (end, begin, right @ by_begin),
        ):
            np.add.at(system, (rows, columns), block)
        np.add.at(slope, begin, np.einsum("nij,nj->ni", left, error))
        np.add.at(slope, end, np.einsum("nij,nj->ni", right, error))
        flat = system.transpose(0, 2, 1, 3).reshape(3 * count, 3 * count)
        step = np.linalg.solve(flat[3:, 3:], -slope.reshape(-1)[3:]).reshape(-1, 3)
        poses[1:] += step
        if np.abs(step).max() < _SETTLED:
            break
    return [Pose(*map(float, pose)) for pose in poses]


def _errors(begin: Floats, end: Floats, seen: Floats) -> tuple[Floats, Floats, Floats]:
    """Return how far each edge is off, and its slopes by the pose at its beginning and at its end: (n, 3, 3)."""
    cos, sin = np.cos(begin[:, 2]), np.sin(begin[:, 2])
    x, y = (end - begin)[:, :2].T
    error = np.stack([cos * x + sin * y, cos * y - sin * x, end[:, 2] - begin[:, 2]], axis=1) - seen
    error[:, 2] = (error[:, 2] + math.pi) % math.tau - math.pi
    by_begin, by_end = np.zeros((2, len(seen), 3, 3))
    by_begin[:, 0] = np.stack([-cos, -sin, cos * y - sin * x], axis=1)
    by_begin[:, 1] = np.stack([sin, -cos, -cos * x - sin * y], axis=1)
    by_begin[:, 2, 2] = -1.0
    by_end[:, 0, :2], by_end[:, 1, :2] = np.stack([cos, sin], axis=1), np.stack([-sin, cos], axis=1)
    by_end[:, 2, 2] = 1.0
    return error, by_begin, by_end
