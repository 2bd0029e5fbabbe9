//! Modes that show as one peak.

use super::bands::Group;
use super::rational::{Rational, rational};
use super::response::hertz;
use super::{Measured, Pole};

/// An additional mode must lower Akaike's criterion by this much: its four numbers then explain 28 of χ², as chance does in one of 10⁵ peaks; ten
/// (Burnham & Anderson 2002, 2.6) would be chance in one of a thousand.
const NEEDED: f64 = 20.0;

/// A sentence, where the lines would rather have mode `m` of a fit as two: its frequency and damping are then those of neither, and no uncertainty
/// is known. `others` are the modes of other groups, which were taken away before the fit.
pub(super) fn hidden(
    lines: &Measured,
    group: &Group,
    fit: &Rational,
    m: usize,
    others: &[Pole],
) -> Option<String> {
    // Where residuals are not white that is said, and anything would explain them better.
    if lines.magnitude_only || fit.whiteness.rejected() {
        return None;
    }
    let mode = fit.modes.get(m).filter(|mode| mode.zeta > 0.0 && mode.frequency > 0.0)?;
    let half = 0.5 * mode.zeta * mode.frequency;
    let split = [(mode.frequency - half, mode.zeta), (mode.frequency + half, mode.zeta)];
    let starts: Vec<(f64, f64)> = fit
        .modes
        .iter()
        .enumerate()
        .flat_map(|(i, o)| if i == m { split.to_vec() } else { vec![(o.frequency, o.zeta)] })
        .collect();
    let both = rational(lines, group.lines.clone(), &starts, others).ok()?;
    let better = fit.aicc - both.aicc;
    (better > NEEDED && both.modes.iter().all(|m| m.zeta > 0.0)).then(|| {
        format!(
            "Two modes explain the peak at {} Hz better than one (AICc smaller by {better:.0}): its frequency, damping and modal constant are those of neither, and have no uncertainty. A finer distance of the lines, or a response at another place, may part them.",
            hertz(mode.frequency)
        )
    })
}
