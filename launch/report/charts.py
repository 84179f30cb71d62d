"""Charts as SVG, drawn by gnuplot."""

import base64
import math
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

COLOURS = {
    "wcsph": "#0072B2",
    "implicit": "#D55E00",
    "wide": "#CC79A7",
    "staggered": "#009E73",
    "ode": "#0072B2",
    "free_body": "#D55E00",
}
MARKS = {"wcsph": 7, "implicit": 5, "wide": 13, "staggered": 9, "ode": 7, "free_body": 5}
DASHES = (1, 2, 4, 5)


@dataclass
class Line:
    """One data set of a chart. style is gnuplot's, such as 'lines lw 1.5' or 'points pt 7'."""

    title: str
    x: list[float]
    y: list[float]
    style: str


@dataclass
class Plot:
    x: str
    y: str
    lines: list[Line] = field(default_factory=list)
    log_x: bool = False
    log_y: bool = False
    y_range: tuple[float, float] | None = None  # nothing beyond it is shown
    levels: list[tuple[float, str]] = field(default_factory=list)  # horizontal lines with a word


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def script(plot: Plot) -> str:
    height = 320 + 14 * max(0, sum(bool(line.title) for line in plot.lines) - 4)  # of the key, so that the chart stays
    out = [
        f'set terminal svg size 480,{height} dynamic enhanced font "Helvetica,12" background "white"',
        "set encoding utf8",
        f"set xlabel {_quoted(plot.x)} noenhanced",
        f"set ylabel {_quoted(plot.y)} noenhanced",
        "set border 3 lc rgb '#666666'",
        "set tics nomirror textcolor rgb '#333333'",
        "set grid lc rgb '#e4e4e4' lt 1",
        "set key above left horizontal maxcols 2 samplen 2 spacing 1.1 noenhanced font 'Helvetica,10'",
    ]
    ys = [v for line in plot.lines for v in line.y if math.isfinite(v) and (v > 0 or not plot.log_y)]
    ys += [v for v, _ in plot.levels]
    if plot.log_x:
        out += ["set logscale x", 'set format x "%g"']
    if plot.log_y:
        out += [
            "set logscale y",
            'set format y "%g"',
            f"set yrange [{10 ** math.floor(math.log10(min(ys)) - 0.05)!r}:{10 ** math.ceil(math.log10(max(ys)) + 0.05)!r}]",
        ]
    elif plot.y_range and ys:
        low, high = max(min(ys), plot.y_range[0]), min(max(ys), plot.y_range[1])
        middle, half = (low + high) / 2, max((high - low) / 2 * 1.05, 1e-3 * max(abs(low), abs(high)), 1e-12)
        out += [f"set yrange [{middle - half!r}:{middle + half!r}]"]
    before, right = 0.0, True
    for value, word in sorted(plot.levels):
        right = not right if value < 1.3 * before else True  # words of neighbours at opposite ends
        before = value
        place = "0.995, first {!r} right" if right else "0.005, first {!r} left"
        out += [
            f"set arrow from graph 0, first {value!r} to graph 1, first {value!r} nohead lc rgb '#CC79A7' dt 2 lw 1.2",
            f"set label {_quoted(word)} at graph {place.format(value)} offset 0,0.45 tc rgb '#A0527A' font 'Helvetica,10'",
        ]
    commands = []
    for index, line in enumerate(plot.lines):
        rows = "\n".join(f"{x!r} {y!r}" for x, y in zip(line.x, line.y))
        out.append(f"$d{index} << EOD\n{rows}\nEOD")
        title = f"title {_quoted(line.title)}" if line.title else "notitle"
        commands.append(f"$d{index} using 1:2 with {line.style} {title}")
    out.append("plot " + ", \\\n  ".join(commands))
    return "\n".join(out) + "\n"


def draw(plot: Plot) -> str:
    """The chart as a data URI, so that definitions inside one drawing cannot meet those of another."""
    if not any(line.x for line in plot.lines):
        return ""
    result = subprocess.run(["gnuplot"], input=script(plot), capture_output=True, text=True)
    if result.returncode != 0 or "<svg" not in result.stdout:
        raise RuntimeError(f"gnuplot failed: {result.stderr.strip()}")
    return "data:image/svg+xml;base64," + base64.b64encode(result.stdout.encode()).decode()


def thumbnail(path: Path, width: int = 480) -> str:
    """A picture made small, as a data URI; empty if there is none."""
    if not path.is_file():
        return ""
    import io

    from PIL import Image

    image = Image.open(path).convert("RGB")
    image = image.resize((width, round(image.height * width / image.width)), Image.LANCZOS).quantize(64)
    stream = io.BytesIO()
    image.save(stream, "PNG", optimize=True)
    return "data:image/png;base64," + base64.b64encode(stream.getvalue()).decode()
