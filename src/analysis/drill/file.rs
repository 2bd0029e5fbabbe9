//! Channels of a file, read block by block.

use crate::measure::drill::{Channels, Cycle, Drill, DrillOptions, drill_each, still};
use std::path::{Path, PathBuf};
use vibro_io::Reader;
use vibro_record::units::Quantity;
use vibro_record::{Error, Finding, Meta, Place, Result, Trace};

/// A file with the channels of a drill, by name or number from 1.
#[derive(Debug, Clone)]
pub struct DrillFile {
    /// Knows what the file does not say. Missing values are taken: they are drop-outs.
    pub reader: Reader,
    /// File.
    pub path: PathBuf,
    /// Velocity along the beam.
    pub velocity: String,
    /// Pulses of the crank.
    pub reference: String,
    /// Acceleration of a handle, one to three axes; empty for none.
    pub handle: Vec<String>,
    /// Acceleration in m/s² for one unit of these channels, where they are not accelerations already.
    pub handle_sensitivity: Option<f64>,
    /// A record of the velocity channel without motion.
    pub noise: Option<PathBuf>,
}

/// A file, and what its channels are.
struct Played<'a> {
    reader: Reader,
    path: &'a Path,
    names: Vec<&'a str>,
    metas: Vec<Meta>,
    findings: Vec<Finding>,
    rate: f64,
    factors: Vec<f64>,
    /// Hears how many samples were read, of all passes.
    progress: &'a dyn Fn(usize, usize),
    done: usize,
    all: usize,
}

/// Times that [`crate::measure::drill::drill`] reads a record.
const PASSES: usize = 3;

impl DrillFile {
    /// Opens the file once to learn its rate, and measures. `sensitivity` may stay NaN in the options where the velocity
    /// channel is a velocity already. `progress` hears after every block how many samples were read, of how many: each is read
    /// three times.
    ///
    /// # Errors
    /// As [`crate::measure::drill::drill`]; if a file cannot be read, a channel does not exist or is named twice, or has another rate; if a channel
    /// that is no acceleration is given as a handle's without its sensitivity.
    pub fn measure(&self, options: &DrillOptions, progress: &dyn Fn(usize, usize)) -> Result<Drill> {
        self.measure_each(options, progress, &mut |_| Ok(()))
    }

    /// As [`DrillFile::measure`], and hands out each turn of the average, resampled, as it comes.
    ///
    /// # Errors
    /// As [`DrillFile::measure`], and if `each` fails.
    pub(crate) fn measure_each(
        &self,
        options: &DrillOptions,
        progress: &dyn Fn(usize, usize),
        each: &mut dyn FnMut(&Cycle<'_>) -> Result<()>,
    ) -> Result<Drill> {
        let mut names = vec![self.velocity.as_str(), self.reference.as_str()];
        names.extend(self.handle.iter().map(String::as_str));
        let mut findings = Vec::new();
        let mut channels = self.open(&self.path, names, progress)?;
        let mut options = options.clone();
        let is = |i: usize, quantity| channels.metas.get(i).is_some_and(|m: &Meta| m.quantity == quantity);
        match (is(0, Quantity::Velocity), options.sensitivity.is_nan()) {
            (true, true) => options.sensitivity = 1.0,
            (true, false) if options.sensitivity != 1.0 => findings.push(
                Finding::doubt("drill-velocity-scaled-twice").number("sensitivity", options.sensitivity),
            ),
            (false, true) => {
                return Err(Error::usage(
                    "no sensitivity",
                    "the sensitivity in m/s for one unit of the velocity channel",
                )
                .setting("sensitivity"));
            }
            _ => {}
        }
        if let Some((_, meta)) =
            channels.metas.iter().enumerate().skip(2).find(|(i, _)| !is(*i, Quantity::Acceleration))
            && self.handle_sensitivity.is_none()
        {
            let found = format!("the handle channel {:?} in {}", meta.name, meta.unit);
            let expected = "an acceleration, or the sensitivity of the handle in m/s² a unit";
            return Err(Error::input(Place::file(&self.path), found, expected).setting("handle_sensitivity"));
        }
        if let Some(factor) = self.handle_sensitivity {
            channels.factors.iter_mut().skip(2).for_each(|f| *f = factor);
        }
        let noise = match &self.noise {
            None => None,
            Some(path) => {
                let mut silent = self.open(path, vec![self.velocity.as_str()], &|_, _| ())?;
                if (silent.rate - channels.rate).abs() > 1e-9 * channels.rate {
                    let found =
                        format!("{} Hz, but the motion was sampled at {} Hz", silent.rate, channels.rate);
                    return Err(Error::input(Place::file(path), found, "a record of the same rate"));
                }
                Some(still(&mut silent, &options)?)
            }
        };
        let mut found = drill_each(&mut channels, &options, noise.as_ref(), each)?;
        findings.append(&mut channels.findings);
        findings.append(&mut found.findings);
        found.findings = findings;
        Ok(found)
    }

    fn open<'a>(
        &self,
        path: &'a Path,
        names: Vec<&'a str>,
        progress: &'a dyn Fn(usize, usize),
    ) -> Result<Played<'a>> {
        for (i, name) in names.iter().enumerate() {
            if names[..i].contains(name) {
                return Err(Error::refused(format!("the channel {name:?} is named twice"))
                    .hint("velocity, reference and handle are different channels; `vibro info` lists them")
                    .setting("velocity")
                    .setting("reference"));
            }
        }
        let reader = self.reader.clone().allow_missing(true);
        let traces = reader.stream_channels(path, &names)?;
        if traces.channels().len() != names.len() {
            return Err(Error::refused(format!("two of the channels {} are one", names.join(", "))));
        }
        let (rate, factors) = (traces.rate(), vec![1.0; names.len()]);
        let (metas, all) = (traces.channels().to_vec(), PASSES * traces.frames());
        Ok(Played { reader, path, names, metas, findings: Vec::new(), rate, factors, progress, done: 0, all })
    }
}

impl Channels for Played<'_> {
    fn rate(&self) -> f64 {
        self.rate
    }

    fn play(&mut self, each: &mut dyn FnMut(&[&[f64]]) -> Result<()>) -> Result<()> {
        let mut traces = self.reader.stream_channels(self.path, &self.names)?;
        let mut block = Vec::new();
        loop {
            let n = traces.next_block(&mut block)?;
            if n == 0 {
                break;
            }
            for (values, factor) in block.iter_mut().zip(&self.factors).filter(|(_, f)| **f != 1.0) {
                for v in values.iter_mut() {
                    *v *= factor;
                }
            }
            let slices: Vec<&[f64]> = block.iter().map(Vec::as_slice).collect();
            each(&slices)?;
            self.done += n;
            (self.progress)(self.done, self.all);
        }
        // What only the values show is known now. Sensitivities are stated: that a file knows none is no finding.
        self.findings = traces.findings();
        self.findings.retain(|found| found.code != Trace::UNCALIBRATED);
        Ok(())
    }
}
