//! Random synthetic frequency response functions (FRFs) with known modes, to check how often the stated
//! uncertainty of the modal fit covers the truth.

use super::disturbance::{Mix, peak};
use super::record::{Answer, Kind, Record, pairs};
use super::trace;
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};
use vibroimpact::measure::modal::{Measured, ModalOptions, Pole, modal};
use vibroimpact::measure::spectral::{Lines, SpectralOptions, spectral};
use vibroimpact::record::{Trace, Traces, Window};
use vibroimpact::signal::fft::Transform;
use vibroimpact::signal::transfer::Estimator;
use vibroimpact::units::Quantity;

/// The kinds of records drawn here.
pub const KINDS: &[Kind] = &[
    Kind {
        name: "one mode of a function",
        ranges: "ζ 0.002 to 0.1, 1 to 20 lines in the half-power bandwidth, a residual stiffness and mass; \
        noise of each line 30 to 60 dB below the peak; receptance, mobility or accelerance",
        every: 1,
        draw: |mix| direct_frf(mix, 1),
    },
    Kind {
        name: "two modes of a function",
        ranges: "as one mode; the second 0.5 to 8 half-power bandwidths above, ζ 0.5 to 2 times, modal \
        constant 0.3 to 1 times that of the first, of either sign",
        every: 1,
        draw: |mix| direct_frf(mix, 2),
    },
    Kind {
        name: "neighbours of a function",
        ranges: "as one mode; the second and third each 0.3 to 1 half-power bandwidths above the one before, a tenth to once \
        as high as the first, ζ 0.7 to 1.4 times, of either sign; 3 to 20 lines in the bandwidth",
        every: 1,
        draw: neighbours,
    },
    Kind {
        name: "modes of twelve points",
        ranges: "two modes 1.3 to 2.5 times apart, ζ 0.01 to 0.05; five points within 1.6 half-power bandwidths of each and two \
        beside; noise of 0.2 % of each point",
        every: 1,
        draw: coarse_sweep,
    },
    Kind {
        name: "hammer test",
        ranges: "one mode at 0.01 to 0.15 of the sampling rate, ζ 0.005 to 0.05; 3 to 8 blows of 0.7 to 20 samples behind an \
        anti-alias filter of order 8, 4 to 12 time constants apart; noise of the force 0.01 to 0.1 % of its peak, of the response \
        0.01 to 1 %",
        every: 4,
        draw: |mix| hammer_test(mix, false),
    },
    Kind {
        name: "hammer test, short segments",
        ranges: "as before; stated segments of 0.3 to 3 time constants",
        every: 4,
        draw: |mix| hammer_test(mix, true),
    },
    Kind {
        name: "one mode of averaged spectra",
        ranges: "random force, 10 to 60 segments of 512 to 2048 samples, Hann window, overlap 0.5, H1; \
        1 to 20 lines in the half-power bandwidth; noise of the response 30 to 60 dB below its peak, 1/f noise, hum and 12 bits",
        every: 8,
        draw: |mix| averaged_frf(mix, 1),
    },
    Kind {
        name: "two modes of averaged spectra",
        ranges: "as before, with modes as in two modes of a function",
        every: 8,
        draw: |mix| averaged_frf(mix, 2),
    },
];

/// Draws one or two true modes. The first lies at `centre` Hz with damping ratio `zeta` and modal constant
/// 1; the second lies 0.5 to 8 half-power bandwidths above it.
fn draw_modes(mix: &mut Mix, count: usize, zeta: f64, centre: f64) -> Vec<Pole> {
    let mut poles = vec![Pole { frequency: centre, zeta, constant: Complex64::new(1.0, 0.0) }];
    if count == 2 {
        let bandwidths_apart = mix.log(0.5, 8.0);
        mix.note("bandwidths apart", bandwidths_apart);
        let relative_damping = mix.log(0.5, 2.0);
        let magnitude = mix.log(0.3, 1.0);
        mix.note("ratio of damping", relative_damping);
        let sign = if mix.chance(0.5) { 1.0 } else { -1.0 };
        let constant = mix.note("second constant", sign * magnitude);
        let second = centre * (1.0 + 2.0 * zeta * bandwidths_apart);
        poles.push(Pole {
            frequency: second,
            zeta: zeta * relative_damping,
            constant: Complex64::new(constant, 0.0),
        });
    }
    poles
}

/// True FRF of viscously damped modes at `f` Hz: the receptance times (iω)^`power`.
fn response(poles: &[Pole], f: f64, power: i32) -> Complex64 {
    let w = TAU * f;
    let sum: Complex64 = poles
        .iter()
        .map(|p| {
            let natural_omega = TAU * p.frequency;
            let stiffness_term = natural_omega * natural_omega - w * w;
            p.constant / Complex64::new(stiffness_term, 2.0 * p.zeta * natural_omega * w)
        })
        .sum();
    sum * Complex64::new(0.0, w).powi(power)
}

/// Draws the kind of FRF: its quantity, the power of iω over a receptance, and the unit of its response.
fn draw_quantity(mix: &mut Mix) -> (Quantity, i32, &'static str) {
    let quantities =
        [(Quantity::Receptance, 0, "m"), (Quantity::Mobility, 1, "m/s"), (Quantity::Accelerance, 2, "m/s^2")];
    quantities[mix.random.between(0.0, 3.0) as usize]
}

/// Draws the lines of an FRF directly, 1 Hz apart, with white noise, as an analyser would state them.
/// Compares the modes that are fitted to them with the true ones.
fn direct_frf(mix: &mut Mix, count: usize) -> Record {
    let zeta = mix.log(0.002, 0.1);
    let lines_in_bandwidth = mix.log(1.0, 20.0);
    mix.note("ζ", zeta);
    mix.note("lines in the bandwidth", lines_in_bandwidth);
    let centre = lines_in_bandwidth / (2.0 * zeta) + mix.random.uniform();
    let poles = draw_modes(mix, count, zeta, centre);
    let (quantity, power, _) = draw_quantity(mix);
    // Residual terms: one mode a decade below and one a decade above the band.
    let residual = mix.some(0.7, "far modes", 0.1, 3.0);
    let mut with_residuals = poles.clone();
    for ratio in [0.1, 10.0] {
        let constant = Complex64::new(residual * ratio * mix.random.between(-1.0, 1.0), 0.0);
        with_residuals.push(Pole { frequency: ratio * centre, zeta: 0.01, constant });
    }
    // Half-span of the record in lines (1 Hz apart) on either side of the modes.
    let half_span = (lines_in_bandwidth * mix.log(6.0, 25.0)).max(12.0);
    let first = (centre - half_span).max(0.3 * centre).max(1.0);
    let last = poles[count - 1].frequency + half_span;
    let frequency: Vec<f64> = (first as usize..last as usize).map(|k| k as f64).collect();
    let mut values: Vec<Complex64> = frequency.iter().map(|f| response(&with_residuals, *f, power)).collect();
    let largest = values.iter().fold(0.0, |most: f64, v| v.norm().max(most));
    let noise = mix.log(1e-3, 10f64.powf(-1.5));
    mix.note("noise", noise);
    for v in &mut values {
        *v += Complex64::new(mix.random.normal(), mix.random.normal()) * (noise * largest / 2f64.sqrt());
    }
    compare_modes(&Measured::new(frequency, values, quantity), &poles)
}

/// One to three modes within a bandwidth of each other, some without a peak of their own. Lines are 1 Hz
/// apart.
fn neighbours(mix: &mut Mix) -> Record {
    let (zeta, lines_in_bandwidth) = (mix.log(0.002, 0.05), mix.log(3.0, 20.0));
    mix.note("ζ", zeta);
    mix.note("lines in the bandwidth", lines_in_bandwidth);
    let centre = lines_in_bandwidth / (2.0 * zeta) + mix.random.uniform();
    let mut poles = vec![Pole { frequency: centre, zeta, constant: Complex64::new(1.0, 0.0) }];
    for name in ["height of the second", "height of the third"] {
        let last = poles[poles.len() - 1];
        let (bandwidths_apart, relative_damping) = (mix.random.between(0.3, 1.0), mix.log(0.7, 1.4));
        let height = mix.some(0.7, name, 0.1, 1.0) * if mix.chance(0.3) { -1.0 } else { 1.0 };
        let frequency = last.frequency * (1.0 + 2.0 * last.zeta * bandwidths_apart);
        // The peak of a mode is A/(2ζω²).
        let constant = height * relative_damping * (frequency / centre).powi(2);
        if height != 0.0 {
            let constant = Complex64::new(constant, 0.0);
            poles.push(Pole { frequency, zeta: zeta * relative_damping, constant });
        }
    }
    let (quantity, power, _) = draw_quantity(mix);
    let half_span = lines_in_bandwidth * mix.log(5.0, 15.0);
    let last = poles[poles.len() - 1].frequency + half_span;
    let first = (centre - half_span).max(0.3 * centre).max(1.0);
    let frequency: Vec<f64> = (first as usize..last as usize).map(|k| k as f64).collect();
    let mut values: Vec<Complex64> = frequency.iter().map(|f| response(&poles, *f, power)).collect();
    let largest = values.iter().fold(0.0, |most: f64, v| v.norm().max(most));
    let noise = mix.log(1e-3, 0.02);
    mix.note("noise", noise);
    for v in &mut values {
        *v += Complex64::new(mix.random.normal(), mix.random.normal()) * (noise * largest / 2f64.sqrt());
    }
    compare_modes(&Measured::new(frequency, values, quantity), &poles)
}

/// Two modes of a stepped sweep of twelve steps.
fn coarse_sweep(mix: &mut Mix) -> Record {
    let (first, ratio) = (mix.log(5.0, 200.0), mix.log(1.3, 2.5));
    let pole = |mix: &mut Mix, frequency: f64, constant: f64| Pole {
        frequency,
        zeta: mix.log(0.01, 0.05),
        constant: Complex64::new(constant, 0.0),
    };
    let poles = [pole(mix, first, 0.5), pole(mix, ratio * first, 0.4)];
    let steps = [-1.5, -0.5, 0.1, 0.6, 1.6];
    let near = |p: &Pole| steps.map(|s| p.frequency * (1.0 + 2.0 * p.zeta * s));
    let mut frequency: Vec<f64> = poles.iter().flat_map(near).collect();
    frequency.extend([0.7 * first, first * (1.0 + ratio) / 2.0]);
    frequency.sort_by(f64::total_cmp);
    let mut values: Vec<Complex64> = frequency.iter().map(|f| response(&poles, *f, 0)).collect();
    for v in &mut values {
        *v += Complex64::new(mix.random.normal(), mix.random.normal()) * (0.002 * v.norm() / 2f64.sqrt());
    }
    compare_modes(&Measured::new(frequency, values, Quantity::Receptance), &poles)
}

/// Draws a random force and the response of the modes to it, disturbed as by a measuring chain, and
/// averages their spectra to an FRF. Compares the modes that are fitted to it with the true ones.
fn averaged_frf(mix: &mut Mix, count: usize) -> Record {
    let segment = [512, 1024, 2048][mix.random.between(0.0, 3.0) as usize];
    let segments = mix.log(10.0, 60.0) as usize;
    mix.note("segments", segments as f64);
    let lines_in_bandwidth = mix.log(1.0, 20.0);
    mix.note("lines in the bandwidth", lines_in_bandwidth);
    let centre = mix.random.between(0.1, 0.3) * segment as f64;
    let zeta = mix.note("ζ", (lines_in_bandwidth / (2.0 * centre)).min(0.1));
    let poles = draw_modes(mix, count, zeta, centre);
    let (_, power, unit) = draw_quantity(mix);
    // Lines are 1 Hz apart.
    let (rate, n) = (segment as f64, (segments + 1) * segment / 2);
    let (force, motion) = random_response(mix, &poles, power, rate, n);
    let options = SpectralOptions {
        segment: Some(segment),
        window: Some(Window::Hann),
        estimator: Some(Estimator::H1),
        ..SpectralOptions::default()
    };
    let measured = function_of([trace("N", rate, force), trace(unit, rate, motion)], &options);
    let measured = measured.map(|measured| Measured { window: Some(Window::Hann), ..measured });
    measured.map_or_else(|| mode_answers(&poles, |_| None), |m| compare_modes(&m, &poles))
}

/// The function between force and motion at its finite lines, with its coherence.
fn function_of(channels: [Trace; 2], options: &SpectralOptions) -> Option<Measured> {
    let mut traces = Traces::from_memory(channels.into()).ok()?;
    let Lines::Transfer(transfer) = spectral(&mut traces, options, |_| ()).ok()?.found else { return None };
    let mut measured = Measured::complex(&transfer.frf);
    let finite: Vec<usize> =
        (0..measured.values.len()).filter(|k| measured.values[*k].norm().is_finite()).collect();
    // A single blow that counts has no coherence.
    let known = !transfer.coherence.is_empty();
    measured.coherence = known.then(|| finite.iter().map(|k| transfer.coherence[*k]).collect());
    measured.frequency = finite.iter().map(|k| measured.frequency[*k]).collect();
    measured.values = finite.iter().map(|k| measured.values[*k]).collect();
    Some(measured)
}

/// Three to eight blows of a hammer behind an anti-alias filter (Butterworth, order 8, corner at 0.39 of the
/// sampling rate), which rings around each blow in the sampled force. Segments reach to the next blow, or are
/// stated and `short`.
fn hammer_test(mix: &mut Mix, short: bool) -> Record {
    let rate = 4096.0;
    let centre = rate * mix.log(0.01, 0.15);
    let zeta = mix.log(0.005, 0.05);
    mix.note("ζ", zeta);
    mix.note("frequency", centre);
    let poles = draw_modes(mix, 1, zeta, centre);
    let (_, power, unit) = draw_quantity(mix);
    let blows = mix.random.between(3.0, 9.0) as usize;
    let slowest = poles.iter().map(|p| p.zeta * p.frequency).fold(f64::INFINITY, f64::min);
    let time_constants = mix.log(4.0, 12.0);
    mix.note("time constants a blow", time_constants);
    let interval = time_constants / (TAU * slowest);
    let duration = (mix.random.between(0.1, 0.6) / centre).clamp(0.7 / rate, 20.0 / rate);
    mix.note("samples a blow", duration * rate);
    let times: Vec<(f64, f64)> = (0..blows)
        .map(|k| {
            let late = 0.1 * mix.random.uniform();
            ((k as f64 + 0.15 + late) * interval, mix.random.between(0.5, 1.0))
        })
        .collect();
    let n = ((blows as f64 + 0.1) * interval * rate) as usize;
    let half_period = n.next_power_of_two();
    let transform = Transform::new(2 * half_period);
    let spacing = rate / (2 * half_period) as f64;
    // A half sine has the spectrum (2d/π) cos(ωd/2)/(1 − (ωd/π)²) about its middle.
    let of_blow = |w: f64| {
        let (half, over) = (0.5 * w * duration, w * duration / PI);
        if (over - 1.0).abs() < 1e-6 {
            0.5 * duration
        } else {
            2.0 * duration / PI * half.cos() / (1.0 - over * over)
        }
    };
    let low_pass = |f: f64| {
        let s = Complex64::new(0.0, f / (0.39 * rate));
        (0..4).fold(Complex64::ONE, |h, k| {
            let damping = 2.0 * (PI * f64::from(2 * k + 1) / 16.0).sin();
            h / (s * s + s * damping + 1.0)
        })
    };
    let force: Vec<Complex64> = (0..=half_period)
        .map(|k| {
            let f = k as f64 * spacing;
            let sum: Complex64 = times.iter().map(|(t, size)| *size * Complex64::cis(-TAU * f * t)).sum();
            sum * low_pass(f) * of_blow(TAU * f) * rate
        })
        .collect();
    let motion: Vec<Complex64> = force
        .iter()
        .enumerate()
        .map(|(k, v)| v * response(&poles, (k as f64 * spacing).max(1e-9), power))
        .collect();
    let (mut force, mut motion) = (transform.inverse(&force), transform.inverse(&motion));
    force.truncate(n);
    motion.truncate(n);
    let largest = peak(&motion);
    mix.spoil(&mut motion, rate, largest, (1e-4, 0.01));
    let relative_noise = mix.log(1e-4, 1e-3);
    mix.note("noise of the force", relative_noise);
    let noise = relative_noise * peak(&force);
    for v in &mut force {
        *v += noise * mix.random.normal();
    }
    let segment = short.then(|| {
        let long = mix.log(0.3, 3.0);
        mix.note("time constants a segment", long);
        (long / (TAU * slowest) * rate / 2.0) as usize * 2
    });
    let estimator = Some(Estimator::H1);
    let options = SpectralOptions { hammer: true, segment, estimator, ..SpectralOptions::default() };
    let measured = function_of([trace("N", rate, force), trace(unit, rate, motion)], &options);
    measured.map_or_else(|| mode_answers(&poles, |_| None), |m| compare_modes(&m, &poles))
}

/// A random force of `n` samples up to 0.45 of the sampling rate with a peak of 1, and the response of the
/// modes with noise, hum and converter.
///
/// The force repeats after at least twice the length of the record. So the response is exactly steady, and
/// its lines are finer than the analysis can resolve.
fn random_response(mix: &mut Mix, poles: &[Pole], power: i32, rate: f64, n: usize) -> (Vec<f64>, Vec<f64>) {
    let half_period = n.next_power_of_two();
    let transform = Transform::new(2 * half_period);
    let spacing = rate / (2 * half_period) as f64;
    let force: Vec<Complex64> = (0..=half_period)
        .map(|k| {
            Complex64::new(mix.random.normal(), mix.random.normal())
                * f64::from(u8::from((k as f64) * spacing < 0.45 * rate && k > 0))
        })
        .collect();
    let motion: Vec<Complex64> = force
        .iter()
        .enumerate()
        .map(|(k, f)| f * if k > 0 { response(poles, k as f64 * spacing, power) } else { Complex64::ZERO })
        .collect();
    let (mut force, mut motion) = (transform.inverse(&force), transform.inverse(&motion));
    force.truncate(n);
    motion.truncate(n);
    let scale = 1.0 / peak(&force);
    for v in &mut force {
        *v *= scale;
    }
    for v in &mut motion {
        *v *= scale;
    }
    let largest = peak(&motion);
    mix.spoil(&mut motion, rate, largest, (1e-3, 0.03));
    (force, motion)
}

/// Fits modes to an FRF and pairs each true mode with the fitted one nearest in frequency, at most one
/// half-power bandwidth (or one line) away. A fitted mode without a partner is an invented answer.
fn compare_modes(measured: &Measured, poles: &[Pole]) -> Record {
    let Ok(fit) = modal(measured, &ModalOptions::default()) else { return mode_answers(poles, |_| None) };
    let limits: Vec<f64> = poles.iter().map(|p| (2.0 * p.zeta * p.frequency).max(1.0)).collect();
    let truths: Vec<f64> = poles.iter().map(|p| p.frequency).collect();
    let paired = pairs(&truths, &limits, &fit.modes.iter().map(|m| m.frequency.value).collect::<Vec<_>>());
    let mut record = mode_answers(poles, |i| paired[i].map(|k| &fit.modes[k]));
    let is_invented = |k: &usize| !paired.contains(&Some(*k)) && fit.modes[*k].frequency.std.is_some();
    record.invented = (0..fit.modes.len()).filter(is_invented).count();
    record
}

/// The answers for each true mode: frequency, damping ratio and modal constant of the fitted mode
/// `fitted(i)`, or none where it was not found.
fn mode_answers<'a>(
    poles: &[Pole],
    fitted: impl Fn(usize) -> Option<&'a vibroimpact::measure::modal::Mode>,
) -> Record {
    let mut record = Record::default();
    for (i, pole) in poles.iter().enumerate() {
        let mode = fitted(i);
        record.answers.push(Answer::new("frequency", pole.frequency, mode.map(|m| &m.frequency)));
        record.answers.push(Answer::new("damping ratio", pole.zeta, mode.map(|m| &m.zeta)));
        record.answers.push(Answer::new("modal constant", pole.constant.re, mode.map(|m| &m.modal_constant)));
    }
    record
}
