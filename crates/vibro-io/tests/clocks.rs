//! Time columns as telephones and loggers write them, drawn with seeds: they jitter, wander, lose samples,
//! or are uneven. Each is read with the rate from which it was drawn, or refused with the setting that
//! reads it. Values and instants are compared one by one.

use vibro_io::{Reader, Recording};
use vibro_math::Noise;
use vibro_record::{AxisKind, Error, Grid, Record, Trace};

/// How an export stamps its samples.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Clock {
    /// Each instant has an independent error.
    Jitters,
    /// Each step has an error, which shifts all later instants.
    Wanders,
}

/// A layout: the header, and how a row is printed.
struct Layout {
    file: &'static str,
    head: &'static str,
    row: fn(f64, [f64; 2]) -> String,
    /// Name of the first channel, and its factor to SI.
    channel: (&'static str, f64),
    /// Largest rounding error of an instant in s, and of a value in its printed unit.
    digits: (f64, f64),
    /// Printed time in s of the instant 0; NaN if the axis counts from its first sample.
    start: f64,
}

fn sci(value: f64) -> String {
    format!("{value:.9E}")
}

const LAYOUTS: [Layout; 7] = [
    Layout {
        file: "Raw Data.csv",
        head: "\"Time (s)\",\"Linear Acceleration x (m/s^2)\",\"Linear Acceleration y (m/s^2)\"\n",
        row: |t, [a, b]| format!("{},{},{}", sci(t), sci(a), sci(b)),
        channel: ("Linear Acceleration x", 1.0),
        digits: (5e-9, 5e-9),
        start: 0.0,
    },
    Layout {
        file: "Raw Data.csv",
        head: "\"Time (s)\"\t\"Linear Acceleration x (m/s^2)\"\t\"Linear Acceleration y (m/s^2)\"\n",
        row: |t, [a, b]| format!("{}\t{}\t{}", sci(t), sci(a), sci(b)),
        channel: ("Linear Acceleration x", 1.0),
        digits: (5e-9, 5e-9),
        start: 0.0,
    },
    Layout {
        file: "Rohdaten.csv",
        head: "\"Time (s)\";\"Linear Acceleration x (m/s^2)\";\"Linear Acceleration y (m/s^2)\"\n",
        row: |t, [a, b]| format!("{};{};{}", sci(t), sci(a), sci(b)).replace('.', ","),
        channel: ("Linear Acceleration x", 1.0),
        digits: (5e-9, 5e-9),
        start: 0.0,
    },
    Layout {
        file: "Rohdaten.csv",
        head: "\"Time (s)\"\t\"Linear Acceleration x (m/s^2)\"\t\"Linear Acceleration y (m/s^2)\"\n",
        row: |t, [a, b]| format!("{}\t{}\t{}", sci(t), sci(a), sci(b)).replace('.', ","),
        channel: ("Linear Acceleration x", 1.0),
        digits: (5e-9, 5e-9),
        start: 0.0,
    },
    Layout {
        file: "Accelerometer.csv",
        head: "time,seconds_elapsed,z,y\n",
        row: |t, [a, b]| {
            let since = 1_700_000_000_123_456_789 + (1e9 * t).round() as i64;
            format!("{since},{:.9},{a:.9},{b:.9}", t + 0.034)
        },
        channel: ("z", 1.0),
        // Nanoseconds since 1970 are rounded by up to 128 ns, as doubles.
        digits: (2e-7, 5e-10),
        start: f64::NAN,
    },
    Layout {
        file: "Inertial.csv",
        head: "Timestamp (us),Accelerometer X (g),Accelerometer Y (g)\n",
        row: |t, [a, b]| format!("{:.0},{a:.6},{b:.6}", 1e6 * (t + 12.5)),
        channel: ("Accelerometer X", 9.80665),
        digits: (5e-7, 5e-7),
        start: 12.5,
    },
    Layout {
        file: "serial.csv",
        head: "millis,a,b\n",
        // The clock of an Arduino truncates to whole milliseconds.
        row: |t, [a, b]| format!("{},{a:.2},{b:.2}", (1e3 * (t + 1.0)).floor()),
        channel: ("a", 1.0),
        digits: (5e-4, 5e-3),
        start: 0.9995,
    },
];

/// A drawn export: the instants of all samples, including lost ones, and which samples are printed.
struct Drawn {
    layout: &'static Layout,
    step: f64,
    instants: Vec<f64>,
    kept: Vec<usize>,
}

impl Drawn {
    fn new(seed: u64, clock: Clock) -> Drawn {
        let mut noise = Noise::new(seed);
        let layout = &LAYOUTS[(seed % LAYOUTS.len() as u64) as usize];
        let n = noise.between(150.0, 900.0) as usize;
        let coarse = layout.digits.0 > 1e-4;
        let step = if coarse { noise.between(3.1e-3, 2e-2) } else { noise.between(2e-3, 2e-2) };
        // Five standard deviations are at most a tenth of a step; with wander, for the sum of all n errors.
        let size = match clock {
            Clock::Jitters => noise.uniform() * 0.02 * step,
            Clock::Wanders => noise.uniform() * 0.02 * step / (n as f64).sqrt(),
        };
        let mut last = 0.0;
        let mut next = |i: usize| match clock {
            Clock::Jitters => step * i as f64 + size * noise.normal(),
            Clock::Wanders => {
                last += step + size * noise.normal();
                last
            }
        };
        let instants = (0..n).map(&mut next).collect();
        Drawn { layout, step, instants, kept: (0..n).collect() }
    }

    /// Removes one to three samples.
    fn lose(mut self, seed: u64) -> Drawn {
        let mut noise = Noise::new(seed ^ 0x5EED);
        for _ in 0..noise.between(1.0, 4.0) as usize {
            let at = noise.between(1.0, (self.kept.len() - 1) as f64) as usize;
            self.kept.remove(at);
        }
        self
    }

    fn values(i: usize) -> [f64; 2] {
        [2.0 * (0.4 * i as f64).sin(), 1.5 * (0.27 * i as f64).cos()]
    }

    fn text(&self) -> String {
        let row = |i: &usize| (self.layout.row)(self.instants[*i], Drawn::values(*i)) + "\n";
        self.layout.head.to_owned() + &self.kept.iter().map(row).collect::<String>()
    }

    fn read(&self, reader: &Reader) -> vibro_record::Result<Recording> {
        reader.from_reader(self.layout.file, self.text().as_bytes())
    }

    /// Differences between a trace and the samples `kept` on an even grid.
    fn faults(&self, trace: &Trace, kept: &[usize]) -> Vec<String> {
        let mut faults = Vec::new();
        let (name, factor) = self.layout.channel;
        if trace.meta.name != name || trace.values.len() != kept.len() {
            return vec![format!("{} values of {:?}", trace.values.len(), trace.meta.name)];
        }
        let off = |k: &usize| {
            let right = factor * Drawn::values(kept[*k])[0];
            (trace.values[*k] - right).abs() > factor * self.layout.digits.1 * (1.0 + 1e-9)
        };
        faults.extend((0..kept.len()).find(off).map(|k| format!("value {k}")));
        // Instants are within jitter and rounding of the grid.
        let start = if self.layout.start.is_nan() { -self.instants[0] } else { self.layout.start };
        let most = 0.15 * self.step + 2.0 * self.layout.digits.0;
        let late = |k: &usize| (trace.axis.at(*k) - start - self.instants[kept[*k]]).abs() > most;
        faults.extend((0..kept.len()).find(late).map(|k| format!("instant {k}: {}", trace.axis.at(k))));
        faults
    }
}

fn concat(rows: impl Iterator<Item = String>) -> String {
    rows.collect::<Vec<String>>().concat()
}

fn first(recording: &Recording) -> &Trace {
    let Record::Trace(trace) = &recording.records[0] else { panic!("no trace") };
    trace
}

fn refused(recording: &Recording) -> Error {
    first(recording).sampling_rate().expect_err("uneven")
}

const SEEDS: u64 = 240;

#[test]
fn a_jittering_or_wandering_clock_is_even_and_its_rate_lies_within_its_uncertainty() {
    let (mut said, mut held, mut wrong) = (0, 0, Vec::new());
    for seed in 1..=SEEDS {
        let clock = if seed % 4 < 2 { Clock::Jitters } else { Clock::Wanders };
        let drawn = Drawn::new(seed, clock);
        let recording = drawn.read(&Reader::new()).unwrap_or_else(|why| panic!("{seed}: {why}"));
        let (trace, all) = (first(&recording), recording.all_findings());
        wrong.extend(drawn.faults(trace, &drawn.kept).into_iter().map(|fault| format!("{seed}: {fault}")));
        let Some(rate) = trace.rate() else {
            wrong.push(format!("{seed}: uneven, {all:?}"));
            continue;
        };
        if recording.records.len() != 2 {
            wrong.push(format!("{seed}: {} channels", recording.records.len()));
        }
        if let Some(found) = all.iter().find(|found| found.code == "axis-jitter") {
            said += 1;
            let std = found.get("std").expect("an uncertainty");
            held += u64::from((rate * drawn.step - 1.0).abs() / drawn.step <= 2.0 * std);
            // 8 standard uncertainties with 7 degrees of freedom (Student): exceeded by chance once in 11
            // 000.
            if (rate - 1.0 / drawn.step).abs() > 8.0 * std {
                wrong.push(format!("{seed}: {rate} ± {std}, not {}", 1.0 / drawn.step));
            }
        } else if (rate * drawn.step - 1.0).abs() * drawn.kept.len() as f64 > 0.5 {
            // For times that are only rounded, the rate is within half a step over the whole record.
            wrong.push(format!("{seed}: {rate}, not {}", 1.0 / drawn.step));
        }
    }
    assert!(wrong.is_empty(), "{} faults:\n{}", wrong.len(), wrong.join("\n"));
    // Within 2 standard uncertainties: 91 % with 7 degrees of freedom (Student); more for independent
    // jitter.
    assert!(said > SEEDS / 2 && held as f64 > 0.9 * said as f64, "{held} of {said}");
}

#[test]
fn a_nominal_rate_beside_such_a_column_works() {
    for seed in 1..=60 {
        let drawn = Drawn::new(seed, Clock::Wanders);
        let nominal =
            (1.0 / drawn.step * (1.0 + 0.004 * Noise::new(seed).between(-1.0, 1.0)) * 100.0).round() / 100.0;
        let recording = drawn.read(&Reader::new().rate(Some(nominal)));
        let recording = match recording {
            Ok(recording) => recording,
            // A column that is only rounded must agree with the stated rate within its digits.
            Err(why) => {
                let plain = drawn.read(&Reader::new()).expect("read without");
                assert!(
                    plain.all_findings().iter().all(|found| found.code != "axis-jitter"),
                    "{seed}: {why}"
                );
                continue;
            }
        };
        assert_eq!(drawn.faults(first(&recording), &drawn.kept), [""; 0], "{seed}");
        // Twice the rate is refused as another clock.
        let why = drawn.read(&Reader::new().rate(Some(2.0 * nominal))).expect_err("another rate").to_string();
        assert!(why.contains("holds a time"), "{why}");
    }
}

#[test]
fn no_lost_sample_passes_in_silence_and_each_stretch_reads() {
    let mut wrong = Vec::new();
    for seed in 1..=SEEDS {
        let drawn = Drawn::new(seed, if seed % 2 == 0 { Clock::Jitters } else { Clock::Wanders }).lose(seed);
        let recording = drawn.read(&Reader::new()).unwrap_or_else(|why| panic!("{seed}: {why}"));
        let all = recording.all_findings();
        let Grid::Uneven(instants) = &first(&recording).axis.grid else {
            wrong.push(format!("{seed}: even in spite of lost samples"));
            continue;
        };
        assert_eq!(instants.len(), drawn.kept.len());
        let Some(found) = all.iter().find(|found| found.code == "samples-lost") else {
            wrong.push(format!("{seed}: {:?}", all.iter().map(|f| &f.code).collect::<Vec<_>>()));
            continue;
        };
        let number = found.get("longest").expect("a number") as usize;
        let why = refused(&recording).to_string();
        assert!(why.contains(&format!("stretch = {number}")), "{seed}: {why}");
        // Runs of consecutive samples; runs of fewer than 16 samples are not offered as stretches.
        let runs: Vec<&[usize]> =
            drawn.kept.chunk_by(|a, b| b - a == 1).filter(|run| run.len() >= 16).collect();
        for (i, run) in runs.iter().enumerate() {
            let stretch = drawn.read(&Reader::new().stretch(Some(i + 1)));
            let stretch = stretch.unwrap_or_else(|why| panic!("{seed}, stretch {}: {why}", i + 1));
            let trace = first(&stretch);
            wrong.extend(drawn.faults(trace, run).into_iter().map(|fault| format!("{seed}, {i}: {fault}")));
            assert!(trace.sampling_rate().is_ok(), "{seed}");
        }
        let many = drawn.read(&Reader::new().stretch(Some(runs.len() + 1)));
        assert!(many.expect_err("one too many").to_string().contains("stretch"), "{seed}");
    }
    assert!(wrong.is_empty(), "{} faults:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn uneven_times_are_refused_and_interpolated_within_the_stated_error() {
    for seed in 1..=60 {
        let mut noise = Noise::new(seed);
        let mut t = 0.0;
        let mut next = || {
            t += noise.between(4e-3, 1.2e-2);
            t
        };
        let instants: Vec<f64> = (0..800).map(|_| next()).collect();
        let frequency = Noise::new(seed + 99).between(2.0, 12.0);
        let signal = |t: f64| 3.0 * (std::f64::consts::TAU * frequency * t).sin();
        let rows = concat(instants.iter().map(|t| format!("{t:.9},{:.12}\n", signal(*t))));
        let text = format!("time (s),a (m/s^2)\n{rows}");
        let read = |reader: Reader| reader.from_reader("a.csv", text.as_bytes());
        let plain = read(Reader::new()).expect("read");
        let why = refused(&plain).to_string();
        let typed = why.rsplit("resample = ").next().and_then(|rest| rest.split(')').next());
        let rate: f64 = typed.and_then(|rate| rate.parse().ok()).unwrap_or_else(|| panic!("{why}"));
        let made = read(Reader::new().resample(Some(rate))).unwrap_or_else(|why| panic!("{seed}: {why}"));
        let trace = first(&made);
        assert!((trace.rate().expect("even") / rate - 1.0).abs() < 1e-12);
        let stated = trace.meta.findings.iter().find(|found| found.code == "resampled").expect("an error");
        let stated = stated.get("error").expect("a number");
        let off = |(i, v): (usize, &f64)| (v - signal(trace.axis.at(i))).powi(2);
        let actual = trace.values.iter().enumerate().map(off).sum::<f64>() / trace.values.len() as f64;
        assert!(actual.sqrt() <= stated, "{seed}: {} of {stated}", actual.sqrt());
        // A rate far below or far above that of the samples is refused, and the error names a rate that
        // works.
        for far in [0.5 * rate, 20.0 * rate] {
            let why = read(Reader::new().resample(Some(far))).expect_err("folds or invents").to_string();
            assert!(why.contains("resample = "), "{why}");
        }
    }
}

#[test]
fn noise_and_repeated_instants_are_not_interpolated() {
    let mut noise = Noise::new(3);
    let mut t = 0.0;
    let mut next = || {
        t += noise.between(4e-3, 1.2e-2);
        (t, noise.normal())
    };
    let drawn: Vec<(f64, f64)> = (0..500).map(|_| next()).collect();
    let rows = concat(drawn.iter().map(|(t, noise)| format!("{t:.6},{noise:.6}\n")));
    let back = |i: usize| if i == 250 { 0.02 } else { 0.0 };
    let twice = concat(
        drawn.iter().enumerate().map(|(i, (t, _))| format!("{:.6},{:.6}\n", t - back(i), (20.0 * t).sin())),
    );
    for (rows, words) in [(rows, "too far apart"), (twice, "do not rise")] {
        let text = format!("time (s),a (m/s^2)\n{rows}");
        let why = Reader::new().resample(Some(150.0)).from_reader("a.csv", text.as_bytes());
        let why = why.expect_err("no interpolation").to_string();
        assert!(why.contains(words), "{why}");
    }
}

/// Output of an Arduino without a header: the unit of the times follows from the stated rate.
#[test]
fn times_without_a_name_have_the_unit_that_the_rate_needs() {
    let row = |i| format!("{},{:.2}\n", 1023 + (f64::from(i) / 0.3) as u64, (0.3 * f64::from(i)).sin());
    let rows = concat((0..600).map(row));
    let recording = Reader::new().rate(Some(300.0)).from_reader("log.txt", rows.as_bytes()).expect("read");
    let trace = first(&recording);
    // The span of 599 steps, 2 s long, is off by at most one millisecond.
    assert!((trace.rate().expect("even") / 300.0 - 1.0).abs() < 1e-3 / 2.0, "{:?}", trace.axis);
}

/// Various header lines that state a rate, above columns of values.
#[test]
fn rates_in_heads_are_used() {
    let row = |i| format!("{:.5},{:.5}\n", (0.1 * f64::from(i)).sin(), (0.3 * f64::from(i)).cos());
    let rows = concat((0..300).map(row));
    for (head, rate) in [
        ("Sampling Freq(Hz) 100Hz", 100.0),
        ("# data_rate = 2000.0 Hz", 2000.0),
        ("// Sample rate: 50.0Hz", 50.0),
        ("#DELTA: 0.0133", 1.0 / 0.0133),
        ("DELTA: 0.0133", 1.0 / 0.0133),
        ("Sample rate 1200 Hz", 1200.0),
        ("Abtastrate 1200 1/s", 1200.0),
        ("Messrate,1200 Hz", 1200.0),
    ] {
        for (file, names) in [("a.csv", "A (V),B (V)\n"), ("a.txt", "")] {
            let text = format!("{head}\n{names}{rows}");
            let found = Reader::new().from_reader(file, text.as_bytes()).expect("read");
            let own = first(&found).rate().unwrap_or_else(|| panic!("{head} in {file}"));
            assert!((own / rate - 1.0).abs() < 1e-12, "{head} in {file}: {own}");
        }
    }
}

/// K-NET, SLIST and Q-files end with a short row: no value is to be removed.
#[test]
fn a_short_last_row_of_a_series_loses_no_value() {
    let values: Vec<f64> = (0..590).map(|i| (1e4 * (0.05 * f64::from(i)).sin()).round()).collect();
    for columns in [5, 6, 7, 8] {
        let rows = values.chunks(columns).map(|row| concat(row.iter().map(|v| format!("{v:10.0}"))) + "\n");
        let text =
            "Station Code      BENCH\nSampling Freq(Hz) 100Hz\n".to_owned() + &rows.collect::<String>();
        let why = Reader::new().from_reader("a.EW", text.as_bytes());
        if let Err(why) = why {
            assert!(why.to_string().contains("wrapped"), "{columns}: {why}");
        } else {
            // Rows of five are all full, so nothing shows a series.
            assert_eq!(values.len() % columns, 0);
        }
        let found = Reader::new().wrapped(Some(true)).from_reader("a.EW", text.as_bytes()).expect("read");
        let trace = first(&found);
        assert_eq!((&trace.values, trace.rate()), (&values, Some(100.0)), "{columns}");
    }
}

/// Headers of loggers and oscilloscopes that state a rate, with semicolons, commas and various units.
#[test]
fn rates_in_units_of_samples_a_second_are_used() {
    let row = |i| format!("{:.5};{:.5}\n", (0.1 * f64::from(i)).sin(), (0.3 * f64::from(i)).cos());
    let rows = concat((0..300).map(row));
    let mut wrong = Vec::new();
    for (head, rate) in [
        ("Sample rate: 2 kS/s", 2000.0),
        ("Sampling rate;2 kS/s", 2000.0),
        ("Sample Rate;2;kS/s", 2000.0),
        ("Abtastrate [Hz];500", 500.0),
        ("Abtastrate;500 Hz", 500.0),
        ("Abtastrate: 500,0 Hz", 500.0),
        ("Samplerate: 1 kHz", 1000.0),
        ("Sample rate = 51.2 kSa/s", 51_200.0),
        ("Sampling Rate: 1 MS/s", 1e6),
        ("Sample Frequency (Hz);1000", 1000.0),
        ("Samplingrate;1000 Hz", 1000.0),
        ("Sample rate [S/s];1000", 1000.0),
        ("Scan rate: 100 samples/s", 100.0),
        ("Sample Rate: 100 samples/sec", 100.0),
        ("Sample rate: 100 samples per second", 100.0),
        ("Sample rate (samples/second);100", 100.0),
        ("Rate: 250 SPS", 250.0),
        ("ODR: 400 Hz", 400.0),
        ("Output data rate: 400 Hz", 400.0),
        ("sampling_rate_hz: 200", 200.0),
        ("sample_rate_hz=200", 200.0),
        ("fs_Hz = 200", 200.0),
        ("# fs = 200 Hz", 200.0),
        ("Fs;200 Hz", 200.0),
        ("Fréquence d'échantillonnage: 200 Hz", 200.0),
        ("Frequenza di campionamento: 200 Hz", 200.0),
        ("Frecuencia de muestreo: 200 Hz", 200.0),
        ("Abtastfrequenz = 2,5 kHz", 2500.0),
        ("Abtastzeit: 2 ms", 500.0),
        ("Abtastintervall [ms];2", 500.0),
        ("Messintervall: 2 ms", 500.0),
        ("Sample interval: 2 ms", 500.0),
        ("Sample period (s);0.002", 500.0),
    ] {
        let text = format!("{head}\nA (V);B (V)\n{rows}");
        match Reader::new().from_reader("a.csv", text.as_bytes()) {
            Ok(found) => {
                let own = first(&found).rate().unwrap_or(f64::NAN);
                let said = found.all_findings().iter().any(|found| found.code == "rate-from-head");
                if (own / rate - 1.0).abs() > 1e-12 || first(&found).axis.kind != AxisKind::Time || !said {
                    wrong.push(format!("{head}: {own}, said: {said}"));
                }
            }
            Err(why) => wrong.push(format!("{head}: {why}")),
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    // The total sampling time, or the time that one sample takes, is not a sampling interval.
    for head in ["Sampling time: 10 s", "Sample Time [s]: 8", "TS [s]: 12"] {
        let text = format!("{head}\nA (V);B (V)\n{rows}");
        let rate = Reader::new().from_reader("a.csv", text.as_bytes()).map(|found| first(&found).rate());
        assert!(matches!(rate, Ok(None) | Err(_)), "{head}: {rate:?}");
    }
}

/// Jitter accepted as an even grid does not enter interpolated values: interpolation uses the stored
/// instants.
#[test]
fn jittering_samples_are_interpolated_from_their_own_times() {
    for seed in 1..=60 {
        let mut noise = Noise::new(seed);
        let step = 8e-3;
        let size = noise.between(0.02, 0.15);
        let frequency = noise.between(2.0, 6.0);
        let signal = |t: f64| 3.0 * (std::f64::consts::TAU * frequency * t).sin();
        // The factor 0.95: the line fitted through 800 instants deviates by up to a twentieth of the
        // jitter.
        let instants: Vec<f64> =
            (0..800).map(|i| step * (f64::from(i) + 0.95 * size * noise.between(-1.0, 1.0))).collect();
        let rows = concat(instants.iter().map(|t| format!("{t:.9},{:.12}\n", signal(*t))));
        let text = format!("time (s),a (m/s^2)\n{rows}");
        let read = |reader: Reader| reader.from_reader("a.csv", text.as_bytes());
        let off = |recording: &Recording| {
            let trace = first(recording);
            let squares =
                trace.values.iter().enumerate().map(|(i, v)| (v - signal(trace.axis.at(i))).powi(2));
            (squares.sum::<f64>() / trace.values.len() as f64).sqrt()
        };
        let even = read(Reader::new()).expect("read");
        assert!(even.all_findings().iter().any(|found| found.code == "axis-jitter"), "{seed}");
        let made = read(Reader::new().resample(Some(130.0))).unwrap_or_else(|why| panic!("{seed}: {why}"));
        let stated =
            made.all_findings().iter().find_map(|f| f.get("error").filter(|_| f.code == "resampled"));
        let (own, grid) = (off(&made), off(&even));
        assert!(own <= stated.expect("an error"), "{seed}: {own} of {stated:?}");
        // At 20 samples per period, cubic interpolation is off by 0.023·(2π/20)⁴ of the amplitude, the even
        // grid by 2π/20 of the jitter, which is at least 1 % of a step.
        assert!(own < 0.3 * grid, "{seed}: {own} and {grid}");
        assert!(read(Reader::new().rate(Some(125.4)).resample(Some(130.0))).is_ok(), "{seed}");
        let why = read(Reader::new().rate(Some(250.0)).resample(Some(130.0))).expect_err("another rate");
        assert!(why.to_string().contains("250 Hz was stated"), "{why}");
    }
}

/// A sine of 3 Hz and white noise, 1000 samples at uneven steps of 4 to 12 ms. Noise cannot be
/// interpolated; a sine with 40 samples per period can.
#[test]
fn a_channel_that_cannot_be_interpolated_loses_only_itself() {
    let (mut noise, mut t) = (Noise::new(7), 0.0);
    let mut row = |i: usize| {
        let (blank, sine) = (if i == 500 { "NaN" } else { "1.5" }, (std::f64::consts::TAU * 3.0 * t).sin());
        let row = format!("{t:.6},{:.6},{sine:.6},{blank}\n", noise.normal());
        t += 0.008 + 0.004 * (2.0 * noise.uniform() - 1.0);
        row
    };
    let rows: String = (0..1000).map(&mut row).collect();
    let text = format!("time (s),noise (m/s^2),sine (m/s^2),blank (m/s^2)\n{rows}");
    let reader = Reader::new().resample(Some(125.0)).allow_missing(true);
    let read = |only: &str| reader.clone().only([only.to_owned()]).from_reader("x.csv", text.as_bytes());
    for name in ["sine", "2"] {
        let found = read(name).unwrap();
        let Record::Trace(sine) = &found.records[1] else { panic!() };
        assert!((sine.rate().unwrap() - 125.0).abs() < 1e-9);
        let left: Vec<bool> = found.records.iter().map(|r| r.meta().has("not-resampled")).collect();
        assert_eq!(left, [true, false, true]);
    }
    for name in ["noise", "1"] {
        assert!(read(name).unwrap_err().to_string().contains("too far apart to interpolate"));
    }
    assert!(read("blank").unwrap_err().to_string().contains("without missing values"));
}

/// A sensor polled 6 times per 5 measurements, here at 128 Hz: every sixth row repeats the row before. A
/// sensor at rest or with coarse digits repeats many rows in succession.
#[test]
fn rows_that_repeat_are_told() {
    let text = |row: &dyn Fn(usize) -> (f64, f64)| {
        let rows = (0..600).map(|i| format!("{:.6},{i},{:.5},{:.5}\n", i as f64 / 128.0, row(i).0, row(i).1));
        "time (s),count,x (m/s^2),y (m/s^2)\n".to_owned() + &rows.collect::<String>()
    };
    let told = |text: String| {
        let found = Reader::new().from_reader("x.csv", text.as_bytes()).unwrap();
        found.all_findings().iter().find(|f| f.code == "rows-repeat").and_then(|f| f.get("n"))
    };
    let sine = |i: usize| ((0.1 * i as f64).sin(), (0.13 * i as f64).cos());
    // The rows 6, 12, … 594.
    assert_eq!(told(text(&|i| sine(i - i / 6))), Some(99.0));
    assert_eq!(told(text(&sine)), None);
    assert_eq!(told(text(&|i| if i < 300 { (0.0, 0.0) } else { sine(i) })), None);
    let coarse = |v: f64| (3.0 * v).round();
    assert_eq!(told(text(&|i| (coarse(sine(i).0), coarse(sine(i).1)))), None);
}

/// A damaged digit makes one instant far larger than the length of any record.
#[test]
fn an_instant_far_beyond_the_record_leaves_no_clock() {
    for at in [1, 100, 199] {
        let time = |i| if i == at { 1e20 } else { f64::from(i) / 400.0 };
        let rows = (0..200).map(|i| format!("{},{}\n", time(i), i % 7)).collect::<Vec<_>>().concat();
        let read = Reader::new().from_reader("x.csv", format!("t [s],a [V]\n{rows}").as_bytes()).unwrap();
        let Record::Trace(trace) = &read.records[0] else { panic!("{read:?}") };
        assert_eq!((trace.rate(), trace.axis.at(at as usize)), (None, 1e20));
    }
}
