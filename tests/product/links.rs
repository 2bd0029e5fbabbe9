//! Links of the documents: each leads to a file of the project, and to a heading of it where it names one.

use super::layers::files;
use std::fs;
use std::path::Path;

/// Targets of the links and images of a document, without those in blocks and spans of code.
fn targets(text: &str) -> Vec<String> {
    let prose = text.split("```").step_by(2).collect::<String>();
    let prose = prose.split('`').step_by(2).collect::<String>();
    let links = prose.split("](").skip(1).filter_map(|rest| rest.split_once(')'));
    links.map(|(target, _)| target.to_owned()).collect()
}

/// The anchor of a heading: letters and digits in lower case, with `-` for spaces.
fn anchor(heading: &str) -> String {
    let kept = heading.trim().chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect::<String>().to_lowercase()
}

/// Anchors of all headings of a document. A `#` in a block of code is a comment.
fn anchors(text: &str) -> Vec<String> {
    let prose = text.split("```").step_by(2).flat_map(str::lines);
    prose.filter(|line| line.starts_with('#')).map(|line| anchor(line.trim_start_matches('#'))).collect()
}

#[test]
fn every_link_of_a_document_leads_somewhere() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let documents = files(root).into_iter().filter(|path| path.extension().is_some_and(|e| e == "md"));
    let (mut dead, mut seen) = (Vec::new(), 0);
    for path in documents {
        let text = fs::read_to_string(&path).unwrap();
        for target in targets(&text).iter().filter(|target| !target.contains("://")) {
            seen += 1;
            let (file, heading) = target.split_once('#').unwrap_or((target, ""));
            let aim = if file.is_empty() { path.clone() } else { path.with_file_name(file) };
            let there = || {
                heading.is_empty()
                    || fs::read_to_string(&aim).is_ok_and(|t| anchors(&t).contains(&heading.to_owned()))
            };
            if !aim.exists() || !there() {
                dead.push(format!("{}: {target}", path.display()));
            }
        }
    }
    assert!(dead.is_empty(), "links to nothing: {dead:#?}");
    assert!(seen > 150, "{seen}");
}
