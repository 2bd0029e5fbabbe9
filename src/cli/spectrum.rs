//! `vibro spectrum`: lines of a channel, or the response of one channel to another.

mod answer;

use super::args::{self, Detrend, Method};
use super::{complain, print, progress, settings};
use crate::error::{Error, Result};
use crate::measure::spectral::{self, SpectralOptions};
use crate::record::Scaling;
use crate::report::words::{self, Voice};
use crate::report::{Output, files, pictures};
use crate::signal::transfer::Estimator;
use answer::Answer;

pub fn run(typed: &args::Spectrum, json: bool) -> Result<()> {
    let window = settings::window(&typed.window)?
        .ok_or_else(|| Error::usage("--window unknown", "the window that is to be applied"))?;
    let scaling = scaling(&typed.scaling)?;
    settings::above_zero("--fmin", typed.fmin)?;
    if typed.method == Method::Fft {
        let ignored = [
            (typed.segment.is_some(), "--segment"),
            (typed.overlap.is_some(), "--overlap"),
            (typed.reference.is_some(), "--reference"),
        ];
        if let Some((_, option)) = ignored.iter().find(|(given, _)| *given) {
            return Err(Error::usage(
                format!("{option} with --method fft"),
                "--method welch, or the whole record of one channel",
            ));
        }
    }
    if typed.tones.is_some() && (typed.method == Method::Welch || typed.integrate != 0) {
        let with = if typed.integrate == 0 { "--method welch" } else { "--integrate" };
        return Err(Error::usage(
            format!("--tones with {with}"),
            "tones of the whole record of one channel as it is",
        ));
    }
    let options = SpectralOptions {
        method: (!typed.hammer).then_some(match typed.method {
            Method::Fft => spectral::Method::Fft,
            Method::Welch => spectral::Method::Welch,
        }),
        segment: typed.segment,
        overlap: typed.overlap,
        detrend: typed.detrend.map(|d| d == Detrend::Mean),
        window: (!typed.hammer).then_some(window),
        scaling: typed.reference.is_none().then_some(scaling),
        integrate: typed.integrate,
        fmin: typed.fmin,
        estimator: typed.reference.as_ref().map(|_| match typed.estimator {
            args::Estimator::H1 => Estimator::H1,
            args::Estimator::H2 => Estimator::H2,
            args::Estimator::Hv => Estimator::Hv,
        }),
        hammer: typed.hammer,
        force_window: typed.force_window,
        left_at_end: typed.left_at_end,
        delay: typed.delay,
        decibel: typed.decibel,
        tones: typed.tones.map(usize::from),
    };
    let mut traces =
        settings::traces(&typed.file, &typed.reading, &typed.channel, typed.reference.as_deref())?;
    let bar = progress::bar(json);
    bar.set_length(traces.frames() as u64);
    bar.set_message("samples");
    let found = spectral::spectral(&mut traces, &options, |frames| bar.set_position(frames as u64));
    // Before a complaint, too.
    bar.finish_and_clear();
    let mut answer = Answer { result: found?, files: Vec::new() };
    if let Some(folder) = &typed.out {
        let name = if typed.reference.is_some() { "frf" } else { "spectrum" };
        let mut output = Output::new(folder)?;
        let figure = pictures::lines(&answer.result.name, &answer.result);
        files::figures(&mut output, &[(name.to_owned(), figure)], &|| ())?;
        answer.result.warnings.extend(files::records(&mut output, name, &answer.result.records())?);
        answer.files = output.written().to_vec();
    }
    if json {
        return print::json(&answer);
    }
    complain::warn(&words::sentences(&answer.result.findings, Voice::Command));
    complain::warn(&answer.result.warnings);
    print::text(&answer.text())
}

fn scaling(name: &str) -> Result<Scaling> {
    let all = [Scaling::Peak, Scaling::Rms, Scaling::Power, Scaling::Psd];
    all.into_iter()
        .find(|s| s.name().eq_ignore_ascii_case(name))
        .ok_or_else(|| Error::usage(format!("--scaling {name:?} is not known"), "peak, rms, power or psd"))
}
