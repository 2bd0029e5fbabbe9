//! What Monte Carlos have in common: the coverage interval of the draws, and what must be known of it.

use super::study::Cells;
use crate::error::{Error, Result};
use crate::model::{Excitation, Rig, Uncertainty};
use crate::record::{Finding, median, sort_by_number};

/// A parameter that is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drawn {
    name: &'static str,
    /// Part of the values that are impossible and drawn again.
    impossible: f64,
}

impl Drawn {
    /// All drawn parameters of a rig under an excitation.
    pub fn all(uncertainty: &Uncertainty, rig: &Rig, excitation: &Excitation) -> Vec<Drawn> {
        let drawn = uncertainty.impossible(rig, excitation);
        drawn
            .into_iter()
            .map(|(parameter, impossible)| Drawn { name: parameter.name(), impossible })
            .collect()
    }
}

/// Part of the draws that have a motion, from which on a band stands for nearly all of them.
pub const MOST_DRAWS: f64 = 0.95;
/// Part of the values drawn again from which on a distribution is no longer nearly normal.
const TRUNCATED: f64 = 0.01;
/// Draws from which on the ends of an interval of 95 % are settled (JCGM 101:2008, 7.2.2).
const SETTLED: u64 = 10_000;

/// Fewest draws: of 100 draws the outermost 2.5 % at each end are two or three.
const FEWEST: u64 = 100;

/// Checks a number of draws of `points` points, at most `most` draws times points.
///
/// # Errors
/// If it is too small or too large.
pub fn check_draws(draws: u64, most: u64, points: u64, what: &str) -> Result<()> {
    let most = most / points.max(1);
    if (FEWEST..=most).contains(&draws) {
        return Ok(());
    }
    let expected = format!("{FEWEST} to {most} draws of {points} {what}");
    Err(Error::usage(format!("{draws} draws"), expected))
}

/// The bytes of the numbers of a draw, as a cell.
pub fn packed(numbers: impl IntoIterator<Item = f64>) -> Vec<u8> {
    numbers.into_iter().flat_map(f64::to_le_bytes).collect()
}

/// The numbers of all draws, those at one place of each draw together; every draw has `n`.
///
/// # Errors
/// Those of the cells; if a cell has not `n` numbers.
pub fn by_place(cells: &mut Cells<'_>, n: usize) -> Result<Vec<Vec<f64>>> {
    let mut places: Vec<Vec<f64>> = vec![Vec::new(); n];
    for cell in cells {
        let cell = cell?;
        let (numbers, rest) = cell.as_chunks::<8>();
        if numbers.len() != n || !rest.is_empty() {
            return Err(Error::refused("a cell of the part is no draw of this study"));
        }
        for (place, number) in places.iter_mut().zip(numbers) {
            place.push(f64::from_le_bytes(*number));
        }
    }
    Ok(places)
}

/// Lower end, median and upper end of the probabilistically symmetric 95 % coverage interval of the finite
/// values.
///
/// Source: JCGM 101:2008, 7.7.2: of M sorted values those with the numbers r and r + q, with q = 0.95 M
/// rounded and r = (M − q)/2, or (M − q + 1)/2 where that is no whole number.
pub fn coverage_interval(values: &[f64]) -> [f64; 3] {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    let m = sorted.len();
    if m == 0 {
        return [f64::NAN; 3];
    }
    sort_by_number(&mut sorted, |value| *value);
    let q = (0.95 * m as f64).round() as usize;
    let r = (m - q).div_ceil(2).max(1);
    [sorted[r - 1], median(&sorted), sorted[(r + q).min(m) - 1]]
}

/// What must be known of bands. `whole` says that nearly all draws have the motion wherever there is a band.
pub fn drawn_findings(draws: u64, drawn: &[Drawn], whole: bool) -> Vec<Finding> {
    let names: Vec<&str> = drawn.iter().map(|drawn| drawn.name).collect();
    let mut findings = vec![
        Finding::note("parameters-drawn").count("n", draws as usize).name("parameters", names.join(", ")),
    ];
    let truncated = drawn.iter().filter(|drawn| drawn.impossible > TRUNCATED).map(|drawn| {
        Finding::caution("draws-truncated").name("parameter", drawn.name).number("part", drawn.impossible)
    });
    findings.extend(truncated);
    if !whole {
        findings.push(Finding::note("bands-of-some-draws"));
    }
    if draws < SETTLED {
        // Two standard deviations of the part beyond an end, √(0.025 · 0.975/M).
        let scatter = 2.0 * (0.025 * 0.975 / draws as f64).sqrt();
        let ends = Finding::note("draws-few").count("n", draws as usize);
        findings.push(ends.number("low", (0.025 - scatter).max(0.0)).number("high", 0.025 + scatter));
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_is_that_of_the_guide() {
        // M = 100: q = 95, (M − q)/2 is no whole number, so r = 3: the 3rd and the 98th value.
        let hundred: Vec<f64> = (1..=100).rev().map(f64::from).collect();
        assert_eq!(coverage_interval(&hundred), [3.0, 50.5, 98.0]);
        // M = 1000: q = 950, r = 25: the 25th and the 975th.
        let mut thousand: Vec<f64> = (1..=1000).map(f64::from).collect();
        thousand.push(f64::NAN);
        assert_eq!(coverage_interval(&thousand), [25.0, 500.5, 975.0]);
        assert_eq!(coverage_interval(&[7.0]), [7.0; 3]);
        assert!(coverage_interval(&[]).iter().all(|end| end.is_nan()));
    }
}
