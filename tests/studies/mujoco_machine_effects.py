"""Hidden effects of the MuJoCo study in the machine, its drives and their record, in the simulator's own terms."""
import math

import mujoco
import numpy as np

STICKS = ([-1.0, -4000.0], [0.9999, 0.9999, 0.001, 0.5, 2])  # of dry friction, as in the exported file


class MachineEffects:
    """A make_NAME for each effect; what it sets is told in mujoco_effects.Hidden."""

    # --- The machine itself

    def make_payload(self, case):
        self.joint = "platform"
        mass = (case.value("platform.m") + case.value("tool.m")) * (0.06 + 0.4 * self.size)

        def edit(case_, spec, log):
            if log == 0:
                spec.body("platform").add_body(name="payload", mass=mass, inertia=[1e-5, 1e-5, 1e-5],
                                               explicitinertial=True)

        self.edit = edit

    def make_base_tilt(self, case):
        self.joint = "robot"
        angle = 0.008 + 0.05 * self.size

        def edit(case_, spec, log):
            spec.option.gravity = 9.81 * np.array([math.sin(angle) * math.cos(self.phase),
                                                   math.sin(angle) * math.sin(self.phase), -math.cos(angle)])

        self.edit = edit

    def make_hose_force(self, case):
        """A tendon from above to the plate that pulls like rubber beyond its length."""
        self.joint = "platform"
        k = (case.value("platform.m") + case.value("tool.m")) * (3 + 25 * self.size)
        across = case.size * self.rng.uniform(-1, 1, 2)
        free = abs(case.height) * (0.3 + 0.4 * self.u)

        def edit(case_, spec, log):
            spec.worldbody.add_site(name="hose_top", pos=[*across, 0])
            spec.body("platform").add_site(name="hose_end", pos=[0, 0, 0])
            tendon = spec.add_tendon(name="hose", stiffness=[k, 0, 0], springlength=[0, free])
            tendon.wrap_site("hose_top")
            tendon.wrap_site("hose_end")

        self.edit = edit

    def make_aerodynamic_drag(self, case):
        self.joint, self.acts_on_plate = "platform", True
        c = (case.value("platform.m") + case.value("tool.m")) * (0.3 + 3 * self.size)
        self.force = lambda m: -c * (np.linalg.norm(m.plate_rate) + 1e-9) ** 0.85 * m.plate_rate

    def make_rotor_inertia(self, case):
        more = case.inertia[self.drive] * (0.02 + 0.15 * self.size)

        def edit(case_, spec, log):
            spec.joint(self.joint).armature += more

        self.edit = edit

    def make_limb_inertia_mismatch(self, case):
        more = case.value("upper_arm.m") * (0.04 + 0.3 * self.size)
        place = [case.arm * (0.3 + 0.6 * self.u), 0, 0]

        def edit(case_, spec, log):
            spec.body(f"upper_arm{self.drive + 1}").add_body(name="lump", pos=place, mass=more,
                                                              inertia=[1e-6, 1e-6, 1e-6], explicitinertial=True)

        self.edit = edit

    def make_kinematic_offset(self, case):
        kind, i = ("home", "arm", "strut")[self.rng.integers(3)], self.drive
        if kind == "arm" and case.sliding:
            kind = "home"
        off = self.sign * (0.004 + 0.026 * self.size) * (1 if not case.sliding else 0.5)
        longer = self.sign * (0.003 + 0.007 * self.size)

        def edit(case_, spec, log):
            for side in "ab":
                if kind == "arm":
                    body = spec.body(f"strut{i + 1}{side}")
                    body.pos = body.pos + np.array([longer * case.arm, 0, 0])
                if kind == "strut":
                    end = spec.site(f"strut{i + 1}{side}_end")
                    end.pos = end.pos * (1 + longer)

        def record(case_, tau, q, log):
            q = q.copy()
            q[:, i] += off if kind == "home" else 0
            return tau, q

        self.edit, self.record, self.note = edit, record, kind

    def make_passive_joint_friction(self, case):
        """Dry friction in both ends of every strut, and in the telescope's universal joints."""
        self.joint = "robot"
        mu = case.coulomb[:3].mean() * (0.01 + 0.05 * self.size) * (1 if not case.sliding else 0.5 * case.size)

        def edit(case_, spec, log):
            for i in range(3):
                for side in "ab":
                    strut = f"strut{i + 1}{side}"
                    spec.joint(f"{strut}_y").frictionloss = mu
                    spec.joint(f"{strut}_z").frictionloss = 2 * mu  # both ends turn alike about this axis
                    tendon = spec.add_tendon(name=f"{strut}_far_end", frictionloss=mu, solref_friction=STICKS[0],
                                             solimp_friction=STICKS[1])
                    tendon.wrap_joint(f"{strut}_y", 1)
                    if not case.sliding:
                        tendon.wrap_joint(f"drive{i + 1}", 1)
            if case.kind == "delta4":
                for joint in ("telescope_x", "telescope_y", "tool_x", "tool_y"):
                    spec.joint(joint).frictionloss = mu

        self.edit = edit

    def make_arm_spring(self, case):
        k = case.peak[self.drive] / (2 * self.span) * (0.03 + 0.25 * self.size)

        def edit(case_, spec, log):
            joint = spec.joint(self.joint)
            joint.stiffness = [k, 0, 0]
            joint.springref = -self.span * (0.5 + self.u)

        self.edit = edit

    # --- Drives and their record

    def make_torque_constant_error(self, case):
        share = self.sign * (0.01 + 0.08 * self.size)

        def edit(case_, spec, log):
            motor = spec.actuator(self.joint)
            gain = motor.gainprm
            gain[0] = 1 / (1 + share)
            motor.gainprm = gain

        self.edit = edit

    def make_current_lag(self, case):
        self.joint = "robot"
        constant = 0.0015 + 0.004 * self.size
        constant = max(constant, 1.5 / case.rate_hz)

        def edit(case_, spec, log):
            for j in range(case.drives):
                motor = spec.actuator(f"drive{j + 1}")
                motor.dyntype = mujoco.mjtDyn.mjDYN_FILTER
                filter_ = motor.dynprm
                filter_[0] = constant
                motor.dynprm = filter_

        self.edit = edit

    def make_time_skew(self, case):
        self.joint = "robot"
        late = (1.6 + 5 * self.size) * max(1.0, 1e-3 * case.rate_hz)  # samples; 1 ms and more

        def record(case_, tau, q, log):
            rows = np.arange(len(tau))
            return np.column_stack([np.interp(rows - late, rows, column) for column in tau.T]), q

        self.record = record
