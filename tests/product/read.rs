//! Reading of files: those of other people's instruments, and files with unusual content.

mod ascii_rows;
mod ascii_statements;
mod formats;
mod lab_files;
mod stated_axes;
mod sweep_units;
mod traces;
mod uff_binary;
mod uff_damage;
mod uff_files;
mod uff_meaning;
mod uff_set;
mod uff_text;

/// The sentences that a user reads for these findings.
fn sentences(findings: &[vibroimpact::record::Finding]) -> Vec<String> {
    use vibroimpact::report::words;
    let about = findings.iter().map(|finding| (String::new(), finding.clone()));
    words::sentences(&about.collect::<Vec<_>>(), words::Voice::Command, true)
}
