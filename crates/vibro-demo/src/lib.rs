//! Example campaigns with their recordings. They are the same every time: the noise has fixed seeds, and
//! nothing depends on the clock. Exception: at one step of the sweeps the rig moves irregularly, so that
//! the rounding of `sin`, hence the compiler, changes the recording.
//!
//! ```
//! let demo = vibro_demo::DEMOS.iter().find(|demo| demo.name == "bench").unwrap();
//! let mut names = Vec::new();
//! demo.make(&mut |name, _| {
//!     names.push(name.to_owned());
//!     Ok(())
//! })?;
//! assert!(names.contains(&"campaign.toml".to_owned()));
//! # Ok::<(), vibro_record::Error>(())
//! ```

mod bench;
pub mod drop_test;
mod hammer_drill;
mod noise;
mod two_mass_rig;

use vibro_record::Result;

/// Receives a file: its path in the folder of the example, and its bytes.
pub type Sink<'a> = dyn FnMut(&str, &[u8]) -> Result<()> + 'a;

/// An example campaign.
#[derive(Debug, Clone, Copy)]
pub struct Demo {
    /// Name of its folder.
    pub name: &'static str,
    /// Description in one line.
    pub about: &'static str,
    campaign: &'static str,
    recordings: fn(&mut Sink<'_>) -> Result<()>,
}

/// All examples.
pub const DEMOS: [Demo; 4] = [
    Demo {
        name: "two_mass_rig",
        about: "stepped sweeps of two masses striking each other, against the model (240 spectra)",
        campaign: include_str!("campaigns/two_mass_rig.toml"),
        recordings: two_mass_rig::recordings,
    },
    Demo {
        name: "bench",
        about: "a mass on a spring, shaken and let go, and a contact pulse",
        campaign: include_str!("campaigns/bench.toml"),
        recordings: bench::recordings,
    },
    Demo {
        name: "drop_test",
        about: "a ball that drops and bounces, and a contact circuit",
        campaign: include_str!("campaigns/drop_test.toml"),
        recordings: drop_test::recordings,
    },
    Demo {
        name: "hammer_drill",
        about: "a hammer drill under a laser vibrometer (25 MB)",
        campaign: include_str!("campaigns/hammer_drill.toml"),
        recordings: hammer_drill::recordings,
    },
];

impl Demo {
    /// Writes the files of the example. The campaign comes first, so that an obstacle shows before anything
    /// is computed.
    ///
    /// # Errors
    /// Those of `sink`.
    pub fn make(&self, sink: &mut Sink<'_>) -> Result<()> {
        sink("campaign.toml", self.campaign.as_bytes())?;
        (self.recordings)(sink)
    }
}
