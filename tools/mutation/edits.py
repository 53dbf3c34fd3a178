"""Edits C sources at random lines. The same seed and the same sources give the same edits.

Each draw k has its own random numbers, SHA-256 of "SEED:k:j" for j = 0, 1, ..., so it depends on nothing else. The
first number chooses a line among all lines of code below src, each with the same probability. The next ones choose the
kind of edit among those that are possible at this line, and the place. Lines of code are lines with at least one token.
Some code is not drawn: preprocessor directives other than the body of #define, macros that are one number, and
assertions. Such macros are tuning constants, and the range over which nothing changes is given beside them. Only wrong
calls reach assertions."""

import hashlib
import re
from collections import namedtuple

Token = namedtuple("Token", "kind text start end line")  # kind: word, number, text or sign; line counts from 1
Edit = namedtuple("Edit", "path line kind start end new")

TOKEN = re.compile(
    r"""(?P<space>\s+|\\\n)|(?P<comment>/\*.*?\*/|//[^\n]*)|(?P<text>"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*')"""
    r"""|(?P<number>\.?[0-9](?:[eEpP][+-]|[0-9a-zA-Z_.])*)|(?P<word>[A-Za-z_]\w*)"""
    r"""|(?P<sign><<=|>>=|\.\.\.|->|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||[-+*/%&|^]=|\#\#|[^\s\w])""", re.S | re.X)
DIRECTIVE = re.compile(r"^[ \t]*#[ \t]*(\w+)(?:\\\n|[^\n])*", re.M)
ONE_NUMBER = re.compile(r"\s*#\s*define\s+\w+\s+\(?-?[0-9.][\w.+-]*\)?\s*$")
KEYWORDS = {"return", "case", "sizeof", "else", "do", "goto", "typedef"}
BOUNDS = {"<": "<=", "<=": "<", ">": ">=", ">=": ">"}
RELATIONS = {"<": ">=", "<=": ">", ">": "<=", ">=": "<", "==": "!=", "!=": "=="}
ARITHMETIC = {"+": "-", "-": "+", "*": "/", "/": "*", "%": "*", "+=": "-=", "-=": "+=", "*=": "/=", "/=": "*=",
              "++": "--", "--": "++", "&": "|", "|": "&", "<<": ">>", ">>": "<<", "|=": "&=", "&=": "|="}
LOGIC = {"&&": "||", "||": "&&"}
SYMMETRIC = ("fmax", "fmin", "hypot")
CLOSING = {"(": ")", "[": "]", "{": "}"}


def tokens_of(text):
    """Returns the tokens outside of comments and of the directives that are not drawn."""
    found, line, at = [], 1, 0
    skipped = [m.span() for m in DIRECTIVE.finditer(text)
               if m[1] != "define" or ONE_NUMBER.match(re.sub(r"/\*.*?(\*/|$)", "", m[0], flags=re.S))]
    heads = [re.compile(r"\s*#\s*define\s+\w+(\([^)]*\))?").match(text, m.start()).span()
             for m in DIRECTIVE.finditer(text) if m[1] == "define"]
    skipped = sorted(skipped + heads)
    while at < len(text):
        m = TOKEN.match(text, at)
        inside = next((s for s in skipped if s[0] <= at < s[1]), None) if skipped else None
        if inside and m.lastgroup != "comment":
            line += text.count("\n", at, inside[1])
            at = inside[1]
            continue
        if m.lastgroup not in ("space", "comment"):
            found.append(Token(m.lastgroup, m[0], at, m.end(), line))
        line += m[0].count("\n")
        at = m.end()
        while skipped and skipped[0][1] <= at:
            skipped.pop(0)
    return found


class Source:
    def __init__(self, path, text):
        self.path, self.text, self.tokens = path, text, tokens_of(text)
        self.partner = self._partners()
        self.assertions = self._assertions()
        self.lines = sorted({t.line for i, t in enumerate(self.tokens) if i not in self.assertions})

    def _partners(self):
        partner, open_, self.in_round = {}, [], set()
        for i, t in enumerate(self.tokens):
            if open_ and self.tokens[open_[-1]].text == "(":
                self.in_round.add(i)
            if t.kind != "sign":
                continue
            if t.text in CLOSING:
                open_.append(i)
            elif t.text in CLOSING.values() and open_ and CLOSING[self.tokens[open_[-1]].text] == t.text:
                partner[open_[-1]] = i
                partner[i] = open_.pop()
        return partner

    def _assertions(self):
        inside = set()
        for i, t in enumerate(self.tokens):
            if t.text in ("assert", "_Static_assert", "static_assert") and self.partner.get(i + 1):
                inside.update(range(i, self.partner[i + 1] + 2))
        return inside

    def edits(self, line):
        """Returns all edits at a line, as a dictionary from kinds to lists, in the order of the text."""
        kinds = {}
        for i, t in enumerate(self.tokens):
            if t.line == line and i not in self.assertions:
                for kind, start, end, new in self._edits_at(i):
                    kinds.setdefault(kind, []).append(Edit(self.path, line, kind, start, end, new))
        return kinds

    def _edits_at(self, i):
        t = self.tokens[i]
        if t.kind == "number":
            yield from (("constant", t.start, t.end, new) for new in other_numbers(t.text))
        if t.kind == "sign":
            yield from self._edits_of_sign(i)
        if t.text in ("if", "while") and self.partner.get(i + 1):
            a, b = self.tokens[i + 1], self.tokens[self.partner[i + 1]]
            yield "negated condition", a.start, b.end, f"(!{self.text[a.start:b.end]})"
        if t.text == "(" and i and self.tokens[i - 1].kind == "word" and i in self.partner:
            yield from self._swapped(i)
        if self._begins_statement(i):
            yield from self._dropped(i)

    def _edits_of_sign(self, i):
        t, before = self.tokens[i], self.tokens[i - 1] if i else None
        is_binary = before and (before.kind in ("word", "number", "text") and before.text not in KEYWORDS
                                or before.text in (")", "]"))
        is_binary = is_binary and (t.text not in "*&" or self.text[t.end].isspace())  # no declaration
        if is_binary or t.text in ("++", "--"):
            for kind, table in (("bound", BOUNDS), ("relation", RELATIONS), ("arithmetic", ARITHMETIC),
                                ("logic", LOGIC)):
                if t.text in table:
                    yield kind, t.start, t.end, table[t.text]
        elif t.text == "-":
            yield "sign", t.start, t.end, ""
        elif t.text == "!":
            yield "negated condition", t.start, t.end, ""
        if is_binary and t.text in LOGIC:
            yield "dropped condition", t.start, self._end_of_operand(i), ""
        if t.text == "?" and is_binary:
            yield from self._swapped_arms(i)

    def _end_of_operand(self, i):
        j = i + 1
        while j < len(self.tokens) and self.tokens[j].text not in ("&&", "||", ")", "]", "}", ";", ",", "?", ":"):
            j = self.partner.get(j, j) + 1 if self.tokens[j].text in CLOSING else j + 1
        return self.tokens[j - 1].end

    def _swapped_arms(self, i):
        j, colon, depth = i + 1, None, 0
        while j < len(self.tokens) and self.tokens[j].text not in (")", "]", "}", ";", ","):
            depth += {"?": 1, ":": -1}.get(self.tokens[j].text, 0)
            if depth < 0:
                if colon:
                    return
                colon, depth = j, 0
            j = self.partner.get(j, j) + 1 if self.tokens[j].text in CLOSING else j + 1
        if colon and colon > i + 1 and j > colon + 1:
            a, b = self.tokens[i + 1].start, self.tokens[colon - 1].end
            c, d = self.tokens[colon + 1].start, self.tokens[j - 1].end
            yield "swapped arms", a, d, self.text[c:d] + self.text[b:c] + self.text[a:b]

    def _arguments(self, i):
        """Returns the spans of what is between the commas of a bracket."""
        spans, first, j, end = [], i + 1, i + 1, self.partner[i]
        while j <= end:
            if j == end or self.tokens[j].text == ",":
                if j > first:
                    spans.append((self.tokens[first].start, self.tokens[j - 1].end))
                first = j + 1
            j = self.partner.get(j, j) + 1 if j < end and self.tokens[j].text in CLOSING else j + 1
        return spans

    def _swapped(self, i):
        if self._is_symmetric(i):
            return
        spans = self._arguments(i)
        for a, b in zip(spans, spans[1:]):
            one, two = self.text[a[0]:a[1]], self.text[b[0]:b[1]]
            if one != two and type_of(one) == type_of(two):
                yield "swapped arguments", a[0], b[1], two + self.text[a[1]:b[0]] + one

    def _is_symmetric(self, i):
        """Returns whether swapped arguments give the same result: those of SYMMETRIC, and of a strcmp that only tells
        whether two texts are equal."""
        before = self.tokens[i - 2].text if i > 1 else ""
        after = self.tokens[self.partner[i] + 1].text if self.partner[i] + 1 < len(self.tokens) else ""
        name = self.tokens[i - 1].text
        return name in SYMMETRIC or name == "strcmp" and (before == "!" or after in ("==", "!="))

    def _begins_statement(self, i):
        t, before = self.tokens[i], self.tokens[i - 1] if i else None
        if not before or i in self.in_round or t.kind != "word" and t.text not in ("*", "(", "++", "--"):
            return False
        after = self.tokens[i + 1] if i + 1 < len(self.tokens) else t
        is_declaration = after.kind == "word" or after.text == "*"
        if t.kind == "word" and t.text not in KEYWORDS and is_declaration:
            return False
        if before.text in ("{", "}", ";", "else", "do"):
            return True
        if before.text != ")" or i - 1 not in self.partner:
            return False
        return self.tokens[self.partner[i - 1] - 1].text in ("if", "for", "while")

    def _dropped(self, i):
        """Yields the edit that drops the statement that begins here. That of an `if` without an `else` is dropped with
        it."""
        t = self.tokens[i]
        if t.text in ("for", "while", "switch", "do", "else", "case", "default", "typedef", "static"):
            return
        j = i
        if t.text == "if" and i + 1 in self.partner:
            j = self.partner[i + 1] + 1
            if self.tokens[j].text in ("if", "for", "while", "switch", "do"):
                return
            if self.tokens[j].text == "{":
                j = self.partner.get(j, j)
        while j < len(self.tokens) and self.tokens[j].text not in (";", "}"):
            j = self.partner.get(j, j) + 1 if self.tokens[j].text in CLOSING else j + 1
        if j + 1 >= len(self.tokens) or self.tokens[j + 1].text == "else" and t.text == "if" or j == i:
            return
        if self.tokens[j].text == "}" and t.text != "if":
            return
        yield "dropped statement", t.start, self.tokens[j].end, ";"

    def edited(self, edit):
        """Returns the text after the edit. All lines keep their numbers."""
        old = self.text[edit.start:edit.end]
        lost = old.count("\n") - edit.new.count("\n")
        return self.text[:edit.start] + edit.new + "\n" * lost + self.text[edit.end:]


def type_of(text):
    """Returns the type of a parameter, '' for an expression. Parameters of two types cannot be swapped."""
    found = re.fullmatch(r"((?:const |volatile |struct |unsigned )*\w+ \**(?:const )?)\w+((?:\[[^]]*\])*)", text)
    return found[1] + found[2] if found else ""


def other_numbers(text):
    if re.fullmatch(r"[0-9]+[uUlL]*", text):
        n, suffix = int(re.match(r"[0-9]+", text)[0]), re.sub(r"^[0-9]+", "", text)
        return [f"{m}{suffix}" for m in sorted({n + 1, max(n - 1, 0), 0} - {n})]
    if re.fullmatch(r"0[xX][0-9a-fA-F]+[uUlL]*", text):
        return [f"({text} + 1)", f"({text} ^ 2)"]
    if float_of(text) == 0:
        return ["1.0"]
    return [f"(2 * {text})", f"(0.5 * {text})", f"(-{text})", "0.0"]


def float_of(text):
    try:
        return float(text.rstrip("fFlL"))
    except ValueError:
        return 1.0


class Draws:
    """draws[k] is an Edit, or None if there is no edit at the line. line_of(k) is the line that was drawn."""

    def __init__(self, top, seed):
        self.seed = seed
        files = sorted(str(p.relative_to(top)) for p in (top / "src").rglob("*.[ch]"))
        self.sources = {f: Source(f, (top / f).read_text()) for f in files}
        self.lines = [(f, line) for f in files for line in self.sources[f].lines]

    def number(self, k, j, n):
        digest = hashlib.sha256(f"{self.seed:x}:{k}:{j}".encode()).digest()
        return int.from_bytes(digest[:16], "big") % n

    def line_of(self, k):
        return self.lines[self.number(k, 0, len(self.lines))]

    def edit(self, k):
        path, line = self.line_of(k)
        kinds = self.sources[path].edits(line)
        if not kinds:
            return None
        names = sorted(kinds)
        edits = kinds[names[self.number(k, 1, len(names))]]
        return edits[self.number(k, 2, len(edits))]
