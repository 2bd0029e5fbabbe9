//! Modes of frequency response functions.

use super::disturbance::{Mix, peak};
use super::record::{Answer, Kind, Record, pairs};
use super::trace;
use num_complex::Complex64;
use std::f64::consts::TAU;
use vibroimpact::measure::modal::{Measured, ModalOptions, Pole, modal};
use vibroimpact::measure::spectral::{Lines, SpectralOptions, spectral};
use vibroimpact::record::{Traces, Window};
use vibroimpact::signal::fft::Transform;
use vibroimpact::signal::transfer::Estimator;
use vibroimpact::units::Quantity;

pub const KINDS: &[Kind] = &[
    Kind {
        name: "one mode of a function",
        ranges: "ζ 0.002 to 0.1, 1 to 20 lines in the half-power bandwidth, a residual stiffness and mass; \
        noise of each line 30 to 60 dB below the peak; receptance, mobility or accelerance",
        every: 1,
        draw: |mix| of_lines(mix, 1),
    },
    Kind {
        name: "two modes of a function",
        ranges: "as one mode; the second 0.5 to 8 half-power bandwidths above, ζ 0.5 to 2 times, modal \
        constant 0.3 to 1 times that of the first, of either sign",
        every: 1,
        draw: |mix| of_lines(mix, 2),
    },
    Kind {
        name: "one mode of averaged spectra",
        ranges: "random force, 10 to 60 segments of 512 to 2048 samples, Hann window, overlap 0.5, H1; \
        1 to 20 lines in the half-power bandwidth; noise of the response 30 to 60 dB below its peak, 1/f noise, hum and 12 bits",
        every: 8,
        draw: |mix| averaged(mix, 1),
    },
    Kind {
        name: "two modes of averaged spectra",
        ranges: "as before, with modes as in two modes of a function",
        every: 8,
        draw: |mix| averaged(mix, 2),
    },
];

/// One or two modes around line `centre`, lines 1 Hz apart.
fn modes(mix: &mut Mix, count: usize, zeta: f64, centre: f64) -> Vec<Pole> {
    let mut poles = vec![Pole { frequency: centre, zeta, constant: Complex64::new(1.0, 0.0) }];
    if count == 2 {
        let apart = mix.log(0.5, 8.0);
        mix.note("bandwidths apart", apart);
        let ratio = mix.log(0.5, 2.0);
        let size = mix.log(0.3, 1.0);
        mix.note("ratio of damping", ratio);
        let sign = if mix.chance(0.5) { 1.0 } else { -1.0 };
        let constant = mix.note("second constant", sign * size);
        let second = centre * (1.0 + 2.0 * zeta * apart);
        poles.push(Pole { frequency: second, zeta: zeta * ratio, constant: Complex64::new(constant, 0.0) });
    }
    poles
}

/// Receptance times (iω)^`power` of viscous modes.
fn response(poles: &[Pole], f: f64, power: i32) -> Complex64 {
    let w = TAU * f;
    let sum: Complex64 = poles
        .iter()
        .map(|p| {
            let own = TAU * p.frequency;
            p.constant / Complex64::new(own * own - w * w, 2.0 * p.zeta * own * w)
        })
        .sum();
    sum * Complex64::new(0.0, w).powi(power)
}

fn kind(mix: &mut Mix) -> (Quantity, i32, &'static str) {
    let all =
        [(Quantity::Receptance, 0, "m"), (Quantity::Mobility, 1, "m/s"), (Quantity::Accelerance, 2, "m/s^2")];
    all[mix.random.between(0.0, 3.0) as usize]
}

fn of_lines(mix: &mut Mix, count: usize) -> Record {
    let zeta = mix.log(0.002, 0.1);
    let wide = mix.log(1.0, 20.0);
    mix.note("ζ", zeta);
    mix.note("lines in the bandwidth", wide);
    let centre = wide / (2.0 * zeta) + mix.random.uniform();
    let poles = modes(mix, count, zeta, centre);
    let (kind, power, _) = kind(mix);
    // What stands far below and far above the band.
    let far = mix.some(0.7, "far modes", 0.1, 3.0);
    let mut all = poles.clone();
    for ratio in [0.1, 10.0] {
        let constant = Complex64::new(far * ratio * mix.random.between(-1.0, 1.0), 0.0);
        all.push(Pole { frequency: ratio * centre, zeta: 0.01, constant });
    }
    let reach = (wide * mix.log(6.0, 25.0)).max(12.0);
    let last = poles[count - 1].frequency + reach;
    let frequency: Vec<f64> =
        (((centre - reach).max(0.3 * centre).max(1.0) as usize)..last as usize).map(|k| k as f64).collect();
    let mut values: Vec<Complex64> = frequency.iter().map(|f| response(&all, *f, power)).collect();
    let top = values.iter().fold(0.0, |most: f64, v| v.norm().max(most));
    let noise = mix.log(1e-3, 10f64.powf(-1.5));
    mix.note("noise", noise);
    for v in &mut values {
        *v += Complex64::new(mix.random.normal(), mix.random.normal()) * (noise * top / 2f64.sqrt());
    }
    let measured = Measured::new(frequency, values, kind);
    compare(&measured, &poles)
}

fn averaged(mix: &mut Mix, count: usize) -> Record {
    let segment = [512, 1024, 2048][mix.random.between(0.0, 3.0) as usize];
    let segments = mix.log(10.0, 60.0) as usize;
    mix.note("segments", segments as f64);
    let wide = mix.log(1.0, 20.0);
    mix.note("lines in the bandwidth", wide);
    let centre = mix.random.between(0.1, 0.3) * segment as f64;
    let zeta = mix.note("ζ", (wide / (2.0 * centre)).min(0.1));
    let poles = modes(mix, count, zeta, centre);
    let (_, power, unit) = kind(mix);
    // A force that repeats after twice the record or later: exact steady motion, whose lines lie too close
    // together to be seen.
    let (rate, n) = (segment as f64, (segments + 1) * segment / 2);
    let half = n.next_power_of_two();
    let transform = Transform::new(2 * half);
    let step = rate / (2 * half) as f64;
    let force: Vec<Complex64> = (0..=half)
        .map(|k| {
            Complex64::new(mix.random.normal(), mix.random.normal())
                * f64::from(u8::from((k as f64) * step < 0.45 * rate && k > 0))
        })
        .collect();
    let motion: Vec<Complex64> = force
        .iter()
        .enumerate()
        .map(|(k, f)| f * if k > 0 { response(&poles, k as f64 * step, power) } else { Complex64::ZERO })
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
    let top = peak(&motion);
    mix.spoil(&mut motion, rate, top, (1e-3, 0.03));
    let traces = Traces::from_memory(vec![trace("N", rate, force), trace(unit, rate, motion)]);
    let options = SpectralOptions {
        segment: Some(segment),
        window: Some(Window::Hann),
        estimator: Some(Estimator::H1),
        ..SpectralOptions::default()
    };
    let found = traces.and_then(|mut traces| spectral(&mut traces, &options, |_| ()));
    let Some(Lines::Transfer(transfer)) = found.ok().map(|f| f.found) else { return asked(&poles, |_| None) };
    let mut measured = Measured::complex(&transfer.frf);
    measured.coherence = Some(transfer.coherence);
    measured.window = Some(Window::Hann);
    let known: Vec<usize> =
        (0..measured.values.len()).filter(|k| measured.values[*k].norm().is_finite()).collect();
    measured.frequency = known.iter().map(|k| measured.frequency[*k]).collect();
    measured.values = known.iter().map(|k| measured.values[*k]).collect();
    measured.coherence = measured.coherence.map(|c| known.iter().map(|k| c[*k]).collect());
    compare(&measured, &poles)
}

fn compare(measured: &Measured, poles: &[Pole]) -> Record {
    let Ok(found) = modal(measured, &ModalOptions::default()) else { return asked(poles, |_| None) };
    let reach: Vec<f64> = poles.iter().map(|p| (2.0 * p.zeta * p.frequency).max(1.0)).collect();
    let truths: Vec<f64> = poles.iter().map(|p| p.frequency).collect();
    let own = pairs(&truths, &reach, &found.modes.iter().map(|m| m.frequency.value).collect::<Vec<_>>());
    let mut record = asked(poles, |i| own[i].map(|k| &found.modes[k]));
    let unowned = |k: &usize| !own.contains(&Some(*k)) && found.modes[*k].frequency.std.is_some();
    record.invented = (0..found.modes.len()).filter(unowned).count();
    record
}

fn asked<'a>(
    poles: &[Pole],
    found: impl Fn(usize) -> Option<&'a vibroimpact::measure::modal::Mode>,
) -> Record {
    let mut record = Record::default();
    for (i, pole) in poles.iter().enumerate() {
        let own = found(i);
        record.answers.push(Answer::new("frequency", pole.frequency, own.map(|m| &m.frequency)));
        record.answers.push(Answer::new("damping ratio", pole.zeta, own.map(|m| &m.zeta)));
        record.answers.push(Answer::new("modal constant", pole.constant.re, own.map(|m| &m.modal_constant)));
    }
    record
}
