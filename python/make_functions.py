"""Writes the functions of the package anew from the options of the commands.

    python make_functions.py            # writes vibroimpact/_measure.py and vibroimpact/_rig.py
    python make_functions.py --check    # says whether they are as it would write them

Each function has the options of its command as keyword arguments, with the same names and the same help.
"""

from __future__ import annotations

import keyword
import re
import sys
import textwrap
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent / "vibroimpact"
# The sources alone are no package: an installed one is taken.
if not list(HERE.glob("_native*.so")):
    sys.path = [place for place in sys.path if Path(place or ".").resolve() != HERE.parent]

from vibroimpact._native import questions  # noqa: E402
WIDTH = 110

# Options of the command line alone: files that it writes, and how it prints.
LEFT_OUT = {"out", "style", "replace", "json", "help", "each_cycle", "write_lists", "max_memory", "shard"}

# Commands that measure records.
MEASURE = [
    "spectrum",
    "impacts",
    "restitution",
    "pulse",
    "decay",
    "modal",
    "drill",
    "response",
    "waterfall",
    "excitation",
    "compare",
]
# Method of a rig for each command on a model.
RIG = {
    "orbit": "orbits",
    "simulate": "simulate",
    "response": "response",
    "backbone": "backbone",
    "continue": "branches",
    "sweep": "sweep",
    "choose": "choose",
    "map": "map",
}
# Questions whose record may be left out, and those that take several.
SEVERAL = {"spectrum", "restitution", "response", "waterfall", "excitation"}
OPTIONAL = {"pulse", "restitution"}
FILES_ONLY = {"response": "sweep", "waterfall": "sweep", "excitation": "sweep", "compare": "campaign"}

# What the answer of a function holds, and a call.
ANSWERS = {
    "spectrum": "``frequency``, ``value`` and ``level`` are lists; with ``tones`` each of ``tones`` has ``frequency``, ``amplitude`` and ``phase`` (of the sine at the first sample, rad). ``spectrum(\"a.csv\", segment=4096).frequency``.",
    "impacts": "``n``, ``times`` (s) and ``heights`` of the impacts, ``interval`` (mean, s), ``frequency`` (Hz), with an excitation ``per_cycle``. ``impacts(\"a.csv\", excitation=11.2).interval.interval()``.",
    "restitution": "``restitution``, the methods one by one in ``by``, and ``agree``: whether they agree; ``intervals`` and ``times`` (s) of each drop. ``restitution(\"a.csv\", height=0.57, height_std=0.001).restitution.std``.",
    "pulse": "``xi`` (damping ratio of the contact), ``frequency`` (undamped, Hz), ``restitution``, ``duration`` (s), ``stiffness`` and ``damping`` with a mass, ``initial_velocity`` (m/s), ``peak`` and ``impulse`` of the force (N, N s) and ``peak_read`` and ``impulse_read`` of its samples, every model in ``fits``. ``pulse(\"a.csv\", mass=0.125, low_pass=\"none\").duration``.",
    "decay": "Each of ``modes`` has ``frequency`` (undamped, Hz), ``zeta``, ``amplitude`` and ``phase`` (of the cosine at ``start``, rad); ``decrement`` is ζ of the strongest mode from the fall of its amplitude; ``start`` and ``end`` (s) of the part that was used. ``decay(\"a.csv\").modes[0].zeta``.",
    "modal": "Each of ``modes`` has ``frequency`` (undamped, Hz), ``zeta``, ``modal_constant``, ``phase`` (°), with a mass ``stiffness``. Of a time record: ``modal(\"a.csv\", reference=\"force\", channel=\"velocity\", segment=1024, mass=0.125).modes[0].frequency``; of hammer blows with ``hammer=True``.",
    "drill": "``speed`` (Hz), ``before`` and ``after`` (mean velocities at first contact, m/s), ``phase`` (turns), ``energy``, ``energy_given`` (J), ``restitution``; each blow in ``impacts``, the mean turn in ``average``.",
}

HEAD = '"""{about}\n\nWritten by make_functions.py from the options of the commands.\n"""\n\n'


def argument(option: dict[str, Any]) -> str:
    """The name of a keyword argument; a word of Python gets an underscore."""
    name: str = option["name"]
    return name + "_" if keyword.iskeyword(name) else name


def mark(option: dict[str, Any]) -> str | None:
    """The mark between the values of an option that has several in one word."""
    shown = option["placeholder"] or ""
    if option["joined"]:
        return str(option["joined"])
    found = re.fullmatch(r"[A-Z]+([:,])[A-Z:,0-9]+", shown)
    return found[1] if found else None


def hint(option: dict[str, Any]) -> str:
    """The type of a keyword argument."""
    if not option["takes_value"]:
        return "bool"
    shown = option["placeholder"] or ""
    joined = mark(option)
    if joined:
        parts = re.split("[:,]", shown)
        numbers = all(part in ("LO", "HI", "FROM", "TO", "NUMBER", "LOW", "HIGH") for part in parts)
        kind = "tuple[float | None, float | None]" if numbers and len(parts) == 2 else "Sequence[str | float]"
        return f"str | {kind}"
    one = {"NUMBER": "float", "N": "int", "FILE": "str | PathLike[str]"}.get(shown)
    if one is None and option["values"]:
        one = "Literal[" + ", ".join(f'"{value}"' for value in option["values"]) + "]"
    one = one or ("str | int" if option["name"] in ("channel", "reference", "speed_reference") else "str")
    return f"{one} | Sequence[{one}]" if option["many"] else one


def pythonic(text: str) -> str:
    """The help of an option with keyword arguments in place of options."""
    text = re.sub(r"`?--([a-z][a-z-]*)`?", lambda found: f"``{found[1].replace('-', '_')}``", text)
    return text.replace("\\", "\\\\")


def described(option: dict[str, Any], joined: str | None) -> str:
    """The line of an option in a docstring."""
    help = " ".join((option["help"] or "").split("\n\n")[0].split())
    given = ""
    if joined:
        parts = re.split("[:,]", option["placeholder"])
        given = f" ``({', '.join(part.lower() for part in parts)})``." if len(parts) > 1 else ""
    text = f"{argument(option)}: {pythonic(help)}{'' if help.endswith('.') else '.'}{given}"
    return textwrap.fill(text, WIDTH - 8, initial_indent="    ", subsequent_indent="        ")


def function(question: dict[str, Any], name: str, place: str, command: list[str], method: bool) -> str:
    """The text of one function."""
    options = [o for o in question["options"] if o["name"] not in LEFT_OUT and not o["place"]]
    if method:
        options = [o for o in options if o["name"] != "set"]
    first = [o for o in options if o["required"]]
    rest = [o for o in options if not o["required"]]
    signature = ["self"] if method else []
    called = question["name"]
    if not method:
        kind = "str | PathLike[str]" if called in FILES_ONLY else "Source"
        if called in SEVERAL:
            signature.append(f"*{place}: {kind}")
        elif called in OPTIONAL:
            signature.append(f"{place}: {kind} | None = None")
        else:
            signature.append(f"{place}: {kind}")
    if options and called not in SEVERAL or method:
        signature.append("*")
    signature += [f"{argument(o)}: {hint(o)}" for o in first]
    for o in rest:
        signature.append(f"{argument(o)}: bool = False" if hint(o) == "bool" else f"{argument(o)}: {hint(o)} | None = None")
    own = [o for o in first + rest if not o["heading"]]
    groups = [("Arguments", own)]
    for o in first + rest:
        if o["heading"] and o["heading"] != "Output":
            if groups[-1][0] != o["heading"]:
                groups.append((o["heading"], []))
            groups[-1][1].append(o)
    lines = [f"{pythonic(question['about'])}.", ""]
    if not method and called not in FILES_ONLY:
        lines += [f"``{place}`` is a file, a record, a list of records of one length, or an array with ``rate`` and ``unit``.", ""]
    if not method and FILES_ONLY.get(called) == "sweep":
        lines += ["``sweep`` is a list file, campaign.toml#name, a folder, or the files of its steps.", ""]
    lines += ["Numbers are in SI units. Raises ``Refused`` where the data allow no answer, and ``BadInput`` where a", "file or an argument is not what it should be.", ""]
    if not method and called in ANSWERS:
        held = f"The answer: {ANSWERS[called]} A number has ``.value``, ``.std``, ``.unit`` and ``.interval()``; ``tables`` are printed, ``tables[0].to_pandas()`` is a frame."
        lines += [*textwrap.wrap(held, WIDTH - 6, break_long_words=False), ""]
    for heading, group in groups:
        if group:
            lines += [f"{heading}:", *(described(o, mark(o)) for o in group), ""]
    doc = "\n".join(("    " + line).rstrip() if line else "" for text in lines for line in text.split("\n"))
    given = ", ".join(
        f'"{o["name"]}": ' + (f'Joined("{mark(o)}", {argument(o)})' if mark(o) else argument(o)) for o in first + rest
    )
    sources = "[]" if method else f"list({place})" if called in SEVERAL else f"[] if {place} is None else [{place}]" if called in OPTIONAL else f"[{place}]"
    words = "[" + ", ".join(f'"{word}"' for word in command) + "]"
    call = f"self._ask({words}, {{{given}}})" if method else f"ask({words}, {sources}, {{{given}}})"
    body = f"def {name}(\n" + "".join(f"    {part},\n" for part in signature) + ") -> Answer:\n"
    body += f'    """{doc.strip()}\n    """\n    return {call}\n'
    return textwrap.indent(body, "    ") if method else body


def measure() -> str:
    """The module of functions on records."""
    by_name = {question["name"]: question for question in questions()}
    made = []
    for name in MEASURE:
        place = FILES_ONLY.get(name, "record")
        made.append(function(by_name[name], name, place, [name], False))
    head = HEAD.format(about="Measurements on records.")
    head += "# ruff: noqa\nfrom __future__ import annotations\n\nfrom collections.abc import Sequence\nfrom os import PathLike\n"
    head += "from typing import Literal\n\nfrom ._answer import Answer\nfrom ._ask import Source, ask\nfrom ._words import Joined\n\n\n"
    return head + "\n\n".join(made)


def rig() -> str:
    """The module of the methods of a rig."""
    model = next(question for question in questions() if question["name"] == "model")
    made = [function(part, RIG[part["name"]], "", ["model", part["name"]], True) for part in model["parts"] if part["name"] in RIG]
    head = HEAD.format(about="Questions to the model of a rig.")
    head += "# ruff: noqa\nfrom __future__ import annotations\n\nfrom collections.abc import Mapping, Sequence\nfrom os import PathLike\n"
    head += "from typing import Any, Literal\n\nfrom ._answer import Answer\nfrom ._words import Joined\n\n\n"
    head += 'class RigQuestions:\n    """The questions that a rig answers."""\n\n'
    head += "    def _ask(self, command: Sequence[str], options: Mapping[str, Any]) -> Answer:\n        raise NotImplementedError\n\n"
    return head + "\n".join(made)


def main() -> int:
    """Writes or checks the modules."""
    stale = 0
    for path, text in ((HERE / "_measure.py", measure()), (HERE / "_rig_questions.py", rig())):
        if "--check" in sys.argv:
            stale += not path.exists() or path.read_text(encoding="utf-8") != text
        else:
            path.write_text(text, encoding="utf-8")
    if stale:
        print("options changed: python make_functions.py writes the functions anew")
    return int(bool(stale))


if __name__ == "__main__":
    sys.exit(main())
