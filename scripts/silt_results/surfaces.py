"""The surfaces of bodies and walls as VTK PolyData (.vtp), a file a time, and the list of times that ParaView opens (.pvd).

    write_surfaces(silt_results.open("cases/segregation").bodies, "out")        # out/bodies_000000000100.vtp, ..., out/bodies.pvd
Each triangle has what its body has: id, kind, velocity and the other columns of bodies.h5; each point `surface_velocity`, v + omega x r.
"""
import pathlib
import sys

import numpy as np

TYPES = {"f4": "Float32", "f8": "Float64", "i4": "Int32", "i8": "Int64", "u8": "UInt64"}
LEFT_OUT = ("position", "image", "orientation")  # the points say where a body is


def rotations(q):
    """Returns the matrices [n, 3, 3] of unit quaternions w, x, y, z [n, 4]: body to world."""
    w, x, y, z = q.T
    rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
    return np.moveaxis(np.array(rows), -1, 0)


def surfaces(series, index):
    """Returns points [P, 3] and their velocities, triangles [T, 3] and the row in series.at(index) of each one's body."""
    rows = series.at(index)
    points, velocities, triangles, bodies = [np.zeros((0, 3))], [np.zeros((0, 3))], [np.zeros((0, 3), int)], [np.zeros(0, int)]
    first = 0
    for kind in np.unique(rows["kind"]):
        of_kind = np.flatnonzero(rows["kind"] == kind)
        if not series.meshes[kind]:
            raise ValueError(f"bodies.h5 has no surface of the kind {series.kinds[kind]}")
        turned = rotations(rows["orientation"][of_kind])
        if "scale" in rows:
            turned *= rows["scale"][of_kind][:, None, None]
        for part in series.meshes[kind]:
            arms = np.einsum("nij,vj->nvi", turned, part["vertices"])
            spin = np.cross(rows["angular_velocity"][of_kind][:, None], arms)
            points.append((rows["position"][of_kind][:, None] + arms).reshape(-1, 3))
            velocities.append((rows["velocity"][of_kind][:, None] + spin).reshape(-1, 3))
            corners = len(part["vertices"]) * np.arange(len(of_kind))
            triangles.append((first + corners[:, None, None] + part["triangles"]).reshape(-1, 3))
            bodies.append(np.repeat(of_kind, len(part["triangles"])))
            first += corners.size * len(part["vertices"])
    return tuple(map(np.concatenate, (points, velocities, triangles, bodies)))


class Blocks:
    """Blocks are the arrays of a .vtp file, which follow its XML as they are in memory."""

    def __init__(self):
        self.arrays, self.size = [], 0

    def element(self, name, values, attributes=""):
        """Returns the XML of an array and keeps its values."""
        values = np.ascontiguousarray(values)
        components = f' NumberOfComponents="{values.shape[1]}"' if values.ndim > 1 else ""
        text = (f'<DataArray type="{TYPES[values.dtype.str[1:]]}" Name="{name}"{components}{attributes} format="appended" '
                f'offset="{self.size}"/>\n')
        self.arrays.append(values)
        self.size += 8 + values.nbytes
        return text

    def write(self, file):
        for values in self.arrays:
            file.write(np.uint64(values.nbytes).tobytes())
            file.write(values.tobytes())


def write_vtp(path, time, points, triangles, of_points, of_triangles):
    """Writes triangles [T, 3] of points [P, 3] at a time, with arrays by name that have a row a point or a triangle; numbers other
    than whole ones in single precision."""
    blocks = Blocks()

    def elements(arrays):
        return "".join(blocks.element(name, values.astype("f4") if values.dtype.kind == "f" else values) for name, values in arrays.items())
    cells = elements(of_triangles)
    when = blocks.element("TimeValue", np.array([float(time)]), ' NumberOfTuples="1"')
    at_points = elements(of_points)
    where = blocks.element("Points", points.astype("f4"))
    faces = blocks.element("connectivity", triangles.astype("i8").reshape(-1)) + \
        blocks.element("offsets", 3 * np.arange(1, len(triangles) + 1, dtype="i8"))
    text = (f'<?xml version="1.0"?>\n<VTKFile type="PolyData" version="1.0" byte_order="{sys.byteorder.title()}Endian" '
            f'header_type="UInt64">\n<PolyData>\n<FieldData>\n{when}</FieldData>\n'
            f'<Piece NumberOfPoints="{len(points)}" NumberOfPolys="{len(triangles)}">\n'
            f"<PointData>\n{at_points}</PointData>\n<CellData>\n{cells}</CellData>\n<Points>\n{where}</Points>\n"
            f'<Polys>\n{faces}</Polys>\n</Piece>\n</PolyData>\n<AppendedData encoding="raw">\n_')
    with open(path, "wb") as file:
        file.write(text.encode())
        blocks.write(file)
        file.write(b"\n</AppendedData>\n</VTKFile>\n")


def write_list(path, times, files):
    """Writes the list of files and their times that ParaView opens (.pvd)."""
    listed = "".join(f'<DataSet timestep="{float(time)!r}" file="{file.name}"/>\n' for time, file in zip(times, files))
    path.write_text(f'<?xml version="1.0"?>\n<VTKFile type="Collection" version="1.0">\n<Collection>\n{listed}</Collection>\n</VTKFile>\n')


def write_surfaces(series, folder, indices=None):
    """Writes FOLDER/bodies_STEP.vtp of the times with these indices (of all), and FOLDER/bodies.pvd. Returns the paths of the former."""
    folder, paths = pathlib.Path(folder), []
    indices = range(len(series)) if indices is None else indices
    for index in indices:
        paths.append(folder / f"bodies_{series.step[index]:012d}.vtp")
        points, velocities, triangles, bodies = surfaces(series, index)
        columns = {name: values[bodies] for name, values in series.at(index).items() if name not in LEFT_OUT}
        write_vtp(paths[-1], series.time[index], points, triangles, {"surface_velocity": velocities}, columns)
    write_list(folder / "bodies.pvd", [series.time[index] for index in indices], paths)
    return paths


def write_walls(scene, folder, times):
    """Writes the walls that are meshes at some times, pairs (step, time): FOLDER/walls_STEP.vtp, and FOLDER/walls.pvd, the list of
    them; one file where none of them moves. Each triangle has the number of its wall. Returns the paths; none without such walls."""
    folder, paths, when = pathlib.Path(folder), [], []
    meshes = [(number, wall) for number, wall in enumerate(scene.walls) if wall.type == "mesh"]
    if not meshes:
        return []
    for step, time in times if any(wall.moves for _, wall in meshes) else times[:1]:
        paths.append(folder / f"walls_{step:012d}.vtp")
        when.append(time)
        first = np.cumsum([0] + [len(wall.vertices) for _, wall in meshes])
        triangles = np.concatenate([begin + wall.triangles for begin, (_, wall) in zip(first, meshes)])
        numbers = np.concatenate([np.full(len(wall.triangles), number, "i4") for number, wall in meshes])
        write_vtp(paths[-1], time, np.concatenate([wall.points(time) for _, wall in meshes]), triangles, {}, {"wall": numbers})
    write_list(folder / "walls.pvd", when, paths)
    return paths
