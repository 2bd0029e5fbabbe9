use super::*;
use crate::excitation::Sine;
use crate::orbit::orbits;
use crate::periodic::PeriodicOrbit;
use crate::regime;

fn plan(n: usize) -> Plan {
    Plan {
        rig: Rig::thesis(),
        excitation: Sine { force: 0.5, frequency: 11.0 }.into(),
        x: MapAxis { key: Parameter::Frequency, low: 4.0, high: 14.0, n },
        y: MapAxis { key: Parameter::Restitution, low: 0.3, high: 0.95, n },
        cycles: 200,
    }
}

#[test]
fn cells_are_the_simulation_and_the_orbit() {
    let plan = plan(7);
    plan.check().unwrap();
    let mut settled = 0;
    for (row, column) in (0..7).flat_map(|row| (0..7).map(move |column| (row, column))) {
        let (rig, excitation) = plan.at(column, row);
        let Excitation::Sine(sine) = excitation else { panic!("{excitation:?}") };
        let cell = plan.cell((7 * row + column) as u64);
        let mut motion = Simulation::new(&rig, &sine).unwrap();
        let Ok(long) = regime(&mut motion, 4000, 200) else { continue };
        if let (true, Regime::Periodic { cycles, .. }) = (long.settled, long.regime) {
            // A motion settled after 4000 cycles may not be settled after 200; but a pattern that is named
            // must be right.
            if cell.regime != Some(Regime::Irregular) {
                assert_eq!(cell.regime, Some(long.regime), "{rig:?} {sine:?}");
                let orbit = PeriodicOrbit::from_strikes(&rig, &sine, cycles, &long.strikes).unwrap();
                let (found, exact) = (cell.spectral_radius.unwrap(), orbit.spectral_radius().unwrap());
                // The radius is that of the pattern's periodic orbit or, if this orbit is not found, of
                // states within 1e-6 of it.
                assert!((found / exact - 1.0).abs() < 1e-3, "{found} {exact} {rig:?} {sine:?}");
                settled += 1;
            }
        }
    }
    assert!(settled > 20, "{settled}");
}

#[test]
fn one_settled_cell_has_the_radius_of_the_closed_form() {
    let (rig, sine) = (Rig { restitution: 0.5, ..Rig::thesis() }, Sine { force: 0.5, frequency: 10.0 });
    let cell = cell(&rig, &sine.into(), 400);
    let orbit = orbits(&rig, sine.force, sine.frequency).unwrap().orbits.remove(0);
    assert_eq!(cell.regime, Some(Regime::Periodic { impacts: 1, cycles: 1 }));
    // Both are the radius of the same periodic orbit; the tolerance also allows for a state within 1e-6 of
    // it.
    assert!((cell.spectral_radius.unwrap() - orbit.spectral_radius().unwrap()).abs() < 1e-4);
    // Without impacts: e^{−bT} of the more lightly damped mass.
    let quiet = super::cell(&rig, &Sine { force: 0.001, frequency: 12.0 }.into(), 40);
    assert_eq!(quiet.regime, Some(Regime::NoImpact));
    assert!((quiet.spectral_radius.unwrap() - (-0.1_f64 / 0.25 / 12.0).exp()).abs() < 1e-15);
}

#[test]
fn impossible_maps_are_refused() {
    for text in
        ["gap", "gap:1:2", "gap:2:1:5", "gap:0:1:1", "mass:0:1:5", "gap:0:inf:5", "gap:0:1:5:6", "gap:0:x:5"]
    {
        assert!(text.parse::<MapAxis>().is_err(), "{text}");
    }
    let good = plan(4);
    let axis = |text: &str| text.parse::<MapAxis>().unwrap();
    for (plan, word) in [
        (Plan { y: axis("frequency:1:2:3"), ..good.clone() }, "both axes"),
        (Plan { x: axis("frequency:0:2:3"), ..good.clone() }, "frequency is 0"),
        (
            Plan { x: axis("restitution:0.5:1.5:3"), y: axis("gap:0:1:3"), ..good.clone() },
            "restitution is 1.5",
        ),
        (Plan { y: axis("gap:-1:1:3"), ..good.clone() }, "gap is -1"),
        (Plan { y: axis("m1:-1:1:3"), ..good.clone() }, "m1 is -1"),
        (Plan { y: axis("impulse:0.1:1:3"), ..good.clone() }, "kind sine"),
        (Plan { cycles: 0, ..good.clone() }, "0 cycles"),
    ] {
        let text = plan.check().unwrap_err().to_string();
        assert!(text.contains(word), "{text}");
    }
    // What one command does not compute is still a map, in parts.
    let long = Plan { cycles: 1_000_000_000, ..good.clone() };
    long.check().unwrap();
    assert!(long.check_work().unwrap_err().to_string().contains("more than"));
    let (x, y) = (axis("frequency:1:2:1000000"), axis("gap:0:1:1000000"));
    assert!(Plan { x, y, ..good }.check().unwrap_err().to_string().contains("1.0e12 cells"));
}
