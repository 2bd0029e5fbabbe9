//! Figures and matrices as files.

use super::{Drawing, Figure, Output};
use crate::error::Result;
use crate::measure::waterfall::Waterfall;
use crate::record::Record;
use crate::write::{Storage, Target};
use rayon::prelude::*;
use std::fmt::Write as _;
use std::path::Path;

/// Resolution of the PNG figures in dots an inch: enough for print.
const DPI: f64 = 300.0;

/// Draws figures in parallel and writes each as `NAME.svg` and `NAME.png`; `step` is called for each that is drawn. Gives the
/// drawings in order.
///
/// # Errors
/// If a file cannot be written.
pub fn figures(
    output: &mut Output,
    figures: &[(String, Figure)],
    step: &(dyn Fn() + Sync),
) -> Result<Vec<Drawing>> {
    let drawn: Vec<(Drawing, Vec<u8>)> = figures
        .par_iter()
        .map(|(_, figure)| {
            let drawing = figure.draw();
            let png = drawing.png(DPI)?;
            step();
            Ok((drawing, png))
        })
        .collect::<Result<_>>()?;
    let mut drawings = Vec::with_capacity(drawn.len());
    for ((name, _), (drawing, png)) in figures.iter().zip(drawn) {
        output.write(&format!("{name}.svg"), drawing.svg())?;
        output.write(&format!("{name}.png"), png)?;
        drawings.push(drawing);
    }
    Ok(drawings)
}

/// Matrix as CSV: a column of line frequencies, then one column a spectrum, headed by its excitation frequency.
pub fn matrix_csv(matrix: &Waterfall) -> String {
    let mut text = String::from("frequency [Hz]");
    for excitation in &matrix.excitation {
        let _ = write!(text, ",{excitation} Hz [{}]", matrix.unit);
    }
    text.push('\n');
    for (k, frequency) in matrix.frequency.iter().enumerate() {
        let _ = write!(text, "{frequency}");
        for value in matrix.magnitude.column(k) {
            if value.is_finite() {
                let _ = write!(text, ",{value:e}");
            } else {
                text.push(',');
            }
        }
        text.push('\n');
    }
    text
}

/// Writes records as CSV and UFF: binary where the text of data set 58 has too few digits for the abscissa. Gives the sentence that
/// says why there is no UFF where that has too few, too.
///
/// # Errors
/// If a file cannot be written, or there is nothing to write.
pub fn records(output: &mut Output, name: &str, records: &[Record]) -> Result<Option<String>> {
    let text = |target: Target, storage: Storage| -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        target.write(records, storage, &mut bytes)?;
        Ok(bytes)
    };
    output.write(&format!("{name}.csv"), text(Target::Csv, Storage::default())?)?;
    let binary = Storage { binary: true, ..Storage::default() };
    match text(Target::Uff, Storage::default()).or_else(|_| text(Target::Uff, binary)) {
        Ok(bytes) => output.write(&format!("{name}.uff"), bytes).map(|_| None),
        Err(error) if error.exit_code() == 1 => {
            let why = error.to_string().lines().next().unwrap_or_default().to_owned();
            Ok(Some(format!("{name}.uff is not written: {why}. All lines are in {name}.csv.")))
        }
        Err(error) => Err(error),
    }
}

/// Endings of the files that results are written in.
const ENDINGS: [&str; 5] = ["svg", "png", "csv", "json", "html"];
/// So many names of left-over files are said.
const NAMED: usize = 8;

/// A sentence on the files in the folder that look like results but were not written by this run, nor are among `coming`: they
/// may be those of an earlier one. They are left as they are.
pub fn left_over(output: &Output, coming: &[&str]) -> Option<String> {
    let written = |name: &str| coming.contains(&name) || output.written().iter().any(|w| w == name);
    let entries = std::fs::read_dir(output.folder()).ok()?.filter_map(std::result::Result::ok);
    let mut names: Vec<String> = entries
        .filter(|e| e.file_type().is_ok_and(|t| t.is_file()))
        .filter(|e| Path::new(&e.file_name()).extension().is_some_and(|x| ENDINGS.iter().any(|e| x == *e)))
        .map(|e| e.file_name().to_string_lossy().into_owned())
        .filter(|name| !written(name))
        .collect();
    names.sort();
    let others = match names.len().saturating_sub(NAMED) {
        0 => String::new(),
        n => format!(" and {n} more"),
    };
    names.truncate(NAMED);
    (!names.is_empty()).then(|| {
        format!(
            "Files in the folder of the results that this run did not write, perhaps of an earlier one: {}{others}.",
            names.join(", ")
        )
    })
}

/// A name as part of a file name that every system takes: ASCII letters and digits, Greek letters by their names, raised and lowered digits as
/// digits, everything else one `_`.
pub fn slug(name: &str) -> String {
    let mut slug = String::new();
    for c in name.chars().flat_map(char::to_lowercase) {
        if c.is_ascii_alphanumeric() {
            slug.push(c);
        } else if let Some((_, spelled)) = SPELLED.iter().find(|s| s.0.contains(c)) {
            slug.push_str(spelled);
        } else if !slug.ends_with('_') && !slug.is_empty() {
            slug.push('_');
        }
    }
    slug.trim_end_matches('_').to_owned()
}

/// Characters of names in this field, and how they are spelled in ASCII.
const SPELLED: [(&str, &str); 36] = [
    ("⁰₀", "0"),
    ("¹₁", "1"),
    ("²₂", "2"),
    ("³₃", "3"),
    ("⁴₄", "4"),
    ("⁵₅", "5"),
    ("⁶₆", "6"),
    ("⁷₇", "7"),
    ("⁸₈", "8"),
    ("⁹₉", "9"),
    ("α", "alpha"),
    ("β", "beta"),
    ("γ", "gamma"),
    ("δ", "delta"),
    ("ε", "epsilon"),
    ("ζ", "zeta"),
    ("η", "eta"),
    ("θ", "theta"),
    ("κ", "kappa"),
    ("λ", "lambda"),
    ("μµ", "mu"),
    ("ν", "nu"),
    ("ξ", "xi"),
    ("π", "pi"),
    ("ρ", "rho"),
    ("σ", "sigma"),
    ("τ", "tau"),
    ("φ", "phi"),
    ("χ", "chi"),
    ("ψ", "psi"),
    ("ω", "omega"),
    ("ä", "ae"),
    ("ö", "oe"),
    ("ü", "ue"),
    ("ß", "ss"),
    ("é", "e"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_an_earlier_run_are_named() {
        let dir = tempfile::tempdir().unwrap();
        let mut output = Output::new(dir.path()).unwrap();
        output.write("response.svg", "new").unwrap();
        std::fs::create_dir(dir.path().join("folder.svg")).unwrap();
        for name in ["notes.txt", "report.html"] {
            std::fs::write(dir.path().join(name), "").unwrap();
        }
        assert_eq!(left_over(&output, &["report.html"]), None);
        for i in 0..10 {
            std::fs::write(dir.path().join(format!("map_{i}.png")), "").unwrap();
        }
        let sentence = left_over(&output, &["report.html"]).unwrap();
        assert!(
            sentence.contains("map_0.png, map_1.png") && sentence.ends_with("map_7.png and 2 more."),
            "{sentence}"
        );
        assert!(dir.path().join("map_0.png").exists());
        assert_eq!(left_over(&Output::new(dir.path().join("none")).unwrap(), &[]), None);
    }

    #[test]
    fn a_function_with_gaps_is_written_as_far_as_the_format_goes() {
        use crate::record::{Axis, AxisKind, Frf, FrfKind, Grid, Meta};
        use crate::units::Unit;
        use num_complex::Complex64;
        let gaps = |step: f64| {
            let lines: Vec<f64> = [0.0, 1.0, 2.0, 5.0, 6.0].map(|k| 10_000.0 + step * k).to_vec();
            let values = vec![Complex64::new(1.0, -1.0); lines.len()];
            let axis = Axis { kind: AxisKind::Frequency, grid: Grid::Uneven(lines) };
            let meta = Meta::new("gaps", Unit::parse("m/N").unwrap());
            [Record::Frf(Frf { meta, axis, values, kind: FrfKind::Receptance })]
        };
        let dir = tempfile::tempdir().unwrap();
        let mut output = Output::new(dir.path()).unwrap();
        let lines = || {
            let found = crate::read::Reader::new().from_path(dir.path().join("x.uff")).unwrap();
            found.records[0].axis().values()
        };
        // Text of six digits, then single precision (half a unit in the last place is 4.9e-4 there).
        for (step, off) in [(10.0, 0.05), (0.01, 5e-4)] {
            assert_eq!(records(&mut output, "x", &gaps(step)).unwrap(), None);
            let wanted = gaps(step)[0].axis().values();
            assert!(lines().iter().zip(&wanted).all(|(a, b)| (a - b).abs() <= off), "{:?}", lines());
        }
        let why = records(&mut output, "y", &gaps(1e-4)).unwrap().unwrap();
        assert!(why.contains("y.uff is not written") && why.contains("too few digits"), "{why}");
        assert!(dir.path().join("y.csv").is_file() && !dir.path().join("y.uff").exists());
    }

    #[test]
    fn names_become_file_names() {
        assert_eq!(slug("Mass 1, up!"), "mass_1_up");
        assert_eq!(slug("../../x"), "x");
        assert_eq!(slug("***"), "");
        assert_eq!(slug("contact ξ: ρ → 0"), "contact_xi_rho_0");
        assert_eq!(slug("H¹, m₂ in µm"), "h1_m2_in_mum");
        assert_eq!(slug("Straße Ω, 振動 x"), "strasse_omega_x");
    }
}
