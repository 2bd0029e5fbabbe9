//! `vibro precision`: speed against accuracy, and where methods break.

use crate::analysis::precision::{figures, tables};
use crate::cli::{args, complain, print, progress};
use crate::compare::precision::{Cell, Earlier, FailureMap, Family, Scene, added, busy, estimators, models};
use crate::error::{Error, Result};
use crate::report::{Figure, Output, files};
use serde::Serialize;
use std::fmt::Write as _;
use std::path::Path;

#[derive(Serialize)]
struct Answer<'a> {
    scenes: &'a [Scene],
    #[serde(skip_serializing_if = "Option::is_none")]
    failures: Option<Vec<Failure<'a>>>,
    warnings: &'a [String],
    files: &'a [String],
}

#[derive(Serialize)]
struct Failure<'a> {
    family: Family,
    #[serde(flatten)]
    cell: &'a Cell,
}

pub fn run(typed: &args::Precision, json: bool) -> Result<()> {
    let wanted = |family: Family| typed.family.holds(family);
    let (mut scenes, mut maps): (Vec<Scene>, Vec<FailureMap>) = Default::default();
    let bar = progress::bar(json);
    let mut tell = |scene: &str| {
        bar.set_message(scene.to_owned());
        bar.inc(1);
    };
    if let Some(path) = &typed.from {
        Earlier { scenes, maps } = earlier(path, typed)?;
    } else {
        if wanted(Family::Models) {
            scenes.extend(models::scenes(typed.quick, &mut tell)?);
        }
        if wanted(Family::Estimators) {
            scenes.extend(estimators::scenes(typed.quick, &mut tell)?);
        }
        if typed.failures {
            tell("borders");
            if wanted(Family::Models) {
                maps.push(models::failures(typed.quick)?);
            }
            if wanted(Family::Estimators) {
                maps.push(estimators::failures(typed.quick)?);
            }
        }
    }
    bar.finish_and_clear();
    // Of a file or of this run: those of other programs come without quartiles.
    let mut warnings: Vec<String> = busy::busy(&scenes).into_iter().collect();
    for path in &typed.add {
        warnings.extend(added::add(&mut scenes, path)?);
    }
    if typed.from.is_none() && cfg!(debug_assertions) {
        warnings
            .push("This is a build for development: its times are not those of the released program.".into());
    }
    let mut written = Vec::new();
    if let Some(folder) = &typed.out {
        let mut output = Output::new(folder)?;
        let mut drawn: Vec<(String, Figure)> = Vec::new();
        for scene in &scenes {
            drawn.push((format!("precision_{}", files::slug(&scene.name)), figures::precision(scene)));
        }
        for map in &maps {
            let name =
                |(name, figure): (String, Figure)| (format!("failures_{}", files::slug(&name)), figure);
            drawn.extend(figures::failures(map).into_iter().map(name));
        }
        files::figures(&mut output, &drawn, &|| ())?;
        output.write("precision.csv", tables::precision(&scenes).csv())?;
        if !maps.is_empty() {
            output.write("failures.csv", tables::failures(&maps).csv())?;
        }
        written = output.written().to_vec();
    }
    if json {
        let failures = (!maps.is_empty()).then(|| {
            maps.iter()
                .flat_map(|map| map.cells.iter().map(move |cell| Failure { family: map.family, cell }))
                .collect()
        });
        return print::json(&Answer { scenes: &scenes, failures, warnings: &warnings, files: &written });
    }
    complain::warn(&warnings);
    let mut text = String::new();
    for scene in &scenes {
        let bound = scene.bound.map_or(String::new(), |b| format!("; Cramér–Rao bound: {b:.1e}"));
        let Scene { name, says, error_of, .. } = scene;
        let _ = writeln!(text, "{name}\n{says}\nError: {error_of}{bound}\n{}", tables::scene(scene).text());
    }
    for map in &maps {
        let _ = writeln!(text, "{}", tables::borders(map).text());
    }
    for file in written {
        let _ = writeln!(text, "wrote {file}");
    }
    print::text(&text)
}

/// What a file holds of the family that is asked for.
fn earlier(path: &Path, typed: &args::Precision) -> Result<Earlier> {
    let mut earlier = Earlier::from_path(path)?;
    let cells = |maps: &[FailureMap]| maps.iter().map(|map| map.cells.len()).sum::<usize>();
    let held = format!("scenes held: {}, failures held: {}", earlier.scenes.len(), cells(&earlier.maps));
    earlier.retain(|family| typed.family.holds(family));
    let of = match typed.family {
        args::Kind::Both => String::new(),
        kind => format!(" of the family {kind:?}").to_lowercase(),
    };
    if typed.failures && earlier.maps.is_empty() {
        return Err(Error::usage(
            format!("{}: no failures{of} ({held})", path.display()),
            "failures to draw",
        )
        .hint("write the file with `vibro precision --failures --json > FILE`, or leave out --failures"));
    }
    if earlier.scenes.is_empty() && earlier.maps.is_empty() {
        return Err(Error::usage(format!("{}: nothing{of} ({held})", path.display()), "one scene at least")
            .hint("ask for the family that the file holds"));
    }
    Ok(earlier)
}
