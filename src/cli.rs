//! The command `vibro`: what was typed, checked, done and printed. Nothing in the library uses this folder.

mod args;
mod compare;
mod complain;
mod convert;
mod drill;
mod excitation;
mod impacts;
mod info;
mod modal;
mod model;
mod precision;
mod print;
mod progress;
mod pulse;
mod response;
mod restitution;
mod run;
mod settings;
mod spectrum;
mod target;
mod waterfall;

use crate::error::Result;
use crate::report::words::Voice;
use args::{Args, Command};
use clap::Parser;

/// Parses the command line, does what it says, and gives the exit code: 0 done, 1 no answer possible, 2 wrong usage or
/// unreadable input.
pub fn main() -> u8 {
    let args = match Args::try_parse() {
        Ok(args) => args,
        // What could not be parsed may have asked for JSON all the same.
        Err(error) => {
            let json = std::env::args_os().take_while(|a| a != "--").any(|a| a == "--json");
            return complain::usage(&error, json);
        }
    };
    match dispatch(&args) {
        Ok(code) => code,
        Err(error) => complain::error(&error, voice(&args.command), args.json),
    }
}

/// How settings are named: what a campaign says is corrected there.
fn voice(command: &Command) -> Voice {
    match command {
        Command::Run(_) | Command::Compare(_) => Voice::Campaign,
        _ => Voice::Command,
    }
}

fn dispatch(args: &Args) -> Result<u8> {
    let done = match &args.command {
        Command::Info(typed) => return info::run(typed, args.json),
        Command::Convert(typed) => convert::run(typed, args.json),
        Command::Spectrum(typed) => spectrum::run(typed, args.json),
        Command::Excitation(typed) => excitation::run(typed, args.json),
        Command::Waterfall(typed) => waterfall::run(typed, args.json),
        Command::Response(typed) => response::run(typed, args.json),
        Command::Drill(typed) => drill::run(typed, args.json),
        Command::Impacts(typed) => impacts::run(typed, args.json),
        Command::Restitution(typed) => restitution::run(typed, args.json),
        Command::Compare(typed) => compare::run(typed, args.json),
        Command::Modal(typed) => modal::run(typed, args.json),
        Command::Pulse(typed) => pulse::run(typed, args.json),
        Command::Model(typed) => model::run(typed, args.json),
        Command::Precision(typed) => precision::run(typed, args.json),
        Command::Run(typed) => return run::run(typed, args.json),
    };
    done.map(|()| 0)
}
