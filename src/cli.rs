//! The command `vibro`: parses and checks the command line, runs the command and prints the result. Nothing
//! in the library uses this folder.

mod app;
mod campaign;
mod campaigns;
mod complain;
mod convert;
mod demo;
mod info;
mod init;
mod model;
mod plan;
mod precision;
mod print;
mod program;
mod question;
mod record;
mod respelt;
mod shell;
mod stdout;
mod study;
mod sweep;
mod typed;

use crate::analysis::{self, FileCommand};
use crate::campaign::KeyRange;
use crate::error::{Error, Result};
use crate::read::Limit;
use crate::record::Kind;
use crate::record::kind::{number, whole};
use crate::report::Medium;
use crate::report::files::Names;
use crate::report::words::Voice;
use clap::{ArgMatches, Args, Command as Typed};

pub use campaign::RunResults;
pub use clap::builder::StyledStr;
pub use clap::{Arg, ArgAction, Command};
pub use demo::written as demo;
pub use program::{answer, questions, reading, run, study};
use question::Question;
use std::any::TypeId;
use std::ffi::OsString;
use std::path::PathBuf;
pub use study::Shared;

/// All commands by purpose, in the order of the help. Each row states an example, without `vibro`, and what
/// the command does. A new command is a new row. [`MEASURE`] has the commands of kinds of records, too.
const GROUPS: &[(&str, &[CommandRow])] = &[
    (
        "Begin with a folder of recordings",
        &[
            CommandRow::of::<init::Init>("init measurements", "Write a campaign for what lies in a folder"),
            CommandRow::of::<campaign::Run>(
                "run measurements",
                "Run a campaign or a folder: results, tables, figures, report",
            ),
            CommandRow::of::<init::Check>("check campaign.toml", "Check a campaign without computing"),
            CommandRow::of::<demo::Open>("open measurements", "Open the report of a folder in a browser"),
            CommandRow::of::<demo::Demo>("demo bench", "Write an example with its recordings, and run it"),
        ],
    ),
    (
        "Files",
        &[
            CommandRow::of::<info::Info>(
                "info measurement.uff",
                "List the records of a file: channels, units, sampling rate",
            ),
            CommandRow::of::<convert::Convert>(
                "convert measurement.uff measurement.csv",
                "Convert a file to UFF-58, CSV, WAV or NPY, by the ending of OUTPUT",
            ),
        ],
    ),
    (
        "Before a test",
        &[CommandRow::asking::<plan::Plan>(
            "plan plan.toml",
            "What a test will tell before it is made: expected uncertainties, what to change first",
        )
        .of_campaigns()],
    ),
    (
        MEASURE,
        &[
            CommandRow::asking::<sweep::ResponseArgs>(
                "response step*.csv --out figures",
                "Response of a sweep at the excitation frequency, with resonances and jumps",
            ),
            CommandRow::asking::<sweep::WaterfallArgs>(
                "waterfall LIST.TXT --unit mm/s --out figures",
                "Waterfall of all response spectra of a sweep",
            ),
            CommandRow::asking::<sweep::ExcitationArgs>(
                "excitation LIST.TXT",
                "Excitation frequency of every point of a sweep",
            ),
            CommandRow::asking::<record::Spectrum>(
                "spectrum trace.csv --channel velocity --out figures",
                "Spectrum of a channel, or frequency response function between two",
            ),
            CommandRow::asking::<record::Modal>(
                "modal blows.csv --reference force --hammer",
                "Natural frequency, damping and modal constant of the modes of a frequency response function",
            ),
            CommandRow::asking::<record::Impacts>(
                "impacts contact.csv --excitation 11.2",
                "Impacts in a contact signal: interval, frequency, impacts per cycle",
            ),
            CommandRow::asking::<record::Restitution>(
                "restitution drop1.csv drop2.csv --height 0.57 --height-std 0.001",
                "Coefficient of restitution from drops, bounces or velocities, every method side by side",
            ),
            CommandRow::asking::<record::Pulse>(
                "pulse contact.csv --low-pass none",
                "Damping ratio, frequency and restitution of a contact from its pulse",
            ),
            CommandRow::asking::<record::Drill>(
                "drill drill.wav --velocity striker --beam-angle 0 --beam-from axis --sensitivity 2",
                "Speed, impacts and average turn of a hammer drill",
            ),
        ],
    ),
    (
        "Model",
        &[
            CommandRow::asking::<model::Model>(
                "model orbit --frequency 11.2 --force 0.5",
                "Model of a rig: periodic motions, simulation, sweep, map, choice of a model",
            ),
            CommandRow::asking::<campaign::Compare>(
                "compare campaign.toml --fit gap,restitution",
                "Compare the measured responses of a campaign with the model; fit parameters of the rig",
            )
            .of_campaigns(),
            CommandRow::of::<study::Merge>(
                "merge parts --out figures",
                "Join the parts that --shard computed: of a map, a Monte Carlo, a benchmark, campaigns",
            ),
            CommandRow::of::<precision::Precision>(
                "precision --quick",
                "Speed and accuracy of every method on scenes with a known truth",
            ),
        ],
    ),
    (
        "Browser and shell",
        &[
            CommandRow::of::<app::App>(
                "app --out page",
                "Write the page vibro.html: the same without a terminal",
            ),
            CommandRow::of::<shell::Completions>(
                "completions bash > ~/.local/share/bash-completion/completions/vibro",
                "Print the completions for a shell",
            ),
            CommandRow::of::<shell::Man>("man > vibro.1", "Print the manual page"),
        ],
    ),
];

/// Heading of the commands that measure.
const MEASURE: &str = "Measure";

/// All groups of commands, with the commands that kinds of records bring.
fn groups() -> impl Iterator<Item = (&'static str, Vec<CommandRow>)> {
    GROUPS.iter().map(|&(name, rows)| {
        let of_kinds = analysis::commands().filter(|_| name == MEASURE);
        let of_kinds = of_kinds.map(|(command, names)| CommandRow::of_kind(command, names));
        (name, rows.iter().copied().chain(of_kinds).collect())
    })
}

/// All commands.
fn rows() -> impl Iterator<Item = CommandRow> {
    groups().flat_map(|(_, rows)| rows)
}

/// Arguments of a command, and the function that runs it.
trait CommandArgs: Args {
    /// How messages name settings: as options, or as keys for commands that read a campaign file.
    const VOICE: Voice = Voice::Command;

    /// Runs the command and returns the exit code.
    fn run(&self, json: bool) -> Result<u8>;
}

/// A row of the table of commands.
#[derive(Clone, Copy)]
struct CommandRow {
    /// Example of what is typed after `vibro`.
    example: &'static str,
    about: &'static str,
    voice: Voice,
    source: CommandSource,
}

/// Where the options and the function of a command are.
#[derive(Clone, Copy)]
enum CommandSource {
    /// In this folder.
    Args { options: fn(Typed) -> Typed, run: fn(&ArgMatches, bool) -> Result<u8> },
    /// With the kind of record that it measures, whose results have these names.
    Kind(FileCommand, Names),
    /// In this folder; the command gives one answer.
    Question { options: fn(Typed) -> Typed, of: fn(&ArgMatches) -> Read },
}

/// A question read from typed options.
type Read = std::result::Result<Box<dyn Question>, clap::Error>;

impl CommandRow {
    const fn of<T: CommandArgs>(example: &'static str, about: &'static str) -> CommandRow {
        let run = |typed: &ArgMatches, json| match T::from_arg_matches(typed) {
            Ok(typed) => typed.run(json),
            Err(error) => Ok(complain::usage(&error, json)),
        };
        let source = CommandSource::Args { options: T::augment_args, run };
        CommandRow { example, about, voice: T::VOICE, source }
    }

    /// A command that gives one answer.
    const fn asking<T: Args + Question + 'static>(example: &'static str, about: &'static str) -> CommandRow {
        let of = |typed: &ArgMatches| -> Read { Ok(Box::new(T::from_arg_matches(typed)?)) };
        let source = CommandSource::Question { options: T::augment_args, of };
        CommandRow { example, about, voice: Voice::Command, source }
    }

    /// The same command, with messages to the author of a campaign.
    const fn of_campaigns(self) -> CommandRow {
        CommandRow { voice: Voice::Campaign, ..self }
    }

    /// The command of a kind of record.
    fn of_kind(command: FileCommand, names: Names) -> CommandRow {
        let FileCommand { example, about, .. } = command;
        CommandRow { example, about, voice: Voice::Command, source: CommandSource::Kind(command, names) }
    }

    /// The command line with its options.
    fn options(&self, line: Typed) -> Typed {
        match self.source {
            CommandSource::Args { options, .. } | CommandSource::Question { options, .. } => options(line),
            CommandSource::Kind(command, _) => record::with_file(line, command),
        }
    }

    /// The question that the typed options ask; `None` for a command that does other work.
    fn question(&self, typed: &ArgMatches) -> Option<Read> {
        match self.source {
            CommandSource::Args { .. } => None,
            CommandSource::Question { of, .. } => Some(of(typed)),
            CommandSource::Kind(command, names) => {
                Some(record::OfKind::of(typed, command, names).map(|question| Box::new(question) as _))
            }
        }
    }

    /// Runs the command and returns the exit code.
    fn run(&self, typed: &ArgMatches, json: bool) -> Result<u8> {
        match (self.question(typed), self.source) {
            (Some(Ok(question)), _) => question::printed(&*question, json),
            (Some(Err(error)), _) => Ok(complain::usage(&error, json)),
            (None, CommandSource::Args { run, .. }) => run(typed, json),
            (None, _) => Ok(0),
        }
    }

    /// The name of the command.
    fn name(&self) -> &'static str {
        self.example.split(' ').next().unwrap_or_default()
    }

    /// Its line in a list of commands.
    fn line(&self) -> String {
        format!("  {:12} {}\n", self.name(), self.about)
    }
}

/// Help of the option `--style`.
const STYLES: &str =
    "Figures for a report, paper (86 mm wide, grey) or slide (1.6 times larger) [default: report]";

/// Help of the option `--max-memory`.
const MEMORY: &str =
    "Memory that a file and its analysis may take, such as 2GB [default: a quarter of the machine's]";

/// Purpose of the program.
const ABOUT: &str = "Measure impacting machines: from analyser files to answers, each with its uncertainty";

/// The commands that a newcomer needs.
const FIRST: [&str; 5] = ["init", "run", "demo", "info", "response"];

/// Help that is printed if no command was typed.
fn short() -> String {
    let lines: String = rows().filter(|row| FIRST.contains(&row.name())).map(|row| row.line()).collect();
    format!(
        "{ABOUT}\n\nUsage: vibro COMMAND\n\n{lines}\nAll commands: vibro --help. Options and an example: vibro COMMAND --help\n"
    )
}

/// Help with all commands by purpose.
fn long() -> String {
    let group = |(name, rows): (&str, Vec<CommandRow>)| {
        format!("{name}:\n{}\n", rows.iter().map(CommandRow::line).collect::<String>())
    };
    let groups: String = groups().map(group).collect();
    format!(
        "{ABOUT}\n\nUsage: vibro COMMAND\n\n{groups}Options:\n  --json              Print one JSON object instead of a table\n  --max-memory SIZE   {MEMORY}\n  --version           Print the version\n\nOptions and an example of a command: vibro COMMAND --help\n"
    )
}

fn command() -> Typed {
    let json = Arg::new("json").action(ArgAction::SetTrue).global(true).help_heading(OUTPUT);
    let size = |text: &str| Limit::parse(text).ok_or(Kind::Other("a size such as 2GB or 500MB".to_owned()));
    let memory =
        Arg::new("max_memory").long("max-memory").value_name("SIZE").global(true).help_heading(OUTPUT);
    let memory = memory.value_parser(size).help(MEMORY);
    let commands = rows().map(|row| command_of(&row));
    let all = Typed::new("vibro")
        .version(env!("CARGO_PKG_VERSION"))
        .about(ABOUT)
        .max_term_width(100)
        .override_help(long())
        .arg(json.help("Print one JSON object instead of a table"))
        .arg(memory);
    options(all.subcommands(commands))
}

/// Parses and runs a command line, which begins with the name of the program, and returns the exit code: 0
/// done, 1 no answer possible, 2 wrong usage or unreadable input.
pub fn main(words: impl IntoIterator<Item = OsString>) -> u8 {
    typed::state(words);
    let typed = match command().try_get_matches_from(respelt::args()) {
        Ok(typed) => typed,
        // A command line that cannot be parsed may still ask for JSON.
        Err(error) => {
            let json = typed::words().take_while(|a| a != "--").any(|a| a == "--json");
            return complain::usage(&error, json);
        }
    };
    let json = typed.get_flag("json");
    if let Some(limit) = typed.get_one::<Limit>("max_memory") {
        limit.state();
    }
    if respelt::repeats_stdin() {
        let twice = Error::usage("- stands twice", "standard input once: it is one record");
        return complain::error(&twice, Voice::Command, json);
    }
    let last = std::iter::successors(Some(&typed), |at| Some(at.subcommand()?.1)).last();
    let style = last.and_then(|typed| typed.try_get_one::<String>("style").ok()?);
    let medium = match style.map(String::as_str) {
        Some("paper") => Medium::Paper,
        Some("slide") => Medium::Slide,
        _ => Medium::Report,
    };
    let replace = last.and_then(|typed| typed.try_get_one("replace").ok()?).copied().unwrap_or(false);
    // Set only here, so this cannot fail.
    let _ = print::WRITTEN.set(print::OutputSettings { medium, replace });
    if let Err(error) = numbers(last.unwrap_or(&typed)) {
        return complain::error(&error, Voice::Command, json);
    }
    let row = |(name, typed)| Some((rows().find(|row| row.name() == name)?, typed));
    let Some((row, typed)) = typed.subcommand().and_then(row) else {
        return complain::nothing(&short(), json);
    };
    row.run(typed, json).unwrap_or_else(|error| complain::error(&error, row.voice, json))
}

/// The definition of one command.
fn command_of(row: &CommandRow) -> Typed {
    let example = format!("Example:\n  vibro {}", row.example);
    row.options(Typed::new(row.name())).about(row.about).after_help(example)
}

/// Checks that each number typed after a command is in the range of its option: a single number, one in a
/// range such as 1:2, or one in a list.
fn numbers(typed: &ArgMatches) -> Result<()> {
    for key in typed.ids().map(clap::Id::as_str) {
        let Some(range) = KeyRange::of(key, analysis::key_ranges()) else { continue };
        for words in typed.try_get_raw(key).ok().flatten().into_iter().flatten() {
            let words = words.to_string_lossy();
            let mut numbers = words.split([':', ',']).filter_map(|word| word.trim().parse().ok());
            numbers.try_for_each(|number| range.check(key, number))?;
        }
    }
    Ok(())
}

/// Turns the fields of all keys into options, in their order. The field `field_name` becomes the option
/// `--field-name`, unless a long name is declared. The placeholder of its value in the help is by its type,
/// unless declared. Negative numbers are accepted here: [`numbers`] explains them better than an error about
/// an unknown option.
fn options(command: Typed) -> Typed {
    let mut order = 0;
    let option = |arg: Arg| {
        order += 1;
        let takes_value = arg.get_action().takes_values();
        // Options common to all commands are listed after those of the command.
        let order = if arg.is_global_set() { usize::MAX } else { order };
        let arg = arg.allow_negative_numbers(takes_value).display_order(order);
        if arg.get_index().is_some() {
            return arg;
        }
        let id = arg.get_id().to_string();
        let long = arg.get_long().map_or_else(|| id.replace('_', "-"), str::to_owned);
        let placeholder_declared =
            arg.get_value_names().is_none_or(|names| names[0] != id.to_uppercase().as_str());
        let placeholder = placeholder(&arg);
        let arg = read_by_type(arg.long(long));
        let arg = if id == "out" { arg.help_heading(OUTPUT) } else { arg };
        if takes_value && !placeholder_declared { arg.value_name(placeholder) } else { arg }
    };
    let command = command.mut_args(option).mut_subcommands(options).next_help_heading(OUTPUT);
    let has = |name: &str| command.get_arguments().any(|arg| arg.get_id() == name);
    let style = Arg::new("style").long("style").value_name("STYLE").help(STYLES).hide_possible_values(true);
    let style = style.value_parser(["report", "paper", "slide"]).display_order(order + 1);
    let replace = Arg::new("replace").long("replace").action(ArgAction::SetTrue).help(REPLACE);
    let replace = replace.display_order(order + 2);
    let more = [(has("out"), style), (WRITES.iter().any(|name| has(name)), replace)];
    command.args(more.into_iter().filter(|(wanted, _)| *wanted).map(|(_, arg)| arg))
}

/// Heading in the help for options of printed and written output. The heading of options for reading files is
/// at their struct; options of an analysis have no heading and come first.
const OUTPUT: &str = "Output";

/// Options that name files to write: a command with one of these also gets `--replace`.
const WRITES: [&str; 4] = ["out", "output", "each_cycle", "write_lists"];

/// Help of the option `--replace`.
const REPLACE: &str =
    "Replace files that vibro did not write, or that were changed since; never what the command reads";

/// Placeholder for the value of an option in the help, by the type of the value.
fn placeholder(arg: &Arg) -> &'static str {
    let is = arg.get_value_parser().type_id();
    if is == TypeId::of::<PathBuf>() {
        return "FILE";
    }
    let whole = [
        TypeId::of::<usize>(),
        TypeId::of::<u32>(),
        TypeId::of::<u16>(),
        TypeId::of::<u8>(),
        TypeId::of::<i8>(),
    ];
    match () {
        () if is == TypeId::of::<f64>() => "NUMBER",
        () if whole.iter().any(|of| is == *of) => "N",
        () => "NAME",
    }
}

/// Sets the parser of a number by its type, so that a wrong value gives an error with its expected [`Kind`].
fn read_by_type(arg: Arg) -> Arg {
    let is = arg.get_value_parser().type_id();
    match () {
        () if is == TypeId::of::<f64>() => arg.value_parser(number),
        () if is == TypeId::of::<usize>() => arg.value_parser(whole::<usize, 0, { i64::MAX }>),
        () if is == TypeId::of::<u32>() => arg.value_parser(whole::<u32, 0, { u32::MAX as i64 }>),
        () => arg,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::LowPass;
    use crate::model::Parameter;
    use clap::error::{ContextKind, ErrorKind};
    use std::error::Error as _;

    #[test]
    fn every_option_that_takes_a_number_has_its_range() {
        // The model checks these itself: parameters that can be varied, and settings of `vibro model`.
        let asked = ["from", "to", "step", "start", "tolerance", "noise_floor", "gap_std"];
        let of_model = |key: &str| Parameter::named(key).is_some() || asked.contains(&key);
        let mut left = vec![command()];
        let mut seen = 0;
        while let Some(mut at) = left.pop() {
            left.extend(at.get_subcommands_mut().map(|part| part.clone()));
            let numbers = [
                TypeId::of::<f64>(),
                TypeId::of::<(f64, f64)>(),
                TypeId::of::<LowPass>(),
                TypeId::of::<usize>(),
                TypeId::of::<u32>(),
            ];
            for arg in at
                .get_arguments()
                .filter(|arg| numbers.iter().any(|of| arg.get_value_parser().type_id() == *of))
            {
                let key = arg.get_id().as_str();
                let range = KeyRange::of(key, analysis::key_ranges());
                assert!(of_model(key) || range.is_some(), "{key} of {}", at.get_name());
                seen += 1;
            }
        }
        assert!(seen > 80, "{seen}");
    }

    /// A refused value comes with its expected kind or a list of names, whichever crate parses it.
    #[test]
    fn every_value_that_is_refused_is_refused_with_its_kind() {
        let mut left: Vec<(Vec<String>, Typed)> = vec![(vec!["vibro".to_owned()], command())];
        let mut seen = 0;
        while let Some((typed, at)) = left.pop() {
            for part in at.get_subcommands() {
                left.push(([&typed[..], &[part.get_name().to_owned()]].concat(), part.clone()));
            }
            for arg in at.get_arguments().filter(|arg| arg.get_action().takes_values()) {
                let option = arg.get_long().map(|long| format!("--{long}"));
                let words = typed.iter().cloned().chain(option).chain(["?".to_owned(), "?".to_owned()]);
                let Err(error) = command().try_get_matches_from(words) else { continue };
                if matches!(error.kind(), ErrorKind::ValueValidation | ErrorKind::InvalidValue) {
                    let kind = error.source().and_then(|source| source.downcast_ref::<Kind>()).is_some();
                    let named = error.get(ContextKind::ValidValue).is_some();
                    assert!(kind || named, "{typed:?} {}: {error}", arg.get_id());
                    seen += 1;
                }
            }
        }
        assert!(seen > 120, "{seen}");
    }
}
