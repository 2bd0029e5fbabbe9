//! Two modes under one peak.

use super::bands::Group;
use super::rational::{Rational, rational};
use super::{Measured, Pole};

/// An additional mode must lower Akaike's criterion by this much: its four numbers then explain 28 of χ², as chance does in one of 10⁵
/// peaks; ten (Burnham & Anderson 2002, 2.6) would be chance in one of a thousand.
const NEEDED: f64 = 20.0;

/// How much lower Akaike's criterion is with mode `m` of a fit split in two, where the lines support that: its frequency and damping
/// are then those of neither. `others` are the modes of other groups, which were subtracted before the fit.
pub(super) fn support_for_two(
    lines: &Measured,
    group: &Group,
    fit: &Rational,
    m: usize,
    others: &[Pole],
) -> Option<f64> {
    // Anything would explain residuals better that are not white.
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
    (better > NEEDED && both.modes.iter().all(|m| m.zeta > 0.0)).then_some(better)
}
