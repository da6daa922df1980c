"""Hidden effects of the MuJoCo study, in the simulator's terms or in formulas that are not the catalogue's."""
import numpy as np

from mujoco_friction_effects import FrictionEffects
from mujoco_machine_effects import MachineEffects

# Effect and the robots that it can be told from logs of.
DELTAS, ARMS, ALL = ("delta3", "delta4", "linear-delta3"), ("delta3", "delta4"), (
    "delta3", "delta4", "linear-delta3", "axis")
EFFECTS = {
    "stribeck": ALL,
    "shear_thinning": ALL,
    "convex_viscous": ALL,
    "asymmetric_coulomb": DELTAS,  # an axis has an offset of its own
    "asymmetric_viscous": ALL,
    "torque_ripple": ALL,
    "position_dependent_friction": ALL,
    "load_dependent_friction": DELTAS,
    "directional_efficiency": DELTAS,
    "payload": DELTAS,
    "base_tilt": DELTAS,
    "hose_force": DELTAS,
    "aerodynamic_drag": DELTAS,
    "rotor_inertia": DELTAS,
    "limb_inertia_mismatch": ARMS,
    "time_skew": ALL,
    "current_lag": ALL,
    "torque_constant_error": DELTAS,
    "presliding": ALL,
    "hysteresis": ALL,
    "thermal_drift": ALL,
    "kinematic_offset": DELTAS,
    "passive_joint_friction": DELTAS,
    "arm_spring": DELTAS,
    "telescope_stribeck": ("delta4",),
}


class Hidden:
    """Nothing hidden; the effects below override what they are."""

    name, joint, size = "nothing", "", 0.0
    has_bristles = acts_on_plate = False

    def edit(self, case, spec, log):
        """Changes the model of one log before it is compiled."""

    def begin(self, case):
        """A log begins."""
        self.none = np.zeros(case.drives)

    def level(self, moment):
        """More dry friction of each drive, its law's size at this moment."""
        return self.none

    def telescope_level(self, moment):
        return None

    def viscous(self, moment):
        return self.none

    def torque(self, moment):
        """Resisting torque of each drive."""
        return self.none

    def force(self, moment):
        """Force on the plate."""
        return np.zeros(3)

    def displacement(self, case, dirt):
        """Over which friction builds up."""
        return dirt.displacement if dirt else np.ones(case.drives)

    def bristles(self, case):
        return np.zeros(case.drives, bool)

    def record(self, case, tau, q, log):
        return tau, q


class Drawn(FrictionEffects, MachineEffects, Hidden):
    """An effect with its size, place and numbers. \\param size  0 barely detectable ... 1 plain"""

    def __init__(self, name, case):
        rng = self.rng = case.rng
        self.name, self.size = name, rng.uniform()
        limbs = min(3, case.drives)
        self.drive = int(rng.integers(case.drives))
        if name in ("load_dependent_friction", "directional_efficiency", "rotor_inertia", "limb_inertia_mismatch",
                    "torque_constant_error", "kinematic_offset", "arm_spring"):
            self.drive = int(rng.integers(limbs))
        self.joint = f"drive{self.drive + 1}"
        self.u, self.phase, self.sign = rng.uniform(), rng.uniform(0, 6.28), float(rng.choice([-1, 1]))
        self.F = case.coulomb[self.drive] * (0.08 + 0.5 * self.size)
        self.rate = case.peak_rate[self.drive]
        span = (case.coordinates()[0] if case.kind == "axis" else 0.6 if not case.sliding else case.size)
        self.span = 6.0 if self.drive == 3 else span  # of the drive's travel, about
        self.only = np.zeros(case.drives)
        self.only[self.drive] = 1.0
        getattr(self, "make_" + name)(case)

    def displacement(self, case, dirt):
        x = super().displacement(case, dirt).copy()
        if self.has_bristles:
            x[self.drive] = self.builds_up
        return x

    def bristles(self, case):
        return (self.only > 0) & self.has_bristles


def draw_effect(index):
    """Name of the hidden effect, robot type and dirt of a case; every fourth case hides nothing."""
    block, at = divmod(index, 4)
    dirty = (index + block) % 2 == 1
    name = "nothing"
    if at < 3:
        turn, place = divmod(3 * block + at, len(EFFECTS))
        name = list(EFFECTS)[np.random.default_rng(77 + turn).permutation(len(EFFECTS))[place]]
    chances = {"delta3": 0.3, "delta4": 0.35, "linear-delta3": 0.2, "axis": 0.15}
    kinds = EFFECTS.get(name, ALL)
    share = np.array([chances[kind] for kind in kinds])
    return name, str(np.random.default_rng([index, 815]).choice(kinds, p=share / share.sum())), dirty
