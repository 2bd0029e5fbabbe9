//! What makes a sweep doubtful.

use crate::excitation::Excitation;
use crate::line::misfit;
use crate::resonance::Resonance;
use vibro_record::units::notation::significant;
use vibro_record::{Direction, Sweep, SweepPoint, Window};

/// Force lines further than this from their window's shape are not under that window.
const WRONG_SHAPE: f64 = 0.02;

/// A sentence where the force lines, which hold one strong sine, have not the shape that the window gives them.
pub fn wrong_window(sweep: &Sweep, excitations: &[Excitation], df: f64) -> Option<String> {
    let window = sweep.points.first()?.response.window?;
    let typical = |window: Window| {
        let mut found: Vec<f64> = sweep
            .points
            .iter()
            .zip(excitations)
            .filter_map(|(p, e)| {
                let k = ((e.frequency - sweep.axis.start()) / df).round().max(0.0) as usize;
                misfit(&p.force, k, window)
            })
            .collect();
        found.sort_by(f64::total_cmp);
        found.get(found.len() / 2).copied()
    };
    let off = typical(window).filter(|off| *off > WRONG_SHAPE)?;
    let better =
        Window::ALL.into_iter().filter_map(|w| Some((typical(w)?, w))).min_by(|a, b| a.0.total_cmp(&b.0))?;
    let hint = if better.0 < off / 3.0 {
        format!("; {} would fit to {:.1} %", better.1.name(), 100.0 * better.0)
    } else {
        String::new()
    };
    Some(format!(
        "The lines of the force are off the shape of a {} window by {:.0} % of the largest{hint}: amplitudes and their uncertainties are not to be relied on.",
        window.name(),
        100.0 * off
    ))
}

/// A sentence where steps share a file or hold the same response: a name was typed twice.
pub fn twice(sweep: &Sweep) -> Option<String> {
    let points = &sweep.points;
    let same = |a: &SweepPoint, b: &SweepPoint| {
        a.response_path == b.response_path
            || a.force_path.is_some() && a.force_path == b.force_path
            || a.response.values == b.response.values && a.force == b.force && a.given == b.given
    };
    let pairs: Vec<String> = (0..points.len())
        .filter_map(|k| {
            let first = points[..k].iter().position(|p| same(p, &points[k]))?;
            Some(format!("{} and {}", first + 1, k + 1))
        })
        .collect();
    let shown = pairs.get(..5).unwrap_or(&pairs).join(", ");
    let more = if pairs.len() > 5 { format!(" and {} more pairs", pairs.len() - 5) } else { String::new() };
    (!pairs.is_empty()).then(|| {
        format!("Steps {shown}{more} name the same file or hold the same values: a name may stand twice in the list.")
    })
}

/// A sentence where lines at the frequencies of `hiders` hide the responses at `excitation`, both in Hz.
pub fn hidden(excitation: &[f64], hiders: &[Option<f64>]) -> Option<String> {
    let pairs: Vec<String> = excitation
        .iter()
        .zip(hiders)
        .filter_map(|(at, hider)| {
            hider.map(|h| format!("another line at {h:.4} Hz hides the response at {at:.4} Hz"))
        })
        .collect();
    let shown = pairs.get(..5).unwrap_or(&pairs).join("; ");
    let more = if pairs.len() > 5 { format!("; and {} more", pairs.len() - 5) } else { String::new() };
    (!pairs.is_empty()).then(|| {
        format!("Amplitudes that are mostly leakage, with upper limits that allow for it: {shown}{more}.")
    })
}

/// A point that stands this factor above both its neighbours is no curve's top.
const ALONE: f64 = 2.0;

/// A sentence where a maximum is one point alone; frequencies are rising, `found` the resonances of the curve.
pub fn alone(frequency: &[f64], amplitude: &[f64], found: &[Resonance]) -> Option<String> {
    let lone = |i: &usize| {
        let sides = [amplitude[i - 1], amplitude[i + 1]];
        let top = |r: &Resonance| r.frequency == frequency[*i] && r.amplitude_std.is_none() && !r.at_jump;
        sides.iter().all(|side| amplitude[*i] > ALONE * side) && found.iter().any(top)
    };
    let places: Vec<String> = (1..frequency.len().saturating_sub(1))
        .filter(lone)
        .map(|i| {
            let factor = amplitude[i] / amplitude[i - 1].max(amplitude[i + 1]);
            format!("{} Hz ({factor:.1} times its neighbours)", significant(frequency[i], 6))
        })
        .collect();
    (!places.is_empty()).then(|| {
        format!(
            "One point alone stands at {}: a narrow resonance that the steps miss, or a file of another range or point. Names of resonances and minima \
             beside it may be wrong.",
            places.join(", ")
        )
    })
}

/// Direction of a sweep from its frequencies, with doubts where they are not in order.
pub fn direction(
    frequency: &[f64],
    stated: Option<Direction>,
    warnings: &mut Vec<String>,
) -> Option<Direction> {
    if frequency.len() == 1 {
        warnings.push("The sweep has one point only.".to_owned());
    }
    let rising = frequency.windows(2).filter(|w| w[1] > w[0]).count();
    let falling = frequency.windows(2).filter(|w| w[1] < w[0]).count();
    // Equal to a hundred-thousandth: no stepped sweep is that fine.
    let equal = frequency.windows(2).filter(|w| (w[1] - w[0]).abs() <= 1e-5 * w[0]).count();
    if equal > 0 {
        warnings.push(format!("{equal} step(s) repeat the excitation frequency of the step before."));
    }
    let found = match rising.cmp(&falling) {
        std::cmp::Ordering::Greater => Some(Direction::Up),
        std::cmp::Ordering::Less => Some(Direction::Down),
        std::cmp::Ordering::Equal => None,
    };
    let against = rising.min(falling);
    if against > 0 {
        warnings.push(format!(
            "The points are not in order of frequency: {against} of {} steps go the other way; jumps are judged in the order given.",
            frequency.len() - 1
        ));
    }
    if let (Some(stated), Some(found)) = (stated, found)
        && stated != found
    {
        warnings.push(format!(
            "The sweep is said to go {}, but its excitation frequencies go {}.",
            stated.name(),
            found.name()
        ));
    }
    stated.or(found)
}
