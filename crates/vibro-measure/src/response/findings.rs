//! What makes a sweep doubtful.

use crate::excitation::Excitation;
use crate::line::deviation;
use crate::mean::upper_median;
use std::cmp::Ordering;
use vibro_record::{Direction, Finding, Sweep, SweepPoint, Window};

/// Force lines further than this part of the largest from their window's shape are not under that window: a clean sine under Hann,
/// read as under any other window, is off by more.
const WRONG_SHAPE: f64 = 0.02;

/// Where the force lines, which hold one strong sine, have not the shape that the window gives them.
pub(crate) fn wrong_window(sweep: &Sweep, excitations: &[Excitation], df: f64) -> Option<Finding> {
    let window = sweep.points.first()?.response.window?;
    let typical = |window: Window| {
        upper_median(sweep.points.iter().zip(excitations).filter_map(|(p, e)| {
            let k = ((e.frequency - sweep.axis.start()) / df).round().max(0.0) as usize;
            Some(deviation(&p.force, k, 1, window)? / p.force[k])
        }))
    };
    let off = typical(window).filter(|off| *off > WRONG_SHAPE)?;
    let finding = Finding::doubt("sweep-window-unlike").name("window", window.name()).number("off", off);
    let others = Window::ALL.into_iter().filter_map(|w| Some((typical(w)?, w)));
    let better = others.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|b| b.0 < off / 3.0);
    Some(match better {
        Some((off, window)) => finding.name("better", window.name()).number("left", off),
        None => finding,
    })
}

/// Steps that share a file or hold the same values: a name was typed twice.
pub(crate) fn repeated(sweep: &Sweep) -> Option<Finding> {
    let points = &sweep.points;
    let same = |a: &SweepPoint, b: &SweepPoint| {
        a.response_path == b.response_path
            || a.force_path.is_some() && a.force_path == b.force_path
            || a.response.values == b.response.values && a.force == b.force && a.given == b.given
    };
    let earlier = |k: usize| Some((points[..k].iter().position(|p| same(p, &points[k]))? + 1, k + 1));
    let repeats: Vec<(usize, usize)> = (0..points.len()).filter_map(earlier).collect();
    let (first, second) = *repeats.first()?;
    let finding = Finding::caution("sweep-steps-repeated").count("n", repeats.len());
    Some(finding.count("first", first).count("second", second))
}

/// Direction of a sweep from its frequencies, with findings where they are not in order.
pub(crate) fn direction(
    frequency: &[f64],
    stated: Option<Direction>,
    findings: &mut Vec<Finding>,
) -> Option<Direction> {
    let count = |falls: bool| frequency.windows(2).filter(|w| w[0] != w[1] && (w[1] < w[0]) == falls).count();
    let (rising, falling) = (count(false), count(true));
    let found = match rising.cmp(&falling) {
        Ordering::Greater => Some(Direction::Up),
        Ordering::Less => Some(Direction::Down),
        Ordering::Equal => None,
    };
    let against = rising.min(falling);
    if against > 0 {
        let steps = frequency.len() - 1;
        findings.push(Finding::caution("sweep-out-of-order").count("n", against).count("steps", steps));
    }
    if let Some((stated, found)) = stated.zip(found).filter(|(stated, found)| stated != found) {
        let contradicted = Finding::caution("sweep-direction-contradicted");
        findings.push(contradicted.name("stated", stated.name()).name("found", found.name()));
    }
    stated.or(found)
}
