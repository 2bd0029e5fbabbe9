//! The only place where findings become sentences.
//!
//! One sentence per code, from the tables of `docs/findings.md`. A sentence is a template; each pair of
//! braces is replaced by a fact of the finding:
//!
//! | written | shown |
//! |---|---|
//! | `{gap m}` | the number `gap` with its unit, three digits: `0.6 mm` |
//! | `{gap.6 m}` | six digits |
//! | `{rho ± std}` | the number `rho` with its uncertainty `std`, as tables show them |
//! | `{level @unit}` | with the unit that the fact `unit` names |
//! | `{part %}` | a ratio as a percentage |
//! | `{n}` | the number, whole or with three digits; a name as it is; several numbers between commas |
//! | `{n:impact}`, `{n:entry/entries}` | a count with its noun: `1 impact`, `3 impacts` |
//! | `{n?is/are}` | the first word for one, the second for several |
//! | `{subject}` | what the finding is about |
//! | `[refractory]` | a setting: `--refractory` for the command, `refractory` for a campaign |
//! | `[tones 2]` | a setting with its value: `--tones 2`, `tones = 2` |
//! | `<, at {time s}>` | left out where the fact is missing |

use crate::record::{Fact, Finding, Severity, sort_by_number};
use crate::units::notation::{estimate, quantity, significant};
use serde_json::{Map, Value, json};
use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::LazyLock;

/// The sentence of each code, as `docs/findings.md` lists them.
static SENTENCES: LazyLock<HashMap<&str, &str>> = LazyLock::new(|| {
    let rows = include_str!("../../docs/findings.md").lines().filter_map(|line| line.strip_prefix("| `"));
    let cells = |row: &'static str| {
        let (code, rest) = row.strip_suffix(" |")?.split_once("` | ")?;
        Some((code, rest.split_once(" | ")?.1))
    };
    rows.filter_map(cells).collect()
});

/// Reader of the sentence, which decides how settings are named.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Voice {
    /// A person at the command line: `--low-pass`.
    Command,
    /// The author of a campaign: `low_pass`.
    Campaign,
}

impl Voice {
    /// A setting, named by its key in a campaign, as this reader types it.
    pub fn setting(self, key: &str) -> String {
        self.set(key, "")
    }

    /// A setting with its value, as this reader types them.
    pub fn set(self, key: &str, value: &str) -> String {
        let voice = if OPTIONS.contains(&key) { Voice::Command } else { self };
        match (voice, value) {
            (Voice::Command, "") => format!("--{}", key.replace('_', "-")),
            (Voice::Command, value) if value.starts_with('[') => {
                format!("{} {}", voice.setting(key), value.trim_matches(['[', ']']).replace(", ", ":"))
            }
            (Voice::Command, value) if value.contains(' ') => format!("{} {value}", voice.setting(key)),
            (Voice::Command, value) => format!("{} {}", voice.setting(key), value.trim_matches('"')),
            (Voice::Campaign, "") => format!("`{key}`"),
            (Voice::Campaign, value) => format!("`{key} = {value}`"),
        }
    }
}

/// Settings without a key in a campaign: options of the command line only.
const OPTIONS: [&str; 3] = ["allow_outside", "max_memory", "replace"];

/// The sentence of a finding. A code without a sentence is shown itself.
pub fn sentence(finding: &Finding, voice: Voice) -> String {
    SENTENCES
        .get(finding.code.as_ref())
        .map_or_else(|| finding.code.to_string(), |text| filled(text, finding, voice))
}

/// Name of a record, empty for all records, and a finding about it.
pub type About = (String, Finding);

/// The sentences of findings about records, doubts first. A sentence that holds for several records appears
/// once, after their names.
pub fn sentences(findings: &[About], voice: Voice, notes: bool) -> Vec<String> {
    let all =
        graded(findings, voice).into_iter().filter(|(severity, _)| notes || *severity != Severity::Note);
    all.map(|(_, sentence)| sentence).collect()
}

/// As [`sentences`], each with its severity. Within a severity, sentences with the largest percentage come
/// first, since they affect an answer most; the others keep their order.
pub fn graded(findings: &[About], voice: Voice) -> Vec<(Severity, String)> {
    let mut groups: Vec<(&Finding, Vec<&str>)> = Vec::new();
    for (record, finding) in findings {
        match groups.iter_mut().find(|(known, _)| *known == finding) {
            Some((_, records)) if records.contains(&record.as_str()) => {}
            Some((_, records)) => records.push(record),
            None => groups.push((finding, vec![record])),
        }
    }
    let mut all = Vec::new();
    for severity in [Severity::Doubt, Severity::Caution, Severity::Note] {
        let mut joined: Vec<Sentence<'_>> = Vec::new();
        for (finding, records) in groups.iter().filter(|g| g.0.severity() == severity) {
            let new = Sentence {
                finding,
                text: sentence(finding, voice),
                records: records.clone(),
                others: Vec::new(),
            };
            match joined.iter_mut().find(|known| known.joins(&new)) {
                Some(known) if known.text == new.text => known.records.extend(new.records),
                Some(known) => known.others.push((new.finding, new.records)),
                None => joined.push(new),
            }
        }
        sort_by_number(&mut joined, |a| -a.share());
        all.extend(joined.iter().map(|sentence| (severity, sentence.in_full())));
    }
    all
}

/// Number of findings shown first at the command line.
const FOREMOST: usize = 3;

/// Number of findings, sorted by [`graded`], to show first: three, or all doubts if more. A single further
/// one is shown too: a line that counts it would be as long.
pub fn foremost(findings: &[(Severity, String)]) -> usize {
    let doubts = findings.iter().filter(|(severity, _)| *severity == Severity::Doubt).count();
    let first = doubts.max(FOREMOST);
    if findings.len() <= first + 1 { findings.len() } else { first }
}

/// A sentence with its records, and the records for which it holds with other numbers.
struct Sentence<'a> {
    finding: &'a Finding,
    text: String,
    /// Names of the records to which the sentence applies; an empty name stands for all records.
    records: Vec<&'a str>,
    /// Findings that differ from it in numbers only, with their records.
    others: Vec<(&'a Finding, Vec<&'a str>)>,
}

impl Sentence<'_> {
    /// Whether another sentence of the same code is joined to this one: it is the same, or it differs only
    /// in numbers and is about other records. Doubts with other numbers stay separate.
    fn joins(&self, other: &Sentence<'_>) -> bool {
        let (a, b) = (self.finding, other.finding);
        let is_shared = |record: &&str| record.is_empty() || self.records.contains(record);
        let is_name = |(_, fact): &&(Cow<'_, str>, Fact)| matches!(fact, Fact::Name(_));
        let same_names =
            a.subject == b.subject && a.facts.iter().filter(is_name).eq(b.facts.iter().filter(is_name));
        let other_records = a.severity() < Severity::Doubt
            && !self.records.contains(&"")
            && !other.records.iter().any(is_shared);
        a.code == b.code && (self.text == other.text || same_names && other_records)
    }

    /// Largest ratio that it shows as a percentage, 0 without any.
    fn share(&self) -> f64 {
        let all = std::iter::once(self.finding).chain(self.others.iter().map(|(finding, _)| *finding));
        all.flat_map(shares).fold(0.0, f64::max)
    }

    /// The sentence after the names of its records, then the other records with their numbers.
    fn in_full(&self) -> String {
        let also = |(finding, records): &(&Finding, Vec<&str>)| {
            let numbers = differing(self.finding, finding).join(", ");
            let numbers = if numbers.is_empty() { numbers } else { format!(" ({numbers})") };
            format!("{}{numbers}", names(records))
        };
        let others: Vec<String> = self.others.iter().map(also).collect();
        let others = if others.is_empty() { String::new() } else { format!(" Also: {}.", others.join("; ")) };
        if self.records.contains(&"") {
            self.text.clone()
        } else {
            format!("{}: {}{others}", names(&self.records), self.text)
        }
    }
}

/// Names of records; of more than four, their number with the first and the last.
fn names(records: &[&str]) -> String {
    match records {
        [first, .., last] if records.len() > 4 => format!("{} records, {first} to {last}", records.len()),
        few => few.join("; "),
    }
}

/// The numbers in which a finding differs from another one of its code, as the sentence shows them.
fn differing(first: &Finding, finding: &Finding) -> Vec<String> {
    let shown = places(finding).filter(|place| !place.contains('?')).filter_map(|place| {
        let (number, other) = (shown(place, finding)?, shown(place, first));
        (Some(&number) != other.as_ref()).then_some(number)
    });
    shown.collect()
}

/// Contents of each pair of braces in the sentence of a finding.
fn places(finding: &Finding) -> impl Iterator<Item = &'static str> {
    let template = SENTENCES.get(finding.code.as_ref()).copied().unwrap_or_default();
    template.split('{').skip(1).filter_map(|part| part.split('}').next())
}

/// Ratios of a finding that its sentence shows as percentages.
fn shares(finding: &Finding) -> impl Iterator<Item = f64> {
    let names = places(finding).filter_map(|place| place.strip_suffix(" %")?.split('.').next());
    names
        .flat_map(|name| match finding.fact(name) {
            Some(Fact::Number(value)) => std::slice::from_ref(value),
            Some(Fact::Numbers(values)) => values,
            _ => &[],
        })
        .map(|share| share.abs())
}

/// Puts `findings` and `warnings` into an answer: each finding with its record as subject where it names none
/// itself, and the sentences of those that are not notes.
pub fn put(answer: &mut Map<String, Value>, findings: &[About], voice: Voice) {
    let subjects = findings.iter().cloned().map(|(record, finding)| {
        if record.is_empty() || finding.subject.is_some() { finding } else { finding.about(record) }
    });
    answer.insert("findings".to_owned(), json!(subjects.collect::<Vec<Finding>>()));
    answer.insert("warnings".to_owned(), json!(sentences(findings, voice, false)));
}

/// A template with the facts of a finding in place.
fn filled(template: &str, finding: &Finding, voice: Voice) -> String {
    let mut out = String::new();
    let mut rest = template;
    while let Some(at) = rest.find(['{', '[', '<']) {
        out.push_str(&rest[..at]);
        let inner = &rest[at + 1..];
        let close = match rest.as_bytes()[at] {
            b'{' => '}',
            b'[' => ']',
            _ => '>',
        };
        let Some(end) = inner.find(close) else { return out + &rest[at..] };
        let inside = &inner[..end];
        // An optional part is shown where all of its facts are present.
        let mut facts = inside.split('{').skip(1).filter_map(|part| part.split('}').next());
        match close {
            '}' => out.push_str(&shown(inside, finding).unwrap_or_else(|| UNKNOWN.to_owned())),
            ']' => {
                let (key, value) = inside.split_once(' ').unwrap_or((inside, ""));
                out.push_str(&voice.set(key, value));
            }
            _ if facts.all(|fact| shown(fact, finding).is_some()) => {
                out.push_str(&filled(inside, finding, voice));
            }
            _ => {}
        }
        rest = &inner[end + 1..];
    }
    out + rest
}

/// Text for a number that could not be computed (NaN), and for a missing fact.
const UNKNOWN: &str = "unknown";

/// Text that replaces a pair of braces with this content; `None` where the fact is missing or NaN.
fn shown(inside: &str, finding: &Finding) -> Option<String> {
    let (name, format) = inside.split_at(inside.find([' ', '.', ':', '?']).unwrap_or(inside.len()));
    if name == "subject" {
        return finding.subject.clone();
    }
    if let Some(std) = format.strip_prefix(" ± ") {
        return Some(estimate(finding.get(name).filter(|value| !value.is_nan())?, finding.get(std)));
    }
    let (digits, format) = match format.strip_prefix('.') {
        Some(rest) => {
            let (digits, format) = rest.split_at(rest.find(' ').unwrap_or(rest.len()));
            (digits.parse().ok()?, format)
        }
        None => (3, format),
    };
    let all = match finding.fact(name)? {
        Fact::Name(text) => return Some(text.clone()),
        Fact::Number(value) => std::slice::from_ref(value),
        Fact::Numbers(values) => values,
    };
    if !all.is_empty() && all.iter().all(|value| value.is_nan()) {
        return None;
    }
    let is_one = all.first() == Some(&1.0);
    if let Some(nouns) = format.strip_prefix(':') {
        let (singular, plural) =
            nouns.split_once('/').map_or((nouns, format!("{nouns}s")), |(s, p)| (s, p.to_owned()));
        return Some(format!("{} {}", all.first()?, if is_one { singular } else { &plural }));
    }
    if let Some((singular, plural)) = format.strip_prefix('?').and_then(|words| words.split_once('/')) {
        return Some(if is_one { singular } else { plural }.to_owned());
    }
    let format = format.trim_start();
    let unit = match format.strip_prefix('@').map(|name| finding.fact(name)) {
        Some(Some(Fact::Name(unit))) => unit,
        Some(_) => "",
        None => format,
    };
    let show = |v: &f64| match unit {
        _ if v.is_nan() => UNKNOWN.to_owned(),
        "%" => format!("{} %", trimmed(&significant(100.0 * v, digits))),
        "" if v.fract() == 0.0 && v.abs() < 1e15 => v.to_string(),
        "" => trimmed(&significant(*v, digits)),
        unit => trimmed(&quantity(*v, unit, digits)),
    };
    Some(all.iter().map(show).collect::<Vec<String>>().join(", "))
}

/// A number without trailing zeros of its decimals: they would suggest a precision that the sentence does
/// not state.
fn trimmed(number: &str) -> String {
    let end = number.find([' ', '×']).unwrap_or(number.len());
    let (value, rest) = number.split_at(end);
    let short = if value.contains('.') { value.trim_end_matches('0').trim_end_matches('.') } else { value };
    format!("{short}{rest}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn said(template: &str, finding: &Finding) -> String {
        filled(template, finding, Voice::Command)
    }

    #[test]
    fn facts_stand_where_the_template_has_them() {
        let pair = Finding::note("x").number("value", -3.3914).number("std", 0.029);
        assert_eq!(said("{value ± std} lies outside", &pair), "−3.391 ± 0.029 lies outside");
        let found = Finding::note("x").number("gap", 0.0006).name("unit", "V").count("n", 1).about("laser");
        assert_eq!(said("gap {gap m}, {gap.1 m}", &found), "gap 600 µm, 600 µm");
        assert_eq!(said("{n:impact} {n?is/are} at {subject}", &found), "1 impact is at laser");
        assert_eq!(
            said("level {gap @unit}<, at {time s}>; set [low_pass]", &found),
            "level 600 µV; set --low-pass"
        );
        assert_eq!(filled("set [low_pass]", &found, Voice::Campaign), "set `low_pass`");
    }

    #[test]
    fn parts_and_lists_are_shown() {
        let found = Finding::caution("x").number("part", 0.0312).numbers("lines", [5.0, 10.5]).count("n", 3);
        assert_eq!(
            said("{part %} on {lines Hz}: {n:entry/entries}", &found),
            "3.12 % on 5 Hz, 10.5 Hz: 3 entries"
        );
        let unknown = Finding::caution("x").number("std", f64::NAN).numbers("parts", [0.5, f64::NAN]);
        assert_eq!(said("off by {std s}<, ± {std s}>: {parts %}", &unknown), "off by unknown: 50 %, unknown");
        assert_eq!(said("{gap s}", &Finding::note("x").number("gap", 8.88e-16)), "0 s");
    }

    #[test]
    fn doubts_come_first_and_each_sentence_once() {
        let doubt = Finding::doubt("c").without_estimate();
        let found = [Finding::note("a"), Finding::caution("b"), doubt.clone(), doubt];
        let found = found.map(|finding| (String::new(), finding));
        assert_eq!(sentences(&found, Voice::Command, true), ["c", "b", "a"]);
        assert_eq!(sentences(&found, Voice::Command, false), ["c", "b"]);
    }

    #[test]
    fn what_moves_an_answer_most_comes_first() {
        let contact = |parts: f64| Finding::caution("contact-time-unsaid").numbers("parts", [0.01, parts]);
        let found = [
            Finding::note("answer-moves").number("change", 9.0),
            Finding::caution("no-mass-named"),
            contact(0.02),
            Finding::caution("model-not-chosen").number("part", -1.48),
            Finding::doubt("x-doubt").without_estimate(),
            Finding::caution("frf-one-blow"),
        ];
        let graded = graded(&found.map(|finding| (String::new(), finding)), Voice::Command);
        let starts =
            ["x-doubt", "unknown is not stated", "No contact time", "No sweep", "The function", "Against"];
        for ((_, sentence), start) in graded.iter().zip(starts) {
            assert!(sentence.starts_with(start), "{sentence}");
        }
    }

    #[test]
    fn three_are_read_first_and_all_doubts() {
        let first = |doubts: usize, others: usize| {
            let all = [(Severity::Doubt, doubts), (Severity::Caution, others)];
            let all = all.iter().flat_map(|(severity, n)| vec![(*severity, String::new()); *n]);
            foremost(&all.collect::<Vec<_>>())
        };
        assert_eq!([first(0, 0), first(0, 2), first(1, 9), first(5, 9), first(9, 0)], [0, 2, 3, 5, 9]);
        // The line "one more" would be as long as the finding itself.
        assert_eq!([first(0, 4), first(0, 5), first(4, 1)], [4, 3, 5]);
    }

    #[test]
    fn a_finding_of_several_records_stands_once_behind_their_names() {
        let of = |record: &str, code| (record.to_owned(), Finding::caution(code));
        let all =
            [of("a", "x-code"), of("b", "x-code"), of("a", "x-code"), of("", "y-code"), of("c", "y-code")];
        assert_eq!(sentences(&all, Voice::Campaign, true), ["a; b: x-code", "y-code"]);
        let mut answer = Map::new();
        put(&mut answer, &all[..1], Voice::Campaign);
        assert_eq!(answer["findings"][0]["subject"], "a");
        assert_eq!(answer["warnings"], serde_json::json!(["a: x-code"]));
    }

    #[test]
    fn sentences_that_differ_in_numbers_stand_together() {
        let of = |record: &str, code, n| (record.to_owned(), Finding::caution(code).count("n", n));
        let said = |all: &[About]| sentences(all, Voice::Campaign, true);
        let all = ["a", "b", "c"].map(|name| of(name, "frf-one-blow", name.len()));
        assert_eq!(said(&all).len(), 1);
        let all =
            [of("a", "impacts-doubled", 1), of("b", "impacts-doubled", 2), of("c", "impacts-doubled", 1)];
        let first = "a; c: 1 impact follows another too soon: left out of the mean interval.";
        assert_eq!(said(&all), [format!("{first} Also: b (2 impacts).")]);
        // Different numbers about one record stay two sentences.
        assert_eq!(said(&[of("a", "impacts-doubled", 1), of("a", "impacts-doubled", 2)]).len(), 2);
    }

    #[test]
    fn every_row_of_the_documentation_is_read_and_no_code_has_two() {
        let rows = include_str!("../../docs/findings.md").lines().filter(|line| line.starts_with("| `"));
        assert_eq!(rows.count(), SENTENCES.len());
    }

    /// The sources below a folder, without tests and comments.
    fn sources(folder: &Path, all: &mut String) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() && !path.ends_with("tests") {
                sources(&path, all);
            } else if path.extension().is_some_and(|e| e == "rs")
                && !path.ends_with("words.rs")
                && !path.ends_with("tests.rs")
            {
                let text = std::fs::read_to_string(&path).unwrap();
                let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
                all.extend(text.lines().filter(|l| !l.trim_start().starts_with("//")));
            }
        }
    }

    #[test]
    fn every_code_has_its_sentence_and_every_sentence_its_code() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let mut all = String::new();
        sources(&root.join("src"), &mut all);
        sources(&root.join("crates"), &mut all);
        let makers = ["Finding::note(", "Finding::caution(", "Finding::doubt("];
        let behind = makers.iter().flat_map(|maker| all.split(maker).skip(1));
        let named = include_str!("../../crates/vibro-record/src/code.rs").split(": &str = ").skip(1);
        let codes = behind.chain(named).filter_map(|c| c.trim_start().strip_prefix('"')?.split('"').next());
        let silent: Vec<&str> = codes.filter(|c| !SENTENCES.contains_key(c)).collect();
        assert!(silent.is_empty(), "no sentence for {silent:?}");
        let unused: Vec<_> = SENTENCES.keys().filter(|c| !all.contains(&format!("\"{c}\""))).collect();
        assert!(unused.is_empty(), "no finding for {unused:?}");
    }
}
