"""MuJoCo from Python, a call a row; the file's geometry is left out."""

import re
from pathlib import Path

import mujoco
import numpy as np

NAME = "MuJoCo Python"


def functions(arm, file: Path) -> dict:
    text = re.sub(r"<(visual|collision)\b.*?</\1>", "", file.read_text(), flags=re.DOTALL)
    extra = '<mujoco><compiler discardvisual="true" fusestatic="true" strippath="true"/></mujoco>'
    text = re.sub(r"(<robot\b[^>]*>)", rf"\1{extra}", text, count=1)
    model = mujoco.MjModel.from_xml_string(text)
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    model.dof_damping[:] = model.dof_frictionloss[:] = 0
    data = mujoco.MjData(model)

    def inverse(q, v, a):
        data.qpos, data.qvel, data.qacc = q, v, a
        mujoco.mj_inverse(model, data)
        return data.qfrc_inverse.copy()

    def forward(q, v, tau):
        data.qpos, data.qvel, data.qfrc_applied = q, v, tau
        mujoco.mj_forward(model, data)
        return data.qacc.copy()

    def rows(call):
        def batch(*arrays, keep: bool = False):
            results = [call(*row) for row in zip(*arrays, strict=True)]
            return np.array(results) if keep else None

        return batch

    return {"inverse_dynamics": rows(inverse), "forward_dynamics": rows(forward)}
