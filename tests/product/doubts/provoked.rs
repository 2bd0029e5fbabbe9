//! Records that provoke doubts.

use crate::cli::rig;
use crate::drill::{record, volts, wav};
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use vibroimpact::math::Noise;
use vibroimpact::measure::pulse::KelvinVoigt;
use vibroimpact::write::uff58::{Precision, Storage, write_uff58};

/// Arguments of `vibro` and the doubts that their answer must have.
pub struct Case {
    pub name: &'static str,
    pub arguments: Vec<String>,
    pub codes: &'static [&'static str],
}

fn case(name: &'static str, arguments: &str, file: Option<&Path>, codes: &'static [&'static str]) -> Case {
    let file = file.map(|file| file.to_str().unwrap().to_owned());
    let mut arguments: Vec<String> = arguments.split_whitespace().map(str::to_owned).collect();
    arguments.splice(1..1, file);
    Case { name, arguments, codes }
}

/// Records that provoke doubts of all analyses but fits, written to a folder.
pub fn cases(folder: &Path) -> Vec<Case> {
    let all = [readers, decays, functions, impacts, pulses, restitutions, spectra, sweeps, drills, plans];
    let each = all.into_iter().enumerate().flat_map(|(i, cases)| {
        let own = folder.join(i.to_string());
        std::fs::create_dir(&own).unwrap();
        cases(&own)
    });
    each.collect()
}

/// Writes a table of numbers; the name of the file is that of its case.
fn table(folder: &Path, name: &str, head: &str, rows: impl IntoIterator<Item = Vec<f64>>) -> PathBuf {
    let mut text = format!("{head}\n");
    for row in rows {
        let row: Vec<String> = row.iter().map(|value| format!("{value:.10e}")).collect();
        writeln!(text, "{}", row.join(",")).unwrap();
    }
    let path = folder.join(format!("{}.csv", name.replace(' ', "_")));
    std::fs::write(&path, text).unwrap();
    path
}

/// Writes samples at a rate in Hz.
fn samples(folder: &Path, name: &str, unit: &str, rate: f64, values: &[f64]) -> PathBuf {
    let rows = values.iter().enumerate().map(|(i, value)| vec![i as f64 / rate, *value]);
    table(folder, name, &format!("time [s],a [{unit}]"), rows)
}

/// Steady decays of 20 Hz at 1 kHz in files that leave their times, their unit or single values in doubt.
fn readers(folder: &Path) -> Vec<Case> {
    let mut noise = Noise::new(5);
    let mut value = |i: usize| {
        let t = i as f64 * 1e-3;
        (-0.02 * TAU * 20.0 * t).exp() * (TAU * 20.0 * t).cos() + 1e-4 * noise.normal()
    };
    let values: Vec<f64> = (0..3000).map(&mut value).collect();
    let text = |name: &'static str, head: &str, row: &dyn Fn(usize, f64) -> String, codes| {
        let command = if name == "a missing value" { "spectrum --tones 1" } else { "decay" };
        let rows: Vec<String> = values.iter().enumerate().map(|(i, v)| row(i, *v)).collect();
        let path = folder.join(format!("{}.csv", name.replace(' ', "_")));
        std::fs::write(&path, format!("{head}\n{}", rows.concat())).unwrap();
        case(name, command, Some(&path), codes)
    };
    let timed = |i: usize, v: f64| format!("{:.3},{v:.8}\n", i as f64 * 1e-3);
    let alone = |_: usize, v: f64| format!("{v:.8}\n");
    let filled = |i: usize, v: f64| timed(i, if i < 2900 { v } else { 0.0 });
    // A steady sine that stands out of the mark's even spectrum.
    let steady = |i: usize| 90.0 * (TAU * 0.02 * i as f64).sin();
    let marked = |i: usize, _: f64| timed(i, if i == 2000 { 999.0 } else { steady(i) });
    let lost = |i: usize, v: f64| if i % 50 == 9 { String::new() } else { timed(i, v) };
    let minutes = |i: usize, v: f64| format!("{}:{:02},{v:.8}\n", i / 60, i % 60);
    let grouped = |_: usize, v: f64| format!("{:.3}\n", 300.0 + 100.0 * v);
    let cut = |i: usize, v: f64| if i < 2999 { timed(i, v) } else { "2.999,0.0".to_owned() };
    vec![
        text("lost or rounded", "time [s],a [m]", &lost, &["axis-rounded-or-lost"]),
        text("hours or minutes", "time,a [m]", &minutes, &["axis-clock-minutes"]),
        text("decimated", "Sampling rate: 1000 Hz\nevery 8th sample\na [m]", &alone, &["rate-decimated"]),
        text("two rates", "Sampling rate: 1000 Hz\nfs = 2000 Hz\na [m]", &alone, &["rates-differ"]),
        text("step without unit", "Sample period: 500\na [m]", &alone, &["head-step-assumed"]),
        text("grouped digits", "Sampling rate: 1000 Hz\na [m]", &grouped, &["digits-may-be-grouped"]),
        text("unit of the head", "Unit: mm\ntime [s],a [m]", &timed, &["unit-head-differs"]),
        text("unit of the row", "time [s],a [mm]\n[s],[m]", &timed, &["unit-row-differs"]),
        text("quantity of the name", "time [s],Displacement [mm/s]", &timed, &["quantity-name-differs"]),
        text("quantity of the row", "time [s],a [m]\n[s],[m/s]", &timed, &["quantity-row-differs"]),
        text("unit of the times", "time [ms],a [m]\n[s],[m]", &timed, &["axis-row-differs"]),
        text("a missing value", "time [s],a [m]", &marked, &["missing-marked"]),
        text("filled up", "time [s],a [m]", &filled, &["filled-with-zeros"]),
        text("cut off", "time [s],a [m]", &cut, &["last-number-cut-off"]),
    ]
}

/// Free decays of a mode of 20 Hz whose frequency rises with its amplitude.
fn decays(folder: &Path) -> Vec<Case> {
    let decay = |name: &'static str, rise: f64, codes| {
        let (mut noise, mut phase) = (Noise::new(1), 0.0f64);
        let mut next = |i: i32| {
            let size = (-0.01 * TAU * 20.0 * f64::from(i) * 1e-3).exp();
            let value = size * phase.cos() + 1e-4 * noise.normal();
            phase += TAU * 20.0 * (1.0 + rise * size * size) * 1e-3;
            value
        };
        let values: Vec<f64> = (0..6000).map(&mut next).collect();
        case(name, "decay", Some(&samples(folder, name, "m", 1000.0, &values)), codes)
    };
    vec![
        decay("decay that changes", 0.003, &["decay-changes"]),
        decay("decay unexplained", 0.05, &["decay-unexplained"]),
    ]
}

/// Receptances of modes near 80 Hz, and a clipped response.
fn functions(folder: &Path) -> Vec<Case> {
    let receptance = |f: f64, count: i32, apart: f64| {
        let modes = (0..count).map(|k| {
            let (own, zeta) = (80.0 + apart * f64::from(k), 0.01 + 0.002 * f64::from(k % 2));
            let (re, im) = (TAU * TAU * (own * own - f * f), TAU * TAU * 2.0 * zeta * own * f);
            let scale = (1.0 - 0.1 * f64::from(k)) / (re * re + im * im);
            (scale * re, -scale * im)
        });
        modes.fold((0.0, 0.0), |sum: (f64, f64), one| (sum.0 + one.0, sum.1 + one.1))
    };
    let function = |name: &'static str, (count, apart): (i32, f64), phases: bool, codes| {
        let mut noise = Noise::new(2);
        let rows = (0..160).map(|k| {
            let f = 60.0 + 0.25 * f64::from(k);
            let (re, im) = receptance(f, count, apart);
            let size = re.hypot(im) * (1.0 + 1e-3 * noise.normal());
            let phase = im.atan2(re).to_degrees() + 0.05 * noise.normal();
            if phases { vec![f, size, phase] } else { vec![f, size] }
        });
        let phase = if phases { ",Phase [°]" } else { "" };
        let head = format!("Frequency [Hz],Receptance [m/N]{phase}");
        let file = table(folder, name, &head, rows.collect::<Vec<_>>());
        case(name, "modal", Some(&file), codes)
    };
    let mut noise = Noise::new(3);
    let mut past = [0.0; 2];
    let rows = (0..40_000).map(|i| {
        let force = noise.normal();
        past = [1.98 * 0.4f64.cos() * past[0] - 0.9801 * past[1] + force, past[0]];
        vec![f64::from(i) * 1e-3, force, past[0].clamp(-10.0, 10.0)]
    });
    let rows: Vec<Vec<f64>> = rows.collect();
    let clipped = table(folder, "modes of a clipped response", "time [s],force [N],x [m]", rows);
    vec![
        function("magnitudes", (1, 0.0), false, &["modal-magnitudes-only"]),
        function("two modes", (2, 0.3), true, &["modal-two-modes"]),
        function("six modes", (6, 0.6), true, &["modal-more-modes"]),
        case(
            "modes of a clipped response",
            "modal --reference force --channel x",
            Some(&clipped),
            &["spectrum-clipped"],
        ),
    ]
}

/// Bursts of 2 kHz at these times in s with these heights, in noise, sampled at 20 kHz.
fn bursts(times: impl Iterator<Item = (f64, f64)>, sigma: f64) -> Vec<f64> {
    let times: Vec<(f64, f64)> = times.collect();
    let last = times.iter().map(|(time, _)| *time).fold(0.0, f64::max);
    let mut noise = Noise::new(4);
    let mut values: Vec<f64> = (0..((last + 0.1) * 2e4) as usize).map(|_| sigma * noise.normal()).collect();
    for (at, height) in times {
        for (i, value) in values.iter_mut().enumerate().skip((at * 2e4) as usize + 1).take(200) {
            let t = i as f64 / 2e4 - at;
            *value += height * (-t / 6e-4).exp() * (TAU * 2000.0 * t).sin();
        }
    }
    values
}

fn impacts(folder: &Path) -> Vec<Case> {
    let train = |name: &'static str, arguments, values: &[f64], codes| {
        case(name, arguments, Some(&samples(folder, name, "m/s²", 2e4, values)), codes)
    };
    let regular = |n: i32| (0..n).map(|k| (0.05 + 0.08 * f64::from(k), 1.0));
    let echoes = regular(40).flat_map(|(t, _)| [(t, 1.0), (t + 4.1e-3, 0.3), (t + 9.7e-3, 0.21)]);
    // A pause of 60 intervals amid 24 impacts.
    let paused = (0..24).map(|k| (0.05 + 0.02 * f64::from(if k < 12 { k } else { k + 60 }), 1.0));
    // Flights of a body with R = 0.8, the first of 0.4 s.
    let bounces = (0..8).map(|k| (0.1 + 0.4 * (1.0 - 0.8f64.powi(k)) / 0.2, 1.0));
    vec![
        train("bounces", "impacts", &bursts(bounces, 2e-3), &["impacts-bounce"]),
        train("echoes", "impacts", &bursts(echoes, 2e-3), &["impacts-or-echoes"]),
        train("noise", "impacts --threshold 0.1", &bursts(regular(40), 0.1), &["impacts-lost-in-noise"]),
        train("a long pause", "impacts", &bursts(paused, 2e-3), &["impacts-mostly-missed"]),
    ]
}

/// The acceleration of a contact of ξ = 0.2 and 10 kHz, 3 m/s before it, at the time `t` in s: the sum of
/// spring and damper.
fn contact(t: f64) -> f64 {
    let (xi, omega, lasts) = (0.2f64, TAU * 10e3, KelvinVoigt::new(0.2, 10e3).unwrap().duration());
    let damped = omega * (1.0 - xi * xi).sqrt();
    let (sin, cos) = (damped * t).sin_cos();
    let (x, v) = (sin / damped, cos - xi * omega / damped * sin);
    let pulse = 3.0 * (-xi * omega * t).exp() * (omega * omega * x + 2.0 * xi * omega * v);
    if (0.0..lasts).contains(&t) { pulse } else { 0.0 }
}

fn pulses(folder: &Path) -> Vec<Case> {
    let seconds = |i: usize| i as f64 * 1e-6;
    let pulse = |name: &'static str, low_pass: &str, of: &dyn Fn(usize) -> f64, codes| {
        let mut noise = Noise::new(5);
        let values: Vec<f64> = (0..400).map(|i| of(i) + 100.0 * noise.normal()).collect();
        let file = samples(folder, name, "m/s²", 1e6, &values);
        case(name, &format!("pulse --mass 0.4 {low_pass}"), Some(&file), codes)
    };
    let own = |i: usize| contact(seconds(i) - 150.4e-6);
    // A first-order high-pass with a time constant of 15 pulses: y' = x' − y/τ.
    let tau = 15.0 * KelvinVoigt::new(0.2, 10e3).unwrap().duration();
    let drooping: Vec<f64> = (0..400)
        .scan((0.0, 0.0), |(y, before), i| {
            *y = (*y + own(i) - *before) * (-1e-6 / tau).exp();
            *before = own(i);
            Some(*y)
        })
        .collect();
    let ringing = |i: usize| {
        let rings = own(i) != 0.0;
        own(i) + if rings { 3e3 * (TAU * 2e5 * seconds(i)).sin() } else { 0.0 }
    };
    let times = |name, arguments, codes| case(name, arguments, None, codes);
    let none = "--low-pass none";
    vec![
        pulse("an unknown instrument", "", &own, &["pulse-instrument-unknown"]),
        pulse(
            "a corner above half the rate",
            "--low-pass 6e5 --order 2",
            &own,
            &["pulse-corner-above-half-rate"],
        ),
        pulse("a drooping sensor", none, &|i| drooping[i], &["pulse-level-changes"]),
        pulse("a pulse backwards in time", none, &|i| own(399 - i), &["pulse-gains-energy"]),
        pulse("a ringing sensor", none, &ringing, &["pulse-unexplained"]),
        times(
            "an early peak",
            "pulse --time-to-peak 1e-6 --duration 18e-6 --std 1e-6",
            &["pulse-ratio-near-zero"],
        ),
        times(
            "a pulse of the filter",
            "pulse --time-to-peak 5e-6 --duration 9e-6 --std 1e-7 --low-pass 50000 --order 2",
            &["pulse-low-pass-alone"],
        ),
    ]
}

fn restitutions(_: &Path) -> Vec<Case> {
    let of = |name, arguments: &str, codes| case(name, &format!("restitution {arguments}"), None, codes);
    let listed = |times: &[f64]| times.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
    // Flights after a fall of 0.57 m with R = 0.8, from the second on.
    let flights: Vec<f64> =
        (2..7).map(|n| 2.0 * (2.0f64 * 0.57 / 9.806_65).sqrt() * 0.8f64.powi(n)).collect();
    let voice = (0..5).flat_map(|k| [0.447 * 0.7f64.powi(k), 0.0023]);
    let voice: Vec<f64> = [0.0025, 0.0024].into_iter().chain(voice).collect();
    vec![
        of(
            "methods disagree",
            "--height 0.57 --height-std 0.001 --interval-std 1e-4 --intervals 0.144,0.072,0.036,0.018,0.009",
            &["methods-disagree"],
        ),
        of(
            "a velocity beside a train far from it",
            "--intervals 0.3,0.18 --before 3,0 --after=-1.2,0 --velocity-std 0.01",
            &["methods-far-apart"],
        ),
        of(
            "the second impact first",
            &format!("--height 0.57 --height-std 0.002 --interval-std 1e-4 --intervals {}", listed(&flights)),
            &["first-impact-unheard"],
        ),
        of(
            "a voice among bounces",
            &format!("--height 0.5 --height-std 0.001 --interval-std 1e-5 --intervals {}", listed(&voice)),
            &["drop-flights-grow"],
        ),
    ]
}

/// A plan of a decay below its noise.
fn plans(folder: &Path) -> Vec<Case> {
    let text = "[instrument]\nrate = 1000\nduration = 2\nnoise = 1\nrehearsals = 5\n\n[[decay]]\nmodes = [{ frequency = 25, zeta = 0.05, amplitude = 0.2 }]\n";
    let path = folder.join("plan.toml");
    std::fs::write(&path, text).unwrap();
    vec![case("a planned decay below the noise", "plan", Some(&path), &["plan-unanswered"])]
}

fn spectra(folder: &Path) -> Vec<Case> {
    let mut noise = Noise::new(6);
    let clipped: Vec<f64> = (0..20_000).map(|i| (TAU * 0.0221 * f64::from(i)).sin().min(0.7)).collect();
    let two = |i: i32| {
        let turn = TAU * f64::from(i) * 1e-3;
        (50.0 * turn).cos() + 0.5 * (50.8 * turn + 1.0).cos() + 1e-3 * noise.normal()
    };
    let two: Vec<f64> = (0..2000).map(two).collect();
    // A sweep through two lines.
    let swept = |i: i32| {
        let t = f64::from(i) * 1e-3 - 1.0;
        (TAU * (50.0 * t + 0.25 * t * t)).cos() + 1e-3 * noise.normal()
    };
    let swept: Vec<f64> = (0..2000).map(swept).collect();
    let spectrum = |name, arguments, values: &[f64], codes| {
        case(name, arguments, Some(&samples(folder, name, "V", 1000.0, values)), codes)
    };
    vec![
        spectrum("a clipped sine", "spectrum --scaling psd", &clipped, &["spectrum-clipped"]),
        spectrum("a drifting sine", "spectrum --tones 1", &swept, &["sine-unsteady"]),
        spectrum("two near sines", "spectrum --tones 1", &two, &["sine-not-alone"]),
    ]
}

/// Writes three steps of a sweep, sampled at 600 Hz, and returns the pattern of their names. The response to
/// the step at 25 Hz is a function of its time in s and its noise.
fn steps(folder: &Path, name: &str, seconds: f64, response: &dyn Fn(f64, f64) -> f64) -> PathBuf {
    let mut noise = Noise::new(7);
    for f in [20.0, 25.0, 30.0] {
        let rows = (0..(600.0 * seconds) as usize).map(|i| {
            let t = i as f64 / 600.0;
            let [of_force, own] = [3e-3, 1e-5].map(|sigma| sigma * noise.normal());
            let seen = if f == 25.0 { response(t, own) } else { 5e-3 * (TAU * f * t).cos() + own };
            vec![t, 3.0 * (TAU * f * t + 0.4).cos() + of_force, seen]
        });
        let rows: Vec<Vec<f64>> = rows.collect();
        table(folder, &format!("{name} {f}"), "Time (s),Force (N),Displacement (m)", rows);
    }
    folder.join(format!("{}_*.csv", name.replace(' ', "_")))
}

fn sweeps(folder: &Path) -> Vec<Case> {
    let sine = |t: f64| 1e-2 * (TAU * 25.0 * t - 1.0).cos();
    let unsettled = |t: f64, noise| sine(t) + noise + 1e-2 * (-t).exp() * (TAU * 24.4 * t).cos();
    let clipped = steps(folder, "clipped", 4.0, &|t, noise| (sine(t) + noise).min(8e-3));
    let unsettled = steps(folder, "unsettled", 1.0, &unsettled);
    let list = rig::sweep(folder, &rig::frequencies());
    vec![
        case("a clipped step", "response", Some(&clipped), &["step-clipped"]),
        case("an unsettled step", "response", Some(&unsettled), &["step-not-settled"]),
        case(
            "another window",
            "response --unit m/s --window rectangular",
            Some(&list),
            &["sweep-window-unlike"],
        ),
    ]
}

fn drills(folder: &Path) -> Vec<Case> {
    const PLAIN: &str = "drill --velocity striker --reference pulse --beam-angle 30 --beam-from normal \
                         --pulses-per-turn 1 --edge rising --mass 0.14";
    let made = record::run(0, 1.0).unwrap();
    let drill = |name: &'static str, more: &str, striker: Vec<f64>, pulse: Vec<f64>, codes| {
        let channels = [volts("striker", striker), volts("pulse", pulse)];
        let file = wav(folder, &format!("{}.wav", name.replace(' ', "_")), &channels);
        case(name, &format!("{PLAIN} --sensitivity 2 {more}"), Some(&file), codes)
    };
    let (striker, pulse) = (|| made.velocity.clone(), || made.pulse.clone());
    let moved =
        |by: &dyn Fn(usize, f64) -> f64| made.velocity.iter().enumerate().map(|(i, v)| by(i, *v)).collect();
    let seconds = |i: usize| i as f64 / record::RATE;
    // Pulses of another shaft, of 61.3 turns a second.
    let other = (0..made.pulse.len()).map(|i| f64::from(u8::from((61.3 * seconds(i)).fract() < 0.1)));
    let mut twice = [volts("striker", striker()), volts("pulse", pulse())];
    twice[0].meta_mut().adopt_unit("m/s");
    let file = folder.join("twice.uff");
    let storage = Storage { binary: true, precision: Precision::Double };
    write_uff58(&twice, &mut std::fs::File::create(&file).unwrap(), storage).unwrap();
    vec![
        drill(
            "a range too small",
            "--struck-mass 0.43",
            moved(&|_, v| v.min(0.25 * 7.6)),
            pulse(),
            &["drill-over-range", "drill-impacts-over-range"],
        ),
        drill("a velocity offset", "", moved(&|_, v| v + 0.3), pulse(), &["drill-mean-velocity"]),
        drill(
            "a struck mass too small",
            "--struck-mass 0.02",
            striker(),
            pulse(),
            &["drill-restitution-impossible"],
        ),
        drill("long fits", "--fit-duration 0.005", striker(), pulse(), &["drill-lack-of-fit"]),
        drill("a slow instrument", "--instrument 100", striker(), pulse(), &["drill-instrument-limited"]),
        drill("another shaft", "", striker(), other.collect(), &["drill-phase-undirected"]),
        case(
            "a velocity scaled twice",
            &format!("{PLAIN} --sensitivity 2"),
            Some(&file),
            &["drill-velocity-scaled-twice"],
        ),
    ]
}

/// The example's hammer drill with another damper than that of its recordings.
fn joined_drill(folder: &Path) -> Case {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/hammer_drill");
    std::fs::create_dir_all(folder.join("data")).unwrap();
    std::fs::copy(example.join("campaign.toml"), folder.join("campaign.toml")).unwrap();
    let drill = std::fs::read_to_string(example.join("drill.toml")).unwrap();
    std::fs::write(folder.join("drill.toml"), drill.replace("damping = 1060", "damping = 700")).unwrap();
    crate::drill::example(&folder.join("data"), 1.0);
    case("another drill", "run", Some(&folder.join("campaign.toml")), &["drill-fit-lack"])
}

/// Fits of the example's rig, one sweep of it for speed, and of the example's hammer drill.
pub fn fits(folder: &Path) -> Vec<Case> {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/two_mass_rig");
    let text = std::fs::read_to_string(example.join("campaign.toml")).unwrap();
    let fit = |name: &'static str, sweeps: usize, keys: &str, rig: (&str, &str), fitted: &str, codes| {
        let own = folder.join(name.replace(' ', "_"));
        std::fs::create_dir(&own).unwrap();
        for file in crate::layers::files(&example) {
            let to = own.join(file.strip_prefix(&example).unwrap());
            std::fs::create_dir_all(to.parent().unwrap()).unwrap();
            std::fs::copy(&file, to).unwrap();
        }
        let parts: Vec<&str> = text.split("[[sweep]]").collect();
        let head = parts[0].replace("[fit]", &format!("[fit]\nstarts = 1\n{keys}\n"));
        let head = head.replace(rig.0, rig.1);
        let parts = [&[head.as_str()], &parts[1..=sweeps]].concat();
        let campaign = own.join("campaign.toml");
        std::fs::write(&campaign, parts.join("[[sweep]]")).unwrap();
        case(name, &format!("compare --fit {fitted}"), Some(&campaign), codes)
    };
    vec![
        fit("a prior far off", 4, "prior.gap = [1.3e-3, 1e-5]", ("", ""), "gap,c1", &["prior-contradicted"]),
        joined_drill(&folder.join("drill")),
        fit("another spring", 1, "", ("k1 = 135.0", "k1 = 150.0"), "c1", &["many-outliers", "lack-of-fit"]),
    ]
}
