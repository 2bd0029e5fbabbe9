//! `vibro spectrum`: lines of a channel, or the response of one channel to another.

mod answer;
mod samples;

use super::args::{self, Detrend, Method};
use super::{complain, print, settings};
use crate::error::{Error, Result};
use crate::read::Traces;
use crate::record::{Meta, Record, Scaling, Spectrum, Values, Window};
use crate::report::pictures;
use crate::signal::impact::{Blows, from_blows};
use crate::signal::integrate::in_frequency;
use crate::signal::spectrum;
use crate::signal::transfer::{Estimator, transfer};
use crate::units::Unit;
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
    let mut traces =
        settings::traces(&typed.file, &typed.reading, &typed.channel, typed.reference.as_deref())?;
    let answer = match &typed.reference {
        None => lines(typed, &mut traces, window, scaling, json)?,
        Some(_) => response(typed, &mut traces, window, json)?,
    };
    if json {
        return print::json(&answer);
    }
    complain::warn(&answer.warnings);
    print::text(&answer.text())
}

fn lines(
    typed: &args::Spectrum,
    traces: &mut Traces,
    window: Window,
    scaling: Scaling,
    json: bool,
) -> Result<Answer> {
    let detrend = detrend(typed);
    let (spectrum, averages, mut scatter) = if typed.method == Method::Welch {
        let averages = samples::averages(typed, traces, window, detrend, json)?;
        let meta = traces.channels().first().cloned().unwrap_or_else(|| Meta::new("", Unit::opaque("")));
        let scatter = spectrum::scatter(&averages, scaling);
        (spectrum::averaged(&averages, 0, &meta, window, scaling)?, averages.count, scatter)
    } else {
        let [trace] = samples::whole(traces)?;
        let spectrum = spectrum::plain(&trace, window, scaling, detrend)?;
        let unknown = vec![f64::NAN; spectrum.axis.len()];
        (spectrum, 1, unknown)
    };
    let fmin = fmin(typed, spectrum.axis.step().unwrap_or(0.0));
    let spectrum = in_frequency(&spectrum, typed.integrate, fmin)?;
    scatter.drain(..scatter.len() - spectrum.axis.len());
    let detrend = if detrend { "mean" } else { "none" };
    let mut answer = Answer::lines(&spectrum, averages, &scatter, detrend, traces.doubts());
    answer.left_out(typed.integrate, fmin);
    if let Some(folder) = &typed.out {
        let figure = pictures::spectrum(&spectrum.meta.name, &spectrum);
        answer.write(folder, "spectrum", figure, &[Record::Spectrum(spectrum)])?;
    }
    Ok(answer)
}

fn response(typed: &args::Spectrum, traces: &mut Traces, window: Window, json: bool) -> Result<Answer> {
    let estimator = match typed.estimator {
        args::Estimator::H1 => Estimator::H1,
        args::Estimator::H2 => Estimator::H2,
        args::Estimator::Hv => Estimator::Hv,
    };
    let (found, step, window, detrend, blows) = if typed.hammer {
        let length = typed.segment.unwrap_or(samples::SEGMENT);
        let how = Blows {
            length,
            before: length / samples::BEFORE,
            force_window: typed.force_window,
            left_at_end: typed.left_at_end,
        };
        let [force, response] = samples::whole(traces)?;
        let found = from_blows(&force, &response, &how, estimator)?;
        let window = (found.window, found.enbw);
        (found.transfer, traces.rate() / length as f64, window, "level before the blow", found.blows)
    } else {
        let detrend = detrend(typed);
        let averages = samples::averages(typed, traces, window, detrend, json)?;
        let found = transfer(&averages, 1, traces.channels(), estimator)?;
        let detrend = if detrend { "mean" } else { "none" };
        (found, averages.step(), (window.name(), window.enbw()), detrend, Vec::new())
    };
    let fmin = fmin(typed, step);
    let found = found.integrated(typed.integrate, fmin)?;
    let mut answer = Answer::response(&found, estimator, window, detrend, &blows, traces.doubts());
    answer.left_out(typed.integrate, fmin);
    if let Some(folder) = &typed.out {
        let figure = pictures::transfer(&found.frf.meta.name, &found);
        let coherence = Spectrum {
            meta: Meta::new("coherence", Unit::parse_or_opaque("1")),
            axis: found.frf.axis.clone(),
            values: Values::Real(found.coherence),
            scaling: Scaling::Coherence,
            window: None,
            enbw: None,
        };
        answer.write(folder, "frf", figure, &[Record::Frf(found.frf), Record::Spectrum(coherence)])?;
    }
    Ok(answer)
}

/// Whether the mean is taken out: that of segments, and what would be divided by nothing, unless told otherwise.
fn detrend(typed: &args::Spectrum) -> bool {
    typed.detrend.map_or(typed.method == Method::Welch || typed.integrate > 0, |d| d == Detrend::Mean)
}

fn scaling(name: &str) -> Result<Scaling> {
    let all = [Scaling::Peak, Scaling::Rms, Scaling::Power, Scaling::Psd];
    all.into_iter()
        .find(|s| s.name().eq_ignore_ascii_case(name))
        .ok_or_else(|| Error::usage(format!("--scaling {name:?} is not known"), "peak, rms, power or psd"))
}

/// The lowest frequency: two lines where an integral divides noise by the frequency.
fn fmin(typed: &args::Spectrum, step: f64) -> f64 {
    typed.fmin.unwrap_or(if typed.integrate > 0 { 2.0 * step } else { 0.0 })
}
