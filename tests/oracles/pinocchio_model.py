"""Robots as Pinocchio sees them: from our description, or from the URDF by its own reader."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pinocchio as pin

from mcgee.model import Pose
from mcgee.robot import Robot

KINDS = {"prismatic": pin.JointModelPrismaticUnaligned}


@dataclass
class Oracle:
    """A Pinocchio model with joint positions A q + b, velocities A qd.

    The model knows no followers: they are joints of their own here, and everything is projected
    with A.
    """

    model: pin.Model
    A: np.ndarray
    b: np.ndarray

    @cached_property
    def data(self):
        return self.model.createData()

    @cached_property
    def bare(self):
        """The same model without rotors and weightless."""
        model = self.model.copy()
        model.armature = np.zeros(model.nv)
        model.gravity.linear = np.zeros(3)
        return model

    def positions(self, q):
        """Pinocchio's configuration: an unbounded joint has its cosine and sine there."""
        x, configuration = self.A @ q + self.b, np.zeros(self.model.nq)
        for joint in list(self.model.joints)[1:]:
            angle = x[joint.idx_v]
            values = [angle] if joint.nq == 1 else [np.cos(angle), np.sin(angle)]
            configuration[joint.idx_q : joint.idx_q + joint.nq] = values
        return configuration

    def mass_matrix(self, q):
        M = np.triu(pin.crba(self.model, self.data, self.positions(q)))
        return self.A.T @ (M + np.triu(M, 1).T) @ self.A

    def inverse_dynamics(self, q, qd, qdd):
        x = self.positions(q)
        return self.A.T @ pin.rnea(self.model, self.data, x, self.A @ qd, self.A @ qdd)

    def coriolis(self, q, qd):
        x, still = self.positions(q), np.zeros(self.model.nv)
        return self.A.T @ pin.rnea(self.bare, self.bare.createData(), x, self.A @ qd, still)

    def coriolis_matrix(self, q, qd):
        C = pin.computeCoriolisMatrix(self.model, self.data, self.positions(q), self.A @ qd)
        return self.A.T @ C @ self.A

    def gravity(self, q):
        x = self.positions(q)
        return self.A.T @ pin.computeGeneralizedGravity(self.model, self.data, x)

    def forward_dynamics(self, q, qd, tau):
        """By its articulated-body algorithm; with followers from M and the bias."""
        if self.A.shape[0] == self.A.shape[1]:
            x, back = self.positions(q), np.linalg.inv(self.A)
            joints = back.T @ tau
            return back @ pin.aba(self.model, self.data, x, self.A @ qd, joints)
        bias = self.inverse_dynamics(q, qd, 0 * qd)
        return np.linalg.solve(self.mass_matrix(q), tau - bias)

    def inverse_dynamics_derivatives(self, q, qd, qdd):
        state = self.positions(q), self.A @ qd, self.A @ qdd
        slopes = pin.computeRNEADerivatives(self.model, self.data, *state)[:2]
        return *(self.A.T @ slope @ self.A for slope in slopes), self.mass_matrix(q)

    def forward_dynamics_derivatives(self, q, qd, tau):
        """By its articulated-body algorithm; there are no followers."""
        back = np.linalg.inv(self.A)
        state = self.positions(q), self.A @ qd, back.T @ tau
        by_q, by_qd, Minv = pin.computeABADerivatives(self.model, self.data, *state)[:3]
        Minv = np.triu(Minv) + np.triu(Minv, 1).T
        return back @ by_q @ self.A, back @ by_qd @ self.A, back @ Minv @ back.T

    def regressor(self, q, qd, qdd, poses, order):
        """Its parameters are those of a body in its joint's frame.

        poses are of those frames in the frames of the links, by joint; order is of the joints.
        """
        state = self.positions(q), self.A @ qd, self.A @ qdd
        Y = pin.computeJointTorqueRegressor(self.model, self.data, *state)
        Y = self.A.T @ Y.reshape(self.model.nv, -1)  # one joint makes it a vector
        blocks = []
        for name in order:
            k = self.model.getJointId(name) - 1
            blocks.append(Y[:, 10 * k : 10 * k + 10] @ _carried(poses[name]))
        return np.concatenate(blocks, axis=1)

    def kinetic_energy(self, q, qd):
        """Rotors apart: Pinocchio 4.1 forgets those of its prismatic joints along any axis."""
        v, x = self.A @ qd, self.positions(q)
        links = pin.computeKineticEnergy(self.bare, self.bare.createData(), x, v)
        return links + 0.5 * (self.model.armature * v**2).sum()

    def potential_energy(self, q):
        return pin.computePotentialEnergy(self.model, self.data, self.positions(q))

    def forward_kinematics(self, q, frame):
        pin.framesForwardKinematics(self.model, self.data, self.positions(q))
        return self.data.oMf[self.model.getFrameId(frame)].homogeneous

    def jacobian(self, q, frame):
        x, i = self.positions(q), self.model.getFrameId(frame)
        axes = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        J = pin.computeFrameJacobian(self.model, self.data, x, i, axes)
        return J.reshape(6, -1) @ self.A  # one joint makes it a vector


def _carried(pose: Pose) -> np.ndarray:
    """From ten parameters about a frame to those about another, pose being of the first in it."""
    columns = []
    for unit in np.eye(10):
        m, h, (xx, xy, yy, xz, yz, zz) = unit[0], unit[1:4], unit[4:]
        I = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        R, r = np.array(pose.rotation, float), np.array(pose.translation, float)
        # ∫ c cᵀ dm moves like any second moment
        P = R @ (np.trace(I) / 2 * np.eye(3) - I) @ R.T
        h = R @ h
        P = P + np.outer(r, h) + np.outer(h, r) + m * np.outer(r, r)
        I, h = np.trace(P) * np.eye(3) - P, h + m * r
        columns.append([m, *h, I[0, 0], I[0, 1], I[1, 1], I[0, 2], I[1, 2], I[2, 2]])
    return np.stack(columns, axis=-1)


def from_urdf(text: str, robot: Robot) -> Oracle:
    """As Pinocchio reads the text; coordinates in the robot's order, followers as it has them."""
    return _projected(pin.buildModelFromXML(text), robot)


def from_description(robot: Robot) -> Oracle:
    """Built joint by joint from the links and joints, subtree by subtree.

    That order is what Pinocchio's algorithms need: each subtree's joints are consecutive.
    """
    model = pin.Model()
    model.gravity.linear = np.array(robot.gravity_vector)
    inertias = {link.name: link.inertia for link in robot.links}

    def place(link: str, carrier: int, pose: pin.SE3) -> None:
        inertia = inertias[link]
        if inertia is not None:
            body = pin.Inertia(inertia.mass, np.array(inertia.com), np.array(inertia.matrix))
            model.appendBodyToJoint(carrier, body, pose)
        add_frame(link, carrier, pose)
        for frame in robot.frames:
            if frame.link == link:
                add_frame(frame.name, carrier, pose * _se3(frame.pose))
        for joint in robot.joints:
            if joint.parent != link:
                continue
            at, child = pose * _se3(joint.pose), _se3(joint.child_pose)
            if joint.kind == "fixed":
                place(joint.child, carrier, at * child)
            else:
                slides = joint.kind == "prismatic"
                kind = (
                    pin.JointModelPrismaticUnaligned if slides else pin.JointModelRevoluteUnaligned
                )
                place(
                    joint.child,
                    model.addJoint(carrier, kind(np.array(joint.axis)), at, joint.name),
                    child,
                )

    def add_frame(name: str, carrier: int, pose: pin.SE3) -> None:
        model.addFrame(pin.Frame(name, carrier, 0, pose, pin.FrameType.OP_FRAME), False)

    (root,) = set(inertias) - {joint.child for joint in robot.joints}
    place(root, 0, pin.SE3.Identity())
    armature = np.zeros(model.nv)
    for joint in robot.joints:
        if joint.kind != "fixed":
            armature[model.joints[model.getJointId(joint.name)].idx_v] = joint.armature
    model.armature = armature
    return _projected(model, robot)


def _se3(pose: Pose) -> pin.SE3:
    return pin.SE3(np.array(pose.rotation, float), np.array(pose.translation, float))


def _projected(model: pin.Model, robot: Robot) -> Oracle:
    """A and b, by following each joint's leaders."""
    joints = {joint.name: joint for joint in robot.joints}
    A, b = np.zeros((model.nv, robot.n)), np.zeros(model.nv)
    for name in list(model.names)[1:]:
        row = model.joints[model.getJointId(name)].idx_v
        joint, factor = joints[name], 1.0
        while joint.mimic is not None:
            b[row] += factor * joint.mimic.offset
            factor *= joint.mimic.multiplier
            joint = joints[joint.mimic.joint]
        A[row, robot.joint_names.index(joint.name)] = factor
    return Oracle(model, A, b)
