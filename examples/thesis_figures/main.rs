//! Makes the figures of `docs/thesis.md` and prints the tables of its chapters: `cargo run --release
//! --example thesis_figures [-- FOLDER]`. Without FOLDER they go to `docs/thesis` of this project.

mod antiresonance;
mod impulse;
mod motions;
mod numbers;
mod programs;
mod scene;
mod sheet;
mod sine;
mod sweeps;
mod verdicts;

use sheet::Sheet;
use std::path::{Path, PathBuf};
use vibroimpact::Result;
use vibroimpact::read::Owner;
use vibroimpact::report::Output;

/// Resolution of the PNG files in dots per inch: enough for a screen.
const DPI: f64 = 130.0;

fn main() -> Result<()> {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/thesis");
    let folder = std::env::args_os().nth(1).map_or(own, PathBuf::from);
    let mut output = Output::new(folder, Owner::Person)?.replace(true);
    for (heading, sheets) in chapters()? {
        println!("## {heading}");
        for sheet in sheets {
            println!("{}", sheet.markdown());
            if let Some(figure) = &sheet.figure {
                let drawing = figure.draw();
                output.write(&format!("{}.svg", sheet.name), drawing.svg())?;
                output.write(&format!("{}.png", sheet.name), drawing.png(DPI)?)?;
            }
        }
    }
    output.commit()?;
    Ok(())
}

/// All sheets, under the headings of the document.
fn chapters() -> Result<Vec<(&'static str, Vec<Sheet>)>> {
    let mut closed = vec![impulse::wall()];
    closed.extend(sine::sheets()?);
    closed.push(programs::sheet()?);
    closed.extend(verdicts::sheets()?);
    closed.extend(impulse::sheets()?);
    closed.push(antiresonance::sheet()?);
    let mut simulated = sweeps::sheets()?;
    simulated.extend(motions::simulated()?);
    Ok(vec![
        ("Chapter 3: the closed form", closed),
        ("Chapter 4: simulations", simulated),
        ("Chapter 5: the rig", vec![motions::patterns()?, numbers::spectra()?, numbers::rig()]),
        ("Chapter 6: the hammer drill", vec![numbers::drill()?]),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    /// The document contains every computed row, to the last digit, and no other; the pictures exist.
    #[test]
    fn the_document_says_what_is_computed() {
        let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
        let text = fs::read_to_string(docs.join("thesis.md")).unwrap();
        let mut rows = Vec::new();
        let mut size = 0;
        for (heading, sheets) in chapters().unwrap() {
            assert!(text.contains(&format!("## {heading}\n")), "{heading}");
            for sheet in sheets {
                assert!(text.contains(&sheet.markdown()), "not in docs/thesis.md:\n{}", sheet.markdown());
                rows.extend(sheet.rows());
                for ending in ["svg", "png"].iter().filter(|_| sheet.figure.is_some()) {
                    let path = docs.join(format!("thesis/{}.{ending}", sheet.name));
                    let bytes = fs::metadata(&path).unwrap().len();
                    assert!(bytes < 60_000, "{}: {bytes} bytes", path.display());
                    size += bytes;
                }
            }
        }
        assert!(size < 2_000_000, "{size}");
        // The tables from `## By number` on are written by hand.
        let (figures, _) = text.split_once("## By number").unwrap();
        let stated = figures.lines().filter(|l| l.starts_with("| ") && !l.starts_with("| what |"));
        for row in stated {
            assert!(rows.iter().any(|r| r == row), "nothing computes the row {row}");
        }
    }
}
