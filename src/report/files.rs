//! Figures and matrices as files.

use super::{Figure, Medium, Output};
use crate::error::Result;
use crate::measure::waterfall::Waterfall;
use crate::record::{Finding, Record};
use crate::write::{Storage, Target};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;

/// Resolution of PNG figures in dots per inch, for print.
const DPI: f64 = 300.0;

/// A figure drawn as SVG and PNG.
#[derive(Debug, Serialize, Deserialize)]
pub struct Picture {
    /// Its width in mm.
    pub width: f64,
    /// As SVG.
    pub svg: String,
    /// As PNG.
    #[serde(with = "serde_bytes")]
    pub png: Vec<u8>,
}

impl Picture {
    /// Draws a figure.
    ///
    /// # Errors
    /// If it is too large to be held in memory as pixels.
    pub fn of(figure: &Figure, medium: Medium) -> Result<Picture> {
        let drawing = figure.draw_for(medium);
        Ok(Picture { width: drawing.size.0, svg: drawing.svg(), png: drawing.png(DPI)? })
    }
}

/// Draws figures in parallel and writes each as `NAME.svg` and `NAME.png`. Returns the pictures in order.
///
/// # Errors
/// Those of drawing; if a file cannot be written.
pub fn figures(
    output: &mut Output,
    figures: &[(String, Figure)],
    draw: impl Fn(&Figure) -> Result<Picture> + Sync,
) -> Result<Vec<Picture>> {
    let drawn: Result<Vec<Picture>> = figures.par_iter().map(|(_, figure)| draw(figure)).collect();
    let drawn = drawn?;
    for ((name, _), picture) in figures.iter().zip(&drawn) {
        output.write(&format!("{name}.svg"), &picture.svg)?;
        output.write(&format!("{name}.png"), &picture.png)?;
    }
    Ok(drawn)
}

/// A matrix as CSV: the frequencies of the lines, then one column for each spectrum, headed by its
/// excitation
/// frequency.
pub(crate) fn matrix_csv(matrix: &Waterfall) -> String {
    let mut text = String::from("frequency [Hz]");
    for excitation in &matrix.excitation {
        let _ = write!(text, ",{excitation} Hz [{}]", matrix.unit);
    }
    text.push('\n');
    for (k, frequency) in matrix.frequency.iter().enumerate() {
        let _ = write!(text, "{frequency}");
        for value in matrix.magnitude.column(k) {
            text.push(',');
            if value.is_finite() {
                let _ = write!(text, "{value:e}");
            }
        }
        text.push('\n');
    }
    text
}

/// Files of an analysis: name and content.
pub type Files = Vec<(String, Vec<u8>)>;

/// Records as CSV and UFF. UFF is binary where the text form has too few digits for the abscissa. Where
/// binary has too few as well, UFF is omitted and a finding says why.
///
/// # Errors
/// If there is nothing to write, or it cannot be written.
pub fn records(name: &str, records: &[Record]) -> Result<(Files, Option<Finding>)> {
    let content = |target: Target, storage: Storage| -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        target.write(records, storage, &mut bytes)?;
        Ok(bytes)
    };
    let mut files = vec![(format!("{name}.csv"), content(Target::Csv, Storage::default())?)];
    let binary = Storage { binary: true, ..Storage::default() };
    match content(Target::Uff, Storage::default()).or_else(|_| content(Target::Uff, binary)) {
        Ok(bytes) => files.push((format!("{name}.uff"), bytes)),
        Err(error) => {
            let Some(why) = error.refusal() else { return Err(error) };
            let finding = Finding::caution("uff-not-written").name("file", name).name("why", why);
            return Ok((files, Some(finding)));
        }
    }
    Ok((files, None))
}

/// Names of the figures and tables of one kind of record, without endings. In a campaign the number or name
/// of the record follows.
#[derive(Debug, Clone, Copy)]
pub enum Names {
    /// Followed by the number of the record, from 1.
    Numbered(&'static [&'static str]),
    /// Followed by the name of the record.
    Named(&'static [&'static str]),
}

impl Names {
    /// Whether a file name belongs to this set.
    pub fn has(&self, file: &str) -> bool {
        let Some((name, ending)) = file.rsplit_once('.') else { return false };
        let (Names::Numbered(stems) | Names::Named(stems)) = self;
        let is_mark =
            |mark: &str| matches!(self, Names::Named(_)) || mark.bytes().all(|c| c.is_ascii_digit());
        let is_of = |stem: &&str| match name.strip_prefix(*stem) {
            Some(rest) => rest.is_empty() || rest.strip_prefix('_').is_some_and(is_mark),
            None => false,
        };
        ENDINGS.contains(&ending) && stems.iter().any(is_of)
    }
}

/// Endings of figures and tables.
const ENDINGS: [&str; 5] = ["svg", "png", "csv", "uff", "npy"];

/// Names of the Greek letters α to ω in file names.
const GREEK: [&str; 25] = [
    "alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda", "mu",
    "nu", "xi", "omicron", "pi", "rho", "sigma", "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega",
];

/// A name as part of a portable file name: ASCII letters and digits, names of Greek letters, and `_` for any
/// other characters.
pub(crate) fn slug(name: &str) -> String {
    let mut slug = String::new();
    for c in name.chars().flat_map(char::to_lowercase) {
        if c.is_ascii_alphanumeric() {
            slug.push(c);
        } else if ('α'..='ω').contains(&c) {
            slug.push_str(GREEK[c as usize - 'α' as usize]);
        } else if !slug.ends_with('_') && !slug.is_empty() {
            slug.push('_');
        }
    }
    slug.trim_end_matches('_').to_owned()
}

/// Names as parts of file names, made unique.
pub(crate) fn slugs<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut slugs: Vec<String> = Vec::new();
    for (i, name) in names.enumerate() {
        let slug = slug(name);
        let mut unique = if slug.is_empty() { (i + 1).to_string() } else { slug.clone() };
        let mut number = i + 1;
        while slugs.contains(&unique) {
            unique = format!("{slug}_{number}");
            number += 1;
        }
        slugs.push(unique);
    }
    slugs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Fact;

    #[test]
    fn no_two_records_share_a_file_name() {
        let slugs = slugs(["a_4", "a", "", "A", "a 4", "3"].into_iter());
        let mut distinct = slugs.clone();
        distinct.sort();
        distinct.dedup();
        assert_eq!(distinct.len(), 6, "{slugs:?}");
    }

    #[test]
    fn a_function_with_gaps_is_written_as_far_as_the_format_goes() {
        use crate::record::{Axis, AxisKind, Frf, Grid, Meta};
        use crate::units::Unit;
        use num_complex::Complex64;
        let gaps = |step: f64| {
            let lines: Vec<f64> = [0.0, 1.0, 2.0, 5.0, 6.0].map(|k| 10_000.0 + step * k).to_vec();
            let values = vec![Complex64::new(1.0, -1.0); lines.len()];
            let axis = Axis { kind: AxisKind::Frequency, grid: Grid::Uneven(lines) };
            let meta = Meta::new("gaps", Unit::parse("m/N").unwrap());
            [Record::Frf(Frf { meta, axis, values })]
        };
        let lines = |bytes: &[u8]| {
            let found = crate::read::Reader::new().from_reader("x.uff", bytes).unwrap();
            found.records[0].axis().values()
        };
        // The first file is text with six digits, the second binary in single precision, where half a unit
        // in the last place is 4.9e-4 Hz.
        for (step, off) in [(10.0, 0.05), (0.01, 5e-4)] {
            let (files, finding) = records("x", &gaps(step)).unwrap();
            assert_eq!(finding, None);
            let (wanted, found) = (gaps(step)[0].axis().values(), lines(&files[1].1));
            assert!(found.iter().zip(&wanted).all(|(a, b)| (a - b).abs() <= off), "{found:?}");
        }
        let (files, finding) = records("y", &gaps(1e-4)).unwrap();
        let finding = finding.unwrap();
        assert!(matches!(finding.fact("why"), Some(Fact::Name(why)) if why.contains("too few digits")));
        assert_eq!(
            (finding.code.as_ref(), files.len(), files[0].0.as_str()),
            ("uff-not-written", 1, "y.csv")
        );
    }

    #[test]
    fn names_become_file_names() {
        assert_eq!(slug("Mass 1, up!"), "mass_1_up");
        assert_eq!(slug("../../x"), "x");
        assert_eq!(slug("***"), "");
        assert_eq!(slug("contact ξ: ρ → 0"), "contact_xi_rho_0");
        assert_eq!(slug("Ω, 振動 x"), "omega_x");
    }
}
