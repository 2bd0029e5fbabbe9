//! Draws one figure of each kind into a folder: `cargo run --example gallery -- FOLDER`.
//!
//! The data are made up by formulas and resemble measurements of a two-mass impacting rig; nothing here is
//! a result.

use ndarray::Array2;
use std::f64::consts::{PI, TAU};
use std::time::Instant;
use vibroimpact::Result;
use vibroimpact::figure::{
    AxisSpec, Figure, Heatmap, Ink, Legend, Marker, Medium, Plot, Series, Stroke, Waterfall,
};
use vibroimpact::math::Noise;
use vibroimpact::read::Owner;
use vibroimpact::report::{Cell, Output, Page, Picture, Table};

fn main() -> Result<()> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| "gallery".to_owned());
    let mut out = Output::new(std::path::PathBuf::from(folder), Owner::Results)?;
    let mut page = Page::new("Two-mass rig: one figure of each kind")
        .paragraph("All data are made up by formulas: nothing here is a measurement.")
        .heading("Figures");
    for (name, figure) in figures()? {
        let start = Instant::now();
        let picture = Picture::of(&figure, Medium::Report)?;
        println!(
            "{name}: {:.1} ms, SVG {} kB, PNG {} kB",
            start.elapsed().as_secs_f64() * 1e3,
            picture.svg.len() / 1000,
            picture.png.len() / 1000
        );
        out.write(&format!("{name}.svg"), &picture.svg)?;
        out.write(&format!("{name}.png"), &picture.png)?;
        page = page.figure(&figure, &picture, &[&format!("{name}.svg"), &format!("{name}.png")]);
    }
    let table = resonances();
    print!("{}", table.text());
    out.write("resonances.csv", table.csv())?;
    let page = page.heading("Resonances").table(&table).heading("Provenance").details(
        "Where the data came from",
        [("formula", "examples/gallery.rs"), ("version", env!("CARGO_PKG_VERSION"))],
    );
    out.write("report.html", page.html())?;
    let folder = out.folder().to_owned();
    println!("{} files in {}", out.commit()?.len(), folder.display());
    Ok(())
}

fn figures() -> Result<Vec<(&'static str, Figure)>> {
    Ok(vec![
        ("response", response()),
        ("waterfall-40", waterfall(40, false)?),
        ("waterfall-200", waterfall(200, false)?),
        ("waterfall-db", waterfall(60, true)?),
        ("waterfall-column", Figure { width: 86.0, height: 80.0, ..waterfall(40, false)? }),
        ("receptance", receptance()),
        ("intervals", intervals()),
        ("map", map()?),
        ("regimes", regimes()?),
        ("precision", precision()),
        ("cycle", cycle()),
        ("many", many()),
        ("trace", trace()),
        ("empty", empty()),
    ])
}

fn resonances() -> Table {
    let estimate = |value, std| Cell::Estimate { value, std: Some(std) };
    Table::new("Resonances of the excited mass")
        .column("Kind", "")
        .column("Frequency", "Hz")
        .column("Amplitude", "m")
        .column("Impacts", "")
        .row(["grazing".into(), estimate(5.583_1, 0.012_3), estimate(4.213e-3, 4.1e-5), 560usize.into()])
        .row(["clapping".into(), estimate(10.592, 0.098), estimate(3.1e-3, 1.2e-4), 1070usize.into()])
        .row(["sub-harmonic".into(), 2.81.into(), Cell::Missing, 0usize.into()])
}

fn grid(from: f64, to: f64, n: usize) -> Vec<f64> {
    (0..n).map(|i| from + (to - from) * i as f64 / (n - 1) as f64).collect()
}

fn resonance(f: f64, at: f64, width: f64) -> f64 {
    1.0 / (1.0 + ((f - at) / width).powi(2))
}

/// A resonance curve with jumps, branches, measured points and named peaks.
fn response() -> Figure {
    let f = grid(3.0, 14.0, 900);
    let branch = |f: f64| 4.2e-3 * resonance(f, 5.58, 0.16) + 0.4e-3;
    let clapping = |f: f64| 0.5e-3 + 0.42e-3 * (f - 5.8).max(0.0).powf(1.15);
    let up: Vec<f64> = f
        .iter()
        .map(|&f| if (5.7..10.6).contains(&f) { clapping(f).max(branch(f)) } else { branch(f) })
        .collect();
    let down: Vec<f64> = f.iter().map(|&f| 3.9e-3 * resonance(f, 5.42, 0.15) + 0.35e-3).collect();
    let inside: Vec<f64> = f.iter().copied().filter(|f| (6.6..10.6).contains(f)).collect();
    let unstable: Vec<f64> =
        inside.iter().map(|f| 0.55e-3 + 0.6 * (clapping(*f) - 0.55e-3) * ((f - 6.6) / 4.0)).collect();
    let mut noise = Noise::new(1);
    let at: Vec<f64> = (0..34).map(|i| 3.5 + 0.24 * f64::from(i)).collect();
    let seen: Vec<f64> = at
        .iter()
        .map(|&f| {
            (if (5.7..10.6).contains(&f) { clapping(f).max(branch(f)) } else { branch(f) })
                * (1.0 + 0.06 * noise.normal())
        })
        .collect();
    let std: Vec<f64> = seen.iter().map(|a| 0.07 * a + 0.05e-3).collect();
    let plot =
        Plot::new(AxisSpec::new("Excitation frequency", "Hz"), AxisSpec::new("Displacement amplitude", "m"))
            .with(Series::line("sweeping up", f.clone(), up))
            .with(Series::line("sweeping down", f, down))
            .with(Series::line("unstable orbit", inside, unstable).ink(Ink::Grey).stroke(Stroke::Dotted))
            .with(
                Series::points("measured", at, seen).y_error(std).ink(Ink::Black).marker(Marker::OpenCircle),
            )
            .with(Series::vertical("natural, excited mass", 5.23))
            .note("grazing 5.58 Hz", 5.58, branch(5.58))
            .note("clapping 10.59 Hz", 10.59, clapping(10.59));
    Figure::single("Response of the excited mass")
        .caption("Peak displacement over excitation frequency, sweeping up and down at 0.02 Hz/s; bars show one standard deviation.")
        .panel(plot)
}

/// Spectra over excitation frequency with harmonics, sub-harmonics and noise.
fn spectra(n: usize, lines: usize) -> (Vec<f64>, Vec<f64>, Array2<f64>) {
    let frequency = grid(0.0, 50.0, lines);
    let excitation: Vec<f64> = grid(3.0, 14.0, n).into_iter().map(|e| e + 0.02 * (7.0 * e).sin()).collect();
    let mut noise = Noise::new(2);
    let magnitude = Array2::from_shape_fn((n, lines), |(row, line)| {
        let (e, f) = (excitation[row], frequency[line]);
        let drive = 4.0e-3 * resonance(e, 5.58, 0.3) + if e < 10.6 { 3.5e-4 * (e - 3.0) } else { 4e-4 };
        let impacts = (1..=4).map(|h| {
            let h = f64::from(h);
            drive * h.powf(-1.4) * resonance(f, h * e, 0.08)
        });
        let half = if (7.5..9.0).contains(&e) { 0.3 * drive * resonance(f, e / 2.0, 0.08) } else { 0.0 };
        impacts.sum::<f64>() + half + 2e-5 * noise.uniform()
    });
    (frequency, excitation, magnitude)
}

fn waterfall(n: usize, level: bool) -> Result<Figure> {
    let (frequency, excitation, magnitude) = spectra(n, 801);
    let height = AxisSpec::new("Displacement amplitude", "m");
    let height = if level { height.db(1e-6).limits(26.0, f64::INFINITY) } else { height };
    let picture = Waterfall::new(&frequency, &excitation, &magnitude, height)?.frequencies(0.0, 40.0);
    Ok(Figure::double("Spectra of the excited mass").height(105.0).panel(picture))
}

/// Magnitude over four decades and phase, one above the other.
fn receptance() -> Figure {
    let f = grid(2f64.log10(), 2000f64.log10(), 1500).into_iter().map(|u| 10f64.powf(u)).collect::<Vec<_>>();
    let modes = [(12.0, 0.02, 1.0), (85.0, 0.008, -0.6), (430.0, 0.015, 0.9)];
    let h = |f: f64| {
        modes.iter().fold((0.0, 0.0), |(re, im), (f0, zeta, a)| {
            let r: f64 = f / f0;
            let (x, y) = (1.0 - r * r, 2.0 * zeta * r);
            let k = a * 1e-3 / (f0 * f0) / (x * x + y * y);
            (re + k * x, im - k * y)
        })
    };
    let values: Vec<(f64, f64)> = f.iter().map(|f| h(*f)).collect();
    let magnitude: Vec<f64> = values.iter().map(|v| v.0.hypot(v.1)).collect();
    let phase: Vec<f64> = values.iter().map(|v| v.1.atan2(v.0).to_degrees()).collect();
    let mut noise = Noise::new(3);
    let seen: Vec<f64> =
        magnitude.iter().map(|m| m * (1.0 + 0.25 * noise.normal()) + 2e-11 * noise.uniform()).collect();
    let x = || AxisSpec::frequency().log();
    let first = Plot::new(x(), AxisSpec::new("Receptance", "m/N").log())
        .title("(a) Magnitude")
        .with(Series::line("measured", f.clone(), seen).ink(Ink::Grey).stroke(Stroke::Thin))
        .with(Series::line("fitted", f.clone(), magnitude.clone()).ink(Ink::Nth(1)).stroke(Stroke::Solid))
        .note("12.0 Hz", 12.0, magnitude[f.partition_point(|f| *f < 12.0)])
        .note("85.0 Hz", 85.0, magnitude[f.partition_point(|f| *f < 85.0)])
        .note("430 Hz", 430.0, magnitude[f.partition_point(|f| *f < 430.0)]);
    let second = Plot::new(x(), AxisSpec::new("Phase", "°").limits(-180.0, 180.0))
        .title("(b) Phase")
        .with(Series::phase("", &f, &phase));
    Figure::single("Receptance of the buffer").height(110.0).shared_x().panel(first).panel(second)
}

/// Histogram beside a series of points.
fn intervals() -> Figure {
    let mut noise = Noise::new(4);
    let interval: Vec<f64> =
        (0..180).map(|i| 0.1335 + 0.0021 * noise.normal() + if i % 37 == 5 { 0.118 } else { 0.0 }).collect();
    let number: Vec<f64> = (1..=interval.len()).map(|i| i as f64).collect();
    let regular: Vec<f64> = interval.iter().copied().filter(|t| *t < 0.2).collect();
    let mean = regular.iter().sum::<f64>() / regular.len() as f64;
    let first = Plot::new(AxisSpec::new("Impact", ""), AxisSpec::new("Interval", "s"))
        .title("(a) In sequence")
        .with(Series::points("interval", number, interval))
        .with(Series::horizontal("mean", mean))
        .with(Series::horizontal("one impact missed", 2.0 * mean));
    let second = Plot::new(AxisSpec::new("Interval", "s"), AxisSpec::new("Count", ""))
        .title("(b) Distribution")
        .with(Series::histogram("regular intervals", &regular))
        .with(Series::vertical("mean", mean));
    Figure::double("Intervals between impacts").height(62.0).columns(2).panel(first).panel(second)
}

/// Levels over frequency and excitation with uneven rows, and a line of order 1 over them.
fn map() -> Result<Figure> {
    let (frequency, excitation, magnitude) = spectra(40, 801);
    let uneven: Vec<f64> = excitation.iter().map(|e| 3.0 + (e - 3.0).powf(1.25) * 0.55).collect();
    let level = AxisSpec::new("Displacement", "m").db(1e-6).limits(10.0, f64::INFINITY);
    let order = |name: &str, n: f64| {
        Series::line(name, [3.0 * n, 14.0 * n], [3.0, 14.0]).ink(Ink::White).stroke(Stroke::Dotted)
    };
    let plot =
        Plot::new(AxisSpec::frequency().limits(0.0, 40.0), AxisSpec::new("Excitation frequency", "Hz"))
            .heatmap(Heatmap::new(&frequency, &uneven, &magnitude, level)?)
            .with(order("", 1.0))
            .legend(Legend::Hidden);
    Ok(Figure::single("Levels over excitation").panel(plot))
}

/// Classes of motion over two parameters.
fn regimes() -> Result<Figure> {
    let (x, y) = (grid(0.5, 3.0, 60), grid(0.0, 1.0, 40));
    let classes = Array2::from_shape_fn((40, 60), |(r, c)| {
        let (nu, e) = (x[c], y[r]);
        match 3.0 * (nu - 1.0 - e).sin() + (5.0 * nu * e).cos() {
            _ if nu < 0.7 => f64::NAN,
            v if v < -1.0 => 0.0,
            v if v < 1.2 => 1.0,
            v if v < 2.4 => 2.0,
            _ => 3.0,
        }
    });
    let names = ["no impact", "1 impact, 1 cycle", "2 impacts, 1 cycle", "irregular"];
    let plot = Plot::new(AxisSpec::new("Frequency ratio ν", ""), AxisSpec::new("Restitution R", ""))
        .heatmap(Heatmap::classes(&x, &y, &classes, &names)?);
    Ok(Figure::single("Regimes").height(70.0).panel(plot))
}

/// Error over computing time, both on logarithmic axes, with every point named.
fn precision() -> Figure {
    let methods = [
        ("closed form", 4e-7, 2e-15, 0.0),
        ("exact flight", 3e-5, 4e-11, 2e-11),
        ("stiff contact", 8e-3, 2e-4, 5e-5),
        ("Hertz contact", 2e-2, 3e-4, 8e-5),
        ("loose mass", 1.2e-5, 6e-2, 1e-2),
        ("fixed step", 5e-3, 4e-2, 3.9e-2),
    ];
    let column = |f: fn(&(&str, f64, f64, f64)) -> f64| methods.iter().map(f).collect::<Vec<_>>();
    let mut plot =
        Plot::new(AxisSpec::new("Time for one cycle", "s").log(), AxisSpec::new("Relative error", "").log())
            .with(Series::points("methods", column(|m| m.1), column(|m| m.2)).y_error(column(|m| m.3)))
            .with(Series::horizontal("tolerance", 1e-3))
            .legend(Legend::Hidden);
    for (name, time, error, _) in methods {
        plot = plot.note(name, time, error);
    }
    Figure::single("Speed against accuracy").panel(plot)
}

/// A mean with its band, and a line.
fn cycle() -> Figure {
    let phase = grid(0.0, 360.0, 181);
    let radians: Vec<f64> = phase.iter().map(|p| p.to_radians()).collect();
    let velocity: Vec<f64> = radians
        .iter()
        .map(|p| if *p < 1.2 * PI { 7.5 * (p / 1.2).sin() } else { -1.6 * ((p - 1.2 * PI) / 0.8).sin() })
        .collect();
    let wide: Vec<f64> = radians.iter().map(|p| 0.25 + 0.5 * (p - 1.2 * PI).cos().powi(8)).collect();
    let lower: Vec<f64> = velocity.iter().zip(&wide).map(|(v, w)| v - w).collect();
    let upper: Vec<f64> = velocity.iter().zip(&wide).map(|(v, w)| v + w).collect();
    let piston: Vec<f64> = radians.iter().map(|p| 4.0 * (p + TAU / 8.0).sin()).collect();
    let plot = Plot::new(AxisSpec::new("Crank angle", "°"), AxisSpec::new("Velocity", "m/s"))
        .with(Series::band("± one standard deviation", phase.clone(), lower, upper).ink(Ink::Nth(0)))
        .with(Series::line("striker, mean of 120 cycles", phase.clone(), velocity).ink(Ink::Nth(0)))
        .with(Series::line("piston", phase, piston).ink(Ink::Nth(1)))
        .with(Series::horizontal("", 0.0));
    Figure::single("Velocity over one cycle").panel(plot)
}

/// More series than fit into a legend inside the frame.
fn many() -> Figure {
    let x = grid(0.0, 10.0, 21);
    let mut plot = Plot::new(AxisSpec::new("Time", "s"), AxisSpec::new("Velocity", "m/s"));
    for k in 0..7 {
        let y: Vec<f64> = x.iter().map(|x| (x + f64::from(k)).sin() * 1e-5 * f64::from(k + 1)).collect();
        let series = Series::points(format!("sensor {}", k + 1), x.clone(), y).stroke(Stroke::Thin);
        plot = plot.with(series);
    }
    Figure::double("Many series").height(70.0).panel(plot)
}

/// A long trace, thinned to what is visible.
fn trace() -> Figure {
    let mut noise = Noise::new(5);
    let time = grid(0.0, 4.0, 50_000);
    let acceleration: Vec<f64> = time
        .iter()
        .map(|t| {
            let since = t % 0.1335;
            1.2e5 * (-since / 0.004).exp() * (TAU * 900.0 * since).sin() + 900.0 * noise.normal()
        })
        .collect();
    let plot = Plot::new(AxisSpec::new("Time", "s"), AxisSpec::new("Acceleration", "m/s²"))
        .with(Series::line("", time, acceleration).stroke(Stroke::Thin));
    Figure::double("Impacts").height(60.0).panel(plot)
}

fn empty() -> Figure {
    let nothing = Series::line("nothing", [1.0, 2.0], [f64::NAN, f64::NAN]);
    let plot = Plot::new(AxisSpec::frequency(), AxisSpec::new("Displacement amplitude", "m")).with(nothing);
    Figure::single("No data").panel(plot)
}
