//! Stepped-sine sweeps of a mass on a spring, without impacts.

use super::disturbance::Mix;
use super::record::{Answer, Kind, Record};
use super::trace;
use std::f64::consts::{PI, TAU};
use vibroimpact::measure::response::{ResponseOptions, response};
use vibroimpact::record::{Axis, Direction, Scaling, Spectrum, Sweep, SweepPoint, Values, Window};
use vibroimpact::signal::fft::Transform;

pub const KINDS: &[Kind] = &[Kind {
    name: "sweep",
    ranges: "12 to 30 steps over 1 to 6 half-power bandwidths, ζ 0.005 to 0.1, 512 or 1024 samples a spectrum, Hann window, resonance at 12 to 60 lines; \
        displacement from velocity; white noise 0.0001 to 0.01 of the largest response, 1/f noise, hum and 12 bits as in decays; frequency that drifts by \
        0.01 to 0.2 lines a spectrum, amplitude modulated by 0.1 to 2 % at 0.5 to 20 lines, each in a third; the truth is the mean over the spectrum under its window",
    every: 1,
    draw,
}];

/// One line spectrum of peak magnitudes behind a Hann window.
fn lines(transform: &Transform, values: &[f64]) -> Vec<f64> {
    let n = values.len();
    let hann = |i: usize| 1.0 - (TAU * i as f64 / n as f64).cos();
    let windowed: Vec<f64> = values.iter().enumerate().map(|(i, v)| v * hann(i)).collect();
    let mut lines: Vec<f64> =
        transform.forward(&windowed).iter().map(|line| line.norm() * 2.0 / n as f64).collect();
    lines.truncate((n as f64 / 2.56) as usize + 1);
    lines
}

fn draw(mix: &mut Mix) -> Record {
    let n = if mix.chance(0.5) { 512 } else { 1024 };
    // The rate is that of lines 1/16 Hz apart.
    let width = 0.0625;
    let rate = width * n as f64;
    let zeta = mix.log(0.005, 0.1);
    mix.note("ζ", zeta);
    let own = width * mix.log(12.0, 60.0);
    mix.note("resonance in lines", own / width);
    let reach = zeta * own * mix.log(1.0, 6.0);
    let steps = mix.random.between(12.0, 31.0) as usize;
    let mass = 0.2;
    // Displacement over force.
    let receptance = |f: f64| 1.0 / (mass * TAU * TAU * (own * own - f * f).hypot(2.0 * zeta * own * f));
    let force = mix.log(0.1, 10.0);
    let drift = mix.some(0.33, "drift in lines", 0.01, 0.2);
    let modulation = mix.some(0.33, "modulation", 1e-3, 0.02);
    let wave = mix.log(0.5, 20.0);
    if modulation > 0.0 {
        mix.note("modulation at lines", wave);
    }
    let chain = mix.chain((1e-4, 0.01));
    let largest =
        (0..=100).map(|k| own + reach * (f64::from(k) / 50.0 - 1.0)).map(|f| TAU * f * receptance(f) * force);
    let largest = largest.fold(0.0, f64::max);
    let transform = Transform::new(n);
    let (mut points, mut truths) = (Vec::new(), Vec::new());
    for k in 0..steps {
        let f = (own - reach + 2.0 * reach * k as f64 / (steps - 1) as f64).max(6.0 * width);
        let (phase, lag, beat) =
            (mix.random.between(-PI, PI), mix.random.between(-PI, PI), mix.random.between(-PI, PI));
        // Phase and size at the place u of the record, 0 to 1.
        let turn = |u: f64| TAU * (f / width * u + 0.5 * drift * u * (u - 1.0)) + phase;
        let size = |u: f64| 1.0 + modulation * (TAU * wave * u + beat).cos();
        // The mean of a cosine of w waves, and that under the window.
        let plain = |w: f64| ((TAU * w + beat).sin() - beat.sin()) / (TAU * w);
        let mean = 1.0 + modulation * (plain(wave) - 0.5 * (plain(wave + 1.0) + plain(wave - 1.0)));
        let place = |i: usize| i as f64 / n as f64;
        let mut pressed: Vec<f64> = (0..n).map(|i| force * size(place(i)) * turn(place(i)).cos()).collect();
        let speed = TAU * f * receptance(f) * force;
        let mut moved: Vec<f64> =
            (0..n).map(|i| speed * size(place(i)) * (turn(place(i)) + lag).cos()).collect();
        chain.pass(mix, &mut moved, rate, largest);
        mix.add_white(&mut pressed, 0.3 * chain.white * force);
        let meta = trace("m/s", rate, Vec::new()).meta;
        let values = Values::Real(lines(&transform, &moved));
        let axis = Axis::frequency(0.0, width, values.len());
        let spectrum = Spectrum {
            meta,
            axis,
            values,
            scaling: Scaling::Peak,
            window: Some(Window::Hann),
            enbw: Some(1.5),
        };
        points.push(SweepPoint {
            force_path: None,
            response_path: format!("{k}").into(),
            force: Values::Real(lines(&transform, &pressed)),
            given: None,
            response: spectrum,
        });
        truths.push((f, force * mean, receptance(f) * force * mean));
    }
    let axis = points[0].response.axis.clone();
    let (name, direction) = ("sweep".into(), Some(Direction::Up));
    let sweep =
        Sweep { name, direction, mass: Some(1), axis, analyser_integrated: 0, points, findings: Vec::new() };
    let found = response(&sweep, &ResponseOptions::default()).ok();
    let mut record = Record::default();
    for (k, (f, force, amplitude)) in truths.into_iter().enumerate() {
        let point = found.as_ref().map(|r| &r.points[k]);
        record.answers.push(Answer::of("excitation", f, point.map(|p| (p.excitation, p.excitation_std))));
        record.answers.push(Answer::of("force", force, point.and_then(|p| Some((p.force?, p.force_std)))));
        let amplitudes = point.filter(|p| p.upper_limit.is_none()).map(|p| &p.amplitude);
        record.answers.push(Answer::new("amplitude", amplitude, amplitudes));
    }
    // The displacement is largest below the undamped frequency.
    let top = own * (1.0 - 2.0 * zeta * zeta).sqrt();
    let resonances = found.iter().flat_map(|r| &r.resonances);
    let nearest = resonances.min_by(|a, b| (a.frequency - top).abs().total_cmp(&(b.frequency - top).abs()));
    record.answers.push(Answer::of("resonance", top, nearest.map(|r| (r.frequency, r.frequency_std))));
    // The steps of a force that changes at random lie on no curve.
    if modulation == 0.0 {
        let found = nearest.map(|r| (r.amplitude, r.amplitude_std));
        record.answers.push(Answer::of("height of resonance", receptance(top) * force, found));
    }
    record
}
