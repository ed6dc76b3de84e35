#!/usr/bin/env python3
"""Checks what the documentation says against the tree and the program. Standard library only.

links     relative links and #anchors of every *.md lead somewhere
paths     folders and files in backticks that look like paths of the repository exist
functions `file.cpp`, `name` and `file.h`, `Type::name`: the file names that function
commands  lines `supple ...` in sh blocks use a subcommand and options that it has
samples   cpp blocks are taken from examples/: the line before says <!-- sample: FILE NAME -->, and the
          block is what stands between the two lines `// [NAME]` of that file
tables    the table after a line <!-- keys: TABLE --> is what `supple keys TABLE --markdown` prints, after
          <!-- stress: TABLE --> what `supple stress --markdown TABLE` does; with --write it is put there
runs      sh blocks after a line <!-- run --> end with exit code 0 in a temporary folder
pictures  sh blocks after <!-- pictures --> make the pictures of docs/ again (structural similarity), one after
          the other in a temporary folder per page; <!-- pictures: OUT DOCS --> where they make those of folder
          DOCS in folder OUT

One line per finding, `file:line: found X, expected Y`; exit code 1 if there are any. The program is
the one that SUPPLE_BINARY names; without it, commands and runs are left out.

  check_docs.py [--write] [FOLDER]      FOLDER: root of the repository, default SUPPLE_SOURCE_DIR or ../..
"""
import glob
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import textwrap
import unicodedata

ROOTS = ("volumes", "lib", "raycast", "tools", "tests", "docs", "cmake", "examples")
SKIPPED_FOLDERS = {".git", "build", "out"}
RUN_MARK = re.compile(r"<!-- (?:run|(pictures)(?:: (\S+) (\S+))?) -->")
RUN_SECONDS = 120
LEAST_SSIM = "0.99"
# The help of a subcommand leaves out the options that work everywhere.
EVERYWHERE = {"--threads", "--quiet", "--json", "--force", "--log-level", "--help", "-h"}


class Findings:
    def __init__(self):
        self.lines = []

    def add(self, file, line, found, expected):
        self.lines.append(f"{file}:{line}: found {found}, expected {expected}")


class Page:
    """A Markdown file: its lines, which of them are code, its sh blocks and its anchors."""

    def __init__(self, root, file):
        self.file = file
        with open(os.path.join(root, file), encoding="utf-8") as stream:
            self.lines = stream.read().split("\n")
        self.code = [False] * len(self.lines)
        self.blocks = []  # (number of the first line, its lines, the match of RUN_MARK before it)
        self.anchors = set()
        self._find_blocks()
        self._find_anchors()

    def _find_blocks(self):
        fence, begin, language, indent = None, 0, "", ""
        for n, line in enumerate(self.lines):
            opening = re.match(r"(\s*)(```+|~~~+)\s*(\w*)", line)
            if fence is None and opening:
                indent, fence, language = opening.groups()
                begin = n
                self.code[n] = True
            elif fence is not None:
                self.code[n] = True
                if line.strip() == fence:
                    if language == "sh":
                        run = RUN_MARK.fullmatch(self.lines[begin - 1].strip()) if begin > 0 else None
                        inner = [text[len(indent):] for text in self.lines[begin + 1:n]]
                        self.blocks.append((begin + 2, inner, run))
                    fence = None

    def _find_anchors(self):
        counts = {}
        for line, is_code in zip(self.lines, self.code):
            for name in re.findall(r'<a (?:id|name)="([^"]+)"', line):
                self.anchors.add(name)
            heading = re.match(r"#{1,6}\s+(.*?)\s*#*$", line)
            if is_code or not heading:
                continue
            slug = slug_of(heading.group(1))
            count = counts.get(slug, 0)
            counts[slug] = count + 1
            self.anchors.add(slug if count == 0 else f"{slug}-{count}")


def slug_of(heading):
    """The anchor that GitHub gives a heading."""
    text = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading).replace("`", "").lower()
    kept = (c for c in text if c in " -_" or unicodedata.category(c)[0] in "LN")
    return "".join(kept).replace(" ", "-")


def markdown_files(root):
    files = []
    for folder, folders, names in os.walk(root):
        folders[:] = sorted(set(folders) - SKIPPED_FOLDERS)
        files += [os.path.relpath(os.path.join(folder, name), root)
                  for name in sorted(names) if name.endswith(".md")]
    return sorted(files)


def without_code(line):
    return re.sub(r"(`+).*?\1", "", line)


def check_links(root, pages, findings):
    for page in pages.values():
        for n, line in enumerate(page.lines):
            if page.code[n]:
                continue
            text = without_code(line)
            targets = re.findall(r"\]\(\s*<?([^)\s>]+)>?(?:\s+\"[^\"]*\")?\s*\)", text)
            targets += re.findall(r"^\s*\[[^\]]+\]:\s+(\S+)", text)
            for target in targets:
                check_link(root, pages, page, n + 1, target, findings)


def check_link(root, pages, page, line, target, findings):
    if re.match(r"[a-z][a-z0-9+.-]*:", target):
        return  # other people's pages
    path, _, anchor = target.partition("#")
    file = page.file
    if path:
        file = os.path.normpath(os.path.join(os.path.dirname(page.file), path))
        if not os.path.exists(os.path.join(root, file)):
            findings.add(page.file, line, f"link {target}", "a file that exists")
            return
    if anchor and (file not in pages or anchor not in pages[file].anchors):
        findings.add(page.file, line, f"link {target}", f"a heading of {file} with that anchor")


def check_paths(root, pages, findings):
    """`volumes/io/nrrd`, `volumes/base/plugin.h`, `lib/chainmail/ecm` (its .h and .cpp) and
    `tests/lib/test_*.cpp`; not names with a placeholder, such as command_NAME.cpp."""
    looks_so = re.compile(r"(?:" + "|".join(ROOTS) + r")/[\w./*+-]*")
    for page in pages.values():
        if os.path.basename(page.file) == "CHANGELOG.md":
            continue  # tells of what was
        for n, line in enumerate(page.lines):
            if page.code[n]:
                continue
            for _, text in re.findall(r"(`+)(.+?)\1", line):
                path = text.strip()
                if not looks_so.fullmatch(path) or re.search(r"NAME|NEW", path):
                    continue
                if not path_exists(root, path.rstrip("/")):
                    findings.add(page.file, n + 1, f"`{path}`", "a file or folder that exists")


def check_functions(root, page, findings):
    pair = re.compile(r"`((?:" + "|".join(ROOTS) + r")/[\w./+-]+\.(?:cpp|h))`, `(?:\w+::)*(\w+)(?:\(\))?`")
    for n, line in enumerate(page.lines):
        if page.code[n] or os.path.basename(page.file) == "CHANGELOG.md":
            continue
        for path, name in pair.findall(line):
            place = os.path.join(root, path)
            if not os.path.isfile(place):
                continue  # check_paths says so
            with open(place, encoding="utf-8") as file:
                if not re.search(r"\b" + name + r"\b", file.read()):
                    findings.add(page.file, n + 1, f"`{path}`, `{name}`", "a function of that file")


def check_samples(root, page, findings):
    """Code that no example holds is code that nobody compiles."""
    for n, text in enumerate(page.lines):
        if text.strip() != "```cpp":
            continue
        mark = re.fullmatch(r"<!-- sample: (\S+) (\S+) -->", page.lines[n - 1].strip() if n else "")
        if not mark:
            findings.add(page.file, n + 1, "a block of C++", "<!-- sample: FILE NAME --> before it")
            continue
        end = page.lines.index("```", n)
        shown = [line.rstrip() for line in page.lines[n + 1:end]]
        held = marked_lines(os.path.join(root, mark[1]), mark[2])
        if shown != held:
            findings.add(page.file, n + 1, "another sample",
                         f"what stands between // [{mark[2]}] in {mark[1]}")


def marked_lines(file, name):
    """The lines between two marks, without their common indent; none where they are not."""
    if not os.path.isfile(file):
        return []
    with open(file, encoding="utf-8") as stream:
        parts = re.split(rf"^[ ]*// \[{re.escape(name)}\]\n", stream.read(), flags=re.M)
    if len(parts) != 3:
        return []
    return [line.rstrip() for line in textwrap.dedent(parts[1]).splitlines()]


def path_exists(root, path):
    whole = os.path.join(root, path)
    return any(glob.glob(whole + ending) for ending in ("", ".h", ".cpp"))


def shell_words(text):
    """Words of a command line; |, ;, &, ( and ) alone. None where quotes do not match."""
    lexer = shlex.shlex(text, posix=True, punctuation_chars="|&;()<>")
    lexer.whitespace_split = True
    lexer.commenters = "#"
    try:
        return list(lexer)
    except ValueError:
        return None


def commands_of(first, lines):
    """Simple commands of a block as (line, words): continued lines joined, $(...) taken out."""
    commands = []
    n = 0
    while n < len(lines):
        start, text = n, lines[n]
        while text.endswith("\\") and n + 1 < len(lines):
            n += 1
            text = text[:-1] + " " + lines[n]
        n += 1
        # Substitutions are commands of their own.
        parts = re.findall(r"\$\(([^()]*)\)", text)
        for part in [re.sub(r"\$\([^()]*\)", "SUBSTITUTED", text)] + parts:
            words = shell_words(part)
            if words is None:
                commands.append((first + start, None))
                continue
            command = []
            for word in words + [";"]:
                if word and set(word) <= set("|&;()"):
                    if command:
                        commands.append((first + start, command))
                    command = []
                else:
                    command.append(word)
    return commands


def option_names(help_text):
    names = set()
    for line in help_text.split("\n"):
        match = re.match(r"\s{2,}((?:-[\w-]+,?)+)", line)
        if match:
            names.update(name for name in match.group(1).split(",") if name)
    return names


class Program:
    def __init__(self, binary):
        self.binary = binary
        self.options = {}
        text = self._help([])
        listed = text.split("Subcommands:", 1)[1].split("\n\n", 1)[0] if "Subcommands:" in text else ""
        self.subcommands = re.findall(r"^  ([\w-]+)", listed, re.M)
        self.own_options = option_names(text)

    def _help(self, arguments):
        return subprocess.run([self.binary] + arguments + ["--help"], stdout=subprocess.PIPE,
                              universal_newlines=True, check=True).stdout

    def options_of(self, subcommand):
        if subcommand not in self.options:
            self.options[subcommand] = option_names(self._help([subcommand])) | EVERYWHERE
        return self.options[subcommand]


def check_commands(page, program, findings):
    for first, lines, _ in page.blocks:
        for line, words in commands_of(first, lines):
            if words is None:
                findings.add(page.file, line, "quotes that do not match", "a line that sh parses")
                continue
            while words and re.match(r"\w+=", words[0]):
                words = words[1:]
            if words and os.path.basename(words[0]) == "supple":
                check_command(page, line, words[1:], program, findings)


def check_command(page, line, words, program, findings):
    subcommand = None
    for word in words:
        if word in ("<", ">"):
            break
        if subcommand is None and not word.startswith("-"):
            subcommand = word
            if word not in program.subcommands:
                findings.add(page.file, line, f"supple {word}",
                             "one of " + ", ".join(program.subcommands))
                return
            continue
        if not re.match(r"-{1,2}[a-zA-Z]", word):
            continue  # a value, maybe a negative number
        name = word.split("=", 1)[0]
        known = program.own_options if subcommand is None else program.options_of(subcommand)
        if name not in known:
            findings.add(page.file, line, f"option {name} of supple {subcommand or ''}".rstrip(),
                         "one that its --help lists")


def check_tables(root, page, binary, writes, findings):
    lines = page.lines
    for n in range(len(lines) - 1, -1, -1):
        mark = re.fullmatch(r"<!-- (keys|stress): (\w+) -->", lines[n].strip())
        if not mark or page.code[n]:
            continue
        words = ["keys", mark[2], "--markdown"] if mark[1] == "keys" else ["stress", "--markdown", mark[2]]
        printed = subprocess.run([binary, *words], stdout=subprocess.PIPE,
                                 stderr=subprocess.STDOUT, universal_newlines=True)
        if printed.returncode != 0:
            findings.add(page.file, n + 1, f"supple {' '.join(words)}: {printed.stdout.strip()}", "its table")
            continue
        wanted = printed.stdout.rstrip("\n").split("\n")
        end = n + 1
        while end < len(lines) and lines[end].startswith("|"):
            end += 1
        if lines[n + 1:end] == wanted:
            continue
        if not writes:
            findings.add(page.file, n + 1, "another table",
                         f"what supple {' '.join(words)} prints (check_docs.py --write)")
            continue
        lines[n + 1:end] = wanted
        with open(os.path.join(root, page.file), "w", encoding="utf-8") as stream:
            stream.write("\n".join(lines))


def run_blocks(root, page, binary, findings):
    """Blocks that are run have a folder each; those that make pictures go on in the one of the page."""
    is_left_out = False
    with tempfile.TemporaryDirectory() as shared:
        for first, lines, mark in page.blocks:
            if not mark:
                continue
            text = "\n".join(lines)
            makes_pictures = mark[1] is not None
            missing = missing_input(root, os.path.dirname(binary), text)
            if makes_pictures and is_left_out:
                missing = missing or "what an earlier block makes"
            if missing:
                print(f"{page.file}:{first}: not run, {missing} is absent")
                is_left_out = is_left_out or makes_pictures
            elif makes_pictures:
                before = pictures_in(shared)
                if run_block(root, page, first, text, binary, shared, findings):
                    made = {file for file, time in pictures_in(shared).items()
                            if before.get(file) != time}
                    compare_pictures(root, page, first, mark, shared, made, binary, findings)
            else:
                with tempfile.TemporaryDirectory() as folder:
                    run_block(root, page, first, text, binary, folder, findings)


def run_block(root, page, first, text, binary, folder, findings):
    """True where it ends well. The folder gets a copy of docs/ without its pictures where the block names
    it, the scripts of tools/, the program and build/data."""
    programs = os.path.dirname(binary)

    def link(target, *names):
        os.makedirs(os.path.join(folder, *names[:-1]), exist_ok=True)
        if not os.path.lexists(os.path.join(folder, *names)):
            os.symlink(target, os.path.join(folder, *names))

    if ("docs/" in text or "tools/" in text) and not os.path.exists(os.path.join(folder, "docs")):
        shutil.copytree(os.path.join(root, "docs"), os.path.join(folder, "docs"),
                        ignore=shutil.ignore_patterns("*.png"))
    if "tools/" in text:
        link(os.path.join(root, "tools"), "tools")
        link(programs, "build", "release", "bin")
    for data in glob.glob(os.path.join(root, "build", "data", "*")):
        link(data, "build", "data", os.path.basename(data))
    environment = dict(os.environ)
    environment["PATH"] = programs + os.pathsep + os.environ.get("PATH", "")
    try:
        done = subprocess.run(["bash", "-euo", "pipefail", "-c", text], cwd=folder, env=environment,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, universal_newlines=True, timeout=RUN_SECONDS)
    except subprocess.TimeoutExpired:
        findings.add(page.file, first, f"a block that runs for {RUN_SECONDS} s", "one that ends")
        return False
    if done.returncode != 0:
        last = done.stdout.strip().split("\n")[-1]
        findings.add(page.file, first, f"exit code {done.returncode} ({last})", "0")
    return done.returncode == 0


def pictures_in(folder):
    """Times of change of all pictures below a folder, by their paths from it."""
    files = glob.glob(os.path.join(folder, "**", "*.png"), recursive=True)
    return {os.path.relpath(file, folder): os.stat(file).st_mtime_ns for file in files}


def compare_pictures(root, page, first, mark, folder, made, binary, findings):
    """What a block makes in docs/ is there; of what it makes in another folder something is."""
    out, docs = mark[2] or "docs", mark[3] or "docs"
    compared = 0
    for file in sorted(made):
        name = os.path.relpath(file, out)
        shown = os.path.join(docs, name)
        if name.startswith(".."):
            continue
        if not os.path.exists(os.path.join(root, shown)):
            if not mark[2]:
                findings.add(page.file, first, f"a command for {shown}", "one for a picture that is there")
            continue
        compared += 1
        done = subprocess.run([binary, "compare", os.path.join(folder, file), os.path.join(root, shown),
                               "--min-ssim", LEAST_SSIM], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, universal_newlines=True)
        if done.returncode != 0:
            found = " ".join(done.stdout.split())
            findings.add(page.file, first, f"another {shown} than its command makes ({found})",
                         f"one of ssim {LEAST_SSIM} or more")
    if compared == 0 and mark[2]:
        findings.add(page.file, first, "no picture", f"one of {docs}")


def missing_input(root, programs, text):
    """The first scan that the block or its scene names, or program beside supple, that is not there."""
    for scene in re.findall(r"docs/[\w./-]+\.toml", text):
        if os.path.exists(os.path.join(root, scene)):
            with open(os.path.join(root, scene), encoding="utf-8") as stream:
                text += "\n" + stream.read()
    if "tools/" in text and not os.path.exists(os.path.join(programs, "supple-examples")):
        return "supple-examples"
    for path in re.findall(r"build/data/[\w./-]+", text):
        if not os.path.exists(os.path.join(root, path)):
            return path
    for name in re.findall(r"^supple-\w+", text, re.M):
        if not os.path.exists(os.path.join(programs, name)):
            return name
    return None


def check(root, binary, writes=False):
    findings = Findings()
    pages = {file: Page(root, file) for file in markdown_files(root)}
    check_links(root, pages, findings)
    check_paths(root, pages, findings)
    for page in pages.values():
        check_functions(root, page, findings)
        check_samples(root, page, findings)
    if binary:
        program = Program(binary)
        for page in pages.values():
            if page.file in ("README.md", "CONTRIBUTING.md") or page.file.startswith("docs" + os.sep):
                check_commands(page, program, findings)
                run_blocks(root, page, binary, findings)
                check_tables(root, page, binary, writes, findings)
    else:
        print("SUPPLE_BINARY is not set: commands are not checked")
    return findings.lines


def main():
    here = os.path.dirname(os.path.abspath(__file__))
    writes = "--write" in sys.argv[1:]
    arguments = [argument for argument in sys.argv[1:] if argument != "--write"]
    root = arguments[0] if arguments else os.environ.get("SUPPLE_SOURCE_DIR",
                                                                os.path.join(here, "..", ".."))
    binary = os.environ.get("SUPPLE_BINARY", "")
    lines = check(os.path.abspath(root), os.path.abspath(binary) if binary else "",
                  writes)
    for line in lines:
        print(line)
    print(f"{len(lines)} findings")
    return 1 if lines else 0


if __name__ == "__main__":
    sys.exit(main())
