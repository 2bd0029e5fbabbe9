//! One record of a recording, as a person names it.

use super::{Reader, Recording};
use std::path::Path;
use vibro_record::{Error, Finding, Frf, FrfKind, Place, Record, Result, Scaling, Trace, Traces, Values};

impl Reader {
    /// One channel to be read block by block, behind the channel `reference` where there is one; a `calibration` multiplies it. Where
    /// none is named it is the only one, or the only other one.
    ///
    /// # Errors
    /// As [`Reader::stream_channels`]; if there are several channels and none was named.
    pub fn stream_chosen(
        &self,
        file: impl AsRef<Path>,
        reference: Option<&str>,
        channel: Option<&str>,
        calibration: Option<f64>,
    ) -> Result<Traces> {
        let file = file.as_ref();
        let mut traces = if let Some(channel) = channel {
            let named: Vec<&str> = reference.into_iter().chain([channel]).collect();
            let found = self.stream_channels(file, &named)?;
            if found.channels().len() < named.len() {
                return Err(Error::usage(
                    format!("the channel {channel:?} is its own reference"),
                    "two different channels",
                ));
            }
            found
        } else {
            let mut all = self.stream(file)?;
            let reference = reference.map(|name| all.channel(name)).transpose()?;
            let others: Vec<usize> = (0..all.channels().len()).filter(|i| Some(*i) != reference).collect();
            if others.len() != 1 {
                let names: Vec<&str> = all.channels().iter().map(|m| m.name.as_str()).collect();
                let found = format!("{} channels to choose from, and none was chosen", others.len());
                return Err(Error::input(Place::file(file), found, names.join(", "))
                    .hint("name one, by its name or its number from 1")
                    .setting("channel"));
            }
            all.keep(&reference.into_iter().chain(others).collect::<Vec<usize>>());
            all
        };
        if let Some(factor) = calibration {
            traces.calibrate(usize::from(reference.is_some()), factor)?;
        }
        Ok(traces)
    }
}

impl Recording {
    /// The trace that `channel` names, or by its number among the traces from 1; the only one where it is `None`. A
    /// `calibration` multiplies the values.
    ///
    /// ```
    /// use vibro_io::Reader;
    /// let text = "time [s],force [N],velocity [mm/s]\n0,1,2\n0.1,3,4\n0.2,5,6\n";
    /// let recording = Reader::new().from_reader("bench.csv", text.as_bytes())?;
    /// assert_eq!(recording.trace(Some("velocity"), None)?.values[1], 4e-3);
    /// assert_eq!(recording.trace(Some("1"), Some(10.0))?.values[1], 30.0);
    /// assert!(recording.trace(None, None).unwrap_err().to_string().contains("force, velocity"));
    /// # Ok::<(), vibro_record::Error>(())
    /// ```
    ///
    /// # Errors
    /// If there is no such trace, or several and none was named; if a calibration is not a number other than 0, or is given
    /// for fractions of full scale without a unit.
    pub fn trace(&self, channel: Option<&str>, calibration: Option<f64>) -> Result<Trace> {
        let traces: Vec<&Trace> = self
            .records
            .iter()
            .filter_map(|r| if let Record::Trace(t) = r { Some(t) } else { None })
            .collect();
        let names: Vec<&str> = traces.iter().map(|t| t.meta.name.as_str()).collect();
        let mut trace = traces[self.choose("trace", &names, channel)?].clone();
        if let Some(factor) = calibration {
            if trace.meta.has(Trace::UNCALIBRATED) {
                let found = format!("a calibration of {factor} without a unit");
                return Err(Error::usage(found, "the unit, too").setting("unit"));
            }
            let unit = trace.meta.unit.clone();
            trace.calibrate(factor, &unit)?;
        }
        Ok(trace)
    }

    /// The frequency response function that `channel` names, as [`Recording::trace`] does. A complex spectrum whose scaling
    /// is not stated is taken for one, with a finding.
    ///
    /// # Errors
    /// If there is no such function, or several and none was named; if it is a spectrum of amplitudes or powers.
    pub fn frf(&self, channel: Option<&str>) -> Result<Frf> {
        let frfs: Vec<(Frf, Option<Scaling>)> = self.records.iter().filter_map(as_frf).collect();
        let names: Vec<&str> = frfs.iter().map(|(f, _)| f.meta.name.as_str()).collect();
        let (mut frf, scaling) = frfs[self.choose("frequency response function", &names, channel)?].clone();
        match scaling {
            None => {}
            Some(Scaling::Unknown) => frf.meta.found(Finding::caution("spectrum-taken-for-frf")),
            Some(scaling) => {
                return Err(Error::input(
                    Place::file(&self.path),
                    format!("{:?} is a complex spectrum scaled as {}", frf.meta.name, scaling.name()),
                    "a frequency response function: response per force",
                )
                .hint("export the frequency response function (H1 or H2), not the spectrum of one channel"));
            }
        }
        Ok(frf)
    }

    fn choose(&self, kind: &str, names: &[&str], channel: Option<&str>) -> Result<usize> {
        let refuse = |found: String, expected: String| {
            let hint = "name one, by its name or its number from 1; `vibro info` lists all";
            Err(Error::input(Place::file(&self.path), found, expected).hint(hint).setting("channel"))
        };
        match (channel, names) {
            (_, []) => Err(Error::input(
                Place::file(&self.path),
                format!("no {kind}"),
                format!("a file that holds a {kind}"),
            )
            .hint("`vibro info` lists what is in the file; samples over time need a sampling rate")
            .setting("rate")),
            (None, [_]) => Ok(0),
            (None, _) => refuse(
                format!("{} records of kind {kind}, and none was chosen", names.len()),
                names.join(", "),
            ),
            (Some(name), _) => {
                let number =
                    || name.parse::<usize>().ok().filter(|n| (1..=names.len()).contains(n)).map(|n| n - 1);
                match (names.iter().filter(|n| **n == name).count(), number()) {
                    (1, _) => Ok(names.iter().position(|n| *n == name).unwrap_or(0)),
                    (0, Some(index)) => Ok(index),
                    (0, None) => refuse(format!("no {kind} is named {name:?}"), names.join(", ")),
                    (many, _) => refuse(
                        format!("{many} records of kind {kind} are named {name:?}"),
                        format!("a number from 1 to {}", names.len()),
                    ),
                }
            }
        }
    }
}

/// A function, and the scaling of the spectrum that it is made of, if it is.
fn as_frf(record: &Record) -> Option<(Frf, Option<Scaling>)> {
    match record {
        Record::Frf(frf) => Some((frf.clone(), None)),
        Record::Spectrum(s) => match &s.values {
            Values::Complex(values) => {
                let kind = FrfKind::of(s.meta.quantity);
                let (meta, axis, values) = (s.meta.clone(), s.axis.clone(), values.clone());
                Some((Frf { meta, axis, values, kind }, Some(s.scaling)))
            }
            Values::Real(_) => None,
        },
        Record::Trace(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use crate::Reader;

    #[test]
    fn a_complex_spectrum_is_taken_for_a_function_only_where_nothing_says_otherwise() {
        let of = |preamble: &str| {
            let text = format!("{preamble}f [Hz],X_re [m/s],X_im [m/s]\n0,1,2\n1,3,4\n2,5,6\n");
            Reader::new().from_reader("x.csv", text.as_bytes()).unwrap().frf(None)
        };
        let frf = of("").unwrap();
        assert!(frf.meta.has("spectrum-taken-for-frf"), "{:?}", frf.meta.findings);
        for scaling in ["peak", "rms", "psd"] {
            let error = of(&format!("# scaling: {scaling}\n")).unwrap_err().to_string();
            assert!(error.contains("\"X\" is a complex spectrum scaled as"), "{scaling}: {error}");
        }
    }
}
