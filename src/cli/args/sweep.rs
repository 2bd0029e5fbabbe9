//! A stepped-sine sweep, as typed.

/// A sweep, and what its analyser stored.
#[derive(Debug, clap::Args)]
pub struct Sweep {
    /// List file, hand-over file, or campaign.toml#name
    #[arg(value_name = "SWEEP")]
    pub source: String,
    /// Reproduce the thesis' script, mistakes included
    #[arg(long)]
    pub legacy: bool,
    /// Allow names in the list that lead outside its folder
    #[arg(long)]
    pub allow_outside: bool,
    /// Unit of the stored responses [default: what the files say, else the SI unit of the quantity, m where none is stated]
    #[arg(long)]
    pub unit: Option<String>,
    /// Factor on the stored responses
    #[arg(long, allow_negative_numbers = true)]
    pub calibration: Option<f64>,
    /// Window of the analyser: hann, rectangular, hamming, blackman, blackman-harris, flat-top, unknown [default: hann, assumed]
    #[arg(long)]
    pub window: Option<String>,
    /// Scaling of the spectra: peak or rms [default: peak, assumed]
    #[arg(long)]
    pub scaling: Option<String>,
    /// How often the analyser integrated before it stored [default: once for a displacement]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u8).range(0..=2))]
    pub analyser_integrated: Option<u8>,
    /// Lowest frequency looked at, in Hz [default: two lines or a quarter of the lowest excitation]
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    pub fmin: Option<f64>,
}

/// How a response is taken from a spectrum.
#[derive(Debug, clap::Args)]
pub struct Taking {
    /// Integrations in frequency: 1 takes velocity to displacement [default: what takes the stored quantity to displacement]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(i8).range(-2..=2))]
    pub integrate: Option<i8>,
    /// Lines on both sides of the excitation in which the peak is looked for
    #[arg(long, value_name = "LINES", allow_negative_numbers = true, default_value_t = 3, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub band: u16,
}
