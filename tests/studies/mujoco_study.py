"""A second plant for the blind study of delta-diagnose: MuJoCo, which shares no code with the library.

    mujoco_study.py --tools DIR verify
    mujoco_study.py --tools DIR run FIRST COUNT OUT.csv [--null-runs 40] [--keep FOLDER]
    mujoco_study.py --tools DIR write INDEX FOLDER      robot, prior, truth and the three logs of a case, to look at
    mujoco_study.py [--tools DIR] summary OUT.csv

Every case is a function of its index alone: a robot, its motion, half of them dirty machines, one hidden effect or
none. Three logs are simulated in closed loop; then the tools do what a user does: delta-identify on two logs,
delta-diagnose, and delta-validate of the given and the written model on the third. Cases below 1000 are for tuning,
those from 1000 for reporting. Each is a line of OUT.csv; those that are there already are left out. `verify` compares
the plant, clean and with nothing hidden, with the tools' inverse dynamics. Needs the packages of
tests/peers/requirements.txt (mujoco, numpy). The script runs the tools of DIR, and nothing else of the project.
"""
import argparse
import csv
import os
import shutil
import sys
import tempfile
import time
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np

from mujoco_case import LOGS, Case, Failed, Reference, Tools, read_summary
from mujoco_effects import Drawn, Hidden, draw_effect
from mujoco_plant import Dirt, Plant, simulate, to_log, write_log
from mujoco_summary import print_summary

FIELDS = ["id", "type", "dirty", "rate_hz", "motion", "truth", "size", "strength", "identify", "known", "verdict",
          "named", "set", "gap", "rms_given", "rms_written", "time_s", "note"]


def make_machine(index, tools, folder, kind=None, dirty=None, name=None):
    """Case, dirt, effect, and a reference for each log; the robot's files in `folder`."""
    drawn = draw_effect(index)
    name, kind, dirty = name or drawn[0], kind or drawn[1], drawn[2] if dirty is None else dirty
    case = Case(index, kind, dirty)
    case.make_robot(tools, folder)
    motions = [case.make_motion(log) for log in LOGS]
    truth = folder / "truth.csv"
    case.write_truth(truth)
    case.draw_friction(Reference(case, tools, folder, motions[0], truth))
    case.write_truth(truth)
    dirt = Dirt(case) if dirty else None
    hidden = Hidden() if name == "nothing" else Drawn(name, case)
    tools("delta-model", "convert", folder / "robot.urdf", "--params", truth, "--to", "mjcf", "-o",
          folder / "robot.xml")
    return case, dirt, hidden, [Reference(case, tools, folder, motion, truth) for motion in motions]


def record_logs(case, dirt, hidden, references, folder):
    """Writes the three logs; returns the effect's strength over the noise."""
    strength = 0.0
    for k, (log, reference) in enumerate(zip(LOGS, references)):
        plant = Plant(case, folder / "robot.xml", dirt, hidden, k)
        record = simulate(case, plant, reference, dirt, hidden)
        table, strong = to_log(case, record, dirt, hidden, np.random.default_rng([case.index, k, 99]), k)
        if not np.isfinite(table).all():
            raise Failed("the simulation is not finite")
        write_log(case, folder / f"{log}.csv", table)
        strength = max(strength, strong)
    return strength


def residuals(tools, folder, parameters, summary, *flags):
    """Rms residual of each drive on the hold-out log, and the cut-off, by delta-validate."""
    code, told = tools("delta-validate", folder / "robot.urdf", "--params", parameters, folder / "holdout.csv",
                       "--summary", summary, *flags, allowed=(0, 5))
    if code:
        raise Failed("delta-validate refuses the hold-out log: " + told.strip().splitlines()[0])
    told = read_summary(summary)
    drives = [key for key in told if key.startswith("rms_residual_drive")]
    return [float(told[key]) for key in sorted(drives)], told.get("cutoff_hz")


def diagnose(tools, folder, null_runs, row):
    """What a user does with the three logs. Fills the row."""
    robot, logs = folder / "robot.urdf", [folder / f"{log}.csv" for log in LOGS]
    params = folder / "params.csv"
    code, told = tools("delta-identify", robot, logs[0], logs[1], "--prior", folder / "prior.csv", "-o", params,
                       "--summary", folder / "identify.csv", allowed=(0, 5))
    (folder / "identify.txt").write_text(told, encoding="utf-8")
    row["identify"] = code
    if not params.exists():
        row["verdict"], row["note"] = "refused", told.strip().splitlines()[0].replace(",", ";")[:200]
        return
    with open(params, encoding="utf-8") as lines:
        names = [line.split(",")[0] for line in lines]
    row["known"] = ";".join(n for n in names if n.endswith(".presliding") or n.endswith(".waves"))
    improved, effects, table = folder / "improved.csv", folder / "effects.csv", folder / "diagnosis.csv"
    code, told = tools("delta-diagnose", robot, "--params", params, logs[0], logs[1], "--holdout", logs[2], "-o", table,
                       "--effects-out", effects, "--params-out", improved, "--summary", folder / "diagnose.csv",
                       "--null-runs", null_runs, allowed=(0, 5))
    (folder / "diagnose.txt").write_text(told, encoding="utf-8")
    if code == 5 or not table.exists():
        row["verdict"], row["note"] = "refused", told.strip().splitlines()[0].replace(",", ";")[:200]
        return
    with open(table, encoding="utf-8", newline="") as lines:
        found = list(csv.DictReader(lines))
    summary = read_summary(folder / "diagnose.csv")
    row["verdict"], row["gap"] = summary["verdict"], summary.get("gap_shrink", "")
    row["named"] = ";".join(f"{one['effect']}@{one['joint']}" for one in found if one["effect"])
    row["set"] = ";".join(one["confusable_with"] for one in found if one["confusable_with"])
    given, cutoff = residuals(tools, folder, params, folder / "given.csv")
    row["rms_given"] = ";".join(f"{x:.4g}" for x in given)
    if row["named"]:
        flags = ["--effects", effects] + (["--cutoff-hz", cutoff] if cutoff else [])
        written, _ = residuals(tools, folder, improved, folder / "written.csv", *flags)
        row["rms_written"] = ";".join(f"{x:.4g}" for x in written)


def run_case(index, tools, null_runs, folder):
    start = time.time()
    row = dict.fromkeys(FIELDS, "")
    name, kind, dirty = draw_effect(index)
    row.update(id=index, type=kind, dirty="dirty" if dirty else "clean", truth=name)
    try:
        case, dirt, hidden, references = make_machine(index, tools, folder)
        row.update(rate_hz=case.rate_hz, motion=case.motion, size=f"{hidden.size:.2f}",
                   note=getattr(hidden, "note", ""), truth=f"{name}@{hidden.joint}" if hidden.joint else name)
        row["strength"] = f"{record_logs(case, dirt, hidden, references, folder):.3g}"
        diagnose(tools, folder, null_runs, row)
    except Failed as failure:
        row["verdict"], row["note"] = "failed", str(failure).replace(",", ";")[:300]
    row["time_s"] = f"{time.time() - start:.0f}"
    return row


def run(tools, first, count, path, null_runs, keep):
    path = Path(path)
    if path.exists():
        with open(path, encoding="utf-8", newline="") as lines:
            done = {row["id"] for row in csv.DictReader(lines)}
    else:
        done = set()
        path.write_text(",".join(FIELDS) + "\n", encoding="utf-8")
    for index in range(first, first + count):
        if str(index) in done:
            continue
        folder = Path(tempfile.mkdtemp()) if keep is None else Path(keep) / str(index)
        folder.mkdir(parents=True, exist_ok=True)
        row = run_case(index, tools, null_runs, folder)
        with open(path, "a", encoding="utf-8", newline="") as out:
            csv.DictWriter(out, FIELDS).writerow(row)
        print(",".join(str(row[field]) for field in FIELDS), flush=True)
        if keep is None:
            shutil.rmtree(folder)


def verify(tools):
    """Exact states of the clean plant against inverse dynamics with its parameters, share of each drive's torque."""
    for index, kind in enumerate(("delta3", "delta4", "linear-delta3", "axis")):
        folder = Path(tempfile.mkdtemp())
        case, _, hidden, references = make_machine(index, tools, folder, kind, False, "nothing")
        plant = Plant(case, folder / "robot.xml", None, hidden, 0)
        record = simulate(case, plant, references[0], None, hidden, exact=True)
        names = ["t_s", *case.columns("q"), *case.columns("qd", "_s"), *case.columns("qdd", "_s2")]
        n, table = case.drives, np.array(record.exact)
        np.savetxt(folder / "exact.csv", table[:, : 3 * n + 1], delimiter=",", fmt="%.12g", header=",".join(names),
                   comments="")
        tools("delta-simulate", folder / "robot.urdf", "--params", folder / "truth.csv", "--trajectory",
              folder / "exact.csv", "--inverse", "--rate-hz", case.rate_hz, "-o", folder / "inverse.csv")
        with open(folder / "inverse.csv", encoding="utf-8") as lines:
            columns = dict(zip(lines.readline().strip().split(","), np.loadtxt(lines, delimiter=",", ndmin=2).T))
        shares = []
        for j in range(n):
            tau, rate, acceleration = table[:, 1 + 3 * n + j], table[:, 1 + n + j], table[:, 1 + 2 * n + j]
            error = (columns[case.columns("tau")[j]][: len(tau)] - tau) / np.abs(tau).max()
            moves = np.abs(rate) > 2e-3 * np.abs(acceleration)  # not within 2 ms of a reversal, where MuJoCo sticks
            moves &= np.abs(table[:, -2]) > 2e-3 * np.abs(table[:, -1])
            shares.append(f"{np.sqrt(np.mean(error[moves] ** 2)):.1e} (largest {np.abs(error[moves]).max():.1e})")
        print(f"{kind}: rms difference, share of the largest torque: {', '.join(shares)}; {len(table)} states; "
              f"tracking error {record.worst:.1e} of the range", flush=True)
        shutil.rmtree(folder)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tools", help="folder of delta-model, delta-identify, ...")
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("verify")
    one = commands.add_parser("run")
    one.add_argument("first", type=int)
    one.add_argument("count", type=int)
    one.add_argument("output")
    one.add_argument("--null-runs", type=int, default=40)
    one.add_argument("--keep", help="folder that keeps the files of every case")
    one = commands.add_parser("write")
    one.add_argument("index", type=int)
    one.add_argument("folder")
    commands.add_parser("summary").add_argument("output")
    words = parser.parse_args()
    if words.command != "summary" and not words.tools:
        sys.exit("--tools DIR is needed")
    tools = Tools(words.tools) if words.tools else None
    if words.command == "verify":
        verify(tools)
    elif words.command == "run":
        run(tools, words.first, words.count, words.output, words.null_runs, words.keep)
    elif words.command == "write":
        folder = Path(words.folder)
        folder.mkdir(parents=True, exist_ok=True)
        case, dirt, hidden, references = make_machine(words.index, tools, folder)
        record_logs(case, dirt, hidden, references, folder)
        print(f"{case.kind}, {'dirty' if dirt else 'clean'}, {hidden.name} {hidden.joint}, size {hidden.size:.2f}")
    else:
        print_summary(words.output, tools)


if __name__ == "__main__":
    main()
