"""The exported URDF in Pinocchio, projected by the Jacobian of its loops, against deltadyn's inverse dynamics.

usage: pinocchio_peer.py FOLDER TYPE   with TYPE.out.urdf and TYPE_states.csv in FOLDER
Exit code 77 (skipped) without the packages pin and numpy.
"""
import sys
import xml.etree.ElementTree as xml

try:
    import numpy as np
    import pinocchio as pin

    pin.buildModelFromXML  # another package of this name exists
except (ImportError, AttributeError) as missing:
    print(f"skipped: the Python package pin is not at hand ({missing}; pip install pin numpy)")
    sys.exit(77)

TORQUE = 1e-9  # of the largest torque


def read_table(path):
    with open(path, encoding="utf-8") as lines:
        names = lines.readline().strip().split(",")
        return dict(zip(names, np.loadtxt(lines, delimiter=",", ndmin=2).T))


def vector(element, attribute="xyz"):
    return np.array([float(word) for word in element.get(attribute).split()])


class Tree:
    """Pinocchio's model of the plain URDF, and the <loop> elements that it skips."""

    def __init__(self, path):
        self.model = pin.buildModelFromUrdf(path)
        self.data = self.model.createData()
        root = xml.parse(path).getroot()
        self.model.gravity.linear = vector(root.find("deltadyn/gravity"), "xyz_m_s2")
        self.loops = []
        for loop in root.findall("loop"):
            ends = []
            for name in ("predecessor", "successor"):
                end = loop.find(name)
                frame = self.model.frames[self.model.getFrameId(end.get("link"))]
                place = frame.placement * pin.SE3(np.eye(3), vector(end.find("origin")))
                ends.append((frame.parentJoint, place))
            self.loops.append((loop.get("type"), ends))
        # Pinocchio takes a joint that mimics another for a free one. Those of struts and telescope are true by the loops.
        self.mimics = [
            (joint.get("name"), joint.find("mimic").get("joint"), float(joint.find("mimic").get("multiplier")))
            for joint in root.findall("joint")
            if joint.find("mimic") is not None
        ]
        self.model.armature[:] = 0
        self.friction = {}
        for joint in root.findall("joint"):
            dynamics = joint.find("dynamics")
            if dynamics is not None:
                place = self.dof(joint.get("name"))
                self.friction[place] = (float(dynamics.get("damping")), float(dynamics.get("friction")))

    def joint(self, name):
        return self.model.joints[self.model.getJointId(name)]

    def dof(self, name):
        return self.joint(name).idx_v

    def put(self, q, name, value):
        joint = self.joint(name)
        if joint.nq == 2:
            q[joint.idx_q : joint.idx_q + 2] = np.cos(value), np.sin(value)
        else:
            q[joint.idx_q] = value

    def positions(self, table, row, drives):
        q = pin.neutral(self.model)
        for i in range(drives):
            self.put(q, f"drive{i + 1}", table[f"q{i + 1}"][row])
        carriage = self.joint("drive1").shortname().startswith("JointModelP")
        for i in range(sum(f"beta{k + 1}" in table for k in range(4))):
            beta, gamma = table[f"beta{i + 1}"][row], table[f"gamma{i + 1}"][row]
            for side in "ab":
                self.put(q, f"strut{i + 1}{side}_y", beta if carriage else beta - table[f"q{i + 1}"][row])
                self.put(q, f"strut{i + 1}{side}_z", gamma)
        self.put(q, "platform_z", -table["gamma1"][row]), self.put(q, "platform_y", -table["beta1"][row])
        if "theta" in table:
            followed = {master for _, master, _ in self.mimics if master.startswith(("half_plate", "crossbar", "tool"))}
            for name, gain in [(name, 1.0) for name in followed] + [
                (name, gain) for name, master, gain in self.mimics if master in followed
            ]:
                self.put(q, name, gain * table["theta"][row])
        elif drives == 4:
            a, b = table["bar_a"][row], table["bar_b"][row]
            self.put(q, "telescope_x", a), self.put(q, "telescope_y", b), self.put(q, "telescope", table["bar_length"][row])
            self.put(q, "tool_y", -b), self.put(q, "tool_x", -a)
        return q

    def point(self, end, q):
        """Place, Jacobian and acceleration at zero joint accelerations of one end of a loop, in the directions of the base."""
        joint, place = end
        model, data = self.model, self.data
        at = data.oMi[joint] * place
        # Of the joint's frame, moved to the point.
        J = pin.getJointJacobian(model, data, joint, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
        arm = at.translation - data.oMi[joint].translation
        linear = J[:3] - pin.skew(arm) @ J[3:]
        motion = pin.getClassicalAcceleration(model, data, joint, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
        spin = pin.getVelocity(model, data, joint, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED).angular
        drift = motion.linear + np.cross(motion.angular, arm) + np.cross(spin, np.cross(spin, arm))
        return at, linear, J[3:], drift, motion.angular

    def constraints(self, q, v):
        """Errors, Jacobian and drift (Jdot v) of all loops."""
        pin.forwardKinematics(self.model, self.data, q, v, np.zeros(self.model.nv))
        pin.computeJointJacobians(self.model, self.data, q)
        errors, rows, drifts = [], [], []
        for kind, (first, second) in self.loops:
            at1, J1, W1, drift1, turn1 = self.point(first, q)
            at2, J2, W2, drift2, turn2 = self.point(second, q)
            errors.append(at1.translation - at2.translation)
            rows.append(J1 - J2)
            drifts.append(drift1 - drift2)
            if kind == "revolute":  # about z of both, which stays vertical
                errors.append((at1.rotation - at2.rotation)[:2, 2])
                rows.append((W1 - W2)[:2])
                drifts.append((turn1 - turn2)[:2])
        for name, master, gain in self.mimics:
            row = np.zeros((1, self.model.nv))
            row[0, self.dof(name)], row[0, self.dof(master)] = 1.0, -gain
            errors.append(np.zeros(1)), rows.append(row), drifts.append(np.zeros(1))
        return np.concatenate(errors), np.concatenate(rows), np.concatenate(drifts)


def main(folder, kind):
    table = read_table(f"{folder}/{kind}_states.csv")
    tree = Tree(f"{folder}/{kind}.out.urdf")
    drives = sum(f"q{i + 1}" in table for i in range(4))
    q, qd, qdd, tau = (np.stack([table[f"{stem}{i + 1}"] for i in range(drives)], axis=1) for stem in ("q", "qd", "qdd", "tau"))
    if kind.startswith("linear-"):  # a rotor on a vertical rail does not weigh, so URDF cannot hold it
        rotors = {}
        with open(f"{folder}/{kind}_params.csv", encoding="utf-8") as lines:
            for line in lines:
                rotors[line.split(",")[0]] = line.split(",")[1]
        tau = tau - qdd * np.array([float(rotors[f"drive{i + 1}.rotor_inertia"]) for i in range(drives)])
    driven = np.array([tree.dof(f"drive{i + 1}") for i in range(drives)])
    passive = np.setdiff1d(np.arange(tree.model.nv), driven)
    open_loops = worst = 0.0
    for row in range(len(q)):
        position = tree.positions(table, row, drives)
        errors, J, _ = tree.constraints(position, np.zeros(tree.model.nv))
        open_loops = max(open_loops, np.abs(errors).max())
        follow = np.linalg.pinv(J[:, passive], rcond=1e-10)
        gain = np.zeros((tree.model.nv, drives))
        gain[driven] = np.eye(drives)
        gain[passive] = -follow @ J[:, driven]
        v = gain @ qd[row]
        _, _, drift = tree.constraints(position, v)
        a = gain @ qdd[row]
        a[passive] -= follow @ drift
        torque = pin.rnea(tree.model, tree.data, position, v, a)
        for dof, (damping, coulomb) in tree.friction.items():
            torque[dof] += damping * v[dof] + coulomb * np.sign(v[dof])
        worst = max(worst, np.abs(gain.T @ torque - tau[row]).max())
    worst /= np.abs(tau).max()
    print(f"Pinocchio {pin.__version__}, {kind}, {len(q)} states")
    print(f"  loops in deltadyn's poses [m]         {open_loops:.3g} (limit 1e-09)")
    print(f"  torque on the drives, of the largest  {worst:.3g} (limit {TORQUE:g})")
    if not (open_loops <= 1e-9 and worst <= TORQUE):
        sys.exit("failed")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
