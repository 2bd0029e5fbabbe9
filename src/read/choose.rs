//! One record of a recording, as a person names it.

use super::Recording;
use crate::error::{Error, Place, Result};
use crate::record::{Frf, FrfKind, Record, Trace, Values};

impl Recording {
    /// The trace that `channel` names, or by its number among the traces from 1; the only one where it is `None`. A
    /// `calibration` multiplies the values.
    ///
    /// ```
    /// use vibroimpact::read::Reader;
    /// let text = "time [s],force [N],velocity [mm/s]\n0,1,2\n0.1,3,4\n0.2,5,6\n";
    /// let recording = Reader::new().from_reader("bench.csv", text.as_bytes())?;
    /// assert_eq!(recording.trace(Some("velocity"), None)?.values[1], 4e-3);
    /// assert_eq!(recording.trace(Some("1"), Some(10.0))?.values[1], 30.0);
    /// assert!(recording.trace(None, None).unwrap_err().to_string().contains("force, velocity"));
    /// # Ok::<(), vibroimpact::Error>(())
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
            if trace.meta.doubts.iter().any(|d| d == Trace::UNCALIBRATED) {
                let found = format!("a calibration of {factor} without a unit");
                return Err(Error::usage(found, "the unit, too: --unit, or unit = \"…\" in a campaign"));
            }
            let unit = trace.meta.unit.clone();
            trace.calibrate(factor, &unit)?;
        }
        Ok(trace)
    }

    /// The frequency response function that `channel` names, as [`Recording::trace`] does. A complex spectrum is taken for
    /// one.
    ///
    /// # Errors
    /// If there is no such function, or several and none was named.
    pub fn frf(&self, channel: Option<&str>) -> Result<Frf> {
        let frfs: Vec<Frf> = self.records.iter().filter_map(as_frf).collect();
        let names: Vec<&str> = frfs.iter().map(|f| f.meta.name.as_str()).collect();
        Ok(frfs[self.choose("frequency response function", &names, channel)?].clone())
    }

    fn choose(&self, kind: &str, names: &[&str], channel: Option<&str>) -> Result<usize> {
        let refuse = |found: String, expected: String| {
            let hint = "name one with --channel, or channel = \"…\" in a campaign; `vibro info` lists all";
            Err(Error::input(Place::file(&self.path), found, expected).hint(hint))
        };
        match (channel, names) {
            (_, []) => Err(Error::input(
                Place::file(&self.path),
                format!("no {kind}"),
                format!("a file that holds a {kind}"),
            )
            .hint("`vibro info` lists what is in the file; samples over time need --rate where the file does not say it")),
            (None, [_]) => Ok(0),
            (None, _) => refuse(format!("{} records of kind {kind}, and none was chosen", names.len()), names.join(", ")),
            (Some(name), _) => {
                let number = || name.parse::<usize>().ok().filter(|n| (1..=names.len()).contains(n)).map(|n| n - 1);
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

fn as_frf(record: &Record) -> Option<Frf> {
    match record {
        Record::Frf(frf) => Some(frf.clone()),
        Record::Spectrum(s) => match &s.values {
            Values::Complex(values) => Some(Frf {
                meta: s.meta.clone(),
                axis: s.axis.clone(),
                values: values.clone(),
                kind: FrfKind::of(s.meta.quantity),
            }),
            Values::Real(_) => None,
        },
        Record::Trace(_) => None,
    }
}
