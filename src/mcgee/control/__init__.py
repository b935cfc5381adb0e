"""Laws of control and the references that they follow.

Each law is a `Controller`: `mcgee.simulate.simulate(arm, q0, qd0, duration, law)` moves the arm by
it and keeps its log.
"""

from mcgee.control.adaptive_computed_torque import AdaptiveComputedTorque
from mcgee.control.adaptive_slotine_li import AdaptiveSlotineLi
from mcgee.control.computed_torque import ComputedTorque
from mcgee.control.controller import Controller, Law
from mcgee.control.hybrid import HybridForcePosition
from mcgee.control.ida_cart_pole import CartPoleIDAPBC
from mcgee.control.ida_pbc import IDAPBC
from mcgee.control.ida_wheel import InertiaWheelIDAPBC
from mcgee.control.lqr import LQR
from mcgee.control.operational_space import OperationalSpace
from mcgee.control.pd_gravity import PDGravity
from mcgee.control.references import Constant, Fourier, Quintic, Reference, Trapezoidal
from mcgee.control.regressor import excitation_gains, parameter_scales
from mcgee.control.slotine_li import SlotineLi
from mcgee.control.swing_up import EnergySwingUp, swing_up, upright_since
from mcgee.control.wall import Wall

__all__ = [
    "IDAPBC",
    "LQR",
    "AdaptiveComputedTorque",
    "AdaptiveSlotineLi",
    "CartPoleIDAPBC",
    "ComputedTorque",
    "Constant",
    "Controller",
    "EnergySwingUp",
    "Fourier",
    "HybridForcePosition",
    "InertiaWheelIDAPBC",
    "Law",
    "OperationalSpace",
    "PDGravity",
    "Quintic",
    "Reference",
    "SlotineLi",
    "Trapezoidal",
    "Wall",
    "excitation_gains",
    "parameter_scales",
    "swing_up",
    "upright_since",
]
