//! The command `vibro`: what was typed, checked, done and printed. Nothing in the library uses this folder.

mod campaign;
mod complain;
mod convert;
mod info;
mod init;
mod model;
mod precision;
mod print;
mod record;
mod sweep;

use crate::analysis::{decay, frf, spectrum};
use crate::error::Result;
use crate::report::words::Voice;
use clap::{Arg, ArgAction, ArgMatches, Args, Command as Typed};
use std::any::TypeId;
use std::path::PathBuf;

/// All commands, in the order of the help. A new one is a row.
const COMMANDS: &[Row] = &[
    Row::of::<info::Info>("info").about("List the records of a file: channels, units, sampling rate"),
    Row::of::<convert::Convert>("convert")
        .about("Convert a file to UFF-58, CSV, WAV or NPY, by the ending of OUTPUT"),
    Row::of::<record::Measured<spectrum::Keys>>("spectrum")
        .about("Spectrum of a channel, or frequency response function between two"),
    Row::of::<sweep::Excitation>("excitation").about("Excitation frequency of every point of a sweep"),
    Row::of::<sweep::Waterfall>("waterfall").about("Waterfall of all response spectra of a sweep"),
    Row::of::<sweep::Taken>("response")
        .about("Response of a sweep at the excitation frequency, with resonances and jumps"),
    Row::of::<record::Drill>("drill").about("Speed, impacts and average turn of a hammer drill"),
    Row::of::<record::Impacts>("impacts")
        .about("Impacts in a contact signal: interval, frequency, impacts per cycle"),
    Row::of::<record::Restitution>("restitution")
        .about("Coefficient of restitution from drops, bounces or velocities, every method side by side"),
    Row::of::<record::Measured<frf::Keys>>("modal")
        .about("Natural frequency, damping and modal constant of the modes of a frequency response function"),
    Row::of::<record::Measured<decay::Keys>>("decay")
        .about("Natural frequency and damping of each mode of a free decay"),
    Row::of::<record::Pulse>("pulse")
        .about("Damping ratio, frequency and restitution of a contact from its pulse"),
    Row::of::<model::Model>("model")
        .about("Model of a rig: periodic motions, simulation, sweep, map, choice of a model"),
    Row::of::<campaign::Compare>("compare")
        .about("Compare the measured responses of a campaign with the model; fit parameters of the rig"),
    Row::of::<precision::Precision>("precision")
        .about("Speed and accuracy of every method on scenes with a known truth"),
    Row::of::<init::Init>("init").about("Write a campaign for what lies in a folder"),
    Row::of::<init::Check>("check").about("Check a campaign without computing"),
    Row::of::<campaign::Run>("run").about("Run a campaign: results, tables, figures, report"),
];

/// What is typed behind the name of a command, and what it does.
trait Run: Args {
    /// Who reads what is complained of: what a campaign says is corrected there.
    const VOICE: Voice = Voice::Command;

    /// Does it, and gives the exit code.
    fn run(&self, json: bool) -> Result<u8>;
}

/// A row of the table of commands.
struct Row {
    name: &'static str,
    about: &'static str,
    voice: Voice,
    options: fn(Typed) -> Typed,
    run: fn(&ArgMatches, bool) -> Result<u8>,
}

impl Row {
    const fn of<T: Run>(name: &'static str) -> Row {
        let run = |typed: &ArgMatches, json| match T::from_arg_matches(typed) {
            Ok(typed) => typed.run(json),
            Err(error) => Ok(complain::usage(&error, json)),
        };
        Row { name, about: "", voice: T::VOICE, options: T::augment_args, run }
    }

    const fn about(self, about: &'static str) -> Row {
        Row { about, ..self }
    }
}

fn command() -> Typed {
    let json = Arg::new("json").action(ArgAction::SetTrue).global(true);
    let commands = COMMANDS.iter().map(|row| (row.options)(Typed::new(row.name)).about(row.about));
    let all = Typed::new("vibro")
        .version(env!("CARGO_PKG_VERSION"))
        .about("Measure impacting machines: from analyser files to answers, each with its uncertainty")
        .max_term_width(100)
        .subcommand_required(true)
        .arg_required_else_help(true)
        .arg(json.help("Print one JSON object instead of a table"));
    options(all.subcommands(commands))
}

/// Parses the command line, does what it says, and gives the exit code: 0 done, 1 no answer possible, 2 wrong usage or
/// unreadable input.
pub fn main() -> u8 {
    let typed = match command().try_get_matches() {
        Ok(typed) => typed,
        // What could not be parsed may have asked for JSON all the same.
        Err(error) => {
            let json = std::env::args_os().take_while(|a| a != "--").any(|a| a == "--json");
            return complain::usage(&error, json);
        }
    };
    let json = typed.get_flag("json");
    let row = |(name, typed)| Some((COMMANDS.iter().find(|row| row.name == name)?, typed));
    typed.subcommand().and_then(row).map_or(2, |(row, typed)| {
        (row.run)(typed, json).unwrap_or_else(|error| complain::error(&error, row.voice, json))
    })
}

/// Makes options of the fields of all keys, in their order: each has the name of its field and, where it names no other, a value of the kind
/// that its type says. A negative number is taken: whether it makes sense, its check says better than a complaint about an unknown option.
fn options(command: Typed) -> Typed {
    let mut order = 0;
    let option = |arg: Arg| {
        order += 1;
        let takes = arg.get_action().takes_values();
        let arg = arg.allow_negative_numbers(takes).display_order(order);
        if arg.get_index().is_some() {
            return arg;
        }
        let id = arg.get_id().to_string();
        let long = arg.get_long().map_or_else(|| id.replace('_', "-"), str::to_owned);
        let own = arg.get_value_names().is_none_or(|names| names[0] != id.to_uppercase().as_str());
        let kind = kind(&arg);
        let arg = arg.long(long);
        if takes && !own { arg.value_name(kind) } else { arg }
    };
    command.mut_args(option).mut_subcommands(options)
}

/// The kind of an option's value.
fn kind(arg: &Arg) -> &'static str {
    let kinds = [
        (TypeId::of::<f64>(), "NUMBER"),
        (TypeId::of::<PathBuf>(), "FILE"),
        (TypeId::of::<usize>(), "N"),
        (TypeId::of::<u32>(), "N"),
        (TypeId::of::<u16>(), "N"),
        (TypeId::of::<u8>(), "N"),
        (TypeId::of::<i8>(), "N"),
    ];
    let is = arg.get_value_parser().type_id();
    kinds.into_iter().find(|(id, _)| is == *id).map_or("NAME", |(_, name)| name)
}
