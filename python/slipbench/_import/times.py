"""Times as texts: ISO 8601, times of day, formats of Python's strptime; and times that do not ascend."""

from __future__ import annotations

import re
from datetime import UTC, date, datetime, timedelta

import numpy as np

from slipbench._import.keys import TIME_UNITS

DAY, HOUR, MINUTE = 86400, 3600, 60  # s
CLOCK = re.compile(r"([0-9]{1,2}):([0-5][0-9]):([0-5][0-9])(?:[.,]([0-9]{1,30}))?")
# ISO 8601, in the extended and the basic format: a date of the calendar, of a week or of a year, and
# a time of day, whose last part may have a decimal fraction, with an offset from UTC.
_DATE = r"(?P<year>[0-9]{4})(?P<dash>-?)(?:(?P<month>[0-9]{2})(?P=dash)(?P<day>[0-9]{2})|W(?P<week>[0-9]{2})(?P=dash)(?P<weekday>[1-7])|(?P<ordinal>[0-9]{3}))"
_TIME = r"(?P<hour>[0-9]{2})(?:(?P<colon>:?)(?P<minute>[0-5][0-9])(?:(?P=colon)(?P<second>[0-5][0-9]))?)?(?:[.,](?P<fraction>[0-9]{1,30}))?"
_ZONE = (
    r"(?:[Zz]|(?P<sign>[+\N{MINUS SIGN}-])(?P<east>[01][0-9]|2[0-3])(?::?(?P<past>[0-5][0-9]))?)?"
)
ISO = re.compile(rf"{_DATE}(?:[Tt _]{_TIME}{_ZONE})?")
LONGEST_FORMAT = 100  # characters


def is_moment(text: str) -> bool:
    """True for a date or a time of day, False for a number."""
    return ":" in text or (not text.isdecimal() and ISO.fullmatch(text) is not None)


def _fraction(digits: str | None, unit: int) -> tuple[float, float]:
    """Value of decimal digits after a point, and their resolution, in the unit's seconds."""
    return (
        (int(digits) * unit / 10 ** len(digits), unit / 10 ** len(digits))
        if digits
        else (0.0, float(unit))
    )


def moment_of(text: str) -> tuple[float, float]:
    """Seconds of a time in ISO 8601, and the resolution with which it is written [s].

    They count from 1970 for a date and time, UTC without an offset, and from midnight for a time of
    day such as 12:30:00.5.

    A fraction counts in the last part that is written: T23:40.05 is 40.05 minutes past 23.

    Raises:
        ValueError: the text is neither, or the date does not exist
    """
    if clock := CLOCK.fullmatch(text):
        part, resolution = _fraction(clock[4], 1)
        return HOUR * int(clock[1]) + MINUTE * int(clock[2]) + int(clock[3]) + part, resolution
    found = ISO.fullmatch(text)
    if not found:
        raise ValueError("neither ISO 8601 nor a time of day")
    year = int(found["year"])
    if found["month"]:
        day = date(year, int(found["month"]), int(found["day"]))
    elif found["week"]:
        day = date.fromisocalendar(year, int(found["week"]), int(found["weekday"]))
    else:
        day = date(year, 1, 1) + timedelta(days=int(found["ordinal"]) - 1)
        if day.year != year:
            raise ValueError("the year has no such day")
    seconds = DAY * (day.toordinal() - date(1970, 1, 1).toordinal())
    if not found["hour"]:
        return float(seconds), float(DAY)
    hour, minute, second = (int(found[name] or 0) for name in ("hour", "minute", "second"))
    part, resolution = _fraction(
        found["fraction"], 1 if found["second"] else MINUTE if found["minute"] else HOUR
    )
    if hour > 24 or (hour == 24 and (minute or second or part)):
        raise ValueError("the day has no such hour")
    seconds += HOUR * hour + MINUTE * minute + second
    if found["east"]:
        offset = HOUR * int(found["east"]) + MINUTE * int(found["past"] or 0)
        seconds -= offset if found["sign"] == "+" else -offset
    return seconds + part, resolution


def formatted_moment(text: str, pattern: str) -> float:
    """Seconds since 1970 of a text in a format of Python's strptime; UTC unless it has an offset.

    Raises ValueError if the text does not have the format.
    """
    moment = datetime.strptime(text, pattern)
    try:
        return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()
    except OverflowError as error:
        raise ValueError(str(error)) from error


def format_error(pattern: str) -> str:
    """Reason why a text is not a format of strptime; empty: it is one."""
    if len(pattern) > LONGEST_FORMAT:
        return f"has {len(pattern)} characters; expected at most {LONGEST_FORMAT}"
    try:
        datetime.strptime("", pattern)
    except re.error:
        return "names a part twice"
    except ValueError as error:
        return "" if "does not match format" in str(error) else str(error)
    return ""


def duration_text(seconds: float) -> str:
    """Seconds as "2 ms" or "1.5 s", to four digits."""
    unit = next((unit for unit in ("s", "ms", "us") if seconds >= 0.9995 * TIME_UNITS[unit]), "ns")
    return f"{np.format_float_positional(seconds / TIME_UNITS[unit], precision=4, fractional=False, trim='-')} {unit}"


def stamp_text(seconds: float) -> str:
    """A time with the digits that distinguish it from its neighbours: "1710201598.118 s"."""
    return f"{np.format_float_positional(seconds, trim='-')} s"


class AmbiguousStepError(ValueError):
    """A time that is more than half of the period of `wrap` after the one above it.

    Attributes:
        before, row: rows of the two times
    """

    def __init__(self, before: int, row: int) -> None:
        super().__init__(f"rows {before + 1} and {row + 1}")
        self.before, self.row = before, row


def unwrapped(times: np.ndarray, period: float) -> np.ndarray:
    """Times that start again after a period, as ascending times.

    Each step back by more than half of the period begins the next one.

    Args:
        times: [T] s, NaN if missing
        period: s

    Raises:
        ValueError: the times do not lie within one period
        AmbiguousStepError: a time is more than half of the period after the one above it
    """
    known = ~np.isnan(times)
    span = float(np.ptp(times[known])) if known.any() else 0.0
    if span > period:
        raise ValueError(f"the times span {duration_text(span)}")
    steps, rows = np.diff(times[known]), np.flatnonzero(known)
    # Swapped samples at the end of a period give such a step, which would begin a period too many.
    ambiguous = np.flatnonzero(steps > period / 2)
    if ambiguous.size:
        raise AmbiguousStepError(int(rows[ambiguous[0]]), int(rows[ambiguous[0] + 1]))
    whole = times.copy()
    whole[known] += period * np.concatenate([[0], np.cumsum(steps < -period / 2)])[: known.sum()]
    return whole


def jump_text(times: np.ndarray, row: int) -> str:
    """The likely cause of a time that comes before the one above it, and its remedy.

    Empty: unknown.

    Args:
        times: [T] s
        row: the first row whose time is earlier than the one above it
    """
    steps = np.diff(times[:row])
    step = float(np.median(steps)) if steps.size else 0.0
    drop = float(times[row - 1] - times[row])
    for bits in (16, 32):
        for unit in ("s", "ms", "us", "ns"):
            period = 2**bits * TIME_UNITS[unit]
            if period > 100 * step and 0 < period - drop <= 10 * step:
                return f"; the time jumps back by 2^{bits} {unit}: a counter of {bits} bits has wrapped; use wrap: {stamp_text(period)}"
    for period, text in (
        (DAY, "the clock passed midnight; write the times with their date, or use wrap: 1 day"),
        (DAY / 2, "a clock of 12 hours passed noon or midnight; use wrap: 12 h"),
    ):
        if period > 100 * step and 0 < period - drop <= 10 * step:
            return f"; {text}"
    if drop > 1.5 * step > 0 and abs(times[row] - times[0]) <= step:
        return "; the times start again: if the file has several recordings, write each into its own file"
    return ""
