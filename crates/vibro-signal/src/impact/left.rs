//! What is left of a response when the record of a blow ends.

use super::Blows;
use crate::fft::Transform;
use crate::transfer::Transfer;
use std::f64::consts::TAU;
use vibro_record::Finding;
use vibro_record::code;

/// Parts of a record after the blow; the first and the last are compared.
const PARTS: usize = 4;
/// Fewest samples of a part.
const FEWEST: usize = 16;
/// So many times the scatter of a mean power is no noise: in white noise less than one record in a hundred is
/// then said to ring on.
const BEYOND: f64 = 6.0;
/// Lines with less than this part of the highest power are not those of the response.
const STRONG: f64 = 0.01;
/// Less than this part of a response at the end of its record is not worth a finding: sensors are not as
/// good.
const LEAST: f64 = 1e-3;

/// Takes into the standard deviations of a function, line by line, what is left of a response when its
/// weighted record ends, relative to its beginning, from the blows that begin at `kept`, with a finding where
/// it is most. Nothing where records are too short to tell.
///
/// The last quarter of a mode that decays as e^(−σt) has the transform of the first one times r = e^(−3σT/4);
/// what is left at T is r^(4/3). A mode whose record ends there has lost e^((s − iω)T) of its transform, s
/// its pole: that is also the size of the relative error of its part of H. The noise is that before the
/// quietest blow, taken for white; before the others the blow before may still ring.
pub(super) fn widen(transfer: &mut Transfer, values: &[f64], kept: &[usize], how: &Blows, weights: &[f64]) {
    let quarter = (how.length - how.before) / PARTS;
    if quarter < FEWEST || how.before < 2 || kept.is_empty() {
        return;
    }
    let transform = Transform::new(quarter);
    let mut work = transform.workspace();
    let hann: Vec<f64> =
        (0..quarter).map(|i| 0.5 - 0.5 * (TAU * (i as f64 + 0.5) / quarter as f64).cos()).collect();
    let mut powers = [how.before, how.length - quarter].map(|from| (from, vec![0.0; transform.lines()]));
    let mut noise = f64::INFINITY;
    for start in kept {
        let Some(part) = values.get(*start..start + how.length) else { return };
        let quiet = &part[..how.before];
        let level = quiet.iter().sum::<f64>() / how.before as f64;
        let variance = quiet.iter().map(|v| (v - level).powi(2)).sum::<f64>() / (how.before - 1) as f64;
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
        // The level that was taken off is uncertain, which a Hann window spreads over two lines.
        let level = if k < 2 { sum * sum / how.before as f64 } else { 0.0 };
        let noise = noise * weight * weight * (squares + level);
        let scatter = noise * (n.recip().sqrt() + (2.0 / how.before as f64).sqrt());
        let excess = tail / n - noise;
        if excess <= BEYOND * scatter || *head <= 0.0 {
            return 0.0;
        }
        let whole = PARTS as f64 / (PARTS - 1) as f64;
        (excess * n / head).sqrt().powf(whole).min(1.0)
    };
    // What is left of each line, and whether this is one of the response, no noise and no hum.
    let parts: Vec<(f64, bool)> =
        head.iter().zip(&tail).enumerate().map(|line| (part(line), *line.1.0 > strong)).collect();
    // Lines of a record to one of a part.
    let step = how.length as f64 / quarter as f64;
    let (mut most, mut finding) = (0.0, None);
    for (k, h) in transfer.frf.values.iter().enumerate() {
        // The first line of a function is one above 0 Hz.
        let place = ((k + 1) as f64 / step).round() as usize;
        let Some((part, strong)) = parts.get(place).or(parts.last()) else { continue };
        transfer.magnitude_std[k] = transfer.magnitude_std[k].hypot(part * h.norm());
        transfer.phase_std[k] = transfer.phase_std[k].hypot(*part);
        if *part > LEAST && *strong && part * h.norm() > most {
            most = part * h.norm();
            let here = Finding::caution(code::RESPONSE_CUT_OFF).number("frequency", transfer.frf.axis.at(k));
            finding = Some(here.number("left", *part));
        }
    }
    transfer.findings.extend(finding);
}
