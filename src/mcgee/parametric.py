"""A robot whose inertial parameters are known only when its kernels are called."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from mcgee.build import operation_counts
from mcgee.kernels import quantities, quantity, refuse_symbols
from mcgee.mechanism import Mechanism
from mcgee.robot import ForwardDerivatives, InverseDerivatives, Robot, Terms


@dataclass(frozen=True, repr=False)
class Parametric:
    """The dynamics of a robot as functions of its state and its inertial parameters.

    Every method takes what the robot's method of the same name takes, then `parameters`
    (..., 10 bodies) ordered as `Robot.inertial_parameters`, which broadcasts like the other
    arrays: a row for each sample of an identification or of a randomised robot. Lengths, armature
    and gravity are the robot's. Parameters are not checked: those that no body can have give what
    the equations give.

    Equals: f(q, …, robot.inertial_parameters) = robot.f(q, …), and inverse_dynamics is linear
        in the parameters
    """

    robot: Robot
    parametric: ClassVar[bool] = True

    @property
    def name(self) -> str:
        return self.robot.name

    @property
    def n(self) -> int:
        """The number of independent joints."""
        return self.robot.n

    @property
    def joint_names(self) -> tuple[str, ...]:
        return self.robot.joint_names

    @property
    def mechanism(self) -> Mechanism:
        return self.robot.mechanism

    @property
    def symbols(self) -> tuple[str, ...]:
        return self.robot.symbols

    @property
    def inertial_parameters(self) -> np.ndarray:
        """Those of the robot as described (10 bodies,)."""
        return self.robot.inertial_parameters

    def operation_counts(self, *names: str) -> dict[str, dict[str, int]]:
        """As `Robot.operation_counts`, with the parameters as inputs."""
        refuse_symbols(self, "operation counts")
        return operation_counts(self.mechanism, self.robot.end_frame, names, parametric=True)

    def __repr__(self) -> str:
        bodies = len(self.mechanism.bodies)
        return f"Robot '{self.name}' with parameters (..., {10 * bodies})"

    def __getstate__(self) -> dict[str, Any]:
        return {"robot": self.robot}

    @quantity
    def mass_matrix(self, q: Any, parameters: Any, **ufunc: Any) -> np.ndarray:
        """M(q).

        Args:
            q: (..., n); parameters: (..., 10 bodies)
        Returns: (..., n, n), as Robot.mass_matrix
        """

    @quantity
    def mass_matrix_inverse(self, q: Any, parameters: Any, **ufunc: Any) -> np.ndarray:
        """M(q)⁻¹.

        Args:
            q: (..., n); parameters: (..., 10 bodies)
        Returns: (..., n, n), as Robot.mass_matrix_inverse
        """

    @quantity
    def coriolis(self, q: Any, qd: Any, parameters: Any, **ufunc: Any) -> np.ndarray:
        """C(q, qd) qd.

        Args:
            q, qd: (..., n); parameters: (..., 10 bodies)
        Returns: (..., n), as Robot.coriolis
        """

    @quantity
    def coriolis_matrix(self, q: Any, qd: Any, parameters: Any, **ufunc: Any) -> np.ndarray:
        """C(q, qd) by the Christoffel symbols.

        Args:
            q, qd: (..., n); parameters: (..., 10 bodies)
        Returns: (..., n, n), as Robot.coriolis_matrix
        """

    @quantity
    def coriolis_product(
        self, q: Any, qd: Any, v: Any, parameters: Any, **ufunc: Any
    ) -> np.ndarray:
        """C(q, qd) v.

        Args:
            q, qd, v: (..., n); parameters: (..., 10 bodies)
        Returns: (..., n), as Robot.coriolis_product
        """

    @quantity
    def christoffel(self, q: Any, parameters: Any, **ufunc: Any) -> np.ndarray:
        """c_ijk, the Christoffel symbols of the first kind.

        Args:
            q: (..., n); parameters: (..., 10 bodies)
        Returns: (..., n, n, n), as Robot.christoffel
        """

    @quantity
    def gravity(self, q: Any, parameters: Any, **ufunc: Any) -> np.ndarray:
        """g(q).

        Args:
            q: (..., n); parameters: (..., 10 bodies)
        Returns: (..., n), as Robot.gravity
        """

    @quantity
    def gravity_gradient(self, q: Any, parameters: Any, **ufunc: Any) -> np.ndarray:
        """∂g_i/∂q_j.

        Args:
            q: (..., n); parameters: (..., 10 bodies)
        Returns: (..., n, n), as Robot.gravity_gradient
        """

    @quantity
    def inverse_dynamics(
        self, q: Any, qd: Any, qdd: Any, parameters: Any, **ufunc: Any
    ) -> np.ndarray:
        """Joint efforts that produce the accelerations qdd.

        Args:
            q, qd, qdd: (..., n); parameters: (..., 10 bodies)
        Returns: (..., n), as Robot.inverse_dynamics
        """

    @quantity
    def forward_dynamics(
        self, q: Any, qd: Any, tau: Any, parameters: Any, **ufunc: Any
    ) -> np.ndarray:
        """Accelerations that the joint efforts tau cause.

        Args:
            q, qd, tau: (..., n); parameters: (..., 10 bodies)
        Returns: (..., n), as Robot.forward_dynamics
        """

    @quantity
    def kinetic_energy(self, q: Any, qd: Any, parameters: Any, **ufunc: Any) -> np.ndarray:
        """T = ½ qdᵀ M(q) qd.

        Args:
            q, qd: (..., n); parameters: (..., 10 bodies)
        Returns: (...), as Robot.kinetic_energy
        """

    @quantity
    def potential_energy(self, q: Any, parameters: Any, **ufunc: Any) -> np.ndarray:
        """P(q) = −Σ m gravity_vector · CoM over the bodies.

        Args:
            q: (..., n); parameters: (..., 10 bodies)
        Returns: (...), as Robot.potential_energy
        """

    @quantities(Terms)
    def terms(self, q: Any, qd: Any, parameters: Any, **ufunc: Any) -> Terms:
        """M(q), C(q, qd) qd and g(q) from one kernel.

        Args:
            q, qd: (..., n); parameters: (..., 10 bodies)
        Returns: a named tuple (M, Cqd, g) of (..., n, n), (..., n), (..., n), as Robot.terms
        """

    @quantities(InverseDerivatives)
    def inverse_dynamics_derivatives(
        self, q: Any, qd: Any, qdd: Any, parameters: Any, **ufunc: Any
    ) -> InverseDerivatives:
        """How the efforts of inverse dynamics change with q, qd and qdd.

        Args:
            q, qd, qdd: (..., n); parameters: (..., 10 bodies)
        Returns: a named tuple (dtau_dq, dtau_dqd, M) of (..., n, n) each, as
            Robot.inverse_dynamics_derivatives
        """

    @quantities(ForwardDerivatives)
    def forward_dynamics_derivatives(
        self, q: Any, qd: Any, tau: Any, parameters: Any, **ufunc: Any
    ) -> ForwardDerivatives:
        """How the accelerations that tau causes change with q, qd and tau.

        Args:
            q, qd, tau: (..., n); parameters: (..., 10 bodies)
        Returns: a named tuple (dqdd_dq, dqdd_dqd, Minv) of (..., n, n) each, as
            Robot.forward_dynamics_derivatives
        """
