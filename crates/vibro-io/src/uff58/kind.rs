//! Which record a function type becomes, and how its values are scaled.

use super::codes::{self, Domain};
use super::heading::Heading;
use vibro_record::{AxisKind, Finding, Meta, Scaling};

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
                meta.found(Finding::caution("function-over-time").name("function", name));
            } else if !usual {
                meta.found(Finding::caution("function-as-trace").name("function", name));
            }
            return Kind::Trace;
        }
        if let Some(scaling) = stated {
            return Kind::Spectrum(scaling);
        }
        let unknown = |meta: &mut Meta, found: Finding| {
            meta.found(found.name("function", name.as_str()));
            Kind::Spectrum(Scaling::Unknown)
        };
        match heading.function {
            4 | 5 if complex => Kind::Frf,
            4 | 5 => unknown(meta, Finding::caution("function-real-only")),
            2 | 3 => unknown(meta, Finding::caution("scaling-unsaid-squared")),
            12 => unknown(meta, Finding::caution("scaling-unsaid")),
            6 | 21 | 26 => Kind::Spectrum(Scaling::Coherence),
            9 => Kind::Spectrum(Scaling::Psd),
            10 => Kind::Spectrum(Scaling::Energy),
            _ => unknown(meta, Finding::caution("function-as-spectrum")),
        }
    }
}
