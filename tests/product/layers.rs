//! Rules of the source text. A folder of `src` uses only folders to its left; the compiler enforces the
//! direction between crates. Comments fit the width of code, and some definitions exist only once.

use std::fs;
use std::path::{Path, PathBuf};

/// Layers of `src`, left to right.
const FLOW: [&str; 6] = ["report", "campaign", "compare", "analysis", "proposal", "cli"];

/// All files below a folder, without folders that tools write.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let below = |entry: fs::DirEntry| {
        let (path, name) = (entry.path(), entry.file_name());
        match entry.file_type().expect("a type").is_dir() {
            true if ["target", "node_modules", ".git", "pkg"].iter().any(|made| name == *made) => Vec::new(),
            true => files(&path),
            false => vec![path],
        }
    };
    fs::read_dir(folder).expect("a folder").flat_map(|entry| below(entry.expect("an entry"))).collect()
}

/// The Rust files of these folders of the project.
fn sources(folders: &[&str]) -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let all = folders.iter().flat_map(|folder| files(&root.join(folder)));
    all.filter(|path| path.extension().is_some_and(|e| e == "rs")).collect()
}

const ALL: [&str; 4] = ["src", "crates", "tests", "examples"];

/// Top-level modules that the code names after `crate::`, with line numbers. Lists over several lines
/// count, comments do not.
fn used(code: &str) -> Vec<(usize, String)> {
    let code: String =
        code.lines().map(|l| l.find("//").map_or(l, |at| &l[..at])).collect::<Vec<_>>().join("\n");
    let name = |text: &str| -> String {
        text.trim_start().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
    };
    code.match_indices("crate::")
        .filter(|(at, _)| *at == 0 || !code[..*at].ends_with(|c: char| c.is_alphanumeric() || c == '_'))
        .flat_map(|(at, word)| {
            let line = code[..at].matches('\n').count() + 1;
            let rest = &code[at + word.len()..];
            match rest.strip_prefix('{') {
                // The first name of each item of the list; braces inside an item are skipped.
                Some(list) => {
                    let (mut depth, mut parts) = (0, vec![String::new()]);
                    for c in list.chars() {
                        match c {
                            '{' => depth += 1,
                            '}' if depth == 0 => break,
                            '}' => depth -= 1,
                            ',' if depth == 0 => parts.push(String::new()),
                            c => parts.last_mut().expect("one part at least").push(c),
                        }
                    }
                    parts.iter().map(|p| (line, name(p))).filter(|p| !p.1.is_empty()).collect()
                }
                None => vec![(line, name(rest))],
            }
        })
        .collect()
}

#[test]
fn no_arrow_runs_back() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let files = sources(&["src"]);
    assert!(files.len() > 30, "only {} files found: is this the right folder?", files.len());
    let mut wrong = Vec::new();
    for file in files {
        let inside = file.strip_prefix(&src).expect("a file of src");
        let first = inside.components().next().expect("a name").as_os_str().to_string_lossy().into_owned();
        let layer = first.trim_end_matches(".rs").to_owned();
        if matches!(layer.as_str(), "lib" | "main") {
            continue;
        }
        let place = FLOW.iter().position(|l| *l == layer);
        let Some(place) = place else { panic!("{} is in no layer: add it to this test", inside.display()) };
        let text = fs::read_to_string(&file).expect("text");
        let depth = inside.components().count();
        if text.contains(&"super::".repeat(depth + 1)) {
            wrong.push(format!("{}: a path of `super` that leaves its layer", inside.display()));
        }
        for (line, target) in used(&text) {
            let to = FLOW.iter().position(|l| *l == target);
            // A name that is no layer is that of another crate.
            if to.is_some_and(|to| to > place) {
                wrong.push(format!("{}:{line}: {layer} uses {target}", inside.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "arrows that run back:\n{}", wrong.join("\n"));
}

#[test]
fn the_test_sees_an_arrow() {
    let targets = |code: &str| used(code).into_iter().map(|u| u.1).collect::<Vec<_>>();
    assert_eq!(targets("use crate::report::Output;"), ["report"]);
    assert_eq!(targets("let x = crate::cli::main();"), ["cli"]);
    assert_eq!(targets("use crate::{\n    read::{A, B},\n    report,\n};"), ["read", "report"]);
    assert!(targets("/// See [`crate::report`].").is_empty());
}

/// `rustfmt.toml` limits code to the same number of columns.
#[test]
fn comments_fit_the_width_of_code() {
    let files = sources(&ALL);
    let mut wide = Vec::new();
    for file in &files {
        let text = fs::read_to_string(file).unwrap();
        let lines = (1..).zip(text.lines());
        let long =
            lines.filter(|(_, line)| line.trim_start().starts_with("//") && line.chars().count() > 110);
        wide.extend(long.map(|(number, _)| format!("{}:{number}", file.display())));
    }
    assert!(files.len() > 400 && wide.is_empty(), "{} files; longer: {wide:#?}", files.len());
}

/// Sorted paths, relative to the root, of the files whose text is wrong. This file is left out, since it
/// contains the searched words.
fn wrong(folders: &[&str], is_wrong: impl Fn(&str) -> bool) -> Vec<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = sources(folders);
    files.retain(|file| !file.ends_with(file!()) && is_wrong(&fs::read_to_string(file).unwrap()));
    let mut names: Vec<String> =
        files.iter().map(|file| file.strip_prefix(root).unwrap().display().to_string()).collect();
    names.sort();
    names
}

/// Separate definitions of a median could differ for no value and for an even number of values.
#[test]
fn medians_and_quantiles_are_defined_once() {
    let free = |line: &str| {
        let name = line.trim_start_matches("pub(crate) ").trim_start_matches("pub ").strip_prefix("fn ");
        let name = name.and_then(|name| name.split(['(', '<']).next());
        matches!(name, Some("median" | "upper_median" | "quantile")) || line.contains(".select_nth_unstable")
    };
    assert_eq!(wrong(&ALL, |text| text.lines().any(free)), ["crates/vibro-record/src/order.rs"]);
}

/// Whether a loop in this code halves an interval.
fn halves(code: &str) -> bool {
    let lines: Vec<&str> = code.lines().map(str::trim).collect();
    let loops = |line: &str| ["for _ in 0..", "while ", "loop {"].iter().any(|head| line.starts_with(head));
    let middle =
        |line: &&str| line.starts_with("let ") && (line.contains("midpoint(") || line.contains("0.5 * ("));
    let begins = |(i, line): (usize, &&str)| loops(line) && lines[i + 1..].iter().take(2).any(middle);
    lines.iter().enumerate().any(begins)
}

/// A hand-written loop may continue after no number lies between the ends, or stop too early.
#[test]
fn intervals_are_halved_in_one_place() {
    // A binary search over row numbers does not count.
    let search = |text: &str| halves(&text.replace("usize::midpoint(", ""));
    assert_eq!(wrong(&ALL, search), ["crates/vibro-math/src/bisection.rs"]);
    assert!(halves("for _ in 0..60 {\n    let middle = f64::midpoint(low, high);\n"));
    assert!(!halves("for _ in 0..60 {\n    step();\n}\nlet middle = f64::midpoint(low, high);\n"));
}

/// Every generator of random numbers has a typical constant. The examples keep their own generator, since
/// documents quote figures of their recordings; `vibro-record` keeps one, since it lies below the crate of
/// the shared generator.
#[test]
fn random_numbers_come_from_one_place() {
    const CONSTANTS: [&str; 3] =
        ["6_364_136_223_846_793_005", "0xBF58_476D_1CE4_E5B9", "0x2545_F491_4F6C_DD1D"];
    let has = |text: &str| CONSTANTS.iter().any(|constant| text.contains(constant));
    let homes = wrong(&["src", "crates", "tests", "examples", "benches"], has);
    let known = [
        "crates/vibro-demo/src/noise.rs",
        "crates/vibro-math/src/noise.rs",
        "crates/vibro-record/src/clock.rs",
    ];
    assert_eq!(homes, known);
}

/// Another crate may reword its errors in any release; a change of its error types breaks the build.
#[test]
fn no_code_reads_the_words_of_another_crates_error() {
    let mut read = Vec::new();
    for file in sources(&["src", "crates"]) {
        let text = fs::read_to_string(&file).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap();
        if !file.components().any(|part| part.as_os_str().to_string_lossy().starts_with("tests")) {
            let words = words_read(code);
            read.extend(words.map(|line| format!("{}:{line}", file.display())));
        }
    }
    assert!(read.is_empty(), "{read:#?}");
}

/// Numbers of the lines that search in the text of an error.
fn words_read(code: &str) -> impl Iterator<Item = usize> {
    let said = |line: &str| {
        ["message()", "error.to_string()", "e.to_string()", "source.to_string()"]
            .iter()
            .any(|s| line.contains(s))
    };
    let looks = |line: &str| {
        let into = [
            ".contains(",
            ".starts_with(",
            ".ends_with(",
            ".strip_prefix(",
            ".split",
            ".replace",
            ".find(",
            "== \"",
        ];
        into.iter().any(|look| line.contains(look))
    };
    // Variables that hold such a text; then the lines that search in them.
    let named = |line: &str| Some(line.trim().strip_prefix("let ")?.split([' ', ':']).next()?.to_owned());
    let held: Vec<String> = code.lines().filter(|line| said(line)).filter_map(named).collect();
    let wrong = move |line: &str| {
        let of = |name: &String| line.contains(&format!("{name}.")) && !name.is_empty();
        looks(line) && (said(line) || held.iter().any(of))
    };
    let lines: Vec<usize> = (1..).zip(code.lines()).filter(|(_, line)| wrong(line)).map(|(n, _)| n).collect();
    lines.into_iter()
}

#[test]
fn the_test_sees_words_that_are_read() {
    let lines = |code: &str| words_read(code).collect::<Vec<_>>();
    assert_eq!(lines("let message = error.message();\nif message.starts_with(\"unknown field\") {}"), [2]);
    assert_eq!(lines("let why = e.to_string();\nlet n = 3;\nwhy.split('`').count()"), [3]);
    assert_eq!(lines("if error.to_string().contains(\"os error\") {}"), [1]);
    assert!(lines("let text = error.to_string();\nprint(&text);").is_empty());
}

/// A finding's code in a condition is a constant, so that the compiler checks it wherever it is used.
#[test]
fn no_code_of_a_finding_is_compared_as_text() {
    let mut compared = Vec::new();
    for file in sources(&["src", "crates"]) {
        let text = fs::read_to_string(&file).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap();
        let of_tests = file.components().any(|part| part.as_os_str().to_string_lossy().starts_with("tests"))
            || file.to_string_lossy().contains("_tests");
        let literal = |line: &str| {
            line.contains(".code == \"") || line.contains(".code != \"") || line.contains(".has(\"")
        };
        let lines = (1..).zip(code.lines()).filter(|(_, line)| !of_tests && literal(line));
        compared.extend(lines.map(|(number, _)| format!("{}:{number}", file.display())));
    }
    assert!(compared.is_empty(), "{compared:#?}");
}
