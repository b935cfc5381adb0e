"""The robot a user holds: its description, and the terms of its equation of motion.

M(q) qdd + C(q, qd) qd + g(q) = tau

Longer than other files for its docstrings: this is where users read what each name means.
"""

from __future__ import annotations

import dataclasses
import math
import os
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np

from mcgee import validate
from mcgee.algorithms.parameters import inertial_parameters
from mcgee.build import operation_counts
from mcgee.kernels import bound, quantities, quantity, refuse_symbols
from mcgee.mechanism import GROUND, Mechanism, depth_first, reduce, root_of
from mcgee.model import Frame, Joint, Link, Vec3, is_number, map_numbers
from mcgee.scalar import Scalar, plain

if TYPE_CHECKING:
    from mcgee.closed_form import ClosedForm
    from mcgee.codegen import Package
    from mcgee.explain import Explanation
    from mcgee.parametric import Parametric

EARTH: Vec3 = (0.0, 0.0, -9.81)


class Limits(NamedTuple):
    """Of each joint, (n,) each; infinite where the description sets none."""

    lower: np.ndarray
    upper: np.ndarray
    velocity: np.ndarray
    effort: np.ndarray


class Terms(NamedTuple):
    """M (..., n, n), C qd (..., n) and g (..., n) of one state or a batch."""

    M: np.ndarray
    Cqd: np.ndarray
    g: np.ndarray


class InverseDerivatives(NamedTuple):
    """∂tau/∂q, ∂tau/∂qd and ∂tau/∂qdd = M, (..., n, n) each; row i belongs to tau_i."""

    dtau_dq: np.ndarray
    dtau_dqd: np.ndarray
    M: np.ndarray


class ForwardDerivatives(NamedTuple):
    """∂qdd/∂q, ∂qdd/∂qd and ∂qdd/∂tau = M⁻¹, (..., n, n) each; row i belongs to qdd_i."""

    dqdd_dq: np.ndarray
    dqdd_dqd: np.ndarray
    Minv: np.ndarray


@dataclass(frozen=True, repr=False)
class Robot:
    """A tree of links on a fixed base. Immutable; made by `load`, `from_dh` or `mcgee.arms`.

    Arrays are float64 in SI units, leading dimensions broadcast, and n is the number of
    independent joints. Every quantity is a NumPy gufunc: lists are accepted, out= is filled, a row
    with a NaN among its inputs gives NaN. Joint friction is kept as data and is no part of the
    equation of motion; armature is part of M.
    """

    name: str
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
    frames: tuple[Frame, ...] = ()
    gravity_vector: Vec3 = EARTH
    warnings: tuple[str, ...] = field(default=(), compare=False)
    made_by: tuple[str, tuple[tuple[str, Any], ...]] | None = field(default=None, compare=False)
    """The function of `mcgee.arms` that made it or what it was changed from, and its arguments."""

    parametric: ClassVar[bool] = False
    """Whether the inertial parameters are an argument; see `with_parameters`."""

    def __post_init__(self) -> None:
        validate.check(self.name, self.links, self.joints, self.frames, self.gravity_vector)

    # -- what it is -------------------------------------------------------------------------------

    @cached_property
    def mechanism(self) -> Mechanism:
        """The robot as the algorithms see it: fixed joints merged, every axis a z axis."""
        return reduce(self.links, self.joints, self.frames, self.gravity_vector)

    @cached_property
    def independent_joints(self) -> tuple[Joint, ...]:
        """The joints whose positions are q, in q's order: depth first."""
        return tuple(
            joint
            for joint in depth_first(self.links, self.joints)
            if joint.moves and joint.mimic is None
        )

    @property
    def n(self) -> int:
        """The number of independent joints."""
        return len(self.independent_joints)

    @property
    def joint_names(self) -> tuple[str, ...]:
        return tuple(joint.name for joint in self.independent_joints)

    @property
    def root(self) -> str:
        """The link that stands still; its frame is the root frame."""
        return root_of(self.links, self.joints)

    @property
    def moving_links(self) -> tuple[str, ...]:
        """The links that have an inertia and move."""
        return tuple(mass.link for mass in self.mechanism.masses)

    @property
    def link_names(self) -> tuple[str, ...]:
        return tuple(link.name for link in self.links)

    @property
    def frame_names(self) -> tuple[str, ...]:
        """What `forward_kinematics` and `jacobian` know: every link's frame, and named frames."""
        return tuple(self.mechanism.frames)

    @cached_property
    def end_frame(self) -> str:
        """The frame with the most moving joints between it and the base, the last one of equals."""

        def depth(name: str) -> int:
            body, joints = self.mechanism.frames[name][0], 0
            while body != GROUND:
                body, joints = self.mechanism.bodies[body].parent, joints + 1
            return joints

        return max(reversed(self.frame_names), key=depth)

    @cached_property
    def limits(self) -> Limits:
        """Lower and upper positions [rad | m], speeds [rad/s | m/s] and efforts [N·m | N]."""
        columns = (
            [getattr(joint, what) for joint in self.independent_joints] for what in Limits._fields
        )
        arrays = [np.array(column, float) for column in columns]
        for array in arrays:
            array.flags.writeable = False
        return Limits(*arrays)

    @cached_property
    def symbols(self) -> tuple[str, ...]:
        """The names of parameters that are still symbols; kernels want numbers."""
        found: set[str] = set()

        def collect(x: Any) -> Any:
            found.update(str(symbol) for symbol in getattr(x, "free_symbols", ()))
            return x

        map_numbers((self.links, self.joints, self.frames, self.gravity_vector), collect)
        return tuple(sorted(found))

    def __repr__(self) -> str:
        kinds = Counter(joint.kind for joint in self.independent_joints)
        joints = ", ".join(f"{count} {kind}" for kind, count in kinds.items())
        mass = sum(m.inertia.mass for m in self.mechanism.masses)
        weight = f"{mass:.4g} kg" if is_number(mass) else f"{mass} kg"
        field_ = ", ".join(f"{v:g}" if is_number(v) else str(v) for v in self.gravity_vector)
        return (
            f"Robot '{self.name}': {joints} joint{'s' if self.n > 1 else ''}, {weight} moving, "
            f"gravity ({field_}) m/s², end frame '{self.end_frame}'"
        )

    def __str__(self) -> str:
        width = max(len(name) for name in self.joint_names)
        lines = [repr(self)]
        for joint in self.independent_joints:
            unit = "m" if joint.kind == "prismatic" else "rad"
            span = "unlimited"
            if math.isfinite(joint.lower) or math.isfinite(joint.upper):
                span = f"{joint.lower:.4g} to {joint.upper:.4g} {unit}"
            lines.append(f"  {joint.name:<{width}}  {joint.kind:<10}  {span}")
        return "\n".join(lines)

    def __getstate__(self) -> dict[str, Any]:
        return {field.name: getattr(self, field.name) for field in dataclasses.fields(self)}

    # -- changed copies ---------------------------------------------------------------------------

    def replace(
        self,
        *,
        name: str | None = None,
        gravity_vector: Sequence[Scalar] | None = None,
        armature: Mapping[str, Scalar] | None = None,
        viscous: Mapping[str, Scalar] | None = None,
        coulomb: Mapping[str, Scalar] | None = None,
    ) -> Robot:
        """A changed copy.

        Args:
            gravity_vector: the field in the root frame (3,) [m/s²]
            armature, viscous, coulomb: by joint name, for the joints to change
        Raises: ValueError: a joint that does not exist
        """
        joints = self.joints
        for what, values in (("armature", armature), ("viscous", viscous), ("coulomb", coulomb)):
            if values is not None:
                joints = self._with(joints, what, values)
        field_ = self.gravity_vector
        if gravity_vector is not None:
            if (
                isinstance(gravity_vector, str)
                or len(np.shape(gravity_vector)) != 1
                or len(gravity_vector) != 3
            ):
                raise ValueError(
                    f"gravity_vector is {gravity_vector!r}, expected 3 numbers [m/s²]."
                )
            x, y, z = (plain(v, "gravity_vector") for v in gravity_vector)
            field_ = (x, y, z)
        return dataclasses.replace(
            self,
            name=self.name if name is None else name,
            gravity_vector=field_,
            joints=joints,
        )

    def _with(
        self, joints: tuple[Joint, ...], what: str, values: Mapping[str, Scalar]
    ) -> tuple[Joint, ...]:
        """The joints with one of their numbers changed, by joint name."""
        if not isinstance(values, Mapping):
            raise ValueError(f"{what} is {values!r}, expected a mapping from joint names.")
        moving = [joint.name for joint in joints if joint.moves]
        for name in values:
            if name not in moving:
                raise ValueError(
                    f"{what} names joint '{name}', which robot '{self.name}' has not among its "
                    f"moving joints: {', '.join(moving)}."
                )
        numbers = {name: plain(v, f"{what} of joint '{name}'") for name, v in values.items()}
        return tuple(
            dataclasses.replace(joint, place="", **{what: numbers[joint.name]})
            if joint.name in numbers
            else joint
            for joint in joints
        )

    def subs(self, values: Mapping[Any, Scalar]) -> Robot:
        """A copy with symbolic parameters replaced by numbers or SymPy expressions.

        Args:
            values: by symbol or by symbol name
        Raises: ValueError: a name that is no symbol of this robot
        """
        if not isinstance(values, Mapping):
            raise ValueError(f"subs takes a mapping from symbols to numbers, got {values!r}.")
        named = {str(s): plain(value, f"symbol '{s}'") for s, value in values.items()}
        for name in named:
            if name not in self.symbols:
                known = ", ".join(self.symbols) or "none; all its parameters are numbers"
                raise ValueError(
                    f"robot '{self.name}' has no symbol '{name}'. Its symbols: {known}."
                )

        def put(x: Any) -> Any:
            if not hasattr(x, "free_symbols"):
                return x
            put_in = [(s, named[str(s)]) for s in x.free_symbols if str(s) in named]
            return plain(x.subs(put_in, simultaneous=True), "a parameter")

        fields = ("links", "joints", "frames", "gravity_vector")
        return dataclasses.replace(self, **{f: map_numbers(getattr(self, f), put) for f in fields})

    # -- the equation of motion -------------------------------------------------------------------

    @quantity
    def mass_matrix(self, q: Any, **ufunc: Any) -> np.ndarray:
        """M(q), the inertia matrix.

        Args:
            q: joint positions (..., n) [rad | m]
        Returns: (..., n, n) [kg·m², kg·m, kg], symmetric; positive definite when every joint moves
            something physical
        Raises: ValueError: the last dimension is not n
        Equals: ∂²T/∂qd∂qd, and column j of it inverse_dynamics(q, 0, e_j) − gravity(q)
        Source: Walker & Orin 1982; Featherstone 2008, table 6.2
        """

    @quantity
    def mass_matrix_inverse(self, q: Any, **ufunc: Any) -> np.ndarray:
        """M(q)⁻¹: the accelerations that unit efforts cause.

        Args:
            q: joint positions (..., n) [rad | m]
        Returns: (..., n, n), symmetric
        Source: LᵀDL factors from the leaves, Featherstone 2008, section 6.5
        """

    @quantity
    def coriolis(self, q: Any, qd: Any, **ufunc: Any) -> np.ndarray:
        """C(q, qd) qd: centrifugal and Coriolis efforts.

        Args:
            q, qd: joint positions and velocities (..., n) [rad | m], [rad/s | m/s]
        Returns: (..., n) [N·m | N]
        Equals: coriolis_matrix(q, qd) @ qd
        """

    @quantity
    def coriolis_matrix(self, q: Any, qd: Any, **ufunc: Any) -> np.ndarray:
        """C(q, qd) by the Christoffel symbols, so that Ṁ − 2C is skew-symmetric.

        Args:
            q, qd: joint positions and velocities (..., n)
        Returns: (..., n, n), C_ij = Σ_k c_ijk qd_k
        Source: Echeandia & Wensing 2021, algorithm 1. Cost: O(n²)
        """

    @quantity
    def coriolis_product(self, q: Any, qd: Any, v: Any, **ufunc: Any) -> np.ndarray:
        """C(q, qd) v for a second velocity v, as passivity-based control needs it.

        Args:
            q, qd, v: (..., n)
        Returns: (..., n)
        Equals: coriolis_matrix(q, qd) @ v, and C(q, v) qd: the symbols are symmetric
        Cost: O(n)
        """

    @quantity
    def christoffel(self, q: Any, **ufunc: Any) -> np.ndarray:
        """c_ijk = ½(∂M_ij/∂q_k + ∂M_ik/∂q_j − ∂M_jk/∂q_i), symbols of the first kind.

        Args:
            q: joint positions (..., n)
        Returns: (..., n, n, n), symmetric in j and k
        Source: Echeandia & Wensing 2021, algorithm 2
        """

    @quantity
    def gravity(self, q: Any, **ufunc: Any) -> np.ndarray:
        """g(q): the efforts that hold the arm still.

        Args:
            q: joint positions (..., n)
        Returns: (..., n) [N·m | N]
        Equals: ∂P/∂q, and inverse_dynamics(q, 0, 0)
        """

    @quantity
    def gravity_gradient(self, q: Any, **ufunc: Any) -> np.ndarray:
        """∂g_i/∂q_j = ∂²P/∂q_i∂q_j: how fast the holding efforts change.

        Args:
            q: joint positions (..., n)
        Returns: (..., n, n) [N·m/rad, N/m], symmetric
        """

    @quantity
    def inverse_dynamics(self, q: Any, qd: Any, qdd: Any, **ufunc: Any) -> np.ndarray:
        """Joint efforts that produce the accelerations qdd.

        Args:
            q, qd, qdd: joint positions, velocities, accelerations (..., n)
        Returns: (..., n) [N·m | N]
        Equals: mass_matrix(q) @ qdd + coriolis(q, qd) + gravity(q)
        Source: Luh, Walker & Paul 1980; Featherstone 2008, table 5.1. Cost: O(n)
        """

    @quantity
    def forward_dynamics(self, q: Any, qd: Any, tau: Any, **ufunc: Any) -> np.ndarray:
        """Accelerations that the joint efforts tau cause.

        Args:
            q, qd: joint positions and velocities (..., n); tau: efforts (..., n) [N·m | N]
        Returns: (..., n) [rad/s² | m/s²]
        Equals: mass_matrix_inverse(q) @ (tau − coriolis(q, qd) − gravity(q))
        Source: Featherstone 1983 and 2008, table 7.1, cost O(n); or LᵀDL factors of M where that
            takes fewer operations, as it does for most arms, and with mimic joints
        """

    @quantities(InverseDerivatives)
    def inverse_dynamics_derivatives(
        self, q: Any, qd: Any, qdd: Any, **ufunc: Any
    ) -> InverseDerivatives:
        """How the efforts of inverse dynamics change with q, qd and qdd, to first order.

        Args:
            q, qd, qdd: joint positions, velocities, accelerations (..., n)
        Returns: a named tuple (dtau_dq, dtau_dqd, M) of (..., n, n) each, [i, j] = ∂tau_i/∂x_j
            [N·m/rad, N·m·s/rad, kg·m², and so on]
        Raises: ValueError: a last dimension is not n
        Equals: dtau_dqd = 2 coriolis_matrix(q, qd); M = mass_matrix(q)
        Source: Singh, Russell & Wensing 2022, cost O(n²); or the chain rule on the graph of tau
            where that leaves fewer operations, as it does for a UR5 and not for a Panda
        """

    @quantities(ForwardDerivatives)
    def forward_dynamics_derivatives(
        self, q: Any, qd: Any, tau: Any, **ufunc: Any
    ) -> ForwardDerivatives:
        """How the accelerations that tau causes change with q, qd and tau, to first order.

        Args:
            q, qd: joint positions and velocities (..., n); tau: efforts (..., n) [N·m | N]
        Returns: a named tuple (dqdd_dq, dqdd_dqd, Minv) of (..., n, n) each,
            [i, j] = ∂qdd_i/∂x_j [1/s², 1/s, 1/(kg·m²), and so on]
        Raises: ValueError: a last dimension is not n
        Equals: −M⁻¹ dtau_dq, −M⁻¹ dtau_dqd and M⁻¹, dtau_dq at the qdd that tau causes
        Source: Carpentier & Mansard 2018; Singh, Russell & Wensing 2022. Cost: O(n³) by its
            products with M⁻¹
        """

    @quantity
    def regressor(self, q: Any, qd: Any, qdd: Any, **ufunc: Any) -> np.ndarray:
        """Y, by which inverse dynamics is linear in the links' inertial parameters.

        Args:
            q, qd, qdd: joint positions, velocities, accelerations (..., n)
        Returns: (..., n, 10 bodies), columns in the order of `inertial_parameters`; the bodies
            are the joints that move, n where none mimics another
        Raises: ValueError: a last dimension is not n
        Equals: Y @ inertial_parameters = inverse_dynamics(q, qd, qdd), less armature * qdd for
            joints that have a rotor
        Source: Atkeson, An & Hollerbach 1986. Cost: O(n²)
        """

    @cached_property
    def inertial_parameters(self) -> np.ndarray:
        """m, m cx, m cy, m cz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz of the link of each moving joint.

        About the origin and in the axes of that link's frame, each link together with all that
        is fixed to it [kg, kg·m, kg·m²]. Armature is no part of them.

        Returns: (10 bodies,), read-only; of expressions while the robot has symbols
        """
        kind = object if self.symbols else float
        parameters = np.array(inertial_parameters(self.mechanism), kind)
        parameters.flags.writeable = False
        return parameters

    def with_parameters(self) -> Parametric:
        """The dynamics with the inertial parameters as a last argument, for identification.

        Returns: an object whose mass_matrix, inverse_dynamics, … take `parameters`
            (..., 10 bodies) after their other arrays, ordered as `inertial_parameters`
        """
        from mcgee.parametric import Parametric

        return Parametric(self)

    def operation_counts(self, *names: str) -> dict[str, dict[str, int]]:
        """What one evaluation of each quantity costs, after all simplifications.

        Args:
            names: of the quantities wanted; all of them, where none is named
        Returns: by quantity, the numbers of additions ("add", subtractions among them),
            multiplications ("mul"), divisions ("div"), sign changes ("neg") and sine-cosine pairs
            ("sincos"); with fused multiply-adds, how many those are ("fma") and how many
            instructions they and the first four come to ("instructions"). Frame quantities are
            counted at `end_frame`, and what needs M⁻¹ only where M has an inverse
        Raises: ValueError: the robot still has symbols, or a name is of no quantity
        """
        refuse_symbols(self, "operation counts")
        return operation_counts(self.mechanism, self.end_frame, names)

    @quantity
    def kinetic_energy(self, q: Any, qd: Any, **ufunc: Any) -> np.ndarray:
        """T = ½ qdᵀ M(q) qd.

        Args:
            q, qd: joint positions and velocities (..., n)
        Returns: (...) [J]
        """

    @quantity
    def potential_energy(self, q: Any, **ufunc: Any) -> np.ndarray:
        """P(q) = −Σ m_k gravity_vector · CoM_k over the moving links.

        Args:
            q: joint positions (..., n)
        Returns: (...) [J], zero at the height of the root frame's origin
        """

    @quantities(Terms)
    def terms(self, q: Any, qd: Any, **ufunc: Any) -> Terms:
        """M(q), C(q, qd) qd and g(q) from one kernel.

        Args:
            q, qd: joint positions and velocities (..., n)
        Returns: a named tuple (M, Cqd, g) of (..., n, n), (..., n), (..., n)
        """

    def forward_kinematics(self, q: Any, frame: str | None = None, **ufunc: Any) -> np.ndarray:
        """The pose of a frame in the root frame.

        Args:
            q: joint positions (..., n)
            frame: one of `frame_names`; `end_frame` by default
        Returns: homogeneous matrices (..., 4, 4), translations in m
        Raises: ValueError: an unknown frame
        """
        return bound(self, "forward_kinematics", self._frame(frame))(q, **ufunc)

    def jacobian(self, q: Any, frame: str | None = None, **ufunc: Any) -> np.ndarray:
        """From joint velocities to a frame's velocity: linear rows first, then angular.

        Args:
            q: joint positions (..., n)
            frame: one of `frame_names`; `end_frame` by default
        Returns: (..., 6, n), in the root frame's axes, at the frame's origin
        Raises: ValueError: an unknown frame
        """
        return bound(self, "jacobian", self._frame(frame))(q, **ufunc)

    @quantity
    def link_poses(self, q: Any, **ufunc: Any) -> np.ndarray:
        """Where each link of `moving_links` is: its body's axes, at its centre of mass.

        Args:
            q: joint positions (..., n)
        Returns: homogeneous matrices (..., links, 4, 4) in the root frame
        """

    @quantity
    def link_jacobians(self, q: Any, **ufunc: Any) -> np.ndarray:
        """Jv over Jω of each link of `moving_links`, at its centre of mass.

        Args:
            q: joint positions (..., n)
        Returns: (..., links, 6, n), linear rows first, in the root frame's axes
        """

    @quantity
    def link_accelerations(self, q: Any, qd: Any, qdd: Any, **ufunc: Any) -> np.ndarray:
        """How each link of `moving_links` accelerates, gravity not counted.

        Args:
            q, qd, qdd: joint positions, velocities, accelerations (..., n)
        Returns: (..., links, 6): of the centre of mass [m/s²], then angular [rad/s²], root axes
        """

    # -- what it means ----------------------------------------------------------------------------

    def explain(
        self, q: Any, qd: Any = None, qdd: Any = None, *, frame: str | None = None
    ) -> Explanation:
        """What M, C and g mean in one state, in figures, words and pictures.

        Args:
            q: joint positions (n,) [rad | m]
            qd, qdd: joint velocities and accelerations (n,), zero by default
            frame: where a hand would push, one of `frame_names`; `end_frame` by default
        Returns: an Explanation: print() it, .to_dict(), .to_html(path)
        Raises: ValueError: a wrong shape, numbers that are not finite, an unknown frame
        """
        from mcgee.explain import explain

        return explain(self, q, qd, qdd, self._frame(frame))

    def closed_form(
        self, *, symbolic_inertias: bool = False, simplify: str = "expanded"
    ) -> ClosedForm:
        """T, P, M, C, g and tau as exact formulas, for numbers and for symbolic parameters.

        Args:
            symbolic_inertias: put symbols in the place of all inertial parameters, ten for each
                moving body in the order of `inertial_parameters`: m1, hx1 = m1 cx1, …, Izz1
            simplify: 'expanded', 'collected' by configuration, or 'lumped', where each
                combination of parameters has a name
        Returns: a ClosedForm: .M .C .Cqd .g .T .P, .prove(), .base_parameters(), .latex()
        Raises: ValueError: an unknown simplify; a parameter that is no polynomial in symbols and
            cosines and sines of symbols; a symbol with a name that the formulas need
        Source: the algorithms of this class on polynomials; see mcgee.closed_form.ring
        """
        from mcgee.closed_form import closed_form

        return closed_form(self, symbolic_inertias, simplify)

    def codegen(
        self,
        target: str,
        directory: str | os.PathLike[str],
        functions: Sequence[str] = ("terms",),
        *,
        params: bool = False,
        values: Mapping[Any, float] | None = None,
        frame: str | None = None,
        single: bool = False,
        overwrite: bool = False,
        verify: bool = False,
    ) -> Package:
        """Write a package of code in another language, with vectors and a self-test.

        Args:
            target: 'python', 'c', 'cpp', 'java', 'matlab', 'simulink', 'fmu', 'wolfram' or
                'javascript'
            directory: the package's folder, made whole or not at all
            functions: names of quantities; 'terms' becomes NAME_dynamics, which gives M, C qd and g
            params: leave parameters open: the symbols of the description, those of a textbook
                arm's function, or else ten inertial parameters a body. Otherwise the numbers are
                folded in
            values: defaults of parameters, by name; needed for symbols
            frame: for forward_kinematics and jacobian, one of `frame_names`; `end_frame` by default
            single: float in the place of double, for C and C++
            overwrite: write into a folder that is not empty; what is not generated stays there
            verify: compile the package with warnings as errors, run it in its own toolchain, and
                write how far off it was into VERIFIED.md
        Returns: a Package: .folder, .files, .verification
        Raises: ValueError: an unknown target, function, frame or parameter, a symbol without a
            value, a folder that is in use or cannot be written.
            mcgee.codegen.VerificationError: the code is refused or wrong; nothing is written
        """
        from mcgee.codegen import codegen

        return codegen(
            self,
            target,
            directory,
            functions,
            params=params,
            values=values,
            frame=self._frame(frame),
            single=single,
            overwrite=overwrite,
            verified=verify,
        )

    def _frame(self, frame: str | None) -> str:
        name = self.end_frame if frame is None else frame
        if not isinstance(name, str) or name not in self.mechanism.frames:
            raise ValueError(
                f"frame is {frame!r}, which robot '{self.name}' has not. "
                f"Frames: {', '.join(self.frame_names)}."
            )
        return name
