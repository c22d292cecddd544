"""The commands that work on logs: replay, info, recover."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from space_robot_bringup.cli_app import FAILED, JsonOption, SetOption, app, err, out


@app.command()
def replay(
    bags: Annotated[list[Path], typer.Argument(metavar="BAG...", help="run directories, bags or .mcap files")],
    against: Annotated[
        str,
        typer.Option(help="controller: states in, commands out; plant: commands in, states out; or both"),
    ] = "both",
    set_: SetOption = None,
    rtol: Annotated[float, typer.Option(help="relative to the largest number of a block; default: equal bits")] = 0.0,
    atol: Annotated[float, typer.Option(help="absolute, in the unit of the field; default: equal bits")] = 0.0,
    ignore: Annotated[
        list[str] | None, typer.Option(metavar="TOPIC[/BLOCK]", help="not compared; may be given often")
    ] = None,
    experiment: Annotated[
        str | None, typer.Option(help="for bags of another tool: shipped name or YAML file of what was flown")
    ] = None,
    namespace: Annotated[str, typer.Option(help="in front of the topics of a bag of another tool")] = "",
    update_refs: Annotated[
        bool, typer.Option("--update-refs", help="say what is different, then fly again and replace the bag")
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Compute a recorded run again and compare every number with the log."""
    from space_robot_bringup.replay import show
    from space_robot_bringup.replay.command import Order, replay
    from space_robot_bringup.replay.comparison import Tolerance
    from space_robot_bringup.replay.references import refly

    order = Order(against, Tolerance(rtol, atol, tuple(ignore or ())), set_ or (), experiment, namespace)
    done = []
    for bag in bags:
        one = replay(bag, order)
        done.append(one)
        if not as_json:
            show.print_replayed(out, one)
        if update_refs:
            said = "replaced by a new flight" if refly(one.recording) else "up to date"
            err.print(f"{bag}: {said}", markup=False, soft_wrap=True)
    if as_json:
        found = [show.as_dict(one) for one in done]
        print(json.dumps(found[0] if len(found) == 1 else found, allow_nan=False))
    if not update_refs and not all(one.equal for one in done):
        raise typer.Exit(FAILED)


@app.command()
def info(
    bag: Annotated[Path, typer.Argument(help="run directory, bag or .mcap file, of any tool")],
    as_json: JsonOption = False,
) -> None:
    """Say what is in a bag: topics, rates, gaps, provenance, damage, verdict."""
    from space_robot_bringup.logs import show
    from space_robot_bringup.logs.info import bag_info

    found = bag_info(bag)
    if as_json:
        print(json.dumps(show.info_dict(found), allow_nan=False))
    else:
        show.print_info(out, found)


@app.command()
def recover(
    bag: Annotated[Path, typer.Argument(help="run directory, bag or .mcap file that was cut or damaged")],
    directory: Annotated[Path | None, typer.Option("--out", "-o", help="default BAG_recovered")] = None,
    as_json: JsonOption = False,
) -> None:
    """Make a clean, indexed bag of a cut or damaged one and say what was lost."""
    from space_robot_bringup.logs import show
    from space_robot_msgs_py.log_recover import recover

    place = bag.resolve()
    done = recover(bag, directory or place.with_name(f"{place.stem}_recovered"))
    if as_json:
        print(json.dumps(show.recovery_dict(done), allow_nan=False))
    else:
        show.print_recovery(out, done)
