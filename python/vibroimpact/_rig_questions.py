"""Questions to the model of a rig.

Written by make_functions.py from the options of the commands.
"""

# ruff: noqa
from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any, Literal

from ._answer import Answer
from ._words import Joined


class RigQuestions:
    """The questions that a rig answers."""

    def _ask(self, command: Sequence[str], options: Mapping[str, Any]) -> Answer:
        raise NotImplementedError

    def orbits(
        self,
        *,
        force: float | None = None,
        impulse: float | None = None,
        width: float | None = None,
        frequency: float | None = None,
        impacts: int | None = None,
        cycles: int | None = None,
        gap_std: float | None = None,
    ) -> Answer:
        """All motions with one impact a period at one frequency, or those found with several, with existence and stability.

        Numbers are in SI units. Raises ``Refused`` where the data allow no answer, and ``BadInput`` where a
        file or an argument is not what it should be.

        Arguments:
            force: Force in N: amplitude of a sine, height of a pulse.
            impulse: Impulse in N s, once a cycle, instead of a sine force.
            width: Width in s of a rectangular pulse, once a cycle, instead of a sine force.
            frequency: Excitation frequency in Hz.
            impacts: Impacts in a period.
            cycles: Excitation cycles in a period.
            gap_std: Standard uncertainty of the gap in m: a motion nearer to grazing is not robust.
        """
        return self._ask(["model", "orbit"], {"force": force, "impulse": impulse, "width": width, "frequency": frequency, "impacts": impacts, "cycles": cycles, "gap_std": gap_std})

    def simulate(
        self,
        *,
        force: float | None = None,
        impulse: float | None = None,
        width: float | None = None,
        frequency: float | None = None,
        model: str | None = None,
        cycles: int | None = None,
        settle: int | None = None,
        initial: str | Sequence[str | float] | None = None,
        phase: float | None = None,
        grazing: float | None = None,
    ) -> Answer:
        """Simulated motion: regime, traces, phase plane, Poincaré section.

        Numbers are in SI units. Raises ``Refused`` where the data allow no answer, and ``BadInput`` where a
        file or an argument is not what it should be.

        Arguments:
            force: Force in N: amplitude of a sine, height of a pulse.
            impulse: Impulse in N s, once a cycle, instead of a sine force.
            width: Width in s of a rectangular pulse, once a cycle, instead of a sine force.
            frequency: Excitation frequency in Hz.
            model: Contact law: restitution, kelvin-voigt, hertz, hunt-crossley, loose-mass.
            cycles: Excitation cycles analysed.
            settle: Cycles discarded before, while transients decay.
            initial: Displacements in m and velocities in m/s at the start [default: at rest]. ``(x1, v1, x2,
                v2)``.
            phase: Phase of the excitation's cycle at the start, in rad: 0 is the crest of a sine and the
                beginning of a pulse.
            grazing: Approach speed in m/s below which an impact counts as grazing.
        """
        return self._ask(["model", "simulate"], {"force": force, "impulse": impulse, "width": width, "frequency": frequency, "model": model, "cycles": cycles, "settle": settle, "initial": Joined(",", initial), "phase": phase, "grazing": grazing})

    def response(
        self,
        *,
        from_: float,
        to: float,
        force: float | None = None,
        impulse: float | None = None,
        width: float | None = None,
        points: int | None = None,
        cycles: int | None = None,
        gap_std: float | None = None,
        monte_carlo: int | None = None,
    ) -> Answer:
        """All motions with one impact a period over frequency, with folds and stability limits.

        Numbers are in SI units. Raises ``Refused`` where the data allow no answer, and ``BadInput`` where a
        file or an argument is not what it should be.

        Arguments:
            from_: Lowest excitation frequency in Hz.
            to: Highest excitation frequency in Hz.
            force: Force in N: amplitude of a sine, height of a pulse.
            impulse: Impulse in N s, once a cycle, instead of a sine force.
            width: Width in s of a rectangular pulse, once a cycle, instead of a sine force.
            points: Number of frequencies.
            cycles: Excitation cycles from impact to impact.
            gap_std: Standard uncertainty of the gap in m: a motion nearer to grazing is not robust.
            monte_carlo: Draw the parameters N times from [uncertainty] in the rig's file: bands that hold 95
                % of the draws.
        """
        return self._ask(["model", "response"], {"from": from_, "to": to, "force": force, "impulse": impulse, "width": width, "points": points, "cycles": cycles, "gap_std": gap_std, "monte_carlo": monte_carlo})

    def backbone(
        self,
        *,
        from_: float,
        to: float,
        force: float | None = None,
        impulse: float | None = None,
        width: float | None = None,
        mass: int | None = None,
        points: int | None = None,
        tolerance: float | None = None,
    ) -> Answer:
        """Response of one mass on its curved spring without impacts: jumps and backbone, beside exact motions.

        Numbers are in SI units. Raises ``Refused`` where the data allow no answer, and ``BadInput`` where a
        file or an argument is not what it should be.

        Arguments:
            from_: Lowest excitation frequency in Hz.
            to: Highest excitation frequency in Hz.
            force: Force in N: amplitude of a sine, height of a pulse.
            impulse: Impulse in N s, once a cycle, instead of a sine force.
            width: Width in s of a rectangular pulse, once a cycle, instead of a sine force.
            mass: Mass that is driven, alone on its spring: 1 or 2.
            points: Number of frequencies.
            tolerance: Relative error of an amplitude by harmonic balance that does not matter.
        """
        return self._ask(["model", "backbone"], {"from": from_, "to": to, "force": force, "impulse": impulse, "width": width, "mass": mass, "points": points, "tolerance": tolerance})

    def branches(
        self,
        *,
        from_: float,
        to: float,
        force: float | None = None,
        impulse: float | None = None,
        width: float | None = None,
        over: str | None = None,
        frequency: float | None = None,
        impacts: int | None = None,
        cycles: int | None = None,
        step: float | None = None,
    ) -> Answer:
        """Motions with P impacts in Q cycles followed over frequency, force, gap or restitution, through folds, flips and grazing.

        Numbers are in SI units. Raises ``Refused`` where the data allow no answer, and ``BadInput`` where a
        file or an argument is not what it should be.

        Arguments:
            from_: Lower end, in Hz, N, m or 1.
            to: Upper end, in the same unit.
            force: Force in N: amplitude of a sine, height of a pulse.
            impulse: Impulse in N s, once a cycle, instead of a sine force.
            width: Width in s of a rectangular pulse, once a cycle, instead of a sine force.
            over: What is varied: frequency, force, gap, restitution.
            frequency: Excitation frequency in Hz; over the frequency, where the search for motions starts
                [default: the middle].
            impacts: Impacts in a period.
            cycles: Excitation cycles in a period.
            step: Longest step along a branch, in rad of the impacts' phases.
        """
        return self._ask(["model", "continue"], {"from": from_, "to": to, "force": force, "impulse": impulse, "width": width, "over": over, "frequency": frequency, "impacts": impacts, "cycles": cycles, "step": step})

    def sweep(
        self,
        *,
        from_: float,
        to: float,
        force: float | None = None,
        impulse: float | None = None,
        width: float | None = None,
        over: str | None = None,
        frequency: float | None = None,
        model: str | None = None,
        direction: str | None = None,
        start: str | Sequence[str | float] | None = None,
        sweep_rate: float | None = None,
        steps: int | None = None,
        settle: int | None = None,
        measure: int | None = None,
        observable: str | None = None,
    ) -> Answer:
        """Simulated sweep of frequency or force; the state carries over from step to step.

        Numbers are in SI units. Raises ``Refused`` where the data allow no answer, and ``BadInput`` where a
        file or an argument is not what it should be.

        Arguments:
            from_: Lower end in Hz, in N (N s for impulses) over the force.
            to: Upper end, in the same unit.
            force: Force in N: amplitude of a sine, height of a pulse.
            impulse: Impulse in N s, once a cycle, instead of a sine force.
            width: Width in s of a rectangular pulse, once a cycle, instead of a sine force.
            over: What is swept: the excitation frequency, or force, the size of the force or of the impulse.
            frequency: Excitation frequency in Hz of a sweep of the force.
            model: Contact law: restitution, kelvin-voigt, hertz, hunt-crossley, loose-mass.
            direction: Direction: up, down, both (each from the start), up-down (down from where up ends).
            start: Start: displacements in m, velocities in m/s, phase of the excitation in rad; 0 is the
                crest of a sine and the beginning of a pulse [default: at rest, phase 0]. ``(x1, v1, x2, v2,
                phase)``.
            sweep_rate: Change the frequency continuously by this many Hz/s, instead of in steps.
            steps: Points: steps of a stepped sweep, readings of a continuous one.
            settle: Cycles at each step before it is read.
            measure: Cycles read at each step.
            observable: Observable of both masses: fundamental, the amplitude at the excitation frequency;
                peak, half of peak-to-peak; rms, a running RMS through a low-pass of 10 rad/s.
        """
        return self._ask(["model", "sweep"], {"from": from_, "to": to, "force": force, "impulse": impulse, "width": width, "over": over, "frequency": frequency, "model": model, "direction": direction, "start": Joined(",", start), "sweep_rate": sweep_rate, "steps": steps, "settle": settle, "measure": measure, "observable": observable})

    def choose(
        self,
        *,
        force: float | None = None,
        impulse: float | None = None,
        width: float | None = None,
        frequency: float | None = None,
        from_: float | None = None,
        to: float | None = None,
        points: int | None = None,
        observable: str | None = None,
        tolerance: float | None = None,
        noise_floor: float | None = None,
        gap_std: float | None = None,
        history: str | None = None,
    ) -> Answer:
        """The simplest adequate model of a scene, and why.

        Numbers are in SI units. Raises ``Refused`` where the data allow no answer, and ``BadInput`` where a
        file or an argument is not what it should be.

        Arguments:
            force: Force in N: amplitude of a sine, height of a pulse.
            impulse: Impulse in N s, once a cycle, instead of a sine force.
            width: Width in s of a rectangular pulse, once a cycle, instead of a sine force.
            frequency: Excitation frequency in Hz.
            from_: Lowest frequency of a range, in Hz, instead of one frequency.
            to: Highest frequency of the range, in Hz.
            points: Number of frequencies of the range.
            observable: Observable: fundamental, the amplitude of both masses at the excitation frequency;
                peak, half of peak-to-peak; impact-speed; impulse.
            tolerance: Relative change of the answer that does not matter.
            noise_floor: Noise floor of the measurement, in the unit of the observable: smaller changes do not
                matter.
            gap_std: Standard uncertainty of the gap in m: a closed form nearer to grazing is not valid.
            history: Direction of the sweep, up or down, where several motions coexist.
        """
        return self._ask(["model", "choose"], {"force": force, "impulse": impulse, "width": width, "frequency": frequency, "from": from_, "to": to, "points": points, "observable": observable, "tolerance": tolerance, "noise_floor": noise_floor, "gap_std": gap_std, "history": history})

    def map(
        self,
        *,
        x: str | Sequence[str | float],
        y: str | Sequence[str | float],
        force: float | None = None,
        impulse: float | None = None,
        width: float | None = None,
        frequency: float | None = None,
        cycles: int | None = None,
    ) -> Answer:
        """Regime and stability over two parameters.

        Numbers are in SI units. Raises ``Refused`` where the data allow no answer, and ``BadInput`` where a
        file or an argument is not what it should be.

        Arguments:
            x: Parameter across: one of m1 m2 k1 k2 c1 c2 gap restitution frequency force impulse width, e.g.
                frequency:3:14:120. ``(name, low, high, n)``.
            y: Parameter upwards, as x. ``(name, low, high, n)``.
            force: Force in N: amplitude of a sine, height of a pulse.
            impulse: Impulse in N s, once a cycle, instead of a sine force.
            width: Width in s of a rectangular pulse, once a cycle, instead of a sine force.
            frequency: Excitation frequency in Hz, where it is not varied.
            cycles: Cycles of each cell, from rest; a settled cell ends earlier.
        """
        return self._ask(["model", "map"], {"x": Joined(":", x), "y": Joined(":", y), "force": force, "impulse": impulse, "width": width, "frequency": frequency, "cycles": cycles})
