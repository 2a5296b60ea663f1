#!/usr/bin/python3
"""scripts/body_shapes.py: silhouettes against points of the surfaces, cuts against closed forms."""
import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "scripts"))
from body_shapes import reach, rotation, signed_distance, silhouette  # noqa: E402

random = np.random.default_rng(3)
sphere = random.normal(size=(20000, 3))
sphere /= np.linalg.norm(sphere, axis=1, keepdims=True)
corners = np.array([[0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2.0]]) - 0.5
disc = np.column_stack([np.cos(np.linspace(0, 6.3, 2000)), np.sin(np.linspace(0, 6.3, 2000)), np.ones(2000)])
cap = 0.6 * sphere[sphere[:, 2] > 0] + [0, 0, 0.9]
PARTS = {  # sizes, and points that reach furthest in every direction
    "sphere": ([1.3, 0, 0], 1.3 * sphere),
    "box": ([0.5, 1.1, 0.8], np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-1.1, 1.1) for z in (-0.8, 0.8)])),
    "capsule": ([0.6, 0.9, 0], np.vstack([cap * [1, 1, s] for s in (1, -1)])),
    "cylinder": ([0.6, 0.9, 0], np.vstack([disc * [0.6, 0.6, 0.9], disc * [0.6, 0.6, -0.9]])),
    "ellipsoid": ([1.4, 0.5, 0.9], sphere * [1.4, 0.5, 0.9]),
    "polyhedron": ([0, 0, 0], corners),
}
for kind, (size, surface) in PARTS.items():
    part = dict(type=kind, size=np.array(size), vertices=corners, faces=[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    for _ in range(20):
        q = random.normal(size=(2, 4))
        turned, view = (rotation(x / np.linalg.norm(x)) for x in q)
        centre = random.normal(size=3)
        outline = silhouette(part, centre, turned, view)
        seen = (centre + surface @ turned.T) @ view[:2].T
        part["position"] = centre
        assert reach(part) > np.linalg.norm(centre + surface @ turned.T, axis=1).max() - 1e-12, kind
        for angle in np.linspace(0, 2 * np.pi, 32, endpoint=False):
            d = np.array([np.cos(angle), np.sin(angle)])
            assert abs((outline @ d).max() - (seen @ d).max()) < 0.02, (kind, angle)
        distance = signed_distance(part, centre, turned, centre + surface @ turned.T)
        assert np.abs(distance).max() < 1e-12, kind
        middle = surface.mean(axis=0)
        for factor in (0.9, 1.1):  # inside and outside, in any shape of array
            points = (centre + (middle + factor * (surface - middle)) @ turned.T).reshape(1, -1, 3)
            distance = signed_distance(part, centre, turned, points)
            assert distance.shape == (1, len(surface)) and ((distance < 0) == (factor < 1)).all(), kind
print("silhouettes and cuts are those of the shapes")
