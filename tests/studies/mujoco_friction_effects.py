"""Hidden effects of the MuJoCo study that act in one drive: laws of friction, waves, memory. Formulas of their own."""
import math

import numpy as np


class FrictionEffects:
    """A make_NAME for each effect; what it sets is told in mujoco_effects.Hidden."""

    def on_drive(self, hook, function):
        """hook: level, viscous, torque; function of moment, rate and position of the drive."""
        only, j = self.only, self.drive
        setattr(self, hook, lambda m: only * function(m, m.v[j], m.q[j]))

    # --- Friction that depends on the rate

    def make_stribeck(self, case):
        knee, F = self.rate * (0.03 + 0.15 * self.u), 1.4 * self.F
        self.on_drive("level", lambda m, v, q: F / math.cosh(min(50.0, abs(v) / knee)))

    def make_shear_thinning(self, case):
        bend, F = self.rate * (0.05 + 0.2 * self.u), 1.6 * self.F
        self.on_drive("torque", lambda m, v, q: F * math.atan(v / bend))

    def make_convex_viscous(self, case):
        F = 2.5 * self.F
        power, top = 1.6 + 0.9 * self.u, self.rate
        self.on_drive("torque", lambda m, v, q: math.copysign(F * abs(v / top) ** (power + 0.2), v))

    def make_asymmetric_coulomb(self, case):
        F, width = 0.8 * self.sign * self.F, 0.004 * self.rate
        self.on_drive("level", lambda m, v, q: F * math.tanh(v / width))

    def make_asymmetric_viscous(self, case):
        b = 0.6 * self.sign * case.viscous[self.drive] * (0.15 + 0.85 * self.size)
        self.on_drive("viscous", lambda m, v, q: math.copysign(b, v))

    def make_thermal_drift(self, case):
        b, T = 3 * self.F / self.rate, 3 + 8 * self.u
        self.on_drive("viscous", lambda m, v, q: b / (1 + max(0.0, m.t) / T) ** 2)

    def make_telescope_stribeck(self, case):
        self.joint = "telescope"
        F, knee = case.value("telescope.coulomb") * (0.3 + 2 * self.size), 0.03 + 0.1 * self.u
        self.telescope_level = lambda m: F / math.cosh(min(50.0, abs(m.telescope_rate) / knee))

    # --- Friction that depends on position and load

    def make_torque_ripple(self, case):
        F, n, phase = 0.5 * self.F, (9 + 20 * self.u) / self.span, self.phase
        self.on_drive("torque", lambda m, v, q: F * (math.sin(n * q + phase) + 0.12 * math.sin(2 * n * q)))

    def make_position_dependent_friction(self, case):
        F, n, phase = self.F, (2.5 + 4 * self.u) / self.span, self.phase
        self.on_drive("level", lambda m, v, q: F * math.atan(1.5 * math.cos(n * q + phase)))

    def make_load_dependent_friction(self, case):
        mu, j = 0.02 + 0.1 * self.size, self.drive
        self.on_drive("level", lambda m, v, q: mu * abs(m.load[j]))

    def make_directional_efficiency(self, case):
        loss, j = 0.03 + 0.12 * self.size, self.drive
        self.on_drive("level", lambda m, v, q: loss * max(0.0, m.load[j] * math.copysign(1, v)))

    # --- Friction with memory

    def make_presliding(self, case):
        self.has_bristles = True
        self.builds_up = self.span * (0.015 + 0.05 * self.u)

    def make_hysteresis(self, case):
        """Springs that slide one after the other."""
        limits, F, j = self.span * (0.1 + 0.25 * self.u) * np.array([0.4, 0.8, 1.2]), 0.6 * self.F, self.drive
        state = {}

        def begin(case_):
            self.none = np.zeros(case_.drives)
            state["x"], state["q"] = np.zeros(3), None

        def torque(m):
            move = 0.0 if state["q"] is None else m.q[j] - state["q"]
            state["q"] = m.q[j]
            state["x"] = np.clip(state["x"] + move, -limits, limits)
            return self.only * F * (state["x"] / limits).sum()

        self.begin, self.torque = begin, torque
