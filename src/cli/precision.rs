//! `vibro precision`: speed against accuracy, and where methods break.

use crate::cli::{args, complain, print, progress};
use crate::compare::precision::{Cell, FailureMap, Family, Scene, added, earlier, estimators, models};
use crate::error::{Error, Result};
use crate::report::{Figure, Output, files, pictures, tables};
use serde::Serialize;
use std::fmt::Write as _;

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
    let wanted = |kind: args::Kind| typed.family.is_none_or(|family| family == kind);
    let (mut scenes, mut maps): (Vec<Scene>, Vec<FailureMap>) = Default::default();
    let bar = progress::bar(json);
    let mut tell = |scene: &str| {
        bar.set_message(scene.to_owned());
        bar.inc(1);
    };
    let measures = typed.from.is_none();
    if let Some(path) = &typed.from {
        scenes = earlier::scenes(path)?;
        let kind = |s: &Scene| match s.family {
            Family::Models => args::Kind::Models,
            Family::Estimators => args::Kind::Estimators,
        };
        let held = scenes.len();
        scenes.retain(|scene| wanted(kind(scene)));
        if scenes.is_empty() && !typed.failures {
            let family =
                typed.family.map_or(String::new(), |f| format!(" of the family {f:?}").to_lowercase());
            return Err(Error::usage(
                format!("{}: {held} scenes, none{family}", path.display()),
                "one scene at least; ask for the family that the file holds",
            ));
        }
    }
    if measures && wanted(args::Kind::Models) {
        scenes.extend(models::scenes(typed.quick, &mut tell)?);
    }
    if measures && wanted(args::Kind::Estimators) {
        scenes.extend(estimators::scenes(typed.quick, &mut tell)?);
    }
    if typed.failures {
        tell("borders");
        if wanted(args::Kind::Models) {
            maps.push(models::failures(typed.quick)?);
        }
        if wanted(args::Kind::Estimators) {
            maps.push(estimators::failures(typed.quick)?);
        }
        maps.retain(|map| !map.cells.is_empty());
    }
    bar.finish_and_clear();
    let mut warnings = Vec::new();
    for path in &typed.add {
        let left = added::add(&mut scenes, path)?;
        if left > 0 {
            warnings.push(format!("{left} lines of {} name scenes that were not measured.", path.display()));
        }
    }
    if measures && cfg!(debug_assertions) {
        warnings
            .push("This is a build for development: its times are not those of the released program.".into());
    }
    let mut written = Vec::new();
    if let Some(folder) = &typed.out {
        let mut output = Output::new(folder)?;
        let mut drawn: Vec<(String, Figure)> = Vec::new();
        for scene in &scenes {
            drawn.push((format!("precision_{}", files::slug(&scene.name)), pictures::precision(scene)));
        }
        for map in &maps {
            let name =
                |(name, figure): (String, Figure)| (format!("failures_{}", files::slug(&name)), figure);
            drawn.extend(pictures::failures(map).into_iter().map(name));
        }
        files::figures(&mut output, &drawn, &|| ())?;
        output.write("precision.csv", tables::precision(&scenes).csv())?;
        if typed.failures {
            output.write("failures.csv", tables::failures(&maps).csv())?;
        }
        written = output.written().to_vec();
    }
    if json {
        let failures = typed.failures.then(|| {
            maps.iter()
                .flat_map(|map| map.cells.iter().map(move |cell| Failure { family: map.family, cell }))
                .collect()
        });
        return print::json(&Answer { scenes: &scenes, failures, warnings: &warnings, files: &written });
    }
    complain::warn(&warnings);
    let mut text = String::new();
    for scene in &scenes {
        let _ = writeln!(text, "{}\n{}\n{}", scene.name, scene.says, tables::scene(scene).text());
    }
    for map in &maps {
        let _ = writeln!(text, "{}", tables::borders(map).text());
    }
    for file in written {
        let _ = writeln!(text, "wrote {file}");
    }
    print::text(&text)
}
