//! What this crate's own writer puts into an identification line.

use vibro_record::{Scaling, Window};

/// As it stands there: `scaling rms; window hann; enbw 1.5`.
#[derive(Debug, Default)]
pub struct Stated {
    pub scaling: Option<Scaling>,
    pub window: Option<Window>,
    pub enbw: Option<f64>,
}

impl Stated {
    pub fn of(line: &str) -> Stated {
        let mut stated = Stated::default();
        if !line.starts_with("scaling ") {
            return stated;
        }
        for (key, value) in line.split("; ").filter_map(|part| part.split_once(' ')) {
            match key {
                "scaling" => {
                    stated.scaling = [
                        Scaling::Peak,
                        Scaling::Rms,
                        Scaling::Power,
                        Scaling::Psd,
                        Scaling::Energy,
                        Scaling::Coherence,
                    ]
                    .into_iter()
                    .find(|s| s.name() == value);
                }
                "window" => stated.window = Window::from_name(value),
                "enbw" => stated.enbw = value.parse().ok().filter(|v: &f64| v.is_finite() && *v > 0.0),
                _ => {}
            }
        }
        stated
    }
}
