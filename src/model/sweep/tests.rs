use super::*;
use crate::model::{Rig, Simulation, Sine, orbits};
use std::time::Instant;

/// The thesis' contact: c₃ = 0.1 N s/m on k₃ = 1e5 N/m, so ζ = c₃/2√(k₃M) and R = exp(−ζ(π − 2 asin ζ)/√(1 − ζ²)).
fn thesis() -> Rig {
    let rig = Rig::thesis();
    let zeta = 0.1 / (2.0 * (1e5 * rig.reduced_mass()).sqrt());
    let angle = std::f64::consts::PI - 2.0 * zeta.asin();
    Rig { restitution: (-zeta * angle / (1.0 - zeta * zeta).sqrt()).exp(), ..rig }
}

fn highest(points: &[Point], from: f64, to: f64) -> Point {
    let inside = points.iter().filter(|p| (from..=to).contains(&p.frequency));
    *inside.max_by(|a, b| a.x1.total_cmp(&b.x1)).unwrap()
}

#[test]
fn probe() {
    let plan = Plan {
        from: 3.0,
        to: 14.0,
        pace: Pace::Rate { rate: 0.02, points: 2200 },
        observable: Observable::Rms,
    };
    let motion = Simulation::new(&thesis(), &Sine { force: 0.1, frequency: 3.0 }).unwrap();
    let start = Instant::now();
    let swept = both(&plan, &motion, 0.1, &[Direction::Up, Direction::Down]).unwrap();
    println!("{:?}", start.elapsed());
    for (name, points) in [("up", &swept.up), ("down", &swept.down)] {
        let step = points.len() / 200;
        for p in points.iter().step_by(step) {
            println!("{name} {:.3} {:.3e} {:.3e} {:.1e}", p.frequency, p.x1, p.x2, p.x1_scatter);
        }
        for (a, b) in [(3.0, 8.0), (8.0, 14.0)] {
            let p = highest(points, a, b);
            println!("{name} top {:.3} {:.3e}", p.frequency, p.x1);
        }
    }
    let (r, j) = named(&swept);
    for r in r {
        println!(
            "{} {:?} {:.3} {:.2e} {}",
            r.mass, r.direction, r.found.frequency, r.found.amplitude, r.found.kind
        );
    }
    for r in j {
        println!(
            "{} {:?} {:.3} {:.2e} {}",
            r.mass, r.direction, r.found.frequency, r.found.amplitude_after, r.found.change
        );
    }
}
