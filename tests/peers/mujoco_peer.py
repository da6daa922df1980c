"""The exported MJCF in MuJoCo against deltadyn: mass matrix, accelerations, a closed-loop motion.

usage: mujoco_peer.py FOLDER TYPE   with TYPE.xml, TYPE_states.csv and TYPE_motion.csv in FOLDER
Exit code 77 (skipped) without the packages mujoco and numpy.
"""
import sys

try:
    import mujoco
    import numpy as np
except ImportError as missing:
    print(f"skipped: the Python package {missing.name} is not installed (pip install mujoco numpy)")
    sys.exit(77)

MASS_MATRIX = 1e-6  # of the largest entry
# Of the largest acceleration of the drive. Steep rails load the struts more for the same acceleration, and MuJoCo's constraints
# give way by a ten-thousandth at best.
ACCELERATION = {"linear-delta3": 3e-3}
ANGLE = 2e-3  # [rad | m]


class Table:
    def __init__(self, path):
        with open(path, encoding="utf-8") as lines:
            names = lines.readline().strip().split(",")
            self.columns = dict(zip(names, np.loadtxt(lines, delimiter=",", ndmin=2).T))

    def stack(self, stem, count):
        return np.stack([self.columns[f"{stem}{i + 1}"] for i in range(count)], axis=1)

    def __getitem__(self, name):
        return self.columns[name]


class Plant:
    """The exported model, with its drives and the joints that follow them."""

    def __init__(self, path):
        self.model = mujoco.MjModel.from_xml_path(path)
        self.data = mujoco.MjData(self.model)
        self.count = self.model.nu
        joints = [self.model.joint(f"drive{i + 1}") for i in range(self.count)]
        self.dofs = np.array([joint.dofadr[0] for joint in joints])
        self.places = np.array([joint.qposadr[0] for joint in joints])
        self.passive = np.setdiff1d(np.arange(self.model.nv), self.dofs)

    def loops(self):
        """Rows of the equality constraints: errors and Jacobian."""
        model, data = self.model, self.data
        jacobian = np.zeros((data.nefc, model.nv))
        if mujoco.mj_isSparse(model):
            mujoco.mju_sparse2dense(jacobian, data.efc_J, data.efc_J_rownnz, data.efc_J_rowadr, data.efc_J_colind)
        else:
            jacobian[:] = data.efc_J.reshape(jacobian.shape)
        return data.efc_pos[: data.ne].copy(), jacobian[: data.ne]

    def follow(self):
        """Rates of all joints by the rates of the drives, at the present positions."""
        errors, jacobian = self.loops()
        gain = np.zeros((self.model.nv, self.count))
        gain[self.dofs] = np.eye(self.count)
        gain[self.passive] = -np.linalg.lstsq(jacobian[:, self.passive], jacobian[:, self.dofs], rcond=1e-12)[0]
        return np.abs(errors).max(), gain

    def sticks(self):
        """A joint so slow that MuJoCo brings it to rest: it aims at the acceleration -b v, and dry friction does less for it."""
        rubbing = self.model.dof_frictionloss > 0
        rate = -self.model.dof_solref[rubbing, 1]
        return np.any(np.abs(self.data.qvel[rubbing]) < 2 * np.abs(self.data.qacc[rubbing]) / rate)

    def plate_joints(self):
        """Places of the joints inside an articulated plate: one that follows, the one that it follows, by how much."""
        model = self.model
        for k in np.flatnonzero(model.eq_type == mujoco.mjtEq.mjEQ_JOINT):
            follower, leader = model.jnt_qposadr[model.eq_obj1id[k]], model.jnt_qposadr[model.eq_obj2id[k]]
            yield follower, leader, model.eq_data[k, 1]

    def pose(self, table, row):
        data = self.data

        def put(name, value):
            data.joint(name).qpos = value

        for i in range(self.count):
            put(f"drive{i + 1}", table[f"q{i + 1}"][row])
        carriage = self.model.joint("drive1").type[0] == mujoco.mjtJoint.mjJNT_SLIDE
        for i in range(sum(f"beta{k + 1}" in table.columns for k in range(4))):
            for side in "ab":
                put(f"strut{i + 1}{side}_y", table[f"beta{i + 1}"][row] - (0 if carriage else table[f"q{i + 1}"][row]))
                put(f"strut{i + 1}{side}_z", table[f"gamma{i + 1}"][row])
        if "theta" in table.columns:
            for half, axis in ((half, axis) for half in "12" for axis in "xyz"):
                if mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_JOINT, f"half_plate{half}_{axis}") >= 0:
                    put(f"half_plate{half}_{axis}", table[f"half{half}_{axis}"][row])
            for joint, leader, gain in self.plate_joints():
                data.qpos[leader] = table["leader"][row]
                data.qpos[joint] = gain * table["leader"][row]
        elif self.count == 4:
            a, b = table["bar_a"][row], table["bar_b"][row]
            put("telescope_x", a), put("telescope_y", b), put("telescope", table["bar_length"][row])
            put("tool_x", -a), put("tool_y", -b), put("platform", -table["q4"][row])
        else:
            put("platform", [table[axis][row] for axis in "xyz"] + [1, 0, 0, 0])
        mujoco.mj_fwdPosition(self.model, data)


def full_matrix(model, data):
    M = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, M, data.qM) if hasattr(data, "qM") else mujoco.mj_fullM(model, data, M)
    return M


def check_states(plant, table):
    n = plant.count
    q, qd, qdd, tau = (table.stack(stem, n) for stem in ("q", "qd", "qdd", "tau"))
    M = np.stack([table.stack(f"M{i + 1}_", n) for i in range(n)], axis=1)
    open_loops = mass = 0.0
    acceleration = np.zeros(n)
    compared = 0
    for row in range(len(q)):
        plant.pose(table, row)
        error, gain = plant.follow()
        open_loops = max(open_loops, error)
        projected = gain.T @ full_matrix(plant.model, plant.data) @ gain
        mass = max(mass, np.abs(projected - M[row]).max() / np.abs(M[row]).max())
        plant.data.qvel[:] = gain @ qd[row]
        plant.data.ctrl[:] = tau[row]
        mujoco.mj_forward(plant.model, plant.data)
        if plant.sticks():
            continue
        compared += 1
        acceleration = np.maximum(acceleration, np.abs(plant.data.qacc[plant.dofs] - qdd[row]))
    acceleration /= np.abs(qdd).max(axis=0)
    return open_loops, mass, acceleration, compared


def check_motion(plant, states, table):
    """The same digital controller on the same set points, from the same state; the drive of a telescope is softer."""
    n, model, data = plant.count, plant.model, plant.data
    reference, rate, feed, expected = (table.stack(stem, n) for stem in ("ref", "refd", "ff", "q"))
    gains = np.where((np.arange(n) == 3) & ("bar_a" in states.columns), 0.01, 1.0)
    tick = table["t_s"][1]
    steps = round(tick / model.opt.timestep)
    # The start is closed by Newton's iteration from the state that is nearest to it.
    start = np.argmin(np.abs(states.stack("q", n)[:, :3] - reference[0, :3]).max(axis=1))
    plant.pose(states, start)
    data.qpos[plant.places] = reference[0]
    for _ in range(50):
        mujoco.mj_fwdPosition(model, data)
        errors, jacobian = plant.loops()
        step = np.zeros(model.nv)
        step[plant.passive] = -np.linalg.lstsq(jacobian[:, plant.passive], errors, rcond=1e-12)[0]
        mujoco.mj_integratePos(model, data.qpos, step * min(1.0, 0.3 / max(1e-12, np.abs(step).max())), 1.0)
    mujoco.mj_fwdPosition(model, data)
    error, gain = plant.follow()
    assert error < 1e-9, f"the start of the motion does not close: {error} m"
    data.qvel[:] = gain @ rate[0]
    worst = 0.0
    for row in range(len(reference)):
        q, qd = data.qpos[plant.places], data.qvel[plant.dofs]
        worst = max(worst, np.abs(q - expected[row]).max())
        data.ctrl[:] = feed[row] + gains * (table["k"][row] * (reference[row] - q) + table["d"][row] * (rate[row] - qd))
        for _ in range(steps):
            mujoco.mj_step(model, data)
    return worst


def main(folder, kind):
    states = Table(f"{folder}/{kind}_states.csv")
    plant = Plant(f"{folder}/{kind}.xml")
    mujoco.mj_forward(plant.model, plant.data)
    closed = np.abs(plant.data.efc_pos[: plant.data.ne]).max()
    freedom = plant.model.nv - np.linalg.matrix_rank(plant.loops()[1], tol=1e-9)  # both struts of a limb may say the same
    open_loops, mass, acceleration, compared = check_states(plant, states)
    angle = check_motion(plant, states, Table(f"{folder}/{kind}_motion.csv"))
    print(f"MuJoCo {mujoco.__version__}, {kind}, {len(states['q1'])} states, in {compared} of them no joint sticks")
    failed = []

    def figure(name, value, limit):
        print(f"  {name:<58} {value:.3g} (limit {limit:g})")
        if not value <= limit:
            failed.append(name)

    figure("states left out because a joint sticks, share", 1 - compared / len(states["q1"]), 0.1)
    figure("degrees of freedom less constraints, beyond the drives", abs(freedom - plant.count), 0)
    figure("loops of the file as written [m]", closed, 1e-9)
    figure("loops in deltadyn's poses [m]", open_loops, 1e-9)
    figure("mass matrix, of its largest entry", mass, MASS_MATRIX)
    for i, value in enumerate(acceleration):
        figure(f"acceleration of drive {i + 1}, of the largest", value, ACCELERATION.get(kind, 1e-3))
    figure("drive positions over 0.5 s of closed-loop motion [rad | m]", angle, ANGLE)
    if failed:
        sys.exit("failed: " + ", ".join(failed))


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
