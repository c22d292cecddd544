"""Everything a manifest can get wrong beyond its types, found before the first run."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import SpecError
from space_robot_studies.engine.tasks import TIME_LIMIT
from space_robot_studies.reproduce.claims import check_words
from space_robot_studies.reproduce.expression import Formula
from space_robot_studies.reproduce.manifest import Chart, Claim, Drawing, Figure, Grid, Panel, Table
from space_robot_studies.reproduce.measures import select
from space_robot_studies.reproduce.names import Vocabulary
from space_robot_studies.reproduce.plan import Plan
from space_robot_studies.reproduce.planner import PlannedRun, ReadingRuns, Runs
from space_robot_studies.reproduce.quantities import Measure, Number, Wanted


def check_plan(plan: Plan, figures: Iterable[str], time_limit: float = TIME_LIMIT) -> None:
    """Compose every run of these figures, of campaigns the first of each point, and look up every name they use.

    Raises:
        SpecError: a run cannot be composed, or a group, metric, signal, measure or key is unknown; with the key path
            and the nearest names.
    """
    with Vocabulary(time_limit) as vocabulary:
        for name in figures:
            key = f"{plan.argument} figures.{name}"
            for label, runs in plan.runs[name].items():
                _learn(vocabulary, runs, f"{key}.runs.{label}")
            for index, readings in enumerate(plan.read[name]):
                for runs in (group for one in readings for group in one.groups.values()):
                    _learn(vocabulary, runs, f"{key}.claims.{index}.hangs_on")
            _FigureCheck(plan.manifest.figures[name], plan.runs[name], plan.read[name], vocabulary).check(key)


def _learn(vocabulary: Vocabulary, runs: Sequence[PlannedRun], key: str) -> None:
    first = runs[0]
    for run in runs:
        # The cases of one point differ in what is drawn; composing hundreds would take as long as running some.
        if run.values.get("run"):
            vocabulary.learn_case(run, first)
        else:
            vocabulary.learn(first := run, key)


class _FigureCheck:
    def __init__(
        self, figure: Figure, runs: Runs, read: Sequence[Sequence[ReadingRuns]], vocabulary: Vocabulary
    ) -> None:
        self._figure, self._runs, self._read, self._vocabulary = figure, runs, read, vocabulary

    def check(self, key: str) -> None:
        """Check everything; ``key`` is the path of the figure."""
        figure = self._figure
        self._check_labels(key)
        for index, panel in enumerate(figure.panels):
            self._check_panel(panel, f"{key}.panels.{index}")
        for index, chart in enumerate(figure.charts):
            self._check_chart(chart, f"{key}.charts.{index}")
        for index, grid in enumerate(figure.grids):
            self._check_grid(grid, f"{key}.grids.{index}")
        for index, table in enumerate(figure.tables):
            self._check_table(table, f"{key}.tables.{index}")
        if figure.timing is not None:
            for group in figure.timing.of:
                if len(self._of((group,), f"{key}.timing.of")) != 1:
                    raise SpecError("more than one run", key=f"{key}.timing.of", value=group, accepted="a group of one")
        for index, claim in enumerate(figure.claims):
            for one in self._read[index]:
                self._check_claim(claim, one, f"{key}.claims.{index}")

    def _check_labels(self, key: str) -> None:
        labels = [run.label for group in self._runs.values() for run in group]
        if twice := next((label for label in labels if labels.count(label) > 1), None):
            raise SpecError("two runs would have this label", key=f"{key}.runs", value=twice, accepted="other labels")

    def _check_panel(self, panel: Panel, key: str) -> None:
        runs = self._check_drawing(panel, panel.signals, key)
        for index, signal in enumerate(panel.signals):
            self._vocabulary.check_signal(signal, runs, f"{key}.signals.{index}")
        if panel.before is not None and panel.before <= panel.after:
            later = f"> {panel.after:g}"
            raise SpecError("not later than after", key=f"{key}.before", value=panel.before, accepted=later)

    def _check_chart(self, chart: Chart, key: str) -> None:
        runs = self._check_drawing(chart, (), key)
        self._check_number(chart.measure, runs, f"{key}.measure")
        if chart.x:
            _check_axis(runs, chart.x, chart.x_scale, f"{key}.x")

    def _check_grid(self, grid: Grid, key: str) -> None:
        self._check_chart(grid, key)
        _check_reducible(grid.measure, self._of(grid.of, f"{key}.of"), f"{key}.measure")
        _check_axis(self._of(grid.of, f"{key}.of"), grid.y, grid.y_scale, f"{key}.y")
        for text, formula in grid.lines.items():
            Formula(formula, ("x",), f"{key}.lines.{text}")

    def _check_drawing(self, drawing: Drawing, signals: Sequence[str], key: str) -> list[PlannedRun]:
        runs = self._of(drawing.of, f"{key}.of")
        names = [*dict.fromkeys(run.group for run in runs), *(run.label for run in runs), *signals]
        for part in ("legend", "style"):
            for name in getattr(drawing, part):
                _known("group, run or signal of this drawing", name, names, f"{key}.{part}")
        low, high = drawing.limits or (1.0, 2.0)
        if low >= high or (drawing.y_scale == "log" and low <= 0.0):
            accepted = "[low, high], above 0 on a log scale"
            raise SpecError("not an interval", key=f"{key}.limits", value=drawing.limits, accepted=accepted)
        return runs

    def _check_table(self, table: Table, key: str) -> None:
        groups = table.of or tuple(self._runs)
        runs = self._of(groups, f"{key}.of")
        for heading, number in table.columns.items():
            where = f"{key}.columns.{heading}"
            self._check_number(number, runs, where)
            if table.rows == "groups":
                for group in groups:
                    _check_reducible(number, self._runs[group], where)

    def _check_claim(self, claim: Claim, one: ReadingRuns, key: str) -> None:
        for name, measure in claim.measures.items():
            self._check_measure(measure, one.groups, f"{key}.measures.{name}")
        check_words(claim, one.reading.let, key)

    def _check_measure(self, measure: Measure, groups: Runs, key: str) -> None:
        runs = select(measure, [run for group in measure.groups for run in groups[group]])
        if not runs:
            raise SpecError("no run has these values", key=f"{key}.where", value=dict(measure.where))
        self._check_number(measure, runs, key)
        _check_reducible(measure, runs, key)
        if measure.over:
            others = [run for run in groups[measure.over] if run.has(measure.where)]
            self._check_number(measure, others, f"{key}.over")
            if len({run.seed for run in others}) < len(others):
                accepted = "a group with one run of each seed, or where"
                raise SpecError("a run has several partners", key=f"{key}.over", value=measure.over, accepted=accepted)
        if (partners := measure.only_if) is not None:
            others = [run for group in partners.groups for run in groups[group]]
            self._check_number(partners, others, f"{key}.only_if")

    def _check_number(self, number: Wanted, runs: Sequence[PlannedRun], key: str) -> None:
        if number.timing is not None:
            timed = self._figure.timing.of if self._figure.timing else ()
            for run in runs:
                _known("group of the timing table", run.group, timed, f"{key}.timing")
            return
        if number.metric is not None:
            self._vocabulary.check_metric(number.metric, runs, f"{key}.metric")
            return
        self._vocabulary.check_signal(number.signal or "", runs, f"{key}.signal")
        for run in runs:
            if number.after > run.distinct.experiment.duration:
                accepted = f"less than the {run.distinct.experiment.duration:g} s of {run.label}"
                raise SpecError("after the end of a run", key=f"{key}.after", value=number.after, accepted=accepted)

    def _of(self, groups: Sequence[str] | None, key: str) -> list[PlannedRun]:
        """The runs of these groups; of all if there are none given."""
        for group in groups or ():
            _known("group of runs", group, list(self._runs), key)
        return [run for group in groups or self._runs for run in self._runs[group]]


def _known(what: str, name: str, names: Sequence[str], key: str) -> None:
    if name not in names:
        accepted = nearest(name, names) or ", ".join(names) or "none is there"
        raise SpecError(f"no such {what}", key=key, value=name, accepted=accepted)


def _check_axis(runs: Sequence[PlannedRun], axis: str, scale: str, key: str) -> None:
    """Every run has a place on the axis of a dotted key."""
    for run in runs:
        value = run.values.get(axis)
        if isinstance(value, bool) or not isinstance(value, int | float):
            accepted = "a key that every group sets or varies to numbers"
            raise SpecError(f"{run.label} has no such number", key=key, value=axis, accepted=accepted)
        if scale == "log" and value <= 0:
            raise SpecError("has no place on this scale", key=f"{key}_scale", value=value, accepted="numbers > 0")


def _check_reducible(number: Number, runs: Sequence[PlannedRun], key: str) -> None:
    if number.reduce is None and len(runs) != 1:
        raise SpecError(f"{len(runs)} runs and no reduce", key=key, accepted="reduce: min, max, mean, median, ...")
