"""Balls of triangles, for renderers that have no other."""

import numpy as np


def icosphere(subdivisions: int) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (n, 3) and faces (m, 3) of a subdivided icosahedron with the area of the unit sphere."""
    golden = (1 + 5**0.5) / 2
    pairs = [(a, b * golden) for a in (-1, 1) for b in (-1, 1)]
    vertices = np.array([np.roll((0, a, b), shift) for shift in range(3) for a, b in pairs])
    distances = np.linalg.norm(vertices[:, None] - vertices[None], axis=2)
    near = np.isclose(distances, 2)
    corners = [
        (i, j, k) for i in range(12) for j in range(i) for k in range(j) if near[i, j] and near[j, k] and near[i, k]
    ]
    triangles = vertices[np.array(corners)]
    inward = (
        np.einsum(
            "ti,ti->t", np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), triangles[:, 0]
        )
        < 0
    )
    triangles[inward] = triangles[inward][:, ::-1]
    for _ in range(subdivisions):
        a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
        ab, bc, ca = a + b, b + c, c + a
        triangles = np.concatenate([np.stack(t, 1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
        triangles /= np.linalg.norm(triangles, axis=2, keepdims=True)
    cross = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    triangles *= np.sqrt(4 * np.pi / (np.linalg.norm(cross, axis=1).sum() / 2))
    return triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3)
