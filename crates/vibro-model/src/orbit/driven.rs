//! Steady motion of mass 1 alone under one impulse or rectangular pulse a cycle.

use crate::green::Green;
use crate::steady::NoImpact;
use vibro_math::Oscillator;
use vibro_record::Result;

/// The steady motion as two pieces of free motion: about the displacement f/k₁ during the pulse, and about 0
/// after it. An impulse is a pulse of no width.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PulseResponse {
    pub oscillator: Oscillator,
    /// Cycle of the excitation in s.
    pub cycle: f64,
    /// Duration of the pulse in s; 0 for an impulse.
    pub width: f64,
    /// Equilibrium during the pulse in m, force over k₁; 0 for an impulse.
    pub rest: f64,
    /// Free part of displacement (m) and velocity (m/s) at the beginning of the pulse.
    on: (f64, f64),
    /// Displacement (m) and velocity (m/s) just after the pulse (or impulse).
    off: (f64, f64),
}

/// A piece of the steady motion.
#[derive(Debug, Clone, Copy)]
pub struct Piece {
    /// Time in s from the beginning of the pulse to the start of the piece.
    pub start: f64,
    pub duration: f64,
    /// Equilibrium of mass 1 in m.
    pub rest: f64,
    /// Free displacement (m) and velocity (m/s) at the piece's start.
    pub free: (f64, f64),
}

impl PulseResponse {
    /// Steady motion under one impulse (N s) per cycle: the impulse times the periodic Green's function.
    ///
    /// # Errors
    /// As [`Green::new`].
    pub fn impulse(m: f64, oscillator: Oscillator, cycle: f64, impulse: f64) -> Result<PulseResponse> {
        let green = Green::new(m, oscillator, cycle)?;
        let off = (impulse * green.start, impulse * green.slope_after);
        Ok(PulseResponse { oscillator, cycle, width: 0.0, rest: 0.0, on: (0.0, 0.0), off })
    }

    /// Steady motion under a force (N) that acts for `width` seconds of each cycle.
    ///
    /// After the pulse u = (I − Φ(T))⁻¹ (f/m) ∫₀ʷ Φ(s)(0, 1) ds, the Green's function integrated over the
    /// pulse.
    ///
    /// # Errors
    /// As [`Green::new`].
    pub fn pulse(
        m: f64,
        oscillator: Oscillator,
        cycle: f64,
        force: f64,
        width: f64,
    ) -> Result<PulseResponse> {
        let unit = Green::new(m, oscillator, cycle)?;
        let (c, s) = oscillator.kernels(width);
        // (I − Φ)⁻¹ is applied to (0, S(w)), which gives the Green's function, and to (∫S, 0).
        let area = ramp(&oscillator, width, c, s);
        let (less, determinant) = oscillator.closing(cycle);
        let (_, sine) = oscillator.kernels(cycle);
        let (b, omega2) = (oscillator.decay(), oscillator.omega2());
        let off = (
            force * (unit.start * s + (less + b * sine) * area / (m * determinant)),
            force * (unit.slope_after * s - omega2 * sine * area / (m * determinant)),
        );
        let rest = force / (m * omega2);
        let before = oscillator.free(off.0, off.1, cycle - width);
        Ok(PulseResponse { oscillator, cycle, width, rest, on: (before.0 - rest, before.1), off })
    }

    /// The piece at the time `at` (s) after the beginning of the pulse, 0 ≤ `at` ≤ cycle, and the time within
    /// it.
    pub fn piece(&self, at: f64) -> (Piece, f64) {
        let [on, off] = self.pieces();
        if at < self.width { (on, at) } else { (off, at - self.width) }
    }

    /// Pulse and pause; for an impulse the pulse has no duration.
    pub fn pieces(&self) -> [Piece; 2] {
        [
            Piece { start: 0.0, duration: self.width, rest: self.rest, free: self.on },
            Piece { start: self.width, duration: self.cycle - self.width, rest: 0.0, free: self.off },
        ]
    }

    /// Displacement (m), velocity (m/s) and acceleration (m/s²) `at` seconds after the start of the pulse.
    pub fn at(&self, at: f64) -> [f64; 3] {
        let (piece, t) = self.piece(at);
        let (x, v) = self.oscillator.free(piece.free.0, piece.free.1, t);
        [x + piece.rest, v, self.oscillator.acceleration(x, v)]
    }

    /// Smallest and largest displacement in m.
    pub fn range(&self) -> (f64, f64) {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for piece in self.pieces().iter().filter(|p| p.duration > 0.0) {
            let (x, v) = piece.free;
            let inner = self.oscillator.passages(v, self.oscillator.acceleration(x, v), piece.duration);
            for t in [0.0, piece.duration].into_iter().chain(inner) {
                let at = piece.rest + self.oscillator.free(x, v, t).0;
                (low, high) = (low.min(at), high.max(at));
            }
        }
        (low, high)
    }

    /// The steady motion as a motion without impacts on a rig with this `gap` in m.
    pub fn no_impact(&self, gap: f64) -> NoImpact {
        let (low, high) = self.range();
        NoImpact { possible: high < gap, amplitude: (high - low) / 2.0, largest: high }
    }
}

/// ∫₀ʷ S(s) ds = (1 − C(w) − bS(w))/Ω², by a power series where the formula would cancel.
fn ramp(oscillator: &Oscillator, width: f64, c: f64, s: f64) -> f64 {
    let (b, omega2) = (oscillator.decay(), oscillator.omega2());
    if omega2.sqrt() * width > 0.5 || b * width > 0.25 {
        return (1.0 - c - b * s) / omega2;
    }
    // S = Σ sₙtⁿ with s₀ = 0, s₁ = 1, (n + 1)(n + 2)sₙ₊₂ = −2b(n + 1)sₙ₊₁ − Ω²sₙ. Terms fall faster than
    // 0.5ⁿ/n!.
    let (mut before, mut term, mut sum) = (0.0, width, 0.0);
    for n in 1..20_u32 {
        let n = f64::from(n);
        sum += term * width / (n + 1.0);
        (before, term) =
            (term, -(2.0 * b * n * term * width + omega2 * before * width * width) / (n * (n + 1.0)));
    }
    sum
}
