"""Every member of the family through the installed tools: planned, recorded, identified, diagnosed.

    family_study.py --tools DIR --robots ../../data/robots OUT.csv [--member NAME]... [--effect NAME]... [--folder DIR]
                    [--jobs 2] [--seed 0]

For each member (type and drive kind) a robot file, a prior, and a truth that differs from it; one excitation in two
segments with a validation motion; and for each effect, and for none, three logs with noise, of which delta-identify
reads two and delta-diagnose all. Each case is a line of OUT.csv; those that are there already are left out. The seed
draws the truth, the start of the search for the motion, and the noise; give each seed a file and a folder of its own.
The script runs the tools of DIR, and nothing else of the project.
"""
import argparse
import csv
import os
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Lock
from xml.etree import ElementTree

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np

from mujoco_case import Failed, Tools, read_rows, read_summary

FIELDS = ["member", "truth", "verdict", "named", "d_efficiency", "time_s", "note"]

RAILS = ["--drive-kind", "prismatic", "--base-radius", "0.45", "--platform-radius", "0.08", "--strut", "0.75",
         "--drive-range-m=-0.5,0.7", "--drive-velocity-m-s", "3", "--drive-acceleration-m-s2", "30", "--drive-effort-N",
         "500"]
FOUR_ARMS = ["--drive-range-rad=-0.9,1.6", "--drive-velocity-rad-s", "8", "--drive-acceleration-rad-s2", "100",
             "--drive-effort-Nm", "60"]
HINGES = ["--plate-spacing", "0.12"]
BARS = HINGES + ["--plate-bar-spacing", "0.06"]
# Robot files of data/, or the words of `delta-model create`.
MEMBERS = {
    "h4": "h4.urdf",
    "i4": "i4.urdf",
    "par4": "par4_quattro_like.urdf",
    "h4-rails": ["h4", *RAILS, *HINGES],
    "i4-rails": ["i4", *RAILS, "--pinion-radius", "0.03"],
    "par4-rails": ["par4", *RAILS, *BARS],
    "delta3-tilted": ["delta3", "--base-radius", "0.2", "--platform-radius", "0.06", "--upper-arm", "0.3", "--strut",
                      "0.65", "--limb-azimuth-rad", "0.2,2.0,4.5", "--limb-tilt-rad", "0.4,-0.3,0.2", *FOUR_ARMS],
    "linear-delta3": "linear_delta3.urdf",
    "linear-delta3-inclined": "linear_delta3_inclined.urdf",
}

# Struts near the vertical would let the drives' limits move the plate faster than any motion in its workspace can.
PLATE_LIMITS = {
    "linear-delta3": ["--platform-velocity-m-s", "2", "--platform-acceleration-m-s2", "20"],
    "linear-delta3-inclined": ["--platform-velocity-m-s", "1.5", "--platform-acceleration-m-s2", "30"],
}

# Of arms [N m] and of carriages [N]; the rates fit both.
EFFECTS = {
    "stribeck": ("drive2", "friction={t},rate=0.25,exponent=2", 1.5, 5),
    "asymmetric_coulomb": ("drive3", "offset={t}", 0.8, 2.5),
    "asymmetric_viscous": ("drive1", "viscous={t}", 0.2, 2),
    "load_dependent_friction": ("drive2", "coefficient={t}", 0.08, 0.08),
    "torque_ripple": ("drive2", "cosine={t},sine={t},n={n}", 0.4, 1.5),
    "rotor_inertia": ("drive3", "inertia={t}", 0.03, 0.5),
    "passive_joint_friction": ("robot", "friction={t}", 0.1, 0.2),
    "hose_force": ("platform", "force_z={t},stiffness_x={s},stiffness_y={s},stiffness_z={s}", 3, 3),
    "convex_viscous": ("drive1", "friction={t},exponent=2", 0.1, 3),
    "payload": ("platform", "mass={t},log=1", 0.4, 0.4),
}


class Member:
    """A robot with its prior, its truth and its motions in a folder of its own."""

    def __init__(self, name, tools, robots, folder, seed):
        self.name, self.tools, self.folder, self.seed = name, tools, folder / name, seed
        self.folder.mkdir(parents=True, exist_ok=True)
        self.robot, self.prior, self.truth = (self.folder / n for n in ("robot.urdf", "prior.csv", "truth.csv"))
        self.words = MEMBERS[name]
        if not (self.folder / "plan_1.csv").exists():
            self.make_robot(robots)
            self.plan()
        self.rails = ElementTree.parse(self.robot).find("joint[@name='drive1']").get("type") == "prismatic"
        self.efficiency = read_summary(self.folder / "plan_summary.csv").get("d_efficiency", "")

    def make_robot(self, robots):
        if isinstance(self.words, str):
            self.robot.write_bytes((Path(robots) / self.words).read_bytes())
        else:
            self.tools("delta-model", "create", *self.words, "-o", self.robot)
        self.tools("delta-model", "prior", self.robot, "-o", self.prior)
        random, share = np.random.default_rng([sum(map(ord, self.name)), 16 + self.seed]), {}
        with open(self.truth, "w", encoding="utf-8") as out:
            out.write("name,value,unit\n")
            for row in read_rows(self.prior):
                body, kind = row["name"].rsplit(".", 1)
                key = row["name"] if kind in ("viscous", "coulomb") else body
                value = float(row["value"]) * share.setdefault(key, random.uniform(0.75, 1.3))
                out.write(f"{row['name']},{value:.12g},{row['unit']}\n")

    def plan(self):
        limits = ["--yaw-velocity-rad-s", "12", "--yaw-acceleration-rad-s2", "120"] if "4" in self.name else []
        limits += PLATE_LIMITS.get(self.name, [])
        self.tools("delta-excite", self.robot, "--params", self.prior, "--segments", "2", "--segment-speeds", "0.3,1",
                   "--segment-files", "--validation", self.folder / "val.csv", *limits, "-o", self.folder / "plan.csv",
                   "--summary", self.folder / "plan_summary.csv", "--threads", "2", "--seed", str(self.seed + 1))

    def record(self, folder, effect):
        """Three logs; of a payload the fast one alone has it."""
        noise = ["--torque-noise-n-m", "0.15", "--encoder-step-m", "1e-7"] if self.rails else [
            "--torque-noise-n-m", "0.05", "--encoder-bits", "22"]
        for number, (motion, log) in enumerate((("plan_1", "slow"), ("plan_2", "fast"), ("val", "holdout"))):
            hidden = effect if effect and ("payload" not in effect[1] or log == "fast") else []
            self.tools("delta-simulate", self.robot, "--params", self.truth, "--trajectory",
                       self.folder / f"{motion}.csv", "-o", folder / f"{log}.csv", "--seed",
                       str(1000 * self.seed + number + 1), *noise, *hidden)

    def effect(self, name):
        if name == "nothing":
            return []
        at, form, arm, rail = EFFECTS[name]
        words = form.format(t=rail if self.rails else arm, n=150 if self.rails else 20, s=30)
        return ["--effect", f"{name}@{at}:{words}"]

    def diagnose(self, name):
        folder = self.folder / name
        folder.mkdir(exist_ok=True)
        self.record(folder, self.effect(name))
        logs = [folder / "slow.csv", folder / "fast.csv"]
        identify, _ = self.tools("delta-identify", self.robot, *logs, "--prior", self.prior, "-o",
                                 folder / "params.csv", allowed=(0, 5))
        given = ["--params", folder / "params.csv"]
        self.tools("delta-diagnose", self.robot, *given, *logs, "--holdout", folder / "holdout.csv", "-o",
                   folder / "diagnosis.csv", "--effects-out", folder / "effects.csv", "--params-out",
                   folder / "improved.csv", "--summary", folder / "summary.csv", "--null-runs", "40", allowed=(0, 5))
        found = read_summary(folder / "summary.csv")
        effects = folder / "effects.csv"
        named = dict.fromkeys(row["effect"] for row in read_rows(effects)) if effects.exists() else []
        # What delta-identify has found before belongs to the model given: there is nothing left to name.
        ripples = [row["name"].removesuffix(".waves") for row in read_rows(folder / "params.csv")
                   if row["name"].endswith(".waves")]
        notes = [f"identify {identify}"] * (identify != 0) + ripples
        return {"verdict": found.get("verdict", ""), "named": " ".join(named), "note": " ".join(notes)}


def parse():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("out")
    words.add_argument("--tools", required=True)
    words.add_argument("--robots", required=True)
    words.add_argument("--member", action="append", choices=list(MEMBERS))
    words.add_argument("--effect", action="append", choices=["nothing", *EFFECTS])
    words.add_argument("--folder", default="family-study")
    words.add_argument("--jobs", type=int, default=2)
    words.add_argument("--seed", type=int, default=0)
    return words.parse_args()


def main():
    told = parse()
    tools, out, lock = Tools(told.tools), Path(told.out), Lock()
    done = set()
    if out.exists():
        with open(out, encoding="utf-8", newline="") as lines:
            done = {(row["member"], row["truth"]) for row in csv.DictReader(lines)}
    else:
        out.write_text(",".join(FIELDS) + "\n", encoding="utf-8")

    def run(member, name):
        begin = time.time()
        row = {"member": member.name, "truth": name, "d_efficiency": member.efficiency}
        try:
            row |= member.diagnose(name)
        except Failed as failed:
            row["note"] = str(failed)
        row["time_s"] = f"{time.time() - begin:.1f}"
        with lock, open(out, "a", encoding="utf-8", newline="") as lines:
            csv.DictWriter(lines, FIELDS, restval="").writerow(row)
        print(*row.values(), flush=True)

    with ThreadPoolExecutor(told.jobs) as pool:
        for name in told.member or MEMBERS:
            cases = [e for e in told.effect or ["nothing", *EFFECTS] if (name, e) not in done]
            if not cases:
                continue
            member = Member(name, tools, told.robots, Path(told.folder), told.seed)
            list(pool.map(lambda effect, member=member: run(member, effect), cases))


if __name__ == "__main__":
    sys.exit(main())
