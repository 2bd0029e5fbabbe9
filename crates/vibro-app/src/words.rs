//! Errors in the words of the page: it has kinds of records and keys where the command line has commands and
//! options.

use vibroimpact::analysis;
use vibroimpact::error::{Error, Hint};
use vibroimpact::report::words::Voice;

/// Commands of the command line, and the section of a campaign that does the same.
const COMMANDS: [(&str, &str); 7] = [
    ("vibro spectrum", "spectrum"),
    ("vibro modal", "frf"),
    ("vibro drill", "drill"),
    ("vibro impacts", "impacts"),
    ("vibro restitution", "drop"),
    ("vibro decay", "decay"),
    ("vibro pulse", "pulse"),
];

/// An error as the page says it.
pub fn error(error: &Error) -> String {
    let spelt = |hint: &Hint| match hint {
        // The list of recordings tells what is in each file.
        Hint::OfFile("vibro info") => "the list of recordings tells what is in it".to_owned(),
        Hint::OfFile(command) => as_kinds(&format!("`{command}`")),
        Hint::Words(words) if words.starts_with("`vibro info ") => "drop other files".to_owned(),
        _ => as_kinds(&hint.to_string()),
    };
    on_page(error.text_with(|key, value| Voice::Campaign.set(key, value), spelt))
}

/// A text with the place on the page in place of what only the command line has.
fn on_page(text: String) -> String {
    PLACES.iter().fold(text, |text, (there, here)| text.replace(there, here))
}

/// What else the command line has, and the place on the page.
const PLACES: [(&str, &str); 8] = [
    ("`vibro info` lists what is in the file", "the list of recordings tells what is in the file"),
    (
        "of a measurement file `vibro info` says what is in it",
        "the list of recordings tells what is in each file",
    ),
    ("two values between square brackets", "two values, such as 0.5; 3"),
    ("a list between square brackets, or tables with double brackets", "values with ; between them"),
    ("docs/campaign.md lists every key", "the card of the record lists every key"),
    ("as docs/campaign.md shows", "or choose a kind beside the file"),
    ("vibro info lists the channels with their numbers", "the list of recordings names the channels"),
    ("or vibro demo", "or an example"),
];

/// Begin of an aside in parentheses that is for the command line alone.
const ASIDE: &str = " (vibro init: ";

/// A sentence with the kinds of records in place of commands, and what the page has in place of documents.
pub fn as_kinds(sentence: &str) -> String {
    let sentence = sentence.split(ASIDE).next().unwrap_or(sentence);
    COMMANDS.iter().fold(on_page(sentence.to_owned()), |text, (command, section)| {
        let kind = format!("the kind “{}”", analysis::title(section).unwrap_or(section));
        [format!("`{command}`"), format!("{command} FILE")]
            .iter()
            .fold(text, |text, one| text.replace(one, &kind))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_names_kinds_and_keys() {
        let none = Error::refused("no trace").hint("`vibro info` lists what is in the file; state its rate");
        let said = "no trace\n  try: the list of recordings tells what is in the file; state its rate";
        assert_eq!(error(&none), said);
        let one = error(&Error::usage("span = 3", "two values between square brackets"));
        assert!(one.contains("expected two values, such as 0.5; 3"), "{one}");
        let rings = || Error::refused("the record rings").hint(Hint::OfFile("vibro decay"));
        assert_eq!(error(&rings()), "the record rings\n  try: the kind “Free decays”");
        let empty = Error::refused("nothing").hint("`vibro info a/FILE` tells what is in a file");
        assert_eq!(error(&empty), "nothing\n  try: drop other files");
        let rate = "no sampling rate: choose its kind, and state `rate` (vibro init: --rate HZ for all)";
        assert_eq!(as_kinds(rate), "no sampling rate: choose its kind, and state `rate`");
        let low = Error::refused("no pulse").hint("`vibro impacts` finds them").setting("low_pass");
        assert_eq!(error(&low), "no pulse\n  try: the kind “Impacts” finds them (`low_pass`)");
    }
}
