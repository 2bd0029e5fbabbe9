//! Which record a function type becomes, and how its values are scaled.

use super::codes::{self, Domain};
use super::heading::Heading;
use vibro_record::{AxisKind, Meta, Scaling};

/// Kinds of record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    Trace,
    Spectrum(Scaling),
    Frf,
}

impl Kind {
    /// Kind of record; where function type and abscissa disagree, the abscissa decides.
    pub fn of(heading: &Heading, axis: &AxisKind, stated: Option<Scaling>, meta: &mut Meta) -> Kind {
        let (name, domain) = codes::function(heading.function);
        let complex = heading.layout.complex;
        if *axis == AxisKind::Time || (*axis != AxisKind::Frequency && !complex) {
            let usual = matches!(heading.function, 0 | 1) && matches!(axis, AxisKind::Time | AxisKind::Index);
            if *axis == AxisKind::Time && domain == Domain::Frequency {
                meta.doubt(format!(
                    "The function type says {name}, but the abscissa is time: read as a time trace."
                ));
            } else if !usual {
                meta.doubt(format!("The function type says {name}: read as a trace over its abscissa."));
            }
            return Kind::Trace;
        }
        if let Some(scaling) = stated {
            return Kind::Spectrum(scaling);
        }
        let unknown = |meta: &mut Meta, doubt: String| {
            meta.doubt(doubt);
            Kind::Spectrum(Scaling::Unknown)
        };
        match heading.function {
            4 | 5 if complex => Kind::Frf,
            4 | 5 => unknown(
                meta,
                format!(
                    "A {name} with real values only: whether they are magnitudes or one of two parts is not said, so it is read as a spectrum."
                ),
            ),
            2 | 3 => unknown(
                meta,
                format!(
                    "Whether the lines of this {name} are squared RMS or squared peak values, the format does not say."
                ),
            ),
            12 => unknown(
                meta,
                "Whether the lines of this spectrum are peak or RMS amplitudes, the format does not say."
                    .to_owned(),
            ),
            6 | 21 | 26 => Kind::Spectrum(Scaling::Coherence),
            9 => Kind::Spectrum(Scaling::Psd),
            10 => Kind::Spectrum(Scaling::Energy),
            _ => unknown(
                meta,
                format!(
                    "The function type says {name}: read as a spectrum over its abscissa, its scaling is not known."
                ),
            ),
        }
    }
}
