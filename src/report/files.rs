//! Figures and matrices as files.

use super::{Drawing, Figure, Output};
use crate::error::Result;
use crate::measure::waterfall::Waterfall;
use rayon::prelude::*;
use std::fmt::Write as _;

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

/// A name as part of a file name: letters and digits, everything else one `_`.
pub fn slug(name: &str) -> String {
    let mut slug = String::new();
    for c in name.chars() {
        if c.is_alphanumeric() {
            slug.extend(c.to_lowercase());
        } else if !slug.ends_with('_') && !slug.is_empty() {
            slug.push('_');
        }
    }
    slug.trim_end_matches('_').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_file_names() {
        assert_eq!(slug("Mass 1, up!"), "mass_1_up");
        assert_eq!(slug("../../x"), "x");
        assert_eq!(slug("***"), "");
    }
}
