//! What makes a sweep doubtful.

use crate::excitation::Excitation;
use crate::line::deviation;
use crate::median::upper_median;
use vibro_record::{Direction, Finding, Sweep, SweepPoint, Window};

/// Force lines further than this part of the largest from their window's shape are not under that window: a clean sine under Hann,
/// read as under any other window, is off by more.
const WRONG_SHAPE: f64 = 0.02;

/// Most steps that a finding names.
const NAMED: usize = 5;

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

/// Steps that share a file or hold the same response: a name was typed twice.
pub fn repeated(sweep: &Sweep) -> Option<Finding> {
    let points = &sweep.points;
    let same = |a: &SweepPoint, b: &SweepPoint| {
        a.response_path == b.response_path
            || a.force_path.is_some() && a.force_path == b.force_path
            || a.response.values == b.response.values && a.force == b.force && a.given == b.given
    };
    let repeats: Vec<[usize; 2]> = (0..points.len())
        .filter_map(|k| Some([points[..k].iter().position(|p| same(p, &points[k]))? + 1, k + 1]))
        .collect();
    let [first, second] = *repeats.first()?;
    let finding = Finding::caution("sweep-steps-repeated").count("n", repeats.len());
    Some(finding.count("first", first).count("second", second))
}

/// Where lines at the frequencies of `hiders` hide the responses at `excitation`, both in Hz.
pub(crate) fn hidden_by_lines(excitation: &[f64], hiders: &[Option<f64>]) -> Option<Finding> {
    let pairs = excitation.iter().zip(hiders).filter_map(|(at, hider)| Some((*at, (*hider)?)));
    let (responses, lines): (Vec<f64>, Vec<f64>) = pairs.unzip();
    let first = |all: &[f64]| all.iter().copied().take(NAMED).collect::<Vec<f64>>();
    (!lines.is_empty()).then(|| {
        Finding::caution("sweep-hidden-by-lines")
            .count("n", lines.len())
            .numbers("responses", first(&responses))
            .numbers("lines", first(&lines))
    })
}

/// Direction of a sweep from its frequencies, with findings where they are not in order.
pub fn direction(
    frequency: &[f64],
    stated: Option<Direction>,
    findings: &mut Vec<Finding>,
) -> Option<Direction> {
    let rising = frequency.windows(2).filter(|w| w[1] > w[0]).count();
    let falling = frequency.windows(2).filter(|w| w[1] < w[0]).count();
    let found = match rising.cmp(&falling) {
        std::cmp::Ordering::Greater => Some(Direction::Up),
        std::cmp::Ordering::Less => Some(Direction::Down),
        std::cmp::Ordering::Equal => None,
    };
    let against = rising.min(falling);
    if against > 0 {
        let steps = frequency.len() - 1;
        findings.push(Finding::caution("sweep-out-of-order").count("n", against).count("steps", steps));
    }
    if let (Some(stated), Some(found)) = (stated, found)
        && stated != found
    {
        findings.push(
            Finding::caution("sweep-direction-contradicted")
                .name("stated", stated.name())
                .name("found", found.name()),
        );
    }
    stated.or(found)
}
