#!/usr/bin/python3
"""handbook.py [PROJECT]: is the handbook of faults (docs/handbook/faults) true to the code?

Fails where a note that an event of type fault can carry, a reason of a release, or a warning of the log has no row in the
index; where a row names words that no source has; where a page does not show the line it is about, has no heading of
those that every page has, or is not in the index; where an exit status is missing; and where a link leads nowhere.

With --self-test it spoils copies of the project, one rule a copy, and fails unless each is found.
"""
import argparse
import pathlib
import re
import shutil
import sys
import tempfile

HANDBOOK = "docs/handbook"
SOURCES = ("rt", "dsp", "tools", "drivers")
HEADINGS = ("## Meanwhile", "## Mended when")
LITERAL = re.compile(r'"((?:[^"\\\n]|\\.)*)"')
PLACE = re.compile(r"%[-+ 0-9.]*(?:ll)?[a-zA-Z]|\{[^{}\s]*\}")  # what printf and fmt fill in


def words(text):
    """A text of the code as the index writes it: … for what is filled in."""
    return PLACE.sub("…", text).strip()


def code(project):
    """{file: its text, adjacent literals joined, comments left out}"""
    found = {}
    for room in SOURCES:
        for file in sorted((project / room).rglob("*.[ch]pp")):
            text = re.sub(r"(?m)^(\s*)//.*$|(?<=[;,{]) +//.*$", r"\1", file.read_text())
            found[file.relative_to(project)] = re.sub(r'"\s*\n\s*"', "", text)
    return found


def functions(text):
    """Definitions at the left margin, as clang-format lays them out."""
    return re.findall(r"(?m)^[^\s#/}].*(?:\n.*)*?\n}", text)


def sentences(text):
    return {words(literal) for literal in LITERAL.findall(text) if " " in literal.strip()}


def notes_of_faults(sources, wrong):
    """Of each function that puts a fault event out, its literals; those of describe() where it asks that."""
    notes = set()
    for file, text in sources.items():
        for body in functions(text):
            if not re.search(r"(?:emit|put)\(\s*(?:Event\{)?[^;]*EventType::fault", body):
                continue
            said = sentences(body)
            if "describe(static_cast<Doubt>" in body:
                said |= {words(note) for other in sources.values() for each in functions(other)
                         if "describe(Doubt" in each for note in LITERAL.findall(each) if note}
            if not said:
                wrong.append(f"{file}: puts a fault event out whose note cannot be read here; give it a literal")
            notes |= said
    return notes


def reasons_of_releases(sources):
    """Literals that a compensator gives a release, or returns as the reason to hold back, and the daemon's own."""
    reasons = set()
    for file, text in sources.items():
        if file.name.startswith("compensator"):
            reasons |= set(re.findall(r'(?:release\(in, |with_refusal\(|kNothingKnown = )"([^"]+)"', text))
            for body in functions(text):
                if "::reason_to_hold_back" in body:
                    reasons |= sentences(body)
            reasons |= {words(each) for each in re.findall(r'"(%s refused: [^"]*)"', text)}
        if file.name == "live_outputs.hpp":
            reasons |= set(re.findall(r'reason = short_text\("([^"]+)"\)', text))
    return reasons


def lines_of_log(sources):
    return {words(line) for text in sources.values() for line in re.findall(r'spdlog::(?:warn|error)\("([^"]+)"', text)}


def rows(index):
    """[(words, page)] of the index; the words are what stands first in backquotes."""
    return re.findall(r"(?m)^\| `([^`]+)`.*?\| .*?\]\(([a-z-]+\.md)\)", index)


def is_in(note, literals):
    """A row may shorten a text at either end; between its places it must be the code's words."""
    pieces = [piece.strip() for piece in note.split("…") if len(piece.strip()) > 2]
    return all(any(piece in literal for literal in literals) for piece in pieces)


def shows(page, note):
    """The page has a line of that kind, with something in each place."""
    pattern = ".+?".join(re.escape(piece.strip()) for piece in note.split("…"))
    return re.search(pattern.replace(r".+?", r"\s*.+?\s*"), page) is not None


def check(project):
    wrong = []
    sources = code(project)
    folder = project / HANDBOOK / "faults"
    index = (folder / "README.md").read_text()
    told = rows(index)
    in_index = {note for note, _ in told}
    for kind, notes in (("note of a fault event", notes_of_faults(sources, wrong)),
                        ("reason of a release", reasons_of_releases(sources)), ("line of the log", lines_of_log(sources))):
        if not notes:
            wrong.append(f"no {kind} was found in the code; the handbook's test reads it no longer")
        wrong += [f"{kind} without a row in {HANDBOOK}/faults/README.md: {note}" for note in sorted(notes - in_index)]
    literals = {words(literal) for text in sources.values() for literal in LITERAL.findall(text)}
    for note, page in told:
        if not is_in(note, literals):
            wrong.append(f"{HANDBOOK}/faults/README.md: no source says: {note}")
        elif (folder / page).exists() and not shows((folder / page).read_text(), note):
            wrong.append(f"{HANDBOOK}/faults/{page}: does not show the line: {note}")
    for page in sorted(folder.glob("*.md")):
        text = page.read_text()
        if page.name == "README.md":
            continue
        wrong += [f"{page.relative_to(project)}: has no '{heading}'" for heading in HEADINGS if heading not in text]
        if f"({page.name})" not in index:
            wrong.append(f"{page.relative_to(project)}: is not in the index")
    exits = (folder / "exit-status.md").read_text()
    statuses = re.findall(r"kExit\w+ = (\d+)", (project / "tools/commands.hpp").read_text())
    wrong += [f"exit status {n} has no row in exit-status.md" for n in statuses if f"| {n} |" not in exits]
    pages = [*(project / HANDBOOK).rglob("*.md"), project / "README.md", project / "docs/service.md"]
    for page in pages:
        for link in re.findall(r"\]\(([^)#:\s]+)(?:#[^)]*)?\)", page.read_text()):
            if not (page.parent / link).exists():
                wrong.append(f"{page.relative_to(project)}: leads nowhere: {link}")
    wrong += [f"{page.relative_to(project)}: does not lead to the handbook" for page in pages[-2:]
              if "handbook/" not in page.read_text()]
    return wrong


def self_test(project, wrong_already):
    spoils = {  # what is spoilt: (file, its words, others)
        "a note that changes": ("dsp/integrity.cpp", "accelerometer saturated", "accelerometer at its end"),
        "a note built at the spot": ("rt/core.cpp", "stamp goes back by", "stamp falls back by"),
        "a new reason": ("rt/compensator.cpp", '"the program changed"', '"the part changed"'),
        "a new warning": ("tools/recorder.cpp", "recording goes on in", "recording resumes in"),
        "a row that no source says": (f"{HANDBOOK}/faults/README.md", "`spindle speed missing`", "`spindle lost`"),
        "a page without its line": (f"{HANDBOOK}/faults/bus-off.md", "CAN bus-off:", "CAN silent:"),
        "a page without a heading": (f"{HANDBOOK}/faults/bus-off.md", "## Mended when", "## Well again when"),
        "a page that is not in the index": (f"{HANDBOOK}/faults/README.md", "](no-numbers.md)", "]"),
        "a status": ("tools/commands.hpp", "kExitBadInput = 3", "kExitBadInput = 5"),
        "a link": (f"{HANDBOOK}/README.md", "(real-time.md)", "(real_time.md)"),
        "no way there": ("README.md", "docs/handbook/", "docs/"),
    }
    unseen = []
    for what, (file, old, new) in spoils.items():
        with tempfile.TemporaryDirectory() as copy:
            copy = pathlib.Path(copy)
            for part in (*SOURCES, "docs", "examples"):  # what the sources and the links of the pages reach
                shutil.copytree(project / part, copy / part)
            for part in ("README.md", "LICENSE"):
                shutil.copy(project / part, copy)
            text = (copy / file).read_text()
            (copy / file).write_text(text.replace(old, new))
            found = [line for line in check(copy) if line not in wrong_already]
            print(f"{what}: {found[0] if found else 'NOT SEEN'}")
            if old not in text or not found:
                unseen.append(f"not seen: {what}")
    return unseen


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("project", type=pathlib.Path, nargs="?", default=pathlib.Path(__file__).resolve().parents[1])
    options.add_argument("--self-test", action="store_true")
    given = options.parse_args()
    wrong = check(given.project)
    if given.self_test:
        wrong += self_test(given.project, wrong)
    print(*wrong, sep="\n")
    sys.exit(1 if wrong else 0)


main()
