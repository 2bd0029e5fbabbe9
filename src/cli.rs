//! The command `vibro`: what was typed, checked, done and printed. Nothing in the library uses this folder.

mod campaign;
mod complain;
mod convert;
mod info;
mod model;
mod precision;
mod print;
mod record;
mod sweep;

use crate::error::Result;
use crate::report::words::Voice;
use clap::{Arg, Command as Typed, CommandFactory, FromArgMatches, Parser, Subcommand};
use std::any::TypeId;
use std::path::PathBuf;

/// Measure impacting machines: from analyser files to answers, each with its uncertainty.
#[derive(Debug, Parser)]
#[command(name = "vibro", version, max_term_width = 100)]
struct Args {
    /// Print one JSON object instead of a table
    #[arg(long, global = true)]
    json: bool,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// List the records of a file: channels, units, sampling rate
    Info(info::Info),
    /// Convert a file to UFF-58, CSV, WAV or NPY, by the ending of OUTPUT
    Convert(convert::Convert),
    /// Spectrum of a channel, or frequency response function between two
    Spectrum(record::Spectrum),
    /// Excitation frequency of every point of a sweep
    Excitation(sweep::Excitation),
    /// Waterfall of all response spectra of a sweep
    Waterfall(sweep::Waterfall),
    /// Response of a sweep at the excitation frequency, with resonances and jumps
    Response(sweep::Taken),
    /// Speed, impacts and average turn of a hammer drill
    Drill(Box<record::Drill>),
    /// Impacts in a contact signal: interval, frequency, impacts per cycle
    Impacts(record::Impacts),
    /// Coefficient of restitution from drops, bounces or velocities, every method side by side
    Restitution(record::Restitution),
    /// Natural frequency, damping and modal constant of the modes of a frequency response function
    Modal(record::Modal),
    /// Damping ratio, frequency and restitution of a contact from its pulse
    Pulse(record::Pulse),
    /// Model of a rig: periodic motions, simulation, sweep, map, choice of a model
    #[command(subcommand)]
    Model(Box<model::Model>),
    /// Compare the measured responses of a campaign with the model; fit parameters of the rig
    Compare(campaign::Compare),
    /// Speed and accuracy of every method on scenes with a known truth
    Precision(precision::Precision),
    /// Run a campaign: results, tables, figures, report
    Run(campaign::Run),
}

/// Parses the command line, does what it says, and gives the exit code: 0 done, 1 no answer possible, 2 wrong usage or
/// unreadable input.
pub fn main() -> u8 {
    let typed = options(Args::command()).try_get_matches().and_then(|m| Args::from_arg_matches(&m));
    let args = match typed {
        Ok(args) => args,
        // What could not be parsed may have asked for JSON all the same.
        Err(error) => {
            let json = std::env::args_os().take_while(|a| a != "--").any(|a| a == "--json");
            return complain::usage(&error, json);
        }
    };
    // What a campaign says is corrected there.
    let voice = match &args.command {
        Command::Run(_) | Command::Compare(_) => Voice::Campaign,
        _ => Voice::Command,
    };
    dispatch(&args).unwrap_or_else(|error| complain::error(&error, voice, args.json))
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

fn dispatch(args: &Args) -> Result<u8> {
    let json = args.json;
    match &args.command {
        Command::Info(typed) => return typed.run(json),
        Command::Run(typed) => return typed.run(json),
        Command::Convert(typed) => typed.run(json),
        Command::Spectrum(typed) => typed.run(json),
        Command::Excitation(typed) => typed.run(json),
        Command::Waterfall(typed) => typed.run(json),
        Command::Response(typed) => typed.run(json),
        Command::Drill(typed) => typed.run(json),
        Command::Impacts(typed) => typed.run(json),
        Command::Restitution(typed) => typed.run(json),
        Command::Compare(typed) => typed.run(json),
        Command::Modal(typed) => typed.run(json),
        Command::Pulse(typed) => typed.run(json),
        Command::Model(typed) => typed.run(json),
        Command::Precision(typed) => typed.run(json),
    }?;
    Ok(0)
}
