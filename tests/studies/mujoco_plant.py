"""The machine in MuJoCo: the exported model with dirt and a hidden effect, driven along a reference, and its record."""
import math

import mujoco
import numpy as np

from mujoco_case import DURATION_S, LEAD_S, Failed


class Moment:
    """What an effect may look at; positions and rates are those expected in the middle of the step."""

    def __init__(self, drives):
        self.t = 0.0
        self.q = self.v = self.command = self.load = np.zeros(drives)
        self.telescope_rate = 0.0
        self.plate = self.plate_rate = np.zeros(3)


class Dirt:
    """What is slightly wrong with a real machine: see `draw`."""

    def __init__(self, case):
        draw = case.rng.uniform
        n = case.drives
        # Friction builds up over a displacement [rad | m].
        self.displacement = draw(1.2e-3, 2.5e-3, n) * np.array([1.0 if case.turns(j) else 0.08 for j in range(n)])
        if n == 4:
            self.displacement[3] = draw(1e-2, 2e-2)
        # Cogging; waves a turn, on rails over 2 pi m.
        self.cogging = draw(0.004, 0.006, n) * case.peak
        self.waves = draw(25, 40, n) * np.array([1.0 if case.turns(j) else 12.0 for j in range(n)])
        if n == 4:
            self.waves[3] = draw(6, 12)
        self.phase = draw(0, 6.28, n)
        self.longer = draw(-3e-4, 3e-4, 3)  # arms; rails: zero of the carriages [m]
        self.heavier = int(draw(0, 2.999))  # this arm by 1 %
        self.filter_s = 5e-4  # of the recorded torque

    def edit(self, case, spec):
        for j in range(case.drives):
            spec.joint(f"drive{j + 1}").frictionloss = 0
        if case.kind == "axis":
            return
        for i in range(3):
            for side in "ab":
                place = spec.body(f"strut{i + 1}{side}").pos
                place[2 if case.sliding else 0] += self.longer[i]
                spec.body(f"strut{i + 1}{side}").pos = place
        arm = spec.body(f"upper_arm{self.heavier + 1}")
        arm.mass, arm.fullinertia = 1.01 * arm.mass, 1.01 * arm.fullinertia


class Bristles:
    """Dry friction with a memory: the deflection creeps to its limit as the drive moves. Levels are the caller's."""

    def __init__(self, displacement):
        self.displacement = displacement
        self.bent = np.zeros(len(displacement))  # share of the limit

    def share(self, v, h):
        """Bent share in the middle of a step of h at the rates v, and the state moved to its end."""
        away = np.sign(v) - self.bent
        middle = self.bent + away * -np.expm1(-np.abs(v) * (h / 2) / self.displacement)
        self.bent = self.bent + away * -np.expm1(-np.abs(v) * h / self.displacement)
        return middle


class Plant:
    """The model that delta-model wrote, changed by dirt and effect, and closed at the start of the motion."""

    def __init__(self, case, path, dirt, hidden, log):
        spec = mujoco.MjSpec.from_file(str(path))
        spec.option.timestep = case.step_s
        if dirt:
            dirt.edit(case, spec)
        hidden.edit(case, spec, log)
        for j in range(case.drives):  # no stops: the motion keeps away from them
            spec.joint(f"drive{j + 1}").limited = mujoco.mjtLimited.mjLIMITED_FALSE
        self.model = spec.compile()
        # At two steps, which the exported file asks for, loops swing where the fourth drive turns fast: by 0.2 % of the
        # torque.
        self.model.eq_solref[:, 0] = 5 * case.step_s
        self.data = mujoco.MjData(self.model)
        joints = [self.model.joint(f"drive{j + 1}") for j in range(case.drives)]
        self.dofs = np.array([joint.dofadr[0] for joint in joints])
        self.places = np.array([joint.qposadr[0] for joint in joints])
        self.passive = np.setdiff1d(np.arange(self.model.nv), self.dofs)
        self.telescope = self.model.joint("telescope").dofadr[0] if case.kind == "delta4" else None
        self.platform = self.model.body("platform").id if case.kind != "axis" else None

    def loops(self):
        model, data = self.model, self.data
        jacobian = np.zeros((data.nefc, model.nv))
        if mujoco.mj_isSparse(model):
            mujoco.mju_sparse2dense(jacobian, data.efc_J, data.efc_J_rownnz, data.efc_J_rowadr, data.efc_J_colind)
        else:
            jacobian[:] = data.efc_J.reshape(jacobian.shape)
        return data.efc_pos[: data.ne].copy(), jacobian[: data.ne]

    def gain(self):
        """Rates of all joints by those of the drives."""
        gain = np.zeros((self.model.nv, len(self.dofs)))
        gain[self.dofs] = np.eye(len(self.dofs))
        if len(self.passive):
            jacobian = self.loops()[1]
            gain[self.passive] = -np.linalg.lstsq(jacobian[:, self.passive], jacobian[:, self.dofs], rcond=1e-10)[0]
        return gain

    def start(self, position, rate):
        """The state with these drive positions and rates; the way from the home pose is walked in small steps."""
        model, data = self.model, self.data
        home = data.qpos[self.places].copy()
        for share in np.linspace(0, 1, 41):
            data.qpos[self.places] = home + share * (position - home)
            for _ in range(30):
                mujoco.mj_fwdPosition(model, data)
                if not len(self.passive):
                    break
                errors, jacobian = self.loops()
                if np.abs(errors).max() < 1e-11:
                    break
                step = np.zeros(model.nv)
                step[self.passive] = -np.linalg.lstsq(jacobian[:, self.passive], errors, rcond=1e-10)[0]
                mujoco.mj_integratePos(model, data.qpos, step * min(1.0, 0.3 / max(1e-12, np.abs(step).max())), 1.0)
        mujoco.mj_fwdPosition(model, data)
        if len(self.passive) and np.abs(self.loops()[0]).max() > 1e-8:
            raise Failed("the loops do not close at the start of the motion")
        gain = self.gain()
        data.qvel[:] = gain @ rate
        mass = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, mass)
        return np.diag(gain.T @ mass @ gain)


class Record:
    """What the simulator went through at each of its steps."""

    def __init__(self, steps, drives):
        self.position, self.command = np.zeros((steps, drives)), np.zeros((steps, drives))
        self.hidden = np.zeros((steps, drives))  # torque of the hidden effect, where it is one
        self.exact = []  # t, q, qd, qdd, tau of single states, rate and acceleration of the bar


def simulate(case, plant, reference, dirt, hidden, exact=False):
    """The closed loop. Feed-forward of the true rigid model, and a controller that sees encoders only."""
    model, data, h, n = plant.model, plant.data, case.step_s, case.drives
    drives, places = plant.dofs, plant.places
    inertia = plant.start(reference.position[0], reference.rate[0])
    w = 2 * math.pi * case.bandwidth_hz
    kp, kd = inertia * w * w, 1.4 * inertia * w
    smooth = 1 - math.exp(-2 * math.pi * 120 * h)
    encoder = case.encoder_steps()
    moment = Moment(n)
    bent = Bristles(hidden.displacement(case, dirt)) if dirt or hidden.has_bristles else None
    on_bristles = np.ones(n, bool) if dirt else hidden.bristles(case)
    hidden.begin(case)
    steps = len(reference.t) - 1
    record = Record(steps, n)
    data.act[:] = reference.feed[0] if model.na else 0
    before, seen_before, rate_error = data.qvel[drives].copy(), None, np.zeros(n)
    worst = 0.0
    velocity = np.zeros(6)
    for k in range(steps):
        q, v = data.qpos[places], data.qvel[drives]
        record.position[k] = q
        error = reference.position[k] - np.round(q / encoder) * encoder
        if seen_before is not None:
            rate_error = rate_error + smooth * ((error - seen_before) / h - rate_error)
        seen_before = error
        command = reference.feed[k] + kp * error + kd * rate_error
        record.command[k] = command
        data.ctrl[:] = command

        moment.t = reference.t[k]
        moment.q, moment.v = q + 0.5 * h * v, v + 0.5 * (v - before)
        before = v.copy()
        moment.command = command
        moment.load = command - case.viscous * moment.v - case.coulomb * np.sign(moment.v)
        if plant.telescope is not None:
            moment.telescope_rate = data.qvel[plant.telescope]
            level = hidden.telescope_level(moment)
            if level is not None:
                model.dof_frictionloss[plant.telescope] = case.value("telescope.coulomb") + level
        extra = hidden.level(moment)
        levels = np.maximum(0.0, case.coulomb + extra)
        model.dof_damping[drives] = np.maximum(0.0, case.viscous + hidden.viscous(moment))
        resist = hidden.torque(moment)
        record.hidden[k] = resist + extra * np.sign(moment.v) + (model.dof_damping[drives] - case.viscous) * moment.v
        if bent:
            built_up = levels * bent.share(moment.v, h)
            resist = resist + np.where(on_bristles, built_up, 0)
            if hidden.has_bristles:
                record.hidden[k] += np.where(hidden.bristles(case), built_up - levels * np.sign(moment.v), 0)
        model.dof_frictionloss[drives] = np.where(on_bristles, 0, levels) if bent else levels
        if dirt:
            resist = resist + dirt.cogging * np.sin(dirt.waves * moment.q + dirt.phase)
        data.qfrc_applied[drives] = -resist
        if hidden.acts_on_plate:
            mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_BODY, plant.platform, velocity, 0)
            moment.plate, moment.plate_rate = data.xpos[plant.platform], velocity[3:]
            data.xfrc_applied[plant.platform, :3] = hidden.force(moment)
        if exact and k % case.steps_per_sample == 0:
            mujoco.mj_forward(model, data)
            bar = [1.0, 0.0] if plant.telescope is None else [data.qvel[plant.telescope], data.qacc[plant.telescope]]
            record.exact.append(np.concatenate([[k * h], q, v, data.qacc[drives], command, bar]))
        mujoco.mj_step(model, data)
        if k % 200 == 0:
            worst = max(worst, np.abs(error / np.ptp(reference.position, axis=0)).max())
            if not worst < 0.3:
                raise Failed(f"the controller lost the motion at {reference.t[k]:.2f} s")
    record.worst = worst
    return record


def low_pass(x, time_constant, h):
    y, decay = x.copy(), math.exp(-h / time_constant)
    for k in range(1, len(x)):
        y[k] = decay * y[k - 1] + (1 - decay) * x[k - 1]
    return y


def to_log(case, record, dirt, hidden, rng, log):
    """The record as the drives write it: torque as the mean over the sample, noise, steps of converter and encoder."""
    m, h = case.steps_per_sample, case.step_s
    rows = round(DURATION_S * case.rate_hz)
    at = round(LEAD_S / h) + m * np.arange(rows)
    torque = low_pass(record.command, dirt.filter_s, h) if dirt else record.command
    whole = np.vstack([np.zeros(case.drives), np.cumsum(torque, axis=0)])
    ends = np.arange(len(whole))
    tau = np.column_stack([(np.interp(at + m / 2, ends, column) - np.interp(at - m / 2, ends, column)) / m
                           for column in whole.T])
    sigma = case.noise_share * np.abs(tau).max(axis=0)
    q = record.position[at]
    tau, q = hidden.record(case, tau, q, log)
    tau = tau + sigma * rng.standard_normal(tau.shape)
    if dirt:
        step = 0.5 * sigma
        tau = np.round(tau / step) * step
    encoder = case.encoder_steps()
    q = np.round(q / encoder) * encoder
    strength = (np.sqrt(np.mean(record.hidden[at] ** 2, axis=0)) / sigma).max()
    return np.column_stack([np.arange(rows) / case.rate_hz, q, tau]), strength


def write_log(case, path, table):
    names = ["t_s", *case.columns("q"), *case.columns("tau")]
    np.savetxt(path, table, delimiter=",", fmt="%.9f", header=",".join(names), comments="")
