"""The commands that work on logs: replay, info, events, recover."""

from __future__ import annotations

import json
import signal
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from space_robot_cli.app import (
    FAILED,
    AllowCodeOption,
    JsonOption,
    JunitOption,
    LawOption,
    NamespaceOption,
    SetOption,
    StartOption,
    app,
    err,
    out,
)
from space_robot_cli.completion import choices
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.extras import install

if TYPE_CHECKING:
    from space_robot_bringup.logs.foreign_bag import Source
    from space_robot_bringup.replay.comparison import Tolerance
    from space_robot_bringup.replay.publish import PublishOptions
    from space_robot_supervisor.rows import Severity


@app.command()
def replay(
    bags: Annotated[list[Path], typer.Argument(metavar="BAG", help="run directories, bags or .mcap files")],
    against: Annotated[
        str,
        typer.Option(
            help="controller: states in, commands out; plant: commands in, states out; "
            "supervisor: states, commands and orders in, modes out; or both: all that the run has",
            autocompletion=choices(("controller", "plant", "supervisor", "both")),
        ),
    ] = "both",
    set_: SetOption = None,
    rtol: Annotated[float, typer.Option(help="relative to the largest number of a block; default: equal bits")] = 0.0,
    atol: Annotated[float, typer.Option(help="absolute, in the unit of the field; default: equal bits")] = 0.0,
    ignore: Annotated[
        list[str] | None, typer.Option(metavar="TOPIC[/BLOCK]", help="not compared; may be given often")
    ] = None,
    experiment: Annotated[
        str | None, typer.Option(help="for bags of another tool: shipped name or YAML file of what was run")
    ] = None,
    namespace: NamespaceOption = "",
    start: StartOption = "run",
    update_refs: Annotated[
        bool, typer.Option("--update-refs", help="say what is different, then run again and replace the bag")
    ] = False,
    publish: Annotated[
        bool, typer.Option("--publish", help="put the bag on the live graph in place of the simulator instead")
    ] = False,
    rate: Annotated[
        float | None, typer.Option(help="with --publish: recorded seconds per second; default: wait for each command")
    ] = None,
    paused: Annotated[bool, typer.Option("--paused", help="with --publish: begin paused, for ~/step")] = False,
    loop: Annotated[bool, typer.Option("--loop", help="with --publish: begin again after the end")] = False,
    topics: Annotated[
        list[str] | None, typer.Option("--topics", metavar="TOPIC", help="with --publish: only these; may repeat")
    ] = None,
    role: Annotated[
        str, typer.Option("--as", help="with --publish: state (what a controller hears) or all (commands too)")
    ] = "state",
    law: LawOption = None,
    allow_code: AllowCodeOption = False,
    junit: JunitOption = None,
    as_json: JsonOption = False,
) -> None:
    """Compute a recorded run again and compare every number.

    Or publish it to a node of your own, with --publish.
    """
    from space_robot_bringup.logs.foreign_bag import Source
    from space_robot_bringup.replay.comparison import Tolerance
    from space_robot_bringup.replay.golden import update_reference
    from space_robot_bringup.replay.publish import PublishOptions
    from space_robot_bringup.replay.recording import Code
    from space_robot_bringup.replay.replay import ReplayOptions, replay
    from space_robot_cli.junit import check_junit, write_junit
    from space_robot_cli.render import replay as show
    from space_robot_cli.render.suites import replay_suite

    check_junit(junit)
    tolerance = Tolerance(rtol, atol, tuple(name.lstrip("/") for name in ignore or ()))
    if publish:
        if as_json or junit or set_ or experiment or update_refs or law or allow_code or against != "both":
            key = "--against, --set, --experiment, --update-refs, --law, --allow-code, --junit, --json"
            raise SpecError("means nothing to --publish", key=key, accepted="--publish without it")
        _publish(
            bags, PublishOptions(role, tuple(topics or ()), rate, paused, loop), tolerance, Source(namespace, start)
        )
        return
    if rate is not None or paused or loop or topics or role != "state":
        raise SpecError("is for --publish", key="--rate, --paused, --loop, --topics, --as", accepted="with --publish")
    code, source = Code(tuple(law or ()), allow_code), Source(namespace, start)
    options = ReplayOptions(against, tolerance, set_ or (), experiment, source, code)
    done = []
    for bag in bags:
        one = replay(bag, options, lambda line: None if as_json else err.print(line))
        done.append(one)
        if not as_json:
            show.print_replayed(out, one)
        if update_refs:
            said = "replaced by a new run" if update_reference(one.recording) else "up to date"
            err.print(f"{bag}: {said}", markup=False, soft_wrap=True)
    write_junit(junit, [replay_suite(one, bag) for one, bag in zip(done, bags, strict=True)])
    if as_json:
        found = [show.as_dict(one) for one in done]
        print(json.dumps(found[0] if len(found) == 1 else found, allow_nan=False))
    if not update_refs and not all(one.equal for one in done):
        raise typer.Exit(FAILED)


def _publish(bags: list[Path], options: PublishOptions, tolerance: Tolerance, source: Source) -> None:
    """Let a node on the graph answer one bag; the end of what it answered decides the exit code."""
    from space_robot_bringup.modes.signals import StopFlag
    from space_robot_bringup.replay.publish import Answers, open_broadcast
    from space_robot_cli.render import replay as show

    if len(bags) != 1:
        raise SpecError("one bag at a time", key="--publish", value=len(bags), accepted="one bag")
    try:
        from space_robot_bringup.nodes import replayer
    except ImportError as error:
        accepted = f"a sourced Jazzy, or {install('ros')}"
        raise SpecError(f"needs ROS 2 Jazzy ({error})", key="--publish", accepted=accepted) from None
    broadcast = open_broadcast(bags[0], source)
    answers = Answers(broadcast, tolerance)
    with StopFlag(signal.SIGINT, signal.SIGTERM) as stop:
        reason = replayer.publish(broadcast, options, answers, lambda: stop.reason)
    show.print_answers(out, answers, reason)
    if answers.different or (reason != "completed" and stop.reason is None):
        raise typer.Exit(FAILED)


@app.command()
def info(
    bag: Annotated[Path, typer.Argument(help="run directory, bag or .mcap file, of any tool")],
    full: Annotated[
        bool, typer.Option("--full", help="look at every message of a bag of more than 64 MiB, too, not at its index")
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Say what is in a bag: topics, gaps, damage, verdict."""
    from space_robot_bringup.logs.info import bag_info
    from space_robot_cli.render import log as show

    found = bag_info(bag, full=full)
    if as_json:
        print(json.dumps(show.info_dict(found), allow_nan=False))
    else:
        show.print_info(out, found)


@app.command()
def events(
    bag: Annotated[Path, typer.Argument(help="run directory or .mcap file")],
    severity: Annotated[
        str,
        typer.Option(
            help="only events as severe or more severe: info, low, medium or high",
            autocompletion=choices(("info", "low", "medium", "high")),
        ),
    ] = "info",
    source: Annotated[
        list[str] | None,
        typer.Option(
            help="only events of this source: fault, plant, supervisor or controller; may repeat",
            autocompletion=choices(("fault", "plant", "supervisor", "controller")),
        ),
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Say what happened in a run, with time and severity.

    Faults, what the plant refused, monitors, commands, modes, changes of the law.
    """
    from space_robot_bringup.logs.happened import SEVERITIES, SOURCES, events_of_log
    from space_robot_cli.render import events as show
    from space_robot_msgs_py.log.reader import LogReader

    _check_choice("--severity", severity, SEVERITIES)
    for one in source or ():
        _check_choice("--source", one, SOURCES)
    witness, trouble = events_of_log(LogReader(bag))
    grave = SEVERITIES[SEVERITIES.index(cast("Severity", severity)) :]
    found = [one for one in witness.events if one.severity in grave and (not source or one.source in source)]
    if trouble:
        err.print(f"warning: {trouble}", style="yellow", markup=False, soft_wrap=True)
    if as_json:
        listed = {"path": str(bag), "events": [show.event_dict(one) for one in found], "left_out": witness.left_out}
        print(json.dumps(listed | {"trouble": trouble or None}, allow_nan=False))
    else:
        show.print_events(out, found, witness.left_out)


def _check_choice(option: str, value: str, accepted: Sequence[str]) -> None:
    if value not in accepted:
        raise SpecError("no such choice", key=option, value=value, accepted=", ".join(accepted))


@app.command()
def recover(
    bag: Annotated[Path, typer.Argument(help="run directory, bag or .mcap file that was truncated or corrupted")],
    directory: Annotated[Path | None, typer.Option("--out", "-o", help="default BAG_recovered")] = None,
    as_json: JsonOption = False,
) -> None:
    """Make a clean bag of a corrupted one; say what was lost."""
    from space_robot_cli.render import log as show
    from space_robot_msgs_py.log.recover import recover

    place = bag.resolve()
    done = recover(bag, directory or place.parent / f"{place.stem}_recovered")
    if as_json:
        print(json.dumps(show.recovery_dict(done), allow_nan=False))
    else:
        show.print_recovery(out, done)
