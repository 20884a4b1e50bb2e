"""A screen in memory, for programs that draw on a terminal."""
import codecs
import re


class Screen:
    """As much of a VT100 as a program of ncurses asks of it."""

    def __init__(self, columns, rows):
        self.decoder, self.pending = codecs.getincrementaldecoder("utf-8")("replace"), ""
        self.resize(columns, rows)

    def resize(self, columns, rows):
        self.columns, self.rows, self.x, self.y = columns, rows, 0, 0
        self.cells = [[" "] * columns for _ in range(rows)]
        self.region = (0, rows - 1)

    def step(self, down):
        """A row down (1) or up (-1); at the end of the scrolling region its rows move instead."""
        top, bottom = self.region
        if self.y != (bottom if down > 0 else top):
            self.y = min(max(self.y + down, 0), self.rows - 1)
            return
        del self.cells[top if down > 0 else bottom]
        self.cells.insert(bottom if down > 0 else top, [" "] * self.columns)

    def text(self):
        return "\n".join("".join(row).rstrip() for row in self.cells)

    def feed(self, data):
        self.pending += self.decoder.decode(data)
        while self.pending:
            sequence = re.match(r"\x1b(\[[?0-9;]*[@-~]|[()].|[^\[()])", self.pending)
            if sequence:
                self.obey(sequence[1])
                self.pending = self.pending[sequence.end():]
            elif self.pending[0] == "\x1b":
                return  # the rest is on its way
            else:
                self.put(self.pending[0])
                self.pending = self.pending[1:]

    def put(self, character):
        if character == "\r":
            self.x = 0
        elif character == "\n":
            self.step(1)
        elif character == "\t":
            self.x = min((self.x // 8 + 1) * 8, self.columns - 1)
        elif character == "\b":
            self.x = max(self.x - 1, 0)
        elif character >= " ":
            if self.x >= self.columns:
                self.x = 0
                self.step(1)
            self.cells[self.y][self.x] = character
            self.x += 1

    def obey(self, sequence):
        numbers = [int(n) if n.isdigit() else 0 for n in sequence[1:-1].split(";")]
        first, last = max(1, numbers[0]), sequence[-1]
        if sequence in ("D", "M"):  # a row down, a row up
            self.step(1 if sequence == "D" else -1)
        if not sequence.startswith("[") or sequence.startswith("[?"):
            return
        if last == "H":
            self.y = min(first, self.rows) - 1
            self.x = min(max(1, numbers[1] if len(numbers) > 1 else 1), self.columns) - 1
        elif last == "r":
            self.region = (first - 1, (numbers[1] if len(numbers) > 1 and numbers[1] else self.rows) - 1)
            self.x = self.y = 0
        elif last in "ABCD":
            across, down = {"A": (0, -1), "B": (0, 1), "C": (1, 0), "D": (-1, 0)}[last]
            self.x = min(max(self.x + across * first, 0), self.columns - 1)
            self.y = min(max(self.y + down * first, 0), self.rows - 1)
        elif last == "J":
            if numbers[0] == 2:
                self.cells = [[" "] * self.columns for _ in range(self.rows)]
            else:
                self.cells[self.y][self.x:] = [" "] * len(self.cells[self.y][self.x:])
                self.cells[self.y + 1:] = [[" "] * self.columns for _ in self.cells[self.y + 1:]]
        elif last == "K" and numbers[0] == 1:
            self.cells[self.y][:self.x + 1] = [" "] * (self.x + 1)
        elif last == "K":
            self.cells[self.y][self.x:] = [" "] * len(self.cells[self.y][self.x:])
