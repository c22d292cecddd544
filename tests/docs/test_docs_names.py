"""Pages name only what exists: files of the repository, Python names, keys of files, topics."""

from __future__ import annotations

import re
from fnmatch import fnmatch
from functools import cache
from itertools import pairwise

import pytest

from space_robot_msgs_py.set_points import SET_POINTS
from space_robot_msgs_py.topics import TABLE
from tests.docs.pages import ROOT, Span, pages, spans
from tests.docs.tree import Tree, files_of

# One worker reads the tree, once.
pytestmark = pytest.mark.xdist_group("names")

TOPICS = {topic.name.strip("/") for topic in (*TABLE, *SET_POINTS)}
SPANS = [span for page in pages() for span in spans(str(page.relative_to(ROOT)), page.read_text(encoding="utf-8"))]

# Names of others, and names that stand for one that the reader chooses.
FOREIGN = {
    "JointModelFreeFlyer": "Pinocchio",
    "SeedSequence": "NumPy",
    "pin.aba": "Pinocchio",
    "gymnasium.wrappers.RescaleAction": "gymnasium",
    "highOrderAttitudeIntegration": "Basilisk",
    "layout.dim": "a field of std_msgs/Float64MultiArray",
    "cmeel.prefix/share": "where the wheels of Pinocchio and example-robot-data put data",
    "BAG_recovered": "named after the bag",
    "figNN.png": "named after the figure",
    "moveit_controllers.yaml": "MoveIt",
    "run.yaml": "a file of the reader",
    "law_0.py": "an attachment of a log",
    "SystemExit": "Python",
    "control_msgs/action/FollowJointTrajectory": "ros2_control",
    "module:Class": "a law of the reader",
    "path/to/file.py:Class": "a law of the reader",
}


# What a span looks like. A path has a slash or ends like a file; `.mcap` alone is a suffix and `/alpha` a namespace.
FILE = re.compile(r"[^.].*\.(py|md|ya?ml|toml|jsonl?|xml|urdf|rviz|mcap|parquet|html|png|svg|cff|cfg|j2|js|css)")
PATH = re.compile(r"~?/?[\w.*-]+(/[\w.*-]+)+/?|[\w.-]+/|~/\w+")
DOTTED = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)+")
MEMBER = re.compile(r"(\.[A-Za-z_]\w*)+")
CAMEL = re.compile(r"(?=\w*[a-z])[A-Z]\w+|[a-z]+[A-Z]\w*")
CALL = re.compile(r"([A-Za-z_][\w.]*)\(.*\)")
PLACEHOLDER = re.compile(r"<\w+>|\.\.\.|\$|(^|/)NAME\b")
TOP = {name.split("/")[0] for name in files_of(ROOT) if "/" in name}


@cache
def tree() -> Tree:
    """What the repository defines; not read where the tests are only collected."""
    return Tree(ROOT)


def exists(span: Span) -> bool:
    """Whether everything in a span that looks like a path or an identifier is defined somewhere."""
    text = CALL.sub(r"\1()", span.text)
    if " " in text:  # a command or a formula: only what can be nothing but of this repository
        return all(path_or_module_exists(word.strip("'\",;")) for word in text.split())
    # `key=value`: both sides, the value only where it is a name.
    name, _, value = text.partition("=")
    return name_exists(name, span.before) and (not CAMEL.fullmatch(value) or name_exists(value, ()))


def path_or_module_exists(word: str) -> bool:
    """A word of a command: it has to exist if it starts like a file or a module of this repository."""
    if PLACEHOLDER.search(word):
        return True
    if word.startswith("space_robot_"):
        return word in tree().modules or path_exists(word)
    return word.split("/")[0] not in TOP or "/" not in word or path_exists(word)


def name_exists(name: str, before: tuple[str, ...]) -> bool:
    """A span of one word; what looks neither like a path nor like an identifier passes."""
    called, word = name.endswith("()"), name.removesuffix("()")
    if word in FOREIGN or PLACEHOLDER.search(word):
        return True
    if MEMBER.fullmatch(word) and not FILE.fullmatch("x" + word):
        return any(
            dotted_exists(whole) for first in before for whole in (first.rpartition(".")[0] + word, first + word)
        )
    if PATH.fullmatch(word) or FILE.fullmatch(word):
        return path_exists(word)
    if DOTTED.fullmatch(word):
        return dotted_exists(word)
    if called:
        return word in tree().functions or word in tree().classes
    if word.startswith("space_robot_"):
        return word in tree().modules or word in tree().functions
    return (
        not CAMEL.fullmatch(word) or word in tree().classes or any(word in bound for bound in tree().modules.values())
    )


def path_exists(word: str) -> bool:
    """A file or folder of the repository or of an installation, an experiment, a topic, a file that the code names."""
    plain = word.strip("/")
    places = tree().paths if plain.split("/")[0] in TOP else tree().endings | tree().installed
    if any(fnmatch(place, plain) for place in places) if "*" in plain else plain in places:
        return True
    return f"{plain}.yaml" in tree().endings or word in tree().texts or topic_exists(plain) or signal_exists(word)


def topic_exists(word: str) -> bool:
    """A topic of the table, also in a namespace, also with one of its blocks."""
    for topic in TOPICS:
        namespace, found, block = f"/{word}/".partition(f"/{topic}/")
        if found and "/" not in namespace.strip("/") and (not block or block.strip("/") in tree().texts):
            return True
    return False


def signal_exists(word: str) -> bool:
    """A quantity of an axis, ``base/roll.error``."""
    axis, _, quantity = word.partition(".")
    return "/" in axis and {axis, quantity} <= tree().texts


def dotted_exists(word: str) -> bool:
    """A module, something in a module, a member of a class or object, a key of a file, a text of the code."""
    if word in tree().texts or word in tree().modules or signal_exists(word):
        return True
    parts = word.split(".")
    for cut in range(len(parts) - 1, 0, -1):
        module, rest = ".".join(parts[:cut]), parts[cut:]
        for name, bound in tree().modules.items():
            within = name == module or name.endswith(f".{module}")
            if within and rest[0] in bound and (len(rest) == 1 or rest[1] in tree().members(rest[0])):
                return True
    # An object is called like its class in a page's example; `self` is any.
    owner = next((name for name in (parts[0], parts[0].title()) if name in tree().classes), "")
    if parts[1] in tree().members(owner):
        return held(parts[1:])
    return held(parts[1:] if parts[0] == "self" else parts)


def held(parts: list[str]) -> bool:
    """Each part is a member of what the one before it holds; so are keys of experiments."""
    return parts[0] in tree().keys and all(b in tree().keys[a] for a, b in pairwise(parts))


def test_pages_name_only_what_exists() -> None:
    """Every path and every identifier between back-ticks is defined in the tree, or foreign with a reason."""
    assert len(SPANS) > 1000
    missing = [f"{span.place}: `{span.text}`" for span in SPANS if not exists(span)]
    assert not missing, "\n".join(["the pages name what does not exist:", *missing])


@pytest.mark.parametrize("script", ["Makefile", ".ci/run", ".ci/variant", ".github/workflows/ci.yml"])
def test_scripts_name_only_files_that_exist(script: str) -> None:
    """A folder of tests that is moved is moved in what CI runs, too."""
    named = re.findall(rf"(?<![\w/.-])(?:{'|'.join(map(re.escape, TOP))})/[\w./*-]*\w", (ROOT / script).read_text())
    missing = [name for name in named if not path_exists(name)]
    assert not missing, f"{script} names what does not exist: {missing}"


@pytest.mark.parametrize(
    "text",
    [
        "SlidingTerms",
        "SlidingTerms.s",
        "Adaptive._references",
        "Law.answers",
        "space_robot_control.laws.Lawyer",
        "space_robot_control/laws/none.py",
        "kernel/none.py",
        "config/papers/*.toml",
        "liu2023/fig99",
        "base/odometry",
        "~/stop_and_go",
        "controller.gain",
        "adaptation.leek",
        "nothing_like_it(x)",
        "json_schema_extra=Dynamism",
        "python -m space_robot_msgs_py.doc",
        "rviz2 -d config/rviz/none.rviz",
    ],
)
def test_a_name_that_does_not_exist_is_found(text: str) -> None:
    """A wrong name is found whatever it looks like: a class, a member, a module, a file, a topic, a key, a function."""
    (span,) = spans("page.md", f"See `{text}`.")
    assert not exists(span)


def test_a_member_after_its_owner_is_checked() -> None:
    """```RobotState.q`, `.v``` is two members of one class, and a wrong one is found, in its line."""
    found = list(spans("page.md", "\nThe state:\n`RobotState.q`, `.v`,\n`.w`\n\n```\n`Missing`\n```\n"))
    assert [(span.place, exists(span)) for span in found] == [
        ("page.md:3", True),
        ("page.md:3", True),
        ("page.md:4", False),
    ]


def test_no_exception_outlives_its_reason() -> None:
    """Foreign names are on a page and not in the tree; a file of the layout to come is not there yet."""
    named = {CALL.sub(r"\1", span.text) for span in SPANS}
    assert set(FOREIGN) <= named
    assert {name for name in FOREIGN if name in tree().classes} == set()
