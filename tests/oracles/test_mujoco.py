"""Against MuJoCo: the shipped Panda through its URDF reader, a random chain written as MJCF."""

from dataclasses import replace
from importlib import resources

import mujoco
import numpy as np
import pytest

from mcgee.model import Pose
from robots import apart, built_in, random_state, random_tree

ROUNDING = 1e-14
"""Of the largest element of M; bias: of that and the weight. MuJoCo keeps principal moments and
unit quaternions, and the way there costs a digit."""


def mass_matrix(model, data):
    M = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, M)
    return M


def assert_agrees(robot, model, states):
    names = [mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_JOINT, i) for i in range(model.njnt)]
    order = [names.index(name) for name in robot.joint_names]
    assert model.nq == model.nv == robot.n
    data = mujoco.MjData(model)
    for q, qd, qdd in zip(*states, strict=True):
        data.qpos[order], data.qvel[order] = q, qd
        mujoco.mj_forward(model, data)
        M, bias = mass_matrix(model, data)[np.ix_(order, order)], data.qfrc_bias[order]
        assert apart(robot.mass_matrix(q), M) <= ROUNDING
        size = abs(M).max() * max(abs(qd).max() ** 2, 9.81)
        assert apart(robot.coriolis(q, qd) + robot.gravity(q), bias, size) <= ROUNDING
        assert apart(robot.inverse_dynamics(q, qd, qdd), M @ qdd + bias, size) <= ROUNDING


def test_shipped_panda(rng):
    robot = built_in("panda")
    text = (resources.files("mcgee") / "robots" / "panda.urdf").read_text()
    model = mujoco.MjModel.from_xml_string(text)
    assert_agrees(robot, model, random_state(robot, rng, 10))


def test_shipped_panda_with_rotors(rng):
    plain = built_in("panda")
    rotors = {name: 0.1 * (i + 1) for i, name in enumerate(plain.joint_names)}
    text = (resources.files("mcgee") / "robots" / "panda.urdf").read_text()
    model = mujoco.MjModel.from_xml_string(text)
    for name, inertia in rotors.items():
        model.dof_armature[model.joint(name).dofadr[0]] = inertia
    robot = plain.replace(armature=rotors)
    assert_agrees(robot, model, random_state(robot, rng, 5))


def as_mjcf(robot):
    """The robot's links and joints as nested bodies; no fixed joints, no child poses."""
    inertias = {link.name: link.inertia for link in robot.links}

    def numbers(values):
        return " ".join(repr(float(v)) for v in values)

    def bodies(link):
        for joint in robot.joints:
            if joint.parent != link:
                continue
            quaternion = np.zeros(4)
            mujoco.mju_mat2Quat(quaternion, np.array(joint.pose.rotation).ravel())
            xx, xy, xz, yy, yz, zz = inertias[joint.child].about_com
            kind = "slide" if joint.kind == "prismatic" else "hinge"
            yield f"""
              <body pos="{numbers(joint.pose.translation)}" quat="{numbers(quaternion)}">
                <inertial mass="{inertias[joint.child].mass!r}"
                  pos="{numbers(inertias[joint.child].com)}"
                  fullinertia="{numbers((xx, yy, zz, xy, xz, yz))}"/>
                <joint name="{joint.name}" type="{kind}" axis="{numbers(joint.axis)}"
                  armature="{joint.armature!r}"/>
                {"".join(bodies(joint.child))}
              </body>"""

    return f"""
      <mujoco>
        <option gravity="{numbers(robot.gravity_vector)}"/>
        <worldbody>{"".join(bodies("base"))}</worldbody>
      </mujoco>"""


def without_child_poses(robot):
    return replace(robot, joints=tuple(replace(j, child_pose=Pose()) for j in robot.joints))


@pytest.mark.parametrize("branching", [0.0, 0.6], ids=["chain", "tree"])
def test_random_robots_as_mjcf(branching, rng):
    for seed in range(4):
        tree = random_tree(
            seed, bodies=7, branching=branching, fixed=0.0, prismatic=0.3, armature=0.7
        )
        robot = without_child_poses(tree)
        model = mujoco.MjModel.from_xml_string(as_mjcf(robot))
        assert any(model.dof_armature > 0)
        assert_agrees(robot, model, random_state(robot, rng))
