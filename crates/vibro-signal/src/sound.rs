//! Checks of samples before a transform or a filter.

use vibro_record::{Error, Result};

/// Refuses missing samples of a channel, which would spread over all of the result; `values` begins `before`
/// samples after the start of the channel.
pub(crate) fn no_gaps(values: &[f64], channel: &str, before: usize) -> Result<()> {
    let Some(place) = values.iter().position(|v| !v.is_finite()) else { return Ok(()) };
    let at = before + place;
    let why =
        format!("sample {at} of channel {channel:?} is missing: it would spread over all of the result");
    Err(Error::refused(why)
        .hint(if at == 0 { "read the part behind the gap" } else { "read a part without a gap" })
        .setting("span"))
}

/// The error of a constant channel, which has no spectrum.
pub(crate) fn constant(channel: &str, value: f64) -> Error {
    Error::refused(format!("channel {channel:?} is constant at {value}: it has no spectrum"))
        .hint("check the sensor, its cable and the range of the input")
}
