"""Measurements on records.

Written by make_functions.py from the options of the commands.
"""

# ruff: noqa
from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from typing import Literal

from ._answer import Answer
from ._ask import Source, ask
from ._words import Joined


def spectrum(
    *record: Source,
    method: str | None = None,
    tones: int | None = None,
    segment: int | None = None,
    overlap: float | None = None,
    detrend: str | None = None,
    window: str | None = None,
    scaling: str | None = None,
    integrate: int | None = None,
    fmin: float | None = None,
    reference: str | int | None = None,
    estimator: str | None = None,
    hammer: bool = False,
    force_window: float | None = None,
    left_at_end: float | None = None,
    delay: float | None = None,
    decibel: float | None = None,
    channel: str | int | None = None,
    calibration: float | None = None,
    format: str | None = None,
    allow_missing: bool = False,
    rate: float | None = None,
    base_band: float | None = None,
    unit: str | Sequence[str] | None = None,
    axis_unit: str | None = None,
    decimal: str | None = None,
    complex: bool = False,
    wrapped: bool = False,
    columns: bool = False,
    span: str | tuple[float | None, float | None] | None = None,
    stretch: int | None = None,
    resample: float | None = None,
) -> Answer:
    """Spectrum of a channel, or frequency response function between two.

    ``record`` is a file, a record, a list of records of one length, or an array with ``rate`` and ``unit``.

    Numbers are in SI units. Raises ``Refused`` where the data allow no answer, and ``BadInput`` where a
    file or an argument is not what it should be.

    The answer: ``frequency``, ``value`` and ``level`` are lists; with ``tones`` each of ``tones`` has
    ``frequency``, ``amplitude`` and ``phase`` (of the sine at the first sample, rad). ``spectrum("a.csv",
    segment=4096).frequency``. A number has ``.value``, ``.std``, ``.unit`` and ``.interval()``; ``tables``
    are printed, ``tables[0].to_pandas()`` is a frame.

    Arguments:
        method: One transform of the whole record, fft, or the average over segments, welch [default:
            welch; fft with tones].
        tones: Fit the N strongest sines of the whole record, 1 to 10: frequency, amplitude and phase with
            their uncertainties.
        segment: Samples of a segment [default: 8192, or the whole of a shorter record; for blows, set by
            their ringing and spacing].
        overlap: Overlap of the segments, 0 to below 1 [default: 0.5].
        detrend: Removed before the window: mean or none [default: mean with welch or an integration, else
            none].
        window: Window: hann, rectangular, hamming, blackman, blackman-harris, flat-top [default: hann].
        scaling: Scaling of the lines: peak, rms, power or psd [default: peak].
        integrate: Integrations in frequency: 1 takes velocity to displacement, −1 to acceleration
            [default: 0].
        fmin: Lowest frequency of the result, in Hz [default: two lines where integrated, else 0].
        reference: Channel of the excitation, or FILE#CHANNEL, for the frequency response function.
        estimator: FRF estimator: h1 for noise in the response, h2 for noise in the excitation, hv for
            noise in both [default: h1].
        hammer: Hammer test: one segment for each blow; the level before the blow is removed.
        force_window: Width of the force window in s [default: ten contact times, 64 samples at least].
        left_at_end: Value of the exponential window at the end of a segment, e.g. 0.01.
        delay: Channel delay to remove, in s: the channel was recorded later than the reference.
        decibel: Give levels in decibels over this reference, in SI units of the channel: 1, or 1e-6 for 1
            µm/s².

    Channel:
        channel: Record of the file, by name or by number from 1 [default: the only one].
        calibration: Factor on the stored values; with a unit, to that unit.

    Reading of files:
        format: File format, instead of detecting it.
        allow_missing: Keep NaN, Inf and blank values as missing, instead of refusing them.
        rate: Sampling rate in Hz: the values are a time trace.
        base_band: Base band in Hz: the values are a spectrum from 0 to it, or a trace sampled at 2.56
            times it.
        unit: Unit of the values, such as mm/s; of one channel NAME=UNIT.
        axis_unit: Unit of times or frequencies whose column names none, such as ms.
        decimal: Decimal mark, where the file leaves it open: comma or point.
        complex: Two columns of values are real and imaginary part.
        wrapped: Rows of several columns continue each other as one series.
        columns: Each column is a channel, however much the rows look like one series.
        span: Only this part of a time trace, from and to in s; 600: is to its end. ``(from, to)``.
        stretch: Stretch between lost samples that is used, by its number from 1.
        resample: Rate in Hz at which samples of uneven times are interpolated.
    """
    return ask(["spectrum"], list(record), {"method": method, "tones": tones, "segment": segment, "overlap": overlap, "detrend": detrend, "window": window, "scaling": scaling, "integrate": integrate, "fmin": fmin, "reference": reference, "estimator": estimator, "hammer": hammer, "force_window": force_window, "left_at_end": left_at_end, "delay": delay, "decibel": decibel, "channel": channel, "calibration": calibration, "format": format, "allow_missing": allow_missing, "rate": rate, "base_band": base_band, "unit": unit, "axis_unit": axis_unit, "decimal": decimal, "complex": complex, "wrapped": wrapped, "columns": columns, "span": Joined(":", span), "stretch": stretch, "resample": resample})


def impacts(
    record: Source,
    *,
    legacy: bool = False,
    excitation: float | None = None,
    reference: str | int | None = None,
    threshold: float | None = None,
    refractory: float | None = None,
    band: str | tuple[float | None, float | None] | None = None,
    envelope: bool = False,
    keep_hum: bool = False,
    shape: str | PathLike[str] | None = None,
    shape_rate: float | None = None,
    none_missed: bool = False,
    channel: str | int | None = None,
    calibration: float | None = None,
    format: str | None = None,
    allow_missing: bool = False,
    rate: float | None = None,
    base_band: float | None = None,
    unit: str | Sequence[str] | None = None,
    axis_unit: str | None = None,
    decimal: str | None = None,
    complex: bool = False,
    wrapped: bool = False,
    columns: bool = False,
    span: str | tuple[float | None, float | None] | None = None,
    stretch: int | None = None,
    resample: float | None = None,
) -> Answer:
    """Impacts in a contact signal: interval, frequency, impacts per cycle.

    ``record`` is a file, a record, a list of records of one length, or an array with ``rate`` and ``unit``.

    Numbers are in SI units. Raises ``Refused`` where the data allow no answer, and ``BadInput`` where a
    file or an argument is not what it should be.

    The answer: ``n``, ``times`` (s) and ``heights`` of the impacts, ``interval`` (mean, s), ``frequency``
    (Hz), with an excitation ``per_cycle``. ``impacts("a.csv", excitation=11.2).interval.interval()``. A
    number has ``.value``, ``.std``, ``.unit`` and ``.interval()``; ``tables`` are printed,
    ``tables[0].to_pandas()`` is a frame.

    Arguments:
        legacy: Repeat the thesis' script timeav with its mistakes.
        excitation: Frequency of the excitation in Hz.
        reference: Trigger channel of the same file, one rising edge per excitation cycle, by name or by
            number from 1.
        threshold: Smallest impact counted, as a fraction of the median height [default: 0.125].
        refractory: Shortest time between two impacts in s: ringing within it counts once [default: found
            from the trace].
        band: Band in Hz in which the impacts ring: the trace is filtered to it first, without delay.
            ``(lo, hi)``.
        envelope: Detect impacts in the envelope, so that ringing does not split one impact.
        keep_hum: Do not remove mains hum.
        shape: Record of one pulse: each impact is matched to its shape.
        shape_rate: Sampling rate of that record in Hz, where its file does not state it.
        none_missed: No impact is missed or double, however uneven the intervals are.

    Channel:
        channel: Record of the file, by name or by number from 1 [default: the only one].
        calibration: Factor on the stored values; with a unit, to that unit.

    Reading of files:
        format: File format, instead of detecting it.
        allow_missing: Keep NaN, Inf and blank values as missing, instead of refusing them.
        rate: Sampling rate in Hz: the values are a time trace.
        base_band: Base band in Hz: the values are a spectrum from 0 to it, or a trace sampled at 2.56
            times it.
        unit: Unit of the values, such as mm/s; of one channel NAME=UNIT.
        axis_unit: Unit of times or frequencies whose column names none, such as ms.
        decimal: Decimal mark, where the file leaves it open: comma or point.
        complex: Two columns of values are real and imaginary part.
        wrapped: Rows of several columns continue each other as one series.
        columns: Each column is a channel, however much the rows look like one series.
        span: Only this part of a time trace, from and to in s; 600: is to its end. ``(from, to)``.
        stretch: Stretch between lost samples that is used, by its number from 1.
        resample: Rate in Hz at which samples of uneven times are interpolated.
    """
    return ask(["impacts"], [record], {"legacy": legacy, "excitation": excitation, "reference": reference, "threshold": threshold, "refractory": refractory, "band": Joined(":", band), "envelope": envelope, "keep_hum": keep_hum, "shape": shape, "shape_rate": shape_rate, "none_missed": none_missed, "channel": channel, "calibration": calibration, "format": format, "allow_missing": allow_missing, "rate": rate, "base_band": base_band, "unit": unit, "axis_unit": axis_unit, "decimal": decimal, "complex": complex, "wrapped": wrapped, "columns": columns, "span": Joined(":", span), "stretch": stretch, "resample": resample})


def restitution(
    *record: Source,
    height: float | None = None,
    height_std: float | None = None,
    interval: float | None = None,
    interval_std: float | None = None,
    intervals: str | Sequence[str | float] | None = None,
    contact_time: float | None = None,
    contact_time_std: float | None = None,
    gravity: float | None = None,
    gravity_std: float | None = None,
    threshold: float | None = None,
    refractory: float | None = None,
    keep_hum: bool = False,
    masses: str | None = None,
    before: str | None = None,
    after: str | Sequence[str | float] | None = None,
    after2: float | None = None,
    velocity_std: float | None = None,
    channel: str | int | None = None,
    calibration: float | None = None,
    format: str | None = None,
    allow_missing: bool = False,
    rate: float | None = None,
    base_band: float | None = None,
    unit: str | Sequence[str] | None = None,
    axis_unit: str | None = None,
    decimal: str | None = None,
    complex: bool = False,
    wrapped: bool = False,
    columns: bool = False,
    span: str | tuple[float | None, float | None] | None = None,
    stretch: int | None = None,
    resample: float | None = None,
) -> Answer:
    """Coefficient of restitution from drops, bounces or velocities, every method side by side.

    ``record`` is a file, a record, a list of records of one length, or an array with ``rate`` and ``unit``.

    Numbers are in SI units. Raises ``Refused`` where the data allow no answer, and ``BadInput`` where a
    file or an argument is not what it should be.

    The answer: ``restitution``, the methods one by one in ``by``, and ``agree``: whether they agree;
    ``intervals`` and ``times`` (s) of each drop. ``restitution("a.csv", height=0.57,
    height_std=0.001).restitution.std``. A number has ``.value``, ``.std``, ``.unit`` and ``.interval()``;
    ``tables`` are printed, ``tables[0].to_pandas()`` is a frame.

    Arguments:
        height: Drop height in m; not needed for a train of bounces.
        height_std: Its standard uncertainty in m.
        interval: Time from first to second impact in s.
        interval_std: Standard uncertainty of the interval in s.
        intervals: Times between successive impacts of one train of bounces, in s. ``(a, b, c)``.
        contact_time: How long an impact lasts, in s: taken off each interval, which runs from beginning
            to beginning [default: as a force shows it, else 0].
        contact_time_std: Standard uncertainty of the contact time in s.
        gravity: Acceleration of free fall in m/s² [default: 9.80665].
        gravity_std: Its standard uncertainty in m/s².
        threshold: Smallest impact counted, as a fraction of the median height [default: 0.02].
        refractory: Shortest time between two impacts in s: ringing within it counts once [default: found
            from the trace].
        keep_hum: Do not remove mains hum.
        masses: Masses in kg: the striking and the struck one.
        before: Velocities of both masses before the impact, in m/s.
        after: Velocities of both masses after it, in m/s; of mass 1 alone where masses are given. ``(v1,
            v2)``.
        after2: Velocity of mass 2 after it, in m/s, where that of mass 1 is not known and masses are
            given.
        velocity_std: Standard uncertainty of each velocity, in m/s.

    Channel:
        channel: Record of the file, by name or by number from 1 [default: the only one].
        calibration: Factor on the stored values; with a unit, to that unit.

    Reading of files:
        format: File format, instead of detecting it.
        allow_missing: Keep NaN, Inf and blank values as missing, instead of refusing them.
        rate: Sampling rate in Hz: the values are a time trace.
        base_band: Base band in Hz: the values are a spectrum from 0 to it, or a trace sampled at 2.56
            times it.
        unit: Unit of the values, such as mm/s; of one channel NAME=UNIT.
        axis_unit: Unit of times or frequencies whose column names none, such as ms.
        decimal: Decimal mark, where the file leaves it open: comma or point.
        complex: Two columns of values are real and imaginary part.
        wrapped: Rows of several columns continue each other as one series.
        columns: Each column is a channel, however much the rows look like one series.
        span: Only this part of a time trace, from and to in s; 600: is to its end. ``(from, to)``.
        stretch: Stretch between lost samples that is used, by its number from 1.
        resample: Rate in Hz at which samples of uneven times are interpolated.
    """
    return ask(["restitution"], list(record), {"height": height, "height_std": height_std, "interval": interval, "interval_std": interval_std, "intervals": Joined(",", intervals), "contact_time": contact_time, "contact_time_std": contact_time_std, "gravity": gravity, "gravity_std": gravity_std, "threshold": threshold, "refractory": refractory, "keep_hum": keep_hum, "masses": masses, "before": before, "after": Joined(",", after), "after2": after2, "velocity_std": velocity_std, "channel": channel, "calibration": calibration, "format": format, "allow_missing": allow_missing, "rate": rate, "base_band": base_band, "unit": unit, "axis_unit": axis_unit, "decimal": decimal, "complex": complex, "wrapped": wrapped, "columns": columns, "span": Joined(":", span), "stretch": stretch, "resample": resample})


def pulse(
    record: Source | None = None,
    *,
    time_to_peak: str | None = None,
    duration: float | None = None,
    std: float | None = None,
    mass: float | None = None,
    low_pass: str | None = None,
    order: int | None = None,
    channel: str | int | None = None,
    calibration: float | None = None,
    format: str | None = None,
    allow_missing: bool = False,
    rate: float | None = None,
    base_band: float | None = None,
    unit: str | Sequence[str] | None = None,
    axis_unit: str | None = None,
    decimal: str | None = None,
    complex: bool = False,
    wrapped: bool = False,
    columns: bool = False,
    span: str | tuple[float | None, float | None] | None = None,
    stretch: int | None = None,
    resample: float | None = None,
) -> Answer:
    """Damping ratio, frequency and restitution of a contact from its pulse.

    ``record`` is a file, a record, a list of records of one length, or an array with ``rate`` and ``unit``.

    Numbers are in SI units. Raises ``Refused`` where the data allow no answer, and ``BadInput`` where a
    file or an argument is not what it should be.

    The answer: ``xi`` (damping ratio of the contact), ``frequency`` (undamped, Hz), ``restitution``,
    ``duration`` (s), ``stiffness`` and ``damping`` with a mass, ``initial_velocity`` (m/s), ``peak`` and
    ``impulse`` of the force (N, N s) and ``peak_read`` and ``impulse_read`` of its samples, every model in
    ``fits``. ``pulse("a.csv", mass=0.125, low_pass="none").duration``. A number has ``.value``, ``.std``,
    ``.unit`` and ``.interval()``; ``tables`` are printed, ``tables[0].to_pandas()`` is a frame.

    Arguments:
        time_to_peak: Time from the onset to the largest force in s, instead of a file.
        duration: Time from the onset to the end of the contact, in s.
        std: Standard uncertainty of each of the two times, in s.
        mass: Decelerated mass in kg, for stiffness and damping, of an acceleration also for force and
            impulse.
        low_pass: Corner (-3 dB) of the instrument's Butterworth low-pass, in Hz, or none [default: not
            known, and no uncertainty].
        order: Order of that low-pass, 1 to 10.

    Channel:
        channel: Record of the file, by name or by number from 1 [default: the only one].
        calibration: Factor on the stored values; with a unit, to that unit.

    Reading of files:
        format: File format, instead of detecting it.
        allow_missing: Keep NaN, Inf and blank values as missing, instead of refusing them.
        rate: Sampling rate in Hz: the values are a time trace.
        base_band: Base band in Hz: the values are a spectrum from 0 to it, or a trace sampled at 2.56
            times it.
        unit: Unit of the values, such as mm/s; of one channel NAME=UNIT.
        axis_unit: Unit of times or frequencies whose column names none, such as ms.
        decimal: Decimal mark, where the file leaves it open: comma or point.
        complex: Two columns of values are real and imaginary part.
        wrapped: Rows of several columns continue each other as one series.
        columns: Each column is a channel, however much the rows look like one series.
        span: Only this part of a time trace, from and to in s; 600: is to its end. ``(from, to)``.
        stretch: Stretch between lost samples that is used, by its number from 1.
        resample: Rate in Hz at which samples of uneven times are interpolated.
    """
    return ask(["pulse"], [] if record is None else [record], {"time_to_peak": time_to_peak, "duration": duration, "std": std, "mass": mass, "low_pass": low_pass, "order": order, "channel": channel, "calibration": calibration, "format": format, "allow_missing": allow_missing, "rate": rate, "base_band": base_band, "unit": unit, "axis_unit": axis_unit, "decimal": decimal, "complex": complex, "wrapped": wrapped, "columns": columns, "span": Joined(":", span), "stretch": stretch, "resample": resample})


def decay(
    record: Source,
    *,
    band: str | tuple[float | None, float | None] | None = None,
    modes: int | None = None,
    channel: str | int | None = None,
    calibration: float | None = None,
    format: str | None = None,
    allow_missing: bool = False,
    rate: float | None = None,
    base_band: float | None = None,
    unit: str | Sequence[str] | None = None,
    axis_unit: str | None = None,
    decimal: str | None = None,
    complex: bool = False,
    wrapped: bool = False,
    columns: bool = False,
    span: str | tuple[float | None, float | None] | None = None,
    stretch: int | None = None,
    resample: float | None = None,
) -> Answer:
    """Natural frequency and damping of each mode of a free decay.

    ``record`` is a file, a record, a list of records of one length, or an array with ``rate`` and ``unit``.

    Numbers are in SI units. Raises ``Refused`` where the data allow no answer, and ``BadInput`` where a
    file or an argument is not what it should be.

    The answer: Each of ``modes`` has ``frequency`` (undamped, Hz), ``zeta``, ``amplitude`` and ``phase``
    (of the cosine at ``start``, rad); ``decrement`` is ζ of the strongest mode from the fall of its
    amplitude; ``start`` and ``end`` (s) of the part that was used. ``decay("a.csv").modes[0].zeta``. A
    number has ``.value``, ``.std``, ``.unit`` and ``.interval()``; ``tables`` are printed,
    ``tables[0].to_pandas()`` is a frame.

    Arguments:
        band: Band in Hz in which modes are looked for [default: all lines]. ``(lo, hi)``.
        modes: Number of modes [default: all that stand out of the noise].

    Channel:
        channel: Record of the file, by name or by number from 1 [default: the only one].
        calibration: Factor on the stored values; with a unit, to that unit.

    Reading of files:
        format: File format, instead of detecting it.
        allow_missing: Keep NaN, Inf and blank values as missing, instead of refusing them.
        rate: Sampling rate in Hz: the values are a time trace.
        base_band: Base band in Hz: the values are a spectrum from 0 to it, or a trace sampled at 2.56
            times it.
        unit: Unit of the values, such as mm/s; of one channel NAME=UNIT.
        axis_unit: Unit of times or frequencies whose column names none, such as ms.
        decimal: Decimal mark, where the file leaves it open: comma or point.
        complex: Two columns of values are real and imaginary part.
        wrapped: Rows of several columns continue each other as one series.
        columns: Each column is a channel, however much the rows look like one series.
        span: Only this part of a time trace, from and to in s; 600: is to its end. ``(from, to)``.
        stretch: Stretch between lost samples that is used, by its number from 1.
        resample: Rate in Hz at which samples of uneven times are interpolated.
    """
    return ask(["decay"], [record], {"band": Joined(":", band), "modes": modes, "channel": channel, "calibration": calibration, "format": format, "allow_missing": allow_missing, "rate": rate, "base_band": base_band, "unit": unit, "axis_unit": axis_unit, "decimal": decimal, "complex": complex, "wrapped": wrapped, "columns": columns, "span": Joined(":", span), "stretch": stretch, "resample": resample})


def modal(
    record: Source,
    *,
    band: str | tuple[float | None, float | None] | None = None,
    mass: float | None = None,
    coherence: str | PathLike[str] | None = None,
    least_coherence: float | None = None,
    reference: str | int | None = None,
    estimator: str | None = None,
    segment: int | None = None,
    overlap: float | None = None,
    detrend: str | None = None,
    window: str | None = None,
    integrate: int | None = None,
    fmin: float | None = None,
    hammer: bool = False,
    force_window: float | None = None,
    left_at_end: float | None = None,
    delay: float | None = None,
    channel: str | int | None = None,
    calibration: float | None = None,
    format: str | None = None,
    allow_missing: bool = False,
    rate: float | None = None,
    base_band: float | None = None,
    unit: str | Sequence[str] | None = None,
    axis_unit: str | None = None,
    decimal: str | None = None,
    complex: bool = False,
    wrapped: bool = False,
    columns: bool = False,
    span: str | tuple[float | None, float | None] | None = None,
    stretch: int | None = None,
    resample: float | None = None,
) -> Answer:
    """Natural frequency, damping and modal constant of the modes of a frequency response function.

    ``record`` is a file, a record, a list of records of one length, or an array with ``rate`` and ``unit``.

    Numbers are in SI units. Raises ``Refused`` where the data allow no answer, and ``BadInput`` where a
    file or an argument is not what it should be.

    The answer: Each of ``modes`` has ``frequency`` (undamped, Hz), ``zeta``, ``modal_constant``, ``phase``
    (°), with a mass ``stiffness``. Of a time record: ``modal("a.csv", reference="force",
    channel="velocity", segment=1024, mass=0.125).modes[0].frequency``; of hammer blows with
    ``hammer=True``. A number has ``.value``, ``.std``, ``.unit`` and ``.interval()``; ``tables`` are
    printed, ``tables[0].to_pandas()`` is a frame.

    Arguments:
        band: Band in Hz whose peaks are fitted together [default: a band around each peak]. ``(lo, hi)``.
        mass: Mass in kg, for the stiffness k = m(2 pi f)^2.
        coherence: File with the coherence of the same lines [default: a coherence in the file].
        least_coherence: Lines with a lower coherence are left out [default: 0.5].
        reference: Channel of the excitation in a time record, or FILE#CHANNEL: the frequency response
            function is computed first.
        estimator: FRF estimator: h1 for noise in the response, h2 for noise in the excitation, hv for
            noise in both [default: h1].
        segment: Samples of a segment [default: 8192, or the whole of a shorter record; for blows, set by
            their ringing and spacing].
        overlap: Overlap of the segments, 0 to below 1 [default: 0.5].
        detrend: Removed from a segment before the window: mean or none [default: mean].
        window: Window of a segment [default: hann].
        integrate: Integrations in frequency [default: 0].
        fmin: Lowest frequency in Hz [default: two lines where integrated, else 0].
        hammer: Hammer test: one segment for each blow.
        force_window: Width of the force window in s [default: ten contact times, 64 samples at least].
        left_at_end: Value of the exponential window at the end of a segment.
        delay: Channel delay to remove, in s.

    Channel:
        channel: Record of the file, by name or by number from 1 [default: the only one].
        calibration: Factor on the stored values; with a unit, to that unit.

    Reading of files:
        format: File format, instead of detecting it.
        allow_missing: Keep NaN, Inf and blank values as missing, instead of refusing them.
        rate: Sampling rate in Hz: the values are a time trace.
        base_band: Base band in Hz: the values are a spectrum from 0 to it, or a trace sampled at 2.56
            times it.
        unit: Unit of the values, such as mm/s; of one channel NAME=UNIT.
        axis_unit: Unit of times or frequencies whose column names none, such as ms.
        decimal: Decimal mark, where the file leaves it open: comma or point.
        complex: Two columns of values are real and imaginary part.
        wrapped: Rows of several columns continue each other as one series.
        columns: Each column is a channel, however much the rows look like one series.
        span: Only this part of a time trace, from and to in s; 600: is to its end. ``(from, to)``.
        stretch: Stretch between lost samples that is used, by its number from 1.
        resample: Rate in Hz at which samples of uneven times are interpolated.
    """
    return ask(["modal"], [record], {"band": Joined(":", band), "mass": mass, "coherence": coherence, "least_coherence": least_coherence, "reference": reference, "estimator": estimator, "segment": segment, "overlap": overlap, "detrend": detrend, "window": window, "integrate": integrate, "fmin": fmin, "hammer": hammer, "force_window": force_window, "left_at_end": left_at_end, "delay": delay, "channel": channel, "calibration": calibration, "format": format, "allow_missing": allow_missing, "rate": rate, "base_band": base_band, "unit": unit, "axis_unit": axis_unit, "decimal": decimal, "complex": complex, "wrapped": wrapped, "columns": columns, "span": Joined(":", span), "stretch": stretch, "resample": resample})


def drill(
    record: Source,
    *,
    velocity: str | None = None,
    reference: str | int | None = None,
    sensitivity: float | None = None,
    beam_angle: float | None = None,
    beam_from: str | None = None,
    pulses_per_turn: int | None = None,
    edge: str | None = None,
    level: float | None = None,
    mass: float | None = None,
    struck_mass: float | None = None,
    contact: float | None = None,
    fit_duration: float | None = None,
    longest_dropout: float | None = None,
    delay: float | None = None,
    points: int | None = None,
    low_pass: str | None = None,
    smoothing: float | None = None,
    instrument: float | None = None,
    noise_record: str | PathLike[str] | None = None,
    margin: float | None = None,
    handle: str | Sequence[str] | None = None,
    handle_sensitivity: float | None = None,
    exposure: float | None = None,
    channel: str | int | None = None,
    calibration: float | None = None,
    format: str | None = None,
    allow_missing: bool = False,
    rate: float | None = None,
    base_band: float | None = None,
    unit: str | Sequence[str] | None = None,
    axis_unit: str | None = None,
    decimal: str | None = None,
    complex: bool = False,
    wrapped: bool = False,
    columns: bool = False,
    span: str | tuple[float | None, float | None] | None = None,
    stretch: int | None = None,
    resample: float | None = None,
) -> Answer:
    """Speed, impacts and average turn of a hammer drill.

    ``record`` is a file, a record, a list of records of one length, or an array with ``rate`` and ``unit``.

    Numbers are in SI units. Raises ``Refused`` where the data allow no answer, and ``BadInput`` where a
    file or an argument is not what it should be.

    The answer: ``speed`` (Hz), ``before`` and ``after`` (mean velocities at first contact, m/s), ``phase``
    (turns), ``energy``, ``energy_given`` (J), ``restitution``; each blow in ``impacts``, the mean turn in
    ``average``. A number has ``.value``, ``.std``, ``.unit`` and ``.interval()``; ``tables`` are printed,
    ``tables[0].to_pandas()`` is a frame.

    Arguments:
        velocity: Velocity channel, by name or by number from 1.
        reference: Channel with the pulses of the crank [default: none, the turns come from the impacts].
        sensitivity: Velocity along the beam in m/s for one unit of the channel [default: 1 where the file
            says it is a velocity].
        beam_angle: Angle of the beam in degrees.
        beam_from: What the beam angle is counted from: normal (to the motion) or axis (of the motion).
        pulses_per_turn: Pulses of the reference in a turn.
        edge: Edge of the pulse that counts: rising or falling.
        level: Trigger level of the edge, in the unit of the reference [default: the middle of its two
            levels].
        mass: Measured mass in kg, for the energies.
        struck_mass: Struck mass in kg, at rest before the impact, for the restitution.
        contact: Longest contact in s [default: 0.0002].
        fit_duration: Duration in s of the fits before and after a contact [default: 0.0005].
        longest_dropout: Longest drop-out in s that is bridged [default: 0.002].
        delay: Channel delay to remove, in s: the velocity was recorded later than the reference [default:
            0].
        points: Points of the average turn [default: 720].
        low_pass: Corner in Hz of the zero-phase low-pass for average and displacement, or `none`
            [default: the highest frequency that the points of the average turn resolve].
        smoothing: Time constant in s of exponential smoothing instead of the low-pass.
        instrument: Bandwidth of the instrument in Hz.
        noise_record: Record of the velocity channel without motion: the noise floor.
        margin: Margin in dB of the motion above the noise [default: 10].
        handle: Acceleration channel of a handle, up to three times: hand-arm exposure.
        handle_sensitivity: Acceleration in m/s² for one unit of these channels.
        exposure: Hours a day of that exposure: A(8).

    Channel:
        channel: Record of the file, by name or by number from 1 [default: the only one].
        calibration: Factor on the stored values; with a unit, to that unit.

    Reading of files:
        format: File format, instead of detecting it.
        allow_missing: Keep NaN, Inf and blank values as missing, instead of refusing them.
        rate: Sampling rate in Hz: the values are a time trace.
        base_band: Base band in Hz: the values are a spectrum from 0 to it, or a trace sampled at 2.56
            times it.
        unit: Unit of the values, such as mm/s; of one channel NAME=UNIT.
        axis_unit: Unit of times or frequencies whose column names none, such as ms.
        decimal: Decimal mark, where the file leaves it open: comma or point.
        complex: Two columns of values are real and imaginary part.
        wrapped: Rows of several columns continue each other as one series.
        columns: Each column is a channel, however much the rows look like one series.
        span: Only this part of a time trace, from and to in s; 600: is to its end. ``(from, to)``.
        stretch: Stretch between lost samples that is used, by its number from 1.
        resample: Rate in Hz at which samples of uneven times are interpolated.
    """
    return ask(["drill"], [record], {"velocity": velocity, "reference": reference, "sensitivity": sensitivity, "beam_angle": beam_angle, "beam_from": beam_from, "pulses_per_turn": pulses_per_turn, "edge": edge, "level": level, "mass": mass, "struck_mass": struck_mass, "contact": contact, "fit_duration": fit_duration, "longest_dropout": longest_dropout, "delay": delay, "points": points, "low_pass": low_pass, "smoothing": smoothing, "instrument": instrument, "noise_record": noise_record, "margin": margin, "handle": handle, "handle_sensitivity": handle_sensitivity, "exposure": exposure, "channel": channel, "calibration": calibration, "format": format, "allow_missing": allow_missing, "rate": rate, "base_band": base_band, "unit": unit, "axis_unit": axis_unit, "decimal": decimal, "complex": complex, "wrapped": wrapped, "columns": columns, "span": Joined(":", span), "stretch": stretch, "resample": resample})


def response(
    *sweep: str | PathLike[str],
    legacy: bool = False,
    allow_outside: bool = False,
    unit: str | None = None,
    calibration: float | None = None,
    window: str | None = None,
    scaling: str | None = None,
    analyser_integrated: int | None = None,
    fmin: float | None = None,
    integrate: int | None = None,
    peak_lines: int | None = None,
) -> Answer:
    """Response of a sweep at the excitation frequency, with resonances and jumps.

    ``sweep`` is a list file, campaign.toml#name, a folder, or the files of its steps.

    Numbers are in SI units. Raises ``Refused`` where the data allow no answer, and ``BadInput`` where a
    file or an argument is not what it should be.

    Arguments:
        legacy: Repeat the thesis' script with its mistakes.
        allow_outside: Allow files outside the folder of the list.
        unit: Unit of the stored responses [default: what the files say, else the SI unit of the quantity,
            m where none is stated].
        calibration: Factor on the stored responses.
        window: Window of the analyser: hann, rectangular, hamming, blackman, blackman-harris, flat-top,
            unknown [default: hann, assumed].
        scaling: Scaling of the spectra: peak or rms [default: peak, assumed].
        analyser_integrated: How often the analyser integrated before it stored, 0 to 2 [default: once for
            a displacement].
        fmin: Lowest frequency used, in Hz [default: two lines or a quarter of the lowest excitation].
        integrate: Integrations in frequency: 1 takes velocity to displacement [default: what takes the
            stored quantity to displacement].
        peak_lines: Lines on both sides of the excitation that are searched for the peak.
    """
    return ask(["response"], list(sweep), {"legacy": legacy, "allow_outside": allow_outside, "unit": unit, "calibration": calibration, "window": window, "scaling": scaling, "analyser_integrated": analyser_integrated, "fmin": fmin, "integrate": integrate, "peak_lines": peak_lines})


def waterfall(
    *sweep: str | PathLike[str],
    legacy: bool = False,
    allow_outside: bool = False,
    unit: str | None = None,
    calibration: float | None = None,
    window: str | None = None,
    scaling: str | None = None,
    analyser_integrated: int | None = None,
    fmin: float | None = None,
    integrate: int | None = None,
    peak_lines: int | None = None,
    fmax: float | None = None,
) -> Answer:
    """Waterfall of all response spectra of a sweep.

    ``sweep`` is a list file, campaign.toml#name, a folder, or the files of its steps.

    Numbers are in SI units. Raises ``Refused`` where the data allow no answer, and ``BadInput`` where a
    file or an argument is not what it should be.

    Arguments:
        legacy: Repeat the thesis' script with its mistakes.
        allow_outside: Allow files outside the folder of the list.
        unit: Unit of the stored responses [default: what the files say, else the SI unit of the quantity,
            m where none is stated].
        calibration: Factor on the stored responses.
        window: Window of the analyser: hann, rectangular, hamming, blackman, blackman-harris, flat-top,
            unknown [default: hann, assumed].
        scaling: Scaling of the spectra: peak or rms [default: peak, assumed].
        analyser_integrated: How often the analyser integrated before it stored, 0 to 2 [default: once for
            a displacement].
        fmin: Lowest frequency used, in Hz [default: two lines or a quarter of the lowest excitation].
        integrate: Integrations in frequency: 1 takes velocity to displacement [default: what takes the
            stored quantity to displacement].
        peak_lines: Lines on both sides of the excitation that are searched for the peak.
        fmax: Highest frequency drawn, in Hz [default: the last line to be seen].
    """
    return ask(["waterfall"], list(sweep), {"legacy": legacy, "allow_outside": allow_outside, "unit": unit, "calibration": calibration, "window": window, "scaling": scaling, "analyser_integrated": analyser_integrated, "fmin": fmin, "integrate": integrate, "peak_lines": peak_lines, "fmax": fmax})


def excitation(
    *sweep: str | PathLike[str],
    legacy: bool = False,
    allow_outside: bool = False,
    unit: str | None = None,
    calibration: float | None = None,
    window: str | None = None,
    scaling: str | None = None,
    analyser_integrated: int | None = None,
    fmin: float | None = None,
) -> Answer:
    """Excitation frequency of every point of a sweep.

    ``sweep`` is a list file, campaign.toml#name, a folder, or the files of its steps.

    Numbers are in SI units. Raises ``Refused`` where the data allow no answer, and ``BadInput`` where a
    file or an argument is not what it should be.

    Arguments:
        legacy: Repeat the thesis' script with its mistakes.
        allow_outside: Allow files outside the folder of the list.
        unit: Unit of the stored responses [default: what the files say, else the SI unit of the quantity,
            m where none is stated].
        calibration: Factor on the stored responses.
        window: Window of the analyser: hann, rectangular, hamming, blackman, blackman-harris, flat-top,
            unknown [default: hann, assumed].
        scaling: Scaling of the spectra: peak or rms [default: peak, assumed].
        analyser_integrated: How often the analyser integrated before it stored, 0 to 2 [default: once for
            a displacement].
        fmin: Lowest frequency used, in Hz [default: two lines or a quarter of the lowest excitation].
    """
    return ask(["excitation"], list(sweep), {"legacy": legacy, "allow_outside": allow_outside, "unit": unit, "calibration": calibration, "window": window, "scaling": scaling, "analyser_integrated": analyser_integrated, "fmin": fmin})


def compare(
    campaign: str | PathLike[str],
    *,
    allow_outside: bool = False,
    fit: str | Sequence[str | float] | None = None,
    monte_carlo: int | None = None,
) -> Answer:
    """Compare the measured responses of a campaign with the model; fit parameters of the rig.

    Numbers are in SI units. Raises ``Refused`` where the data allow no answer, and ``BadInput`` where a
    file or an argument is not what it should be.

    Arguments:
        allow_outside: Allow files outside the folder of the campaign.
        fit: Parameters to fit, separated by commas: force, restitution, c1, c2, gap, k1, k2, and m1, m2
            with a prior in [fit] [default: those of [fit] in the campaign].
        monte_carlo: Draw the parameters N times from [uncertainty] of the campaign: bands that hold 95 %
            of the draws.
    """
    return ask(["compare"], [campaign], {"allow_outside": allow_outside, "fit": Joined(",", fit), "monte_carlo": monte_carlo})
