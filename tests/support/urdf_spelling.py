"""Random robots as URDF text in random, but legal spellings: blanks, exponents, what may be left out, both origins."""

from __future__ import annotations

from random import Random


def spelt_robot(seed: int) -> str:
    """URDF text of a tree of 3 to 8 links, some fixed, some massless, some points; no moving end is massless."""
    rng = Random(seed)
    count = rng.randint(3, 8)
    parents = [rng.randrange(index) for index in range(1, count)]
    kinds = [rng.choice(("revolute", "revolute", "continuous", "prismatic", "fixed")) for _ in parents]
    kinds[0] = "revolute"
    parts = [_link(rng, 0, "fixed")]
    for index, (parent, kind) in enumerate(zip(parents, kinds, strict=True), start=1):
        parts += [_link(rng, index, kind), _joint(rng, index, parent, kind)]
    rng.shuffle(parts)
    space = rng.choice(("", ' xmlns="http://www.ros.org"', ' xmlns:xacro="http://ros.org/wiki/xacro"'))
    head = '<?xml version="1.0" encoding="utf-8"?>' if rng.random() < 0.5 else ""
    return f'{head}<robot name="any" version="1.1"{space}>{"".join(parts)}</robot>'


def _link(rng: Random, index: int, kind: str) -> str:
    if kind == "fixed" and index and rng.random() < 0.5:
        inertial = rng.choice(("", "<inertial/>", f"<inertial><mass {_attribute(rng, 'value', [0.0])}/></inertial>"))
        # A point mass where it is fixed to something else.
        inertial = inertial if rng.random() < 0.5 else f"<inertial><mass {_attribute(rng, 'value', [1.5])}/></inertial>"
    else:
        inertial = _inertial(rng)
    strange = rng.choice(("", "<!-- ${mass} -->", '<o:thing xmlns:o="urn:other" a="${x}"/>', "\n\t"))
    return f'<link name="l{index}">{strange}{inertial}</link>'


def _inertial(rng: Random) -> str:
    moments = [round(rng.uniform(0.5, 0.9), 3) for _ in range(3)]
    entries = {"ixx": moments[0], "iyy": moments[1], "izz": moments[2]}
    for name in ("ixy", "ixz", "iyz"):
        value = round(rng.uniform(-0.05, 0.05), 3) if rng.random() < 0.5 else 0.0
        if value or rng.random() < 0.5:
            entries[name] = value
    texts = [_attribute(rng, name, [value]) for name, value in entries.items()]
    rng.shuffle(texts)
    mass = f"<mass {_attribute(rng, 'value', [round(rng.uniform(0.2, 9), 3)])}/>"
    parts = [_origin(rng), mass, f"<inertia {' '.join(texts)}/>"]
    rng.shuffle(parts)
    return f"<inertial>{''.join(parts)}</inertial>"


def _joint(rng: Random, index: int, parent: int, kind: str) -> str:
    axis = rng.choice(([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.3, -0.4, 0.5], [0.0, 0.0, -2.0]))
    parts = [_origin(rng), f'<parent link="l{parent}"/>', f'<child link="l{index}"/>']
    if axis[0] != 1.0 or rng.random() < 0.5:
        parts.append(f"<axis {_attribute(rng, 'xyz', axis)}/>")
    if kind in ("revolute", "prismatic"):
        parts.append(f"<limit {_attribute(rng, 'lower', [-2.0])} {_attribute(rng, 'upper', [2.0])} effort='1'/>")
    rng.shuffle(parts)
    return f'<joint type="{kind}" name="j{index}">{"".join(parts)}</joint>'


def _origin(rng: Random) -> str:
    xyz = _attribute(rng, "xyz", [round(rng.uniform(-1, 1), 3) for _ in range(3)])
    rpy = _attribute(rng, "rpy", [round(rng.uniform(-3, 3), 3) for _ in range(3)])
    quaternion = _attribute(rng, "quat_xyzw", [round(rng.uniform(-1, 1), 3) for _ in range(3)] + [0.5])
    return rng.choice(("", f"<origin {xyz}/>", f"<origin {rpy}/>", f"<origin {rpy} {xyz}/>", f"<origin {quaternion}/>"))


def _attribute(rng: Random, name: str, values: list[float]) -> str:
    blank = rng.choice((" ", "  ", "\n", "\t "))
    text = blank.join(_number(rng, value) for value in values)
    if rng.random() < 0.3:
        text = rng.choice((f"{text} ", f" {text}", f"\n{text}\n"))
    quote = rng.choice("\"'")
    return f"{name}={quote}{text}{quote}"


def _number(rng: Random, value: float) -> str:
    """One of the texts of exactly this number."""
    forms = [repr(value), f"{value:.6f}", f"{value:.9e}", f"{value:.4E}", f"{value:+.5f}"]
    if value == int(value):
        forms += [f"{value:.0f}", f"{value:.0f}."]
    if repr(value).startswith("0."):
        forms.append(repr(value)[1:])
    return rng.choice([form for form in forms if float(form) == value])
