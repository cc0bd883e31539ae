"""Spheres of triangles, for files that have no other."""

import numpy as np


def latitude_longitude_sphere(columns: int, rows: int) -> str:
    """An ASCII PLY of the unit sphere around +y, smooth: quads of two triangles, those at the poles of one."""
    around, down = np.meshgrid(2 * np.pi * np.arange(columns + 1) / columns, np.pi * np.arange(rows + 1) / rows)
    points = np.stack([np.sin(down) * np.cos(around), np.cos(down), -np.sin(down) * np.sin(around)], -1).reshape(-1, 3)
    upper = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    lower = upper + columns + 1
    first, second = np.stack([upper, lower, upper + 1], 1), np.stack([upper + 1, lower, lower + 1], 1)
    faces = np.concatenate([first[columns:], second[:-columns]])
    head = f"ply\nformat ascii 1.0\nelement vertex {len(points)}\n"
    head += "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz"))
    head += f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    lines = [" ".join(f"{v:.9g}" for v in (*p, *p)) + "\n" for p in points]
    return head + "".join(lines + [f"3 {i} {j} {k}\n" for i, j, k in faces])
