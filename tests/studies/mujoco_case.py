"""A case of the MuJoCo study: what is drawn for an index, the robot's files, and its three reference motions."""
import csv
import math
import subprocess
from pathlib import Path

import numpy as np

PARALLEL = ("delta3", "delta4", "linear-delta3")
RATES_HZ = (500, 800, 1000, 1250, 2000)
LOGS = ("fast", "slow", "holdout")
DURATION_S, LEAD_S, TAIL_S = 10.0, 0.5, 0.02


class Failed(Exception):
    """A case that could not be made, or a tool that ended with an error."""


class Tools:
    """The command-line tools of a folder."""

    def __init__(self, folder):
        self.folder = Path(folder)

    def __call__(self, name, *words, allowed=(0,)):
        """Runs a tool; returns exit code and print. Throws Failed on other codes than `allowed`."""
        command = [str(self.folder / name), *map(str, words)]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=1800)
        except subprocess.TimeoutExpired as late:
            raise Failed(f"{name} took more than {late.timeout} s") from late
        if done.returncode not in allowed:
            told = (done.stderr or done.stdout).strip().splitlines()
            raise Failed(f"{name} ended with {done.returncode}: {' '.join(told[:3])}")
        return done.returncode, done.stdout + done.stderr


def read_summary(path):
    with open(path, encoding="utf-8", newline="") as lines:
        return {row["key"]: row["value"] for row in csv.DictReader(lines)}


def read_rows(path):
    """Rows of a table of the tools, without its comments."""
    with open(path, encoding="utf-8", newline="") as lines:
        return list(csv.DictReader(row for row in lines if not row.startswith("#")))


class Case:
    """Everything that is drawn before the hidden effect: lengths, masses, friction, sensors, dirt, motion."""

    def __init__(self, index, kind, dirty):
        self.index, self.kind, self.dirty = index, kind, dirty
        self.rng = np.random.default_rng([index, 4711])
        draw = self.rng.uniform
        self.rate_hz = int(self.rng.choice(RATES_HZ))
        self.steps_per_sample = math.ceil(2000 / self.rate_hz)
        self.step_s = 1 / (self.rate_hz * self.steps_per_sample)
        self.motion = "pick-and-place" if draw() < 1 / 3 else "fourier"
        self.sliding = kind == "linear-delta3" or (kind == "axis" and draw() < 0.4)
        self.drives = {"delta3": 3, "delta4": 4, "linear-delta3": 3, "axis": 1}[kind]
        self.noise_share = math.exp(draw(math.log(0.002), math.log(0.007)))  # of the largest torque
        self.encoder_bits = int(self.rng.integers(15, 20)) if dirty else 20
        self.bandwidth_hz = draw(8, 13)
        self.draw_lengths(draw)

    def draw_lengths(self, draw):
        if self.kind == "axis":
            self.arm = draw(0.15, 0.45)
        elif self.kind == "linear-delta3":
            self.base = draw(0.22, 0.38)
            self.plate = draw(0.04, 0.08)
            self.strut = self.base * draw(2.2, 3.0)
            self.size = self.base * draw(0.6, 1.0)  # of the workspace
            self.height = -(0.45 + math.sqrt(self.strut**2 - (self.base - self.plate) ** 2))
        else:
            self.arm = draw(0.22, 0.55)
            self.base = self.arm * draw(0.35, 0.6)
            self.plate = self.base * draw(0.2, 0.4)
            self.strut = self.arm * draw(1.9, 2.5)
            self.size = self.arm * draw(0.45, 0.8)
            q = draw(0.25, 0.5)
            across = self.base + self.arm * math.cos(q) - self.plate
            self.height = -(self.arm * math.sin(q) + math.sqrt(self.strut**2 - across**2))
        self.spacing = draw(0.06, 0.11)

    def turns(self, drive):
        return drive == 3 or not self.sliding

    def columns(self, stem, end=""):
        unit = {"q": ("rad", "m"), "tau": ("Nm", "N")}[stem.rstrip("d")]
        return [f"{stem}{j + 1}_{unit[0 if self.turns(j) else 1]}{end}" for j in range(self.drives)]

    def encoder_steps(self):
        """A prismatic drive has a pinion of 100 mm a turn."""
        turn = np.array([2 * math.pi if self.turns(j) else 0.1 for j in range(self.drives)])
        return turn / 2**self.encoder_bits

    # --- The robot's files

    def make_robot(self, tools, folder):
        """robot.urdf, prior.csv (what the user believes) and self.truth (masses 25 % off it, no friction yet)."""
        draw = self.rng.uniform
        robot, prior = folder / "robot.urdf", folder / "prior.csv"
        if self.kind == "axis":
            words = ["--drive-kind", "prismatic", "--drive-range-m=-0.6,0.6"] if self.sliding else [
                "--arm", f"{self.arm:.4f}", "--drive-range-rad=-3.2,3.2"]
            masses = []
        else:
            words = ["--base-radius", f"{self.base:.4f}", "--platform-radius", f"{self.plate:.4f}", "--strut",
                     f"{self.strut:.4f}", "--strut-spacing", f"{self.spacing:.4f}"]
            if self.sliding:
                words += ["--drive-range-m=-0.5,1.5"]
            else:
                words += ["--upper-arm", f"{self.arm:.4f}", "--drive-range-rad",
                          "-1.2,1.6;-1.2,1.6;-1.2,1.6" + (";-60,60" if self.kind == "delta4" else "")]
            masses = ["--platform-mass-kg", f"{draw(0.3, 1.5):.3f}"]
            if self.kind == "delta4":
                masses += ["--tool-mass-kg", f"{draw(0.15, 0.6):.3f}", "--tool-diameter-m", f"{draw(0.07, 0.13):.3f}"]
        tools("delta-model", "create", self.kind, *words, "-o", robot)
        tools("delta-model", "prior", robot, *masses, "-o", prior)
        share = {}
        self.truth = []
        for row in read_rows(prior):
            body, name = row["name"].rsplit(".", 1)
            value = float(row["value"])
            if name in ("viscous", "coulomb", "offset"):
                value = 0.0
            else:
                value *= share.setdefault(body, draw(0.75, 1.3))
            self.truth.append([row["name"], value, row["unit"]])

    def value(self, name):
        return next((value for key, value, _ in self.truth if key == name), 0.0)

    def set_value(self, name, value):
        for row in self.truth:
            if row[0] == name:
                row[1] = value

    def write_truth(self, path):
        with open(path, "w", encoding="utf-8") as out:
            out.write("name,value,unit\n")
            for name, value, unit in self.truth:
                out.write(f"{name},{value:.12g},{unit}\n")

    def draw_friction(self, reference):
        """Coulomb friction of 6 to 14 % of the largest rigid torque, as much again viscous at the largest rate."""
        draw = self.rng.uniform
        self.peak = np.abs(reference.feed).max(axis=0)
        self.peak_rate = np.abs(reference.rate).max(axis=0)
        self.inertia = np.sqrt((reference.feed.std(axis=0) ** 2) / (reference.acceleration.std(axis=0) ** 2))
        if self.kind != "axis" and self.drives > 1:
            self.peak[:3], self.peak_rate[:3] = self.peak[:3].mean(), self.peak_rate[:3].mean()
        self.coulomb, self.viscous = np.zeros(self.drives), np.zeros(self.drives)
        for j in range(self.drives):
            # A rotor that turns a light tool has more friction than inertia.
            self.coulomb[j] = self.peak[j] * draw(0.06, 0.14) * (2 if j == 3 else 1)
            self.viscous[j] = self.peak[j] / self.peak_rate[j] * draw(0.05, 0.12)
            self.set_value(f"drive{j + 1}.coulomb", self.coulomb[j])
            self.set_value(f"drive{j + 1}.viscous", self.viscous[j])
        if self.kind == "delta4":
            self.set_value("telescope.coulomb", 0.02 * self.peak[0] / self.size * draw(0.5, 1.5))
            self.set_value("telescope.viscous", 0.02 * self.peak[0] / self.size * draw(0.5, 1.5))

    # --- Motion

    def reachable(self, z):
        """Positions z (rows x, y, z) keep every limb away from its limits and from singular poses."""
        for i in range(3):
            turn = 2 * math.pi / 3 * i
            x = math.cos(turn) * z[:, 0] + math.sin(turn) * z[:, 1] + self.plate - self.base
            y = -math.sin(turn) * z[:, 0] + math.cos(turn) * z[:, 1]
            if self.sliding:
                across = np.hypot(x, y) / self.strut
                if across.max() > 0.85 or across.min() < 0.05:
                    return False
                continue
            far = np.hypot(x, z[:, 2])
            cosine = (x**2 + y**2 + z[:, 2] ** 2 + self.arm**2 - self.strut**2) / (2 * self.arm * far)
            if np.abs(cosine).max() > 0.9:
                return False
            q = np.arctan2(-z[:, 2], x) - np.arccos(cosine)
            if q.min() < -0.8 or q.max() > 1.35:
                return False
        return True

    def coordinates(self):
        """Sizes of the coordinates of the motion: x, y, z, yaw; of an axis its drive."""
        if self.kind == "axis":
            return np.array([0.12 if self.sliding else 0.9])
        sizes = [self.size, self.size, 0.55 * self.size] + ([3.0] if self.kind == "delta4" else [])
        return np.array(sizes)

    def make_motion(self, log):
        """Times and the motion's coordinates with both derivatives, at the simulator's step."""
        t = np.arange(round((LEAD_S + DURATION_S + TAIL_S) / self.step_s) + 1) * self.step_s - LEAD_S
        sizes, centre = self.coordinates(), 0.0 if self.kind == "axis" else self.height
        for trial in range(400):
            shrink = 0.985**trial
            if self.motion == "fourier":
                z = self.fourier(t, log, shrink * sizes)
            else:
                z = self.pick_and_place(t, log, shrink * sizes)
            if self.kind == "axis":
                return t, z
            z[0][:, 2] += centre
            if self.reachable(z[0]):
                return t, z
        raise Failed("no motion fits this robot")

    def fourier(self, t, log, sizes):
        base = self.rng.uniform(0.28, 0.4) if log != "slow" else 0.1
        harmonics = 5
        z = np.zeros((3, len(t), len(sizes)))
        for i, size in enumerate(sizes):
            a = self.rng.uniform(-1, 1, 2 * harmonics) * 0.6 * size * (0.8 if log == "slow" else 1)
            for h in range(1, harmonics + 1):
                w = 2 * math.pi * base * h
                A, B = a[2 * h - 2] / math.sqrt(h), a[2 * h - 1] / math.sqrt(h)
                z[0, :, i] += A * np.sin(w * t) + B * np.cos(w * t)
                z[1, :, i] += w * (A * np.cos(w * t) - B * np.sin(w * t))
                z[2, :, i] -= w * w * (A * np.sin(w * t) + B * np.cos(w * t))
        return z

    def pick_and_place(self, t, log, sizes):
        """Moves between random points with a lift, polynomials of fifth order, short rests between."""
        duration = self.rng.uniform(0.32, 0.5) if log != "slow" else self.rng.uniform(1.1, 1.6)
        z = np.zeros((3, len(t), len(sizes)))
        begin, here = t[0], self.rng.uniform(-1, 1, len(sizes)) * sizes
        while begin < t[-1]:
            to = self.rng.uniform(-1, 1, len(sizes)) * sizes
            rest = duration * self.rng.uniform(0.1, 0.3)
            rows = (t >= begin) & (t < begin + duration + rest)
            s = np.clip((t[rows] - begin) / duration, 0, 1)
            blend = [10 * s**3 - 15 * s**4 + 6 * s**5, (30 * s**2 - 60 * s**3 + 30 * s**4) / duration,
                     (60 * s - 180 * s**2 + 120 * s**3) / duration**2]
            lift = [64 * (s * (1 - s)) ** 3, 192 * (s - s**2) ** 2 * (1 - 2 * s) / duration,
                    (384 * (s - s**2) * (1 - 2 * s) ** 2 - 384 * (s - s**2) ** 2) / duration**2]
            for k in range(3):
                z[k, rows] = (here if k == 0 else 0) + np.outer(blend[k], to - here)
                if len(sizes) > 1:
                    z[k, rows, 2] += 0.5 * sizes[2] * lift[k]
            begin, here = begin + duration + rest, to
        return z

    def write_motion(self, path, t, z):
        if self.kind == "axis":
            names = [self.columns("q")[0], self.columns("qd", "_s")[0], self.columns("qdd", "_s2")[0]]
        else:
            axes = ["x", "y", "z", "psi"][: z.shape[2]]
            names = [f"{axis}{order}_{'rad' if axis == 'psi' else 'm'}{unit}"
                     for order, unit in (("", ""), ("d", "_s"), ("dd", "_s2")) for axis in axes]
        np.savetxt(path, np.column_stack([t - t[0], *z]), delimiter=",", fmt="%.12g",
                   header=",".join(["t_s", *names]), comments="")


class Reference:
    """What the drives are to do, at the simulator's step: positions, rates, feed-forward torque."""

    def __init__(self, case, tools, folder, motion, parameters):
        t, z = motion
        trajectory, log = folder / "trajectory.csv", folder / "reference.csv"
        case.write_motion(trajectory, t, z)
        tools("delta-simulate", folder / "robot.urdf", "--params", parameters, "--trajectory", trajectory, "--inverse",
              "--rate-hz", f"{1 / case.step_s:.10g}", "-o", log)
        with open(log, encoding="utf-8") as lines:
            names = lines.readline().strip().split(",")
            table = dict(zip(names, np.loadtxt(lines, delimiter=",", ndmin=2).T))
        self.t = table["t_s"] - LEAD_S
        self.position = np.column_stack([table[name] for name in case.columns("q")])
        self.rate = np.column_stack([table[name] for name in case.columns("qd", "_s")])
        self.acceleration = np.column_stack([table[name] for name in case.columns("qdd", "_s2")])
        self.feed = np.column_stack([table[name] for name in case.columns("tau")])
