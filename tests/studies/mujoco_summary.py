"""Counts over the cases of the MuJoCo study."""
import csv

# What a dirty machine has anyway: a name for it is right.
DIRT = {"presliding", "torque_ripple", "kinematic_offset", "limb_inertia_mismatch", "current_lag", "time_skew"}
# On rails a heavier carriage is what a heavier arm is elsewhere.
DIRT_ON_RAILS = DIRT | {"rotor_inertia"}
CLASSES = {
    "velocity-shape": "stribeck shear_thinning convex_viscous asymmetric_viscous direction_dependent_friction "
                      "passive_joint_friction aerodynamic_drag telescope_stribeck",
    "quasi-constant": "asymmetric_coulomb",
    "load": "load_dependent_friction directional_efficiency telescope_side_load saturation payload "
            "torque_constant_error",
    "reversal-memory": "presliding hysteresis backlash",
    "position-periodic": "torque_ripple position_dependent_friction",
    "inertia-like": "rotor_inertia limb_inertia_mismatch joint_elasticity",
    "pose-force": "hose_force base_tilt kinematic_offset arm_spring",
    "phase": "time_skew current_lag",
    "drift": "thermal_drift",
}


def classes_of(tools):
    """Class of every effect, by delta-diagnose itself where it is at hand."""
    if tools is None:
        return {name: kind for kind, names in CLASSES.items() for name in names.split()}
    lines = tools("delta-diagnose", "--list-effects")[1].splitlines()
    return {line.split()[0]: line.split()[1] for line in lines if len(line.split()) > 2}


def pairs(text):
    return [tuple(one.split("@")) for one in text.split(";") if one]


class Verdict:
    """A case, judged."""

    def __init__(self, row, classes):
        self.row = row
        self.name, _, self.joint = row["truth"].partition("@")
        self.hidden = self.name != "nothing"
        self.named, self.others = pairs(row["named"]), pairs(row["set"])
        self.failed = row["verdict"] == "failed"
        first = self.named[0] if self.named else ("", "")
        self.first = first[0] == self.name
        self.right_class = bool(self.named) and classes.get(first[0]) == classes.get(self.name)
        self.right_joint = first[1] == self.joint or (row["type"] == "axis" and bool(self.named))
        self.inside = any(name == self.name for name, _ in self.named + self.others)
        # Bristles and waves that delta-identify found itself are part of the model.
        known = [one.split(".")[0] for one in row["known"].split(";") if one.endswith(
            ".presliding" if self.name == "presliding" else ".waves")]
        self.known = self.name in ("presliding", "torque_ripple") and self.joint in known
        dirt = (DIRT_ON_RAILS if row["type"] == "linear-delta3" else DIRT) if row["dirty"] == "dirty" else set()
        self.false = [f"{name}@{joint}" for name, joint in self.named if name not in dirt and name != self.name]
        self.ratio = None
        if row["rms_written"]:
            given, written = ([float(x) for x in row[key].split(";")] for key in ("rms_given", "rms_written"))
            # A drive of which all rows are near reversals has none to be compared.
            shares = [w / g for w, g in zip(written, given) if g > 0]
            if shares:
                self.ratio, self.worst_drive = (sum(x * x for x in shares) / len(shares)) ** 0.5, max(shares)

    def dirt_first(self):
        """Only names of what is really there stand before the truth."""
        return self.inside and not self.false


def share(what, part, whole):
    print(f"  {what:<62} {part:>3} of {whole:<3} {100 * part / whole if whole else 0:5.1f} %")


def print_block(title, cases):
    if not cases:
        return
    print(title)
    effects = [case for case in cases if case.hidden and not case.failed]
    named = [case for case in effects if case.named]
    share("effects: something named", len(named), len(effects))
    share("  of these: right effect first", sum(c.first for c in named), len(named))
    share("  of these: right, or behind dirt that is really there", sum(c.first or c.dirt_first() for c in named),
          len(named))
    share("  of these: right class first", sum(c.right_class for c in named), len(named))
    share("  of these: right joint first", sum(c.right_joint for c in named), len(named))
    share("  of these: truth named or in the set", sum(c.inside for c in named), len(named))
    share("  of these: a name that is neither truth nor dirt", sum(bool(c.false) for c in named), len(named))
    share("effects: not named, but known to delta-identify already", sum(c.known and not c.named for c in effects),
          len(effects))
    for verdict in ("nothing-missing", "unknown-structure", "not-testable", "refused"):
        share(f"effects: {verdict}", sum(c.row["verdict"] == verdict for c in effects), len(effects))
    nothing = [case for case in cases if not case.hidden and not case.failed]
    share("nothing hidden: a false name", sum(bool(c.false) for c in nothing), len(nothing))
    for verdict in ("unknown-structure", "not-testable", "refused"):
        share(f"nothing hidden: {verdict}", sum(c.row["verdict"] == verdict for c in nothing), len(nothing))
    share("delta-identify ends with 5", sum(c.row["identify"] == "5" for c in cases), len(cases))
    proofs = [case for case in cases if case.ratio is not None]
    share("the written model is worse on the hold-out log", sum(c.ratio > 1 for c in proofs), len(proofs))
    share("  of one drive by 5 % and more", sum(c.worst_drive > 1.05 for c in proofs), len(proofs))
    share("could not be simulated, or a tool failed", sum(c.failed for c in cases), len(cases))


def print_summary(path, tools):
    classes = classes_of(tools)
    with open(path, encoding="utf-8", newline="") as lines:
        cases = [Verdict(row, classes) for row in csv.DictReader(lines)]
    print_block("all", cases)
    for key in ("dirty", "type"):
        for value in sorted({case.row[key] for case in cases}):
            print_block(value, [case for case in cases if case.row[key] == value])
    print("the written model is worse on the hold-out log:")
    for case in cases:
        if case.ratio is not None and (case.ratio > 1 or case.worst_drive > 1.05):
            print(f"  {case.row['id']}: {case.row['truth']}, named {case.row['named']}: rms {case.row['rms_given']} as "
                  f"given, {case.row['rms_written']} as written")
    print("misses:")
    for case in cases:
        miss = (case.false or case.failed or case.row["verdict"] in ("unknown-structure", "not-testable", "refused") or
                (case.hidden and not case.inside and not case.known))
        if miss:
            row = case.row
            print(f"  {row['id']} {row['type']} {row['dirty']} {row['rate_hz']} Hz {row['motion']}: {row['truth']} "
                  f"size {row['size']} strength {row['strength']}: {row['verdict']} {row['named']} [{row['set']}] "
                  f"{row['note']}")
