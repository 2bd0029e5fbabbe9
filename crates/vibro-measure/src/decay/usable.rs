//! The part of a record in which motion decays freely.

use crate::clipping::clipped;
use crate::mean::average;
use num_complex::Complex64;
use std::ops::Range;
use vibro_record::{Error, Finding, Result, Scaling, Trace, Window, code, sort_by_number, upper_median};
use vibro_signal::fft::Transform;
use vibro_signal::spectrum;

/// Fewest blocks of the evaluated part, where the record has them; with fewer than half of them it is
/// refused.
const FEWEST: usize = 6;
/// A block begins a new motion where its level exceeds the largest of the blocks before by this factor.
const RISE: f64 = 2.0;
/// Number of blocks before it with which a block is compared.
const BEFORE: usize = 5;
/// Fewest samples of a block.
const SHORTEST: usize = 8;
/// Periods of the strongest line in a block.
const PERIODS: f64 = 2.0;
/// Level of the motion, relative to the largest, at which it ends; noise may end it earlier.
const LEFT: f64 = 2.5e-3;
/// Level, relative to that of the noise, below which the motion is lost in noise.
const LOST: f64 = 1.3;
/// Fewest lines on either side with which a line is compared.
const LEAST: usize = 8;
/// Number of the largest lines that are compared.
const MOST: usize = 80;
/// First line that can be a mode: lower lines hold the mean and its drift.
const LOWEST: usize = 3;

/// Where motion decays, and how long it stays in view.
pub struct Usable {
    /// Samples from the onset, or from the end of clipping, to a third beyond the visible motion.
    pub part: Range<usize>,
    /// Length of a block in samples: two periods of the strongest line, or more.
    pub block: usize,
    /// Sample up to which no other motion begins.
    pub limit: usize,
    pub findings: Vec<Finding>,
}

/// Finds the onset, at the largest sample near the block of highest level, and the end, where the motion is
/// lost in noise.
///
/// # Errors
/// If the trace has no spectrum, no line of the band, or too few periods.
pub fn usable(trace: &Trace, rate: f64, band: Option<(f64, f64)>) -> Result<Usable> {
    let lines = spectrum::plain(trace, Window::Hann, Scaling::Peak, true)?.values.magnitudes();
    let n = trace.values.len();
    let line = |f: f64| (f * n as f64 / rate) as usize;
    let (low, high) = band.map_or((LOWEST, lines.len()), |(low, high)| {
        (line(low).max(LOWEST), line(high).saturating_add(1).min(lines.len()))
    });
    let strongest = strongest(&lines, low..high)?;
    let period = n as f64 / strongest as f64;
    let block = ((PERIODS * period) as usize).max(SHORTEST);
    if n < 5 * block {
        let why = format!("the record holds {strongest} periods of its strongest line");
        return Err(Error::refused(why)
            .hint("record longer, or choose a band above the drift")
            .setting("band"));
    }
    let values = match band {
        Some(_) => within(&trace.values, low..high),
        None => trace.values.clone(),
    };
    let levels = levels(&values, block);
    let top = (0..levels.len()).max_by(|a, b| levels[*a].total_cmp(&levels[*b])).unwrap_or(0);
    let mut sorted = levels.clone();
    sorted.sort_by(f64::total_cmp);
    let gone = (LOST * sorted[sorted.len() / 10]).max(LEFT * levels[top]);
    // The levels of beating modes fall and rise, too; a new motion exceeds all blocks just before it.
    let new = |b: &usize| {
        let before = &levels[b.saturating_sub(BEFORE).max(top + 1)..*b];
        levels[*b] > gone.max(RISE * before.iter().copied().fold(0.0, f64::max))
    };
    let begins = (top + 2..levels.len()).find(new);
    let limit = begins.map_or(n, |b| (b - 1) * block);
    let last = (top + 1..levels.len()).find(|b| levels[*b] < gone).unwrap_or(levels.len());
    let around_top = top * block..((top + 2) * block).min(n);
    let mean = average(&values[around_top.clone()]);
    let size = |i: &usize| (values[*i] - mean).abs();
    let mut start = around_top.max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(0);
    let mut findings = Vec::new();
    let clipped = clipped(&trace.values, period);
    if let Some(behind) = clipped.last().map(|i| i + 1).filter(|behind| *behind > start) {
        findings.push(
            Finding::caution("decay-clipped")
                .count("n", clipped.len())
                .number("start", trace.axis.at(behind.min(n - 1))),
        );
        start = behind;
    }
    // A part a third longer than the visible motion shows the noise.
    let seen = (last * block).saturating_sub(start) * 4 / 3;
    let end = (start + seen.max(FEWEST * block)).min(limit);
    if end < start + FEWEST * block / 2 {
        let periods = end.saturating_sub(start) as f64 / period;
        let why = format!("only {periods:.1} periods of motion lie behind its largest value");
        return Err(Error::refused(why)
            .hint("record longer behind the release or the blow, or choose a band")
            .setting("band"));
    }
    if begins.is_some() && end == limit {
        findings.push(Finding::caution(code::DECAY_CUT).number("end", trace.axis.at(limit)));
    }
    Ok(Usable { part: start..end, block, limit, findings })
}

/// The line in the range `among` with the largest ratio to the median of the lines around it.
///
/// # Errors
/// If none of them is a maximum.
fn strongest(lines: &[f64], among: Range<usize>) -> Result<usize> {
    // Drift raises all lines at low frequency. A mode stands out from the lines between half and twice its
    // own frequency.
    let over = |k: &usize| {
        let (from, to) = ((k / 2).min(k.saturating_sub(LEAST)).max(1), (2 * k).max(k + LEAST));
        let mut around = lines[from..to.min(lines.len())].to_vec();
        lines[*k] / upper_median(&mut around).max(f64::MIN_POSITIVE)
    };
    let tops = (among.start.max(1)..among.end.min(lines.len().saturating_sub(1)))
        .filter(|k| lines[*k] >= lines[k - 1] && lines[*k] >= lines[k + 1]);
    let mut tops: Vec<usize> = tops.collect();
    sort_by_number(&mut tops, |a| -lines[*a]);
    tops.truncate(MOST);
    let strongest = tops.into_iter().max_by(|a, b| over(a).total_cmp(&over(b)));
    strongest.ok_or_else(|| {
        Error::refused("no line of the spectrum lies there").hint("choose another band").setting("band")
    })
}

/// Root mean square of each whole block about its mean.
pub fn levels(values: &[f64], block: usize) -> Vec<f64> {
    let level = |block: &[f64]| {
        let mean = average(block);
        (block.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / block.len() as f64).sqrt()
    };
    values.chunks_exact(block).map(level).collect()
}

/// The record filtered to the lines of a band.
///
/// The transform is periodic: alone, the onset at the beginning of a record would ring before it, at the end
/// of the record, like a new event. So the record is followed by its mirror image, whose lines lie twice as
/// dense.
fn within(values: &[f64], band: Range<usize>) -> Vec<f64> {
    let mirrored: Vec<f64> = values.iter().chain(values.iter().rev()).copied().collect();
    let transform = Transform::new(mirrored.len());
    let mut lines = transform.forward(&mirrored);
    lines.truncate(2 * band.end);
    lines[..2 * band.start].fill(Complex64::ZERO);
    let mut filtered = transform.inverse(&lines);
    filtered.truncate(values.len());
    filtered
}
