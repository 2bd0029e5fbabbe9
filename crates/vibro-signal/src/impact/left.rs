//! The part of a response that is cut off when the record of a blow ends.

use super::{AUDIBLE, Blows};
use crate::fft::Transform;
use crate::transfer::Transfer;
use num_complex::Complex64;
use std::f64::consts::TAU;
use vibro_record::code;
use vibro_record::units::Quantity;
use vibro_record::{Finding, Frf};

/// Parts of a record after the blow; the powers of the first and the last are compared.
const PARTS: usize = 4;
/// Fewest samples of a part for a useful spectrum.
const FEWEST: usize = 16;
/// Excess power over the noise, in standard deviations of the mean noise power, that counts as response:
/// white noise exceeds it in fewer than one record in a hundred.
const BEYOND: f64 = 6.0;
/// Lines with less than this part of the highest power do not belong to the response.
const STRONG: f64 = 0.01;
/// Smallest part of a response at the end of its record that is worth a finding: sensors are less accurate.
const LEAST: f64 = 1e-3;

/// The part of a response that is left at the end of a record, at a line.
#[derive(Debug, Clone, Copy)]
pub(super) struct Left {
    /// Index of the line of the function.
    pub line: usize,
    /// Response at the end of the record over that at its beginning.
    pub part: f64,
}

impl Left {
    /// The lines, by their index, that show the end of the record and no function; `force` is the power of
    /// the force from 0 Hz on, and `length` the time in s from the blow to the end.
    ///
    /// A mode that still rings at an end of the record responds to one more blow, of which nothing was
    /// recorded. That blow's spectrum is flat, `part` of the force at the mode, and the response to it is
    /// that of the mode alone, |Hₘ(ω)|, whose decay is that of `part`. A line shows the end where this
    /// response is within [`AUDIBLE`] of its own, |H(ω)F(ω)|. Lines within [`AUDIBLE`] of the force at the
    /// mode are kept, however early its record ends.
    pub fn hidden(&self, frf: &Frf, force: &[f64], length: f64) -> Vec<bool> {
        let own = force[self.line + 1];
        let power = AUDIBLE * self.part * self.part * own;
        let decay = -self.part.ln() / length;
        let mode = TAU * frf.axis.at(self.line);
        let peak = frf.values[self.line].norm() * 2.0 * decay * mode;
        // An unknown kind is taken as that which falls least above the mode.
        let slope = match frf.meta.quantity {
            Quantity::Receptance => 0,
            Quantity::Mobility => 1,
            _ => 2,
        };
        let hides = |(k, h): (usize, &Complex64)| {
            let omega = TAU * frf.axis.at(k);
            let apart = Complex64::new(mode * mode - omega * omega, 2.0 * decay * omega);
            let alone = peak / apart.norm() * (omega / mode).powi(slope);
            let [seen, hidden] = [h.norm_sqr() * force[k + 1], power * alone * alone];
            hidden > seen && AUDIBLE * force[k + 1] < own
        };
        frf.values.iter().enumerate().map(hides).collect()
    }

    /// Finding for a function, where the part is large enough.
    pub fn finding(&self, transfer: &Transfer) -> Option<Finding> {
        let here = Finding::caution(code::RESPONSE_CUT_OFF);
        let here = here.number("frequency", transfer.frf.axis.at(self.line)).number("left", self.part);
        (self.part > LEAST).then_some(here)
    }
}

/// Adds to the standard deviations of a function, line by line, the part of the response that is left when
/// its weighted record ends, relative to its beginning. The blows begin at `kept`. Returns the line where it
/// disturbs the function most, and the line of the highest response, which is a mode and no hum. Nothing is
/// added where records are too short to tell.
///
/// In the last quarter a mode that decays as e^(−σt) has the transform of the first quarter times r =
/// e^(−3σT/4); r^(4/3) is left at T. A mode whose record ends at T has lost e^((s − iω)T) of its transform,
/// where s is its pole; that is also the relative error of its part of H. White noise is assumed, with the
/// variance before the quietest blow: before the others the previous blow may still ring.
pub(super) fn widen(
    transfer: &mut Transfer,
    values: &[f64],
    kept: &[usize],
    how: &Blows,
    weights: &[f64],
) -> Option<[Left; 2]> {
    let quarter = (how.length - how.before) / PARTS;
    // A blow begins below its trigger, and the response with it: only the first half is quiet.
    let before = how.before / 2;
    if quarter < FEWEST || before < 2 || kept.is_empty() {
        return None;
    }
    let transform = Transform::new(quarter);
    let mut work = transform.workspace();
    let hann: Vec<f64> =
        (0..quarter).map(|i| 0.5 - 0.5 * (TAU * (i as f64 + 0.5) / quarter as f64).cos()).collect();
    let mut powers = [how.before, how.length - quarter].map(|from| (from, vec![0.0; transform.lines()]));
    let mut noise = f64::INFINITY;
    for start in kept {
        let part = values.get(*start..start + how.length)?;
        let quiet = &part[..before];
        let level = quiet.iter().sum::<f64>() / before as f64;
        let variance = quiet.iter().map(|v| (v - level).powi(2)).sum::<f64>() / (before - 1) as f64;
        noise = noise.min(variance);
        for (from, power) in &mut powers {
            let seen = part[*from..].iter().zip(&weights[*from..]).zip(&hann);
            work.input.iter_mut().zip(seen).for_each(|(to, ((v, w), h))| *to = (v - level) * w * h);
            transform.run(&mut work);
            power.iter_mut().zip(&work.output).for_each(|(sum, x)| *sum += x.norm_sqr());
        }
    }
    let n = kept.len() as f64;
    let [(_, head), (from, tail)] = powers;
    let weight = weights.get(from).copied().unwrap_or(1.0);
    let (squares, sum) = hann.iter().fold((0.0, 0.0), |(q, s), h| (q + h * h, s + h));
    let strong = STRONG * head.iter().copied().fold(0.0, f64::max);
    let part = |(k, (head, tail)): (usize, (&f64, &f64))| {
        // The subtracted level is uncertain; the Hann window spreads this error over two lines.
        let level = if k < 2 { sum * sum / before as f64 } else { 0.0 };
        let noise = noise * weight * weight * (squares + level);
        let scatter = noise * (n.recip().sqrt() + (2.0 / before as f64).sqrt());
        let excess = tail / n - noise;
        if excess <= BEYOND * scatter || *head <= 0.0 {
            return 0.0;
        }
        let whole = PARTS as f64 / (PARTS - 1) as f64;
        (excess * n / head).sqrt().powf(whole).min(1.0)
    };
    // Part left at each line, and whether the line belongs to the response rather than to noise or hum.
    let parts: Vec<(f64, bool)> =
        head.iter().zip(&tail).enumerate().map(|line| (part(line), *line.1.0 > strong)).collect();
    // Lines of the record for one line of a part.
    let step = how.length as f64 / quarter as f64;
    let highest = (0..head.len()).max_by(|a, b| head[*a].total_cmp(&head[*b])).unwrap_or(0);
    let last = transfer.frf.values.len().saturating_sub(1);
    let line = ((highest as f64 * step).round() as usize).saturating_sub(1).min(last);
    let mode = Left { line, part: parts[highest].0 };
    let (mut most, mut left) = (0.0, Left { line, part: 0.0 });
    for (line, h) in transfer.frf.values.iter().enumerate() {
        // The first line of a function is the first above 0 Hz.
        let place = ((line + 1) as f64 / step).round() as usize;
        let Some((part, strong)) = parts.get(place).or(parts.last()).copied() else { continue };
        transfer.magnitude_std[line] = transfer.magnitude_std[line].hypot(part * h.norm());
        transfer.phase_std[line] = transfer.phase_std[line].hypot(part);
        if strong && part > LEAST && part * h.norm() > most {
            most = part * h.norm();
            left = Left { line, part };
        }
    }
    Some([left, mode])
}
