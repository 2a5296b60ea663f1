"""Scenes put together at random from what cases can hold, one a seed: the tables of a case, for case_text."""
import random

import silt_results
from silt_runs import run

REFUSED, STOPPED = 2, 3  # exit codes: a scene that is no case, or that a guard stops


def mesh_text(vertices, triangles):
    """The text of a PLY file."""
    head = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}", *(f"property double {axis}" for axis in "xyz"),
            f"element face {len(triangles)}", "property list uchar int vertex_indices", "end_header"]
    return "\n".join([*head, *(" ".join(map(repr, v)) for v in vertices), *(f"3 {a} {b} {c}" for a, b, c in triangles)]) + "\n"


# A cube of edges of 6 with its corners shifted, each in another way: no symmetry maps it to itself.
STONE = ([[-3, -3.25, -3], [-2.5, -3, 3.5], [-3, 3, -2.75], [-3.5, 2.75, 3], [3, -2.5, -3], [3.5, -3, 2.75], [2.75, 3.25, -3.5], [3, 3.5, 3.25]],
         [[a, *side] for a, b, c, d in ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
          for side in ((b, c), (c, d))])
SHAPES = [dict(type="sphere", diameter=7), dict(type="box", edges=[7, 6, 8]), dict(type="capsule", diameter=6, length=4),
          dict(type="ellipsoid", diameters=[6, 7, 9]), dict(type="cylinder", diameter=7, length=6), dict(type="mesh", file="stone.ply"),
          dict(type="polyhedron", vertices=[[4, 0, 0], [-3, 3, 0], [-3, -3, 1], [0, 0, 4], [0, 1, -4]]),
          dict(type="compound", parts=[dict(type="sphere", diameter=6, position=[-2, 0, 0]), dict(type="box", edges=[6, 5, 6], position=[2, 1, 0.5]),
                                       dict(type="cylinder", diameter=3, length=8, position=[0, -1, 1], orientation=[0.6, 0, 0.8])])]


def result(silt, folder, text, mesh=STONE, again=STONE):
    """Runs a case in a folder of its own. Returns the exit code, its results (None if it is refused or stopped) and messages."""
    folder.mkdir()
    (folder / "case.toml").write_text(text)
    for name, surface in (("stone", mesh), ("again", again)):
        (folder / f"{name}.ply").write_text(mesh_text(*surface))
    done = run(silt, "run", folder, code=None)
    if done.returncode not in (0, REFUSED, STOPPED):
        raise SystemExit(f"exit code {done.returncode}: {done.stderr[-600:]}\n{text}")
    return done.returncode, (silt_results.open(folder) if done.returncode == 0 else None), done.stderr


class Scene(random.Random):
    """The tables of a case, made one after another; what is made first decides what goes with it."""

    def __init__(self, seed):
        super().__init__(seed)
        self.fluid, self.levels = self.maybe(0.9), self.maybe(0.4)
        self.heat = self.fluid and self.maybe(0.5)
        self.mean_gradient = self.heat and self.maybe(0.2)
        self.cells = [self.choice([32, 40, 48]) for _ in "xyz"] if self.levels else [self.choice([28, 33, 40]) for _ in "xyz"]
        if self.levels:
            self.cells[self.randrange(3)] = 64
        self.steps = 64 if self.levels else 48
        self.sides = [self.axis(d) for d in range(3)]

    def maybe(self, share):
        return self.random() < share

    def vector(self, largest, without=None):
        return [0 if d == without else round(self.uniform(-largest, largest), 5) for d in range(3)]

    def place(self):
        return [round(n * self.uniform(0.3, 0.7), 3) for n in self.cells]

    def some(self, **tables):
        """Leaves out some of the keys, each with the share that is given beside its value."""
        return {key: value for key, (share, value) in tables.items() if self.maybe(share)}

    def axis(self, d):
        wall = dict(type="no-slip") | (self.choice([dict(temperature=1), dict(heat_flux=1e-3), {}]) if self.heat else {})
        low = self.choice(["periodic", wall, dict(type="free-slip"), dict(type="moving", velocity=self.vector(0.02, d))])
        if self.fluid and self.maybe(0.15):
            stream = [0.02 * (d == k) for k in range(3)]
            return [dict(type="velocity-inlet", velocity=stream, solid_for_bodies=False),
                    dict(type="pressure-outlet", solid_for_bodies=False, pressure=self.choice([0, 1e-3]))]
        return low if low == "periodic" else [low, wall]

    def surface(self):
        if not self.heat or self.mean_gradient or self.maybe(0.4):
            return {}
        return dict(temperature=1) | self.some(heat_capacity=(0.5, 2))

    def bodies(self, name):
        """A fill, or a body at a place, perhaps with a spring."""
        velocity = self.vector(0.01)
        if self.maybe(0.75):
            box = [[1, 1, 1], [n * 3 // 4 for n in self.cells]]
            fill = dict(shape=name, density=self.choice([0.7, 1.3, 2.5]), count=self.choice([2, 4]), velocity=velocity)
            return dict(fill=[fill | self.surface() | (dict(box=box, every=16) if self.maybe(0.25) else {})])
        motion = self.choice(["free", "free", "fixed", "prescribed"])
        body = dict(name="one " + name, shape=name, density=1.5, motion=motion, position=self.place()) | self.surface()
        if motion != "fixed":
            body |= dict(velocity=velocity, angular_velocity=self.vector(0.01))
        if motion != "free":
            return dict(bodies=[body])
        spring = dict(body=body["name"], stiffness=0.5, damping=0.1, ends=[body["position"], self.place()])
        return dict(bodies=[body | self.some(locked=(0.3, [self.choice("xyz"), "rotation z"]))]) | self.some(springs=(0.4, [spring]))

    def flow(self):
        fluid = dict(relaxation_time=self.choice([0.52, 0.6, 0.8, 1.2]), collision=self.choice(["trt", "trt", "regularised", "bgk"]),
                     precision=self.choice(["single", "double"]))
        fluid |= self.some(body_force=(0.4, self.vector(1e-5)), quiet_start=(0.25, True))
        if "quiet_start" not in fluid:
            fluid |= self.some(initial=(0.4, dict(type="uniform", velocity=self.vector(0.01), noise=1e-3)))
        tables = dict(fluid=fluid, coupling=dict(wall_scheme=self.choice(["multireflection", "multireflection", "cli", "bounce-back"]),
                                                 force=self.choice(["galilean", "galilean", "exact"])))
        if self.levels:
            tables |= dict(coarsening=dict(levels=self.choice([1, 1, 2])) | self.some(distance=(0.5, self.choice([8, 10]))))
        if self.heat:
            tables |= dict(heat=dict(prandtl=self.choice([0.7, 3]), expansion=self.choice([0, 0.01])))
            if self.mean_gradient and "periodic" in self.sides:
                tables["heat"] |= dict(mean_gradient=[0.01 * (d == self.sides.index("periodic")) for d in range(3)])
        return tables

    def walls(self):
        tube = dict(type="tube", axis=self.choice("xyz"), radius=min(self.cells) / 2 - 1.2, point=[n / 2 for n in self.cells])
        mesh = dict(type="mesh", file="stone.ply", solid="inside", position=self.place(), motion=dict(angular_velocity=0.002, axis="z"))
        return self.some(walls=(0.25, [self.choice([tube, mesh])]))

    def over_time(self):
        oscillation = dict(amplitude=0.3, frequency=0.02)
        return self.choice([oscillation, dict(table=[[0, 0.2], [20, 1], [40, 0.7]]), oscillation | dict(table=[[10, 1], [30, 0.5]])])

    def details(self, tables, run):
        """Adds to the tables what few cases have."""
        contacts, steady = tables["contacts"], self.levels  # what changes over time is not for levels
        if contacts["resolver"] == "sffd":
            contacts |= self.some(rolling_friction=(0.3, 0.05), twisting_friction=(0.2, 0.05), cohesion=(0.2, 1e-4), sweeps=(0.2, 5))
            contacts |= self.choice([{}, {}, {}, dict(hamaker=1e-5, hamaker_gap=0.05)])
            if not any("locked" in body for body in tables.get("bodies", [])):
                contacts |= self.some(impact_sweeps=(0.15, 20))
        if "gravity" in tables and not (self.heat and tables["heat"]["expansion"]):
            tables["gravity"] |= self.some(over_time=(0 if steady else 0.25, self.over_time()))
        for fill in tables.get("fill", []):
            fill |= self.some(orientation=(0.3, "aligned"), heat_source=(0.5 if "heat_capacity" in fill else 0, 1e-3))
            if "every" not in fill:
                fill |= self.choice([{}] * 6 + [dict(diameter=dict(smallest=5, largest=9)), dict(arrangement="simple-cubic")])
        for body in tables.get("bodies", []):
            body |= self.some(orientation=(0.7, dict(axis=self.vector(1), degrees=self.choice([30, 90, 200]))))
        for wall in tables.get("walls", []):
            if wall["type"] == "mesh" and self.maybe(0.3):
                wall["motion"] |= dict(amplitude=self.vector(1), frequency=0.01)
        for sides in self.sides:
            if sides != "periodic" and sides[0]["type"] == "moving":
                sides[0] |= self.some(over_time=(0 if steady else 0.5, self.over_time()))
        tables["output"] = dict(checkpoint=dict(every=self.steps // 2)) | self.some(bodies=(0.3, dict(every=8, contacts=True)))
        if not self.fluid:
            return
        tables["coupling"] |= self.some(remap_tolerance=(0.3, self.choice([0.02, 0.3])), lubrication=(0.2, False), time=(0.1, "explicit"),
                                        wall_scheme=(0.1, "parabolic"))
        fluid, periodic = tables["fluid"], [d for d in range(3) if self.sides[d] == "periodic"]
        if periodic and not steady and "body_force" not in fluid and "quiet_start" not in fluid and self.maybe(0.3):
            fluid["superficial_velocity"] = [1e-3 * (d == periodic[0]) for d in range(3)]
        if "body_force" in fluid:
            fluid |= self.some(body_force_over_time=(0 if steady else 0.3, self.over_time()), body_force_on_bodies=(0.3, True))
        if self.levels:
            box = [[0, 0, 0], [16 * self.randrange(1, n // 16 + 1) for n in self.cells]]
            tables["coarsening"] |= self.some(fine=(0.3, [dict(box=box, level=self.randrange(tables["coarsening"]["levels"]))]))
        else:
            tables["output"] |= self.some(mean=(0 if "balance" in run else 0.2, {"from": 4, "every": 4}))
        tables["output"] |= self.some(fields=(0.2, dict(every=self.steps // 4)),
                                      probes=(0.2, [dict(name="line", line=[[1, 1, 1], self.place()], count=5, every=4)]))

    def tables(self):
        """The tables of the case. Calls after the first one make other scenes."""
        tables = self.flow() if self.fluid else {}
        tables |= self.some(gravity=(0.8, dict(acceleration=self.vector(2e-4))),
                            outflow=(0.2, [dict(box=[[0, 0, 0], [n // 4 for n in self.cells]])])) | self.walls()
        tables["contacts"] = dict(backend=self.choice(["auto", "auto", "bullet", "fcl"]), resolver=self.choice(["sffd", "sffd", "ffd"]),
                                  restitution=self.choice([0, 0.5]), friction=self.choice([0, 0.4]), substeps=self.choice([1, 2]))
        tables["shapes"] = [dict(name=shape["type"]) | shape for shape in self.sample(SHAPES, self.choice([1, 2, 3]))]
        for shape in tables["shapes"]:
            for table, entries in self.bodies(shape["name"]).items():
                tables.setdefault(table, []).extend(entries)
        domain = dict(size=self.cells, boundary=dict(zip("xyz", self.sides)))
        if not self.levels:
            domain |= self.some(blocks=(0.3, [self.choice([8, 11, 16]) for _ in "xyz"]))
        run = dict(steps=self.steps) | self.some(balance=(0.3, dict(every=32 if self.levels else 8)))
        self.details(tables, run)
        return dict(domain=domain, run=run, **tables)
