"""The page's sections: sentences beside the pictures they speak of, then the numbers."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from mcgee.explain import armplot, forces, maps, plots, sentences, tables
from mcgee.explain.live import Live
from mcgee.explain.look import short_names
from mcgee.typeset import number

if TYPE_CHECKING:
    from mcgee.explain.explanation import Explanation

TOLD = 3
"""Sentences of one kind that stand open; the rest unfold."""
UNFOLDED = 8
"""Rows up to which a long table stands open."""


@dataclass
class Page:
    """One page while it is written; `figures` collects what its script draws."""

    e: Explanation
    figures: dict[str, Any] = field(default_factory=dict)

    @cached_property
    def live(self) -> Live:
        return Live(self.e)

    def body(self) -> str:
        parts = (
            ("conventions", "Conventions", self.conventions()),
            ("arm-section", "The arm, one joint at a time", self.arm()),
            ("inertia", "Inertia: M(q)", self.inertia()),
            ("workspace", "Over two joints", self.workspace()),
            ("velocity", "Velocity: C(q, qd) qd", self.velocity()),
            ("gravity", "Gravity: g(q)", self.gravity()),
            ("notes", "How this page was made", self.notes()),
        )
        made = [(name, title, text) for name, title, text in parts if text]
        links = "".join(f'<a href="#{name}">{escape(title)}</a>' for name, title, _ in made)
        sections = "".join(
            f'<section id="{name}"><h2>{escape(title)}</h2>{text}</section>'
            for name, title, text in made
        )
        return (
            f"<header><h1>{escape(self.e.robot.name)} explained</h1>"
            f'<nav aria-label="Sections">{links}</nav></header>'
            "<noscript><p>The pictures need JavaScript; words and numbers do not.</p></noscript>"
            f"<main>{sections}</main>"
        )

    # -- pieces -----------------------------------------------------------------------------------

    def plot(self, name: str, picture: Any, title: str, caption: str) -> str:
        """A figure with its title and caption; why there is none, where there is none."""
        made = picture.to_plotly_json()
        made["layout"].pop("template", None)
        if not made["data"]:
            words = escape(made["layout"]["annotations"][0]["text"])
            return f'<div><h3>{escape(title)}</h3><p class="empty">{words}</p></div>'
        self.figures[name] = made
        height = made["layout"]["height"]
        return (
            f'<figure><h3>{escape(title)}</h3><div class="plot" id="{name}" data-figure="{name}" '
            f'style="height:{height}px" role="img" aria-label="{escape(f"{title}. {caption}")}">'
            f"</div><figcaption>{escape(caption)}</figcaption></figure>"
        )

    def told(self, lines: Iterable[str], first: str = "") -> str:
        """Sentences: those that begin with the words given first, a few open, the rest folded."""
        ranked = sorted(lines, key=lambda line: not (first and line.startswith(first)))
        # what speaks of single joints is long for long arms; what speaks of the whole is not
        each = [s for s in ranked if s.startswith(("With the other", "Holding "))]
        folded = each[TOLD:] if len(each) > TOLD + 1 else []
        shown = [s for s in ranked if s not in folded]
        return _list(shown) + (
            f"<details><summary>{len(folded)} more joints</summary>{_list(folded)}</details>"
            if folded
            else ""
        )

    # -- sections ---------------------------------------------------------------------------------

    def conventions(self) -> str:
        names = self.e.robot.joint_names
        lines = list(self.e.conventions.lines())
        if short_names(names) != names:
            lines.append("Pictures leave off the words that all joint names begin or end with.")
        return _list(lines) + self.folded("The state, joint by joint", tables.state(self.e))

    def folded(self, title: str, text: str, rows: int | None = None) -> str:
        count = self.e.robot.n if rows is None else rows
        if count <= UNFOLDED:
            return text
        return f"<details><summary>{escape(title)}</summary>{text}</details>"

    def arm(self) -> str:
        e, movable = self.e, self.live.movable
        arm = armplot.arm(e, self.live.room)
        told = list(sentences.task_sentences(e.task))
        if e.is_skater:
            told.insert(0, sentences.skater_sentence(e.conventions, e.felt))
        pictures = [self.plot("arm", arm, "The arm", self.arm_caption())]
        pictures += self.moving() if movable else [tables.task(e)]
        controls = self.controls() if movable else ""
        return f"{_list(told)}{controls}<div class='grid'>{''.join(pictures)}</div>"

    def moving(self) -> list[str]:
        e, room = self.e, self.live.room
        return [
            self.plot(
                "M",
                plots.mass_matrix(e, 430),
                "M at the slider's pose",
                "Efforts on every joint (rows) that a unit acceleration of one joint (columns) "
                "takes. Blue is negative, orange positive.",
            ),
            self.plot(
                "curves",
                maps.curves(e, self.first_sweep, 0),
                "What the joint looked at feels and holds",
                "While the moved joint goes over its range. Dotted: the slider's pose.",
            ),
            "<div>"
            + self.plot(
                "holding",
                forces.holding(e, room),
                "Holding efforts at the slider's pose",
                "What every joint must hold against gravity.",
            )
            + f"{tables.task(e)}</div>",
        ]

    @cached_property
    def first_sweep(self) -> Any:
        """The skater's, if it has a range to sweep."""
        names = self.e.robot.joint_names
        if names.index(self.e.skater.joints[0]) in self.live.movable:
            return self.e.skater
        return self.e.sweeps[self.live.movable[0]]

    def arm_caption(self) -> str:
        e, finite = self.e, self.e.task.masses[np.isfinite(self.e.task.masses)]
        shape = "ellipse" if len(finite) < 3 else "ellipsoid"
        said = "Dots: centres of mass, their areas as the masses. "
        said += "Grey: the explained pose, once a joint moves. "
        if len(finite):
            said += (
                f"Pink {shape}: the mobility of frame '{e.task.frame}', how much a push of 1 N "
                f"accelerates it each way; at the explained pose {number(1 / finite[0])} m/s² "
                f"along its longest axis (effective mass {number(finite[0])} kg), "
                f"{number(1 / finite[-1])} along its shortest ({number(finite[-1])} kg)."
            )
        return said

    def controls(self) -> str:
        names, chosen = self.e.robot.joint_names, self.first_sweep.joints[0]
        movable = [(i, names[i]) for i in self.live.movable]
        looked = list(enumerate(names))
        k = names.index(chosen)
        return (
            '<div class="controls" role="group" aria-label="Move one joint">'
            f"<label>Move {_select('joint', movable, k)}</label>"
            f"<label>Look at {_select('look', looked, 0)}</label>"
            '<button type="button" id="back">Back to the explained pose</button>'
            '<button type="button" id="least">Least inertia</button>'
            '<button type="button" id="most">Most inertia</button></div>'
            '<div class="controls sticky"><label class="slide"><input type="range" id="position" '
            'min="0" max="1" value="0" step="1" aria-label="Position of the joint">'
            '<output id="where"></output></label><p id="said" aria-live="polite"></p></div>'
        )

    def inertia(self) -> str:
        e, n = self.e, self.e.robot.n
        hardest = e.robot.joint_names[int(e.inertia.hidden.argmax())]
        told = self.told(
            sentences.inertia_sentences(e.conventions, e.inertia),
            f"With the other joints locked, {hardest} ",
        )
        mass = self.plot(
            "mass",
            plots.mass_matrix(e),
            "M at the explained pose",
            "Column j: the efforts on all joints if joint j alone accelerates by 1. On the "
            "diagonal: what each joint feels with the others locked.",
        )
        pictures = [
            self.plot(
                "coupling",
                plots.coupling(e),
                "Coupling",
                "M_ij/√(M_ii M_jj): 0 for two joints that leave each other alone, near ±1 for two "
                "that drag each other along.",
            ),
            self.plot(
                "shares",
                plots.link_shares(e),
                "Which links make M_ii",
                "Each link's share of what a joint feels with the others locked. Plain: by moving "
                "(m Jvᵀ Jv). Hatched: by turning (Jωᵀ I Jω).",
            ),
        ]
        written = [tables.principal(e)]
        if n <= tables.WRITTEN:
            written.append(tables.mass_matrix(e))
        return (
            f'<div class="grid text"><div>{told}</div>{mass}</div>'
            f"{self.folded('What each joint feels', tables.inertia(e))}"
            f'<div class="grid">{"".join(pictures)}</div>{self.entry()}'
            f"<details><summary>M and its principal inertias in numbers</summary>"
            f"{''.join(written)}</details>"
        )

    def entry(self) -> str:
        """The picture of one entry of M, with its selectors."""
        names = list(enumerate(self.e.robot.joint_names))
        last = min(1, len(names) - 1)
        picture = self.plot(
            "entry",
            plots.entry_by_link(self.e, 0, last),
            "One entry of M, link by link",
            "What each link adds to the entry chosen.",
        )
        rows, columns = _select("row", names, 0), _select("column", names, last)
        controls = (
            '<div class="controls" role="group" aria-label="Entry of M">'
            f"<label>Row {rows}</label><label>column {columns}</label></div>"
        )
        return f"<div>{controls}{picture}</div>"

    def workspace(self) -> str:
        e, pairs, names = self.e, self.live.pairs(), self.e.robot.joint_names
        if not pairs:
            return ""
        first, looked = self.live.most_telling()
        a, b = pairs[first]
        s, i = self.live.sweep_of(a, b), self.live.shown[looked]
        pairs_named = [(k, f"{names[a]}, {names[b]}") for k, (a, b) in enumerate(pairs)]
        wanted: list[tuple[Any, str]] = [
            (f"felt:{k}", f"inertia felt by {names[i]}") for k, i in enumerate(self.live.shown)
        ]
        wanted += [
            (f"g:{k}", f"holding effort of {names[i]}") for k, i in enumerate(self.live.shown)
        ]
        wanted.append(("condition", "condition number of M"))
        picture = self.plot(
            "map",
            maps.plane(e, s, s.M[..., i, i], ""),
            "Over the ranges of two joints",
            "The other joints stay where the explained pose has them.",
        )
        controls = (
            '<div class="controls" role="group" aria-label="Map">'
            f"<label>Joints {_select('pair', pairs_named, first)}</label>"
            f"<label>Show {_select('quantity', wanted, f'felt:{looked}')}</label></div>"
        )
        words = '<p id="extremes" aria-live="polite"></p>'
        return f'<div class="grid text"><div>{controls}{words}</div>{picture}</div>'

    def velocity(self) -> str:
        e = self.e
        told = self.told(sentences.velocity_sentences(e.conventions, e.velocity))
        if not e.velocity.kinetic_energy > 0:
            return told + '<p class="empty">Give velocities qd to see power flow.</p>'
        terms = self.plot(
            "terms",
            forces.velocity_terms(e),
            "Centrifugal and Coriolis efforts",
            "Plain: a joint's own speed squared. Hatched: two joints moving together.",
        )
        flows = [
            self.plot(
                "flow",
                forces.power_flow(e),
                "Power that these forces carry",
                "From joints that give to joints that take; none is made or lost. "
                "Flows under 1 % of the largest are left out.",
            ),
            self.plot(
                "budget",
                forces.energy_budget(e),
                "Power budget of the bodies",
                "Bodies by the joint that moves them. Grey bands: from body to body. "
                "Flows under 1 % of the largest are left out.",
            ),
        ]
        more = tables.kinetic(e) + tables.energy(e)
        return (
            f'<div class="grid text"><div>{told}</div>{terms}</div>'
            f"{self.folded('Velocity terms', tables.velocity(e))}"
            f'<div class="grid">{"".join(flows)}</div>'
            f"<details><summary>Kinetic energy and power budget in numbers</summary>"
            f"{more}</details>"
        )

    def gravity(self) -> str:
        e = self.e
        nearest = int((e.gravity.share + 1e-12 * abs(e.gravity.g)).argmax())
        told = self.told(
            sentences.gravity_sentences(e.conventions, e.gravity),
            f"Holding {e.robot.joint_names[nearest]} ",
        )
        bars = self.plot(
            "hanging",
            forces.gravity(e),
            "Whose weight each joint holds",
            "By link; diamonds at the sums. Upright marks: effort limits, where they are near.",
        )
        margins = self.plot(
            "margins", forces.effort_shares(e), "Against the effort limits", "At this pose."
        )
        return (
            f'<div class="grid text"><div>{told}</div>{bars}</div>'
            f'<div class="grid"><div>{self.folded("Holding efforts", tables.gravity(e))}</div>'
            f"{margins}</div>{self.worst()}"
        )

    def worst(self) -> str:
        first = self.e.worst[0]
        how = (
            f"{first.samples} random poses were looked at; from the best of them {first.starts} "
            "searches per joint climbed along the exact slope ∂g/∂q (SciPy, L-BFGS-B). Searches "
            "that end at the same value make it likely to be the largest, never certain. Joints "
            "without limits were given one turn."
        )
        written = self.folded("The worst over the joint ranges", tables.worst(self.e))
        return f'{written}<p class="muted">{how}</p>'

    def notes(self) -> str:
        e, live = self.e, self.live
        lines = [
            "Everything was computed beforehand; the page asks no network for anything.",
        ]
        if live.movable:
            lines.append(
                f"The slider stops at {live.points} positions of each joint over its range, the "
                "explained pose among them; joints without limits get one turn."
            )
        stuck = [name for i, name in enumerate(e.robot.joint_names) if i not in live.movable]
        if stuck:
            lines.append(f"Not moved, because they slide without limits: {', '.join(stuck)}.")
        if len(live.mapped) < len(live.movable):
            shown = ", ".join(e.robot.joint_names[i] for i in live.mapped)
            lines.append(
                f"Maps are drawn for the pairs among the {len(live.mapped)} joints that change "
                f"inertia and holding efforts most: {shown}."
            )
        return _list(lines)


def _list(lines: Sequence[str]) -> str:
    return f"<ul class='told'>{''.join(f'<li>{escape(line)}</li>' for line in lines)}</ul>"


def _select(name: str, options: Iterable[tuple[Any, str]], chosen: Any) -> str:
    made = "".join(
        f'<option value="{value}"{" selected" if value == chosen else ""}>{escape(text)}</option>'
        for value, text in options
    )
    return f'<select id="{name}">{made}</select>'
