//! `vibro precision`: speed against accuracy, and where methods break.

use crate::analysis::precision as shown;
use crate::cli::{args, complain, print, progress};
use crate::compare::precision::{Family, Results, Scene};
use crate::error::{Error, Result};
use crate::report::{Figure, Output, files};
use serde::Serialize;
use std::fmt::Write as _;

#[derive(Serialize)]
struct Answer<'a> {
    #[serde(flatten)]
    results: &'a Results,
    warnings: &'a [String],
    files: &'a [String],
}

const FAMILIES: [Family; 2] = [Family::Models, Family::Estimators];

pub fn run(typed: &args::Precision, json: bool) -> Result<()> {
    let mut results = match &typed.from {
        Some(path) => Results::from_path(path)?,
        None => Results::default(),
    };
    if typed.from.is_none() {
        let bar = progress::bar(json);
        let mut tell = |scene: &str| {
            bar.set_message(scene.to_owned());
            bar.inc(1);
        };
        for family in FAMILIES.into_iter().filter(|f| typed.family.holds(*f)) {
            results.measure(family, typed.quick, typed.failures, &mut tell)?;
        }
        bar.finish_and_clear();
    }
    results.retain(|family| typed.family.holds(family));
    let nothing = results.failures.is_empty();
    if nothing && (typed.failures || results.scenes.is_empty()) {
        let missing = if typed.failures { "failures" } else { "scenes" };
        return Err(Error::usage(format!("no {missing} of this kind in the file"), "one at least")
            .hint("write it with `vibro precision --failures --json > FILE`"));
    }
    let mut warnings = Vec::new();
    for path in &typed.add {
        let left = results.add(path)?;
        let lines = left.chunk_by(|a, b| a == b);
        warnings.extend(lines.map(|l| {
            format!(
                "{}: left out, as not measured: {} lines of the scene {:?}.",
                path.display(),
                l.len(),
                l[0]
            )
        }));
    }
    if typed.from.is_none() && cfg!(debug_assertions) {
        warnings
            .push("This is a build for development: its times are not those of the released program.".into());
    }
    let Results { scenes, failures } = &results;
    let maps = FAMILIES.map(|family| (family, failures.of(family)));
    let mut written = Vec::new();
    if let Some(folder) = &typed.out {
        let mut output = Output::new(folder)?;
        let chart = |s: &Scene| (format!("precision_{}", files::slug(&s.name)), shown::chart(s));
        let map = |(name, figure): (String, Figure)| (format!("failures_{}", files::slug(&name)), figure);
        let drawn = maps.iter().flat_map(|(family, part)| shown::maps(*family, part)).map(map);
        let drawn: Vec<_> = scenes.iter().map(chart).chain(drawn).collect();
        files::figures(&mut output, &drawn, &|| ())?;
        output.write("precision.csv", shown::precision(scenes).csv())?;
        if !nothing {
            output.write("failures.csv", shown::failures(failures).csv())?;
        }
        written = output.written().to_vec();
    }
    if json {
        return print::json(&Answer { results: &results, warnings: &warnings, files: &written });
    }
    complain::warn(&warnings);
    let mut text = String::new();
    for scene in scenes {
        let bound = scene.bound.map_or(String::new(), |b| format!("; Cramér–Rao bound: {b:.1e}"));
        let Scene { name, says, error_of, .. } = scene;
        let _ = writeln!(text, "{name}\n{says}\nError: {error_of}{bound}\n{}", shown::scene(scene).text());
    }
    for (family, map) in maps.iter().filter(|(_, map)| !map.is_empty()) {
        let _ = writeln!(text, "{}", shown::borders(*family, map).text());
    }
    for file in written {
        let _ = writeln!(text, "wrote {file}");
    }
    print::text(&text)
}
