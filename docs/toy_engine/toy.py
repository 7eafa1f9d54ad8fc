"""A planar physics engine behind the bridge (docs/bridge.md). The x-z plane is that of complex numbers, x + z i."""

import cmath, itertools, json, math, pathlib, struct, sys, time

NEAR = 1e-4  # points further apart than this [m] are left out
PUSH_OUT = 0.2  # share of an overlap that is pushed out in a substep


def dot(a, b):
    return (a.conjugate() * b).real


def lifted(vector, y=0.0):
    return vector.real, y, vector.imag


class Body:
    def __init__(self, kind, size, mass, position, quaternion):
        self.kind, self.mass, self.size, self.force = kind, mass, size, 0j
        self.inertia = mass * (size[0] ** 2 + size[2] ** 2) / 12
        self.place(position, quaternion)

    def place(self, position, quaternion):
        self.center, self.angle = complex(position[0], position[2]), -2 * math.atan2(quaternion[2], quaternion[0])
        self.velocity, self.spin = 0j, 0.0

    def state(self):
        turn = math.cos(self.angle / 2), 0, -math.sin(self.angle / 2), 0
        return *lifted(self.center), *turn, *lifted(self.velocity), 0, -self.spin, 0

    def kick(self, impulse, arm):
        if self.kind == "live":
            self.velocity += impulse / self.mass
            self.spin += dot(arm * 1j, impulse) / self.inertia

    def lightness(self, arm, n):  # speed along n of the point at the end of the arm after an impulse of 1 N s along n
        return 1 / self.mass + dot(arm * 1j, n) ** 2 / self.inertia if self.kind == "live" else 0.0

    def corners(self):
        axis, (x, _, z) = cmath.rect(0.5, self.angle), self.size
        return [self.center + axis * complex(i * x, k * z) for i in (-1, 1) for k in (-1, 1)]


def faces(a, b):
    """The gap between each face of a and the nearest corner of b; the face's normal, its distance and half length."""
    corners = b.corners()
    for k in range(4):
        n, reach, side = cmath.rect(1, a.angle) * 1j**k, a.size[k % 2 * 2] / 2, a.size[2 - k % 2 * 2] / 2
        yield min(dot(corner - a.center, n) for corner in corners) - reach, n, reach, side, a, b


def touch(a, b):
    """Contacts of two boxes along the axis on which they are furthest apart: normal from a to b, points on a and b."""
    gap, n, reach, side, own, other = max([*faces(a, b), *faces(b, a)], key=lambda face: face[0])
    ends = sorted(other.corners(), key=lambda corner: dot(corner - own.center, n))[:2]
    along = [dot(end - own.center, n * 1j) for end in ends]
    for k in (0, 1):  # the other's edge, clipped to the face
        t = max(-side, min(side, along[k]))
        if gap <= NEAR and min(along) <= t <= max(along):
            share = (t - along[k]) / (along[1 - k] - along[k]) if t != along[k] else 0.0
            there = ends[k] + share * (ends[1 - k] - ends[k])
            here = there - (dot(there - own.center, n) - reach) * n
            yield (n, here, there) if own is a else (-n, there, here)


class Contact:
    def __init__(self, ids, a, b, n, here, there, dt):
        self.ids, self.a, self.b, self.n, self.points = ids, a, b, n, (here, there)
        self.arms, gap = (here - a.center, there - b.center), dot(there - here, n)
        self.wanted = -gap / dt * (1 if gap > 0 else PUSH_OUT)  # speed of opening, at least
        self.impulses = {n: 0.0, n * 1j: 0.0}  # along the normal, and across it

    def solve(self, friction):
        (arm_a, arm_b), a, b = self.arms, self.a, self.b
        for axis, total in self.impulses.items():
            speed = dot(b.velocity + 1j * b.spin * arm_b - a.velocity - 1j * a.spin * arm_a, axis)
            most = math.inf if axis == self.n else friction * self.impulses[self.n]
            least, wanted = (0.0, self.wanted) if axis == self.n else (-most, 0.0)
            change = (wanted - speed) / (a.lightness(arm_a, axis) + b.lightness(arm_b, axis))
            self.impulses[axis] = max(least, min(most, total + change))
            b.kick((self.impulses[axis] - total) * axis, arm_b)
            a.kick((total - self.impulses[axis]) * axis, arm_a)

    def rows(self, dt):
        f = sum(axis * impulse for axis, impulse in self.impulses.items()) / dt / 2
        half, (here, there) = min(self.a.size[1], self.b.size[1]) / 2, self.points
        for y in (-half, half):
            yield *self.ids, *lifted(here, y), *lifted(there, y), *lifted(self.n), *lifted(f)


class World:
    def __init__(self, opening):
        x, y, z = opening["ground_half_edges"]
        ground = {"size": (2 * x, 2 * y, 2 * z), "position": (0, 0, -z), "quaternion": (1, 0, 0, 0)}
        boxes = enumerate([ground, *opening["fixed"]])
        self.bodies = {-1 - i: Body("fixed", box["size"], 1, box["position"], box["quaternion"]) for i, box in boxes}
        self.friction, self.gravity, self.contacts = opening["friction"], complex(*opening["gravity"][::2]), []
        self.iterations = opening["knobs"].get("iterations", 20)

    def obey(self, code, number, *words):
        body, vector = self.bodies.get(number), complex(words[0], words[2])
        if code in (1, 2):
            self.bodies[number] = Body("live" if code == 1 else "moved", words[:3], words[3], words[4:7], words[7:11])
        elif code == 3:
            del self.bodies[number]
        elif code == 4:
            body.place(words[:3], words[3:7])
        elif code == 5:
            body.kick(vector, 0j)
        elif code == 6:
            body.force = vector
        elif code == 7:
            body.velocity, body.spin = vector, -words[4]
        elif code == 8:
            self.gravity = vector
        elif code in (9, 10):
            body.kind, body.velocity, body.spin = "frozen" if code == 9 else "live", 0j, 0.0

    def substep(self, dt):
        for body in self.bodies.values():
            body.velocity += (self.gravity + body.force / body.mass) * dt if body.kind == "live" else 0.0
        pairs = itertools.combinations(self.bodies.items(), 2)
        near = [((i, k), a, b) for (i, a), (k, b) in pairs if "live" in (a.kind, b.kind)]
        self.contacts = [Contact(*pair, *found, dt) for pair in near for found in touch(*pair[1:])]
        for contact in self.contacts * self.iterations:
            contact.solve(self.friction)
        for body in self.bodies.values():
            body.center, body.angle = body.center + body.velocity * dt, body.angle + body.spin * dt

    def step(self, words):
        dt, substeps, is_read, count = words[0], int(words[1]), words[2], int(words[3])
        for k in range(count):
            self.obey(*words[4 + 13 * k : 17 + 13 * k])
        ids = sorted(i for i, body in self.bodies.items() if body.kind in ("live", "moved"))
        states, forces, own_time = [], [], 0.0
        for k in range(substeps):
            states += [self.bodies[i].state() for i in ids if is_read]
            forces += [(k - 1, *row[:2], *row[11:]) for c in self.contacts if is_read and k for row in c.rows(dt)]
            begin = time.perf_counter()
            self.substep(dt)
            own_time += time.perf_counter() - begin
        states += [self.bodies[i].state() for i in ids]
        points = [row for contact in self.contacts if is_read for row in contact.rows(dt)]
        head = own_time, len(ids), substeps + 1 if is_read else 1, len(points), len(forces)
        return *head, *ids, *itertools.chain(*states, *points, *forces)


world = None
while header := sys.stdin.buffer.read(8):
    length, kind = struct.unpack("<II", header)
    body = sys.stdin.buffer.read(length)
    if kind == 1:
        answer = pathlib.Path(__file__).with_name("hello.json").read_bytes()
    elif kind == 2:
        world, answer = World(json.loads(body)), b"{}"
    else:
        words = world.step(struct.unpack(f"<{length // 8}d", body))
        answer = struct.pack(f"<{len(words)}d", *words)
    sys.stdout.buffer.write(struct.pack("<II", len(answer), kind) + answer)
    sys.stdout.buffer.flush()
