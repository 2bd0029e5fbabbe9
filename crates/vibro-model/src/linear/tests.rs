use super::*;
use crate::excitation::Sine;
use crate::rig::Rig;
use crate::steady::Steady;

/// Product of two 5×5 matrices.
fn product(p: &[[f64; 5]; 5], q: &[[f64; 5]; 5]) -> [[f64; 5]; 5] {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..5).map(|k| p[i][k] * q[k][j]).sum()))
}

/// Slow reference: exp(At) − I for the state and a constant 1, from t/2³⁰ by 30 squarings as 2E + E².
fn exponential(mode: &Linear, t: f64) -> [[f64; 5]; 5] {
    let h = t / f64::powi(2.0, 30);
    let mut a = [[0.0; 5]; 5];
    a[0][1] = h;
    a[2][3] = h;
    for i in 0..2 {
        for (cell, weight) in a[2 * i + 1].iter_mut().zip(mode.matrix[i]) {
            *cell = h * weight;
        }
        a[2 * i + 1][4] = h * mode.constant[i];
    }
    let (a2, mut e) = (product(&a, &a), [[0.0; 5]; 5]);
    for i in 0..5 {
        for j in 0..5 {
            e[i][j] = a[i][j] + a2[i][j] / 2.0;
        }
    }
    for _ in 0..30 {
        let square = product(&e, &e);
        for i in 0..5 {
            for j in 0..5 {
                e[i][j] = 2.0 * e[i][j] + square[i][j];
            }
        }
    }
    e
}

fn fly_far(mode: &Linear, start: State, t: f64) -> State {
    let pieces = (t * mode.rate).ceil();
    let mut state = start;
    for _ in 0..pieces as usize {
        let piece = mode.fly(&state, &[0.0; ORDER + 1], t / pieces);
        state = piece.state(piece.duration);
    }
    state
}

#[test]
fn a_mode_is_the_matrix_exponential_at_any_damping() {
    // Mass 1 alone and both coupled by a contact; damping from none through critical to far above.
    for (k3, coupling) in [(0.0, 0.0), (1e5, 0.3), (1e5, 2.0)] {
        for c in [0.0, 0.1, 2.0 * f64::sqrt(135.0 * 0.125), 40.0] {
            let c3 = coupling * f64::sqrt(k3 * 0.0537);
            let (m1, m2) = (0.125, 0.094);
            let mode = Linear::new(
                [
                    [-(135.0 + k3) / m1, -(c + c3) / m1, k3 / m1, c3 / m1],
                    [k3 / m2, c3 / m2, -(128.0 + k3) / m2, -(0.1 + c3) / m2],
                ],
                [2.0, -3.0],
                [1.0 / m1, 0.0],
            );
            let start = State { x1: 2e-3, v1: -0.3, x2: -1e-3, v2: 0.2 };
            for turns in [0.3, 1.0, 7.0] {
                let t = turns / mode.rate;
                let e = exponential(&mode, t);
                let y = [start.x1, start.v1, start.x2, start.v2, 1.0];
                let expected: [f64; 4] =
                    std::array::from_fn(|i| y[i] + (0..5).map(|j| e[i][j] * y[j]).sum::<f64>());
                let found = fly_far(&mode, start, t);
                // The size of the motion in the norm max(s|x|, |v|), at most 0.5 m/s + s·3 mm, times the
                // rounding of the reference: 30 squarings with a few roundings each.
                let s = mode.rate;
                let size = (0.5 + 3e-3 * s) * f64::max(1.0, turns);
                let tolerance = 200.0 * f64::EPSILON * size;
                for (x, i) in [(found.x1, 0), (found.x2, 2)] {
                    assert!((x - expected[i]).abs() * s < tolerance, "{k3} {c} {turns}: {x} {}", expected[i]);
                }
                for (v, i) in [(found.v1, 1), (found.v2, 3)] {
                    assert!((v - expected[i]).abs() < tolerance, "{k3} {c} {turns}: {v} {}", expected[i]);
                }
            }
        }
    }
}

#[test]
fn a_driven_flight_is_the_closed_form() {
    let (rig, sine) = (Rig { c1: 0.8, ..Rig::thesis() }, Sine { force: 0.5, frequency: 9.0 });
    let mode = Linear::new(
        [[-rig.k1 / rig.m1, -rig.c1 / rig.m1, 0.0, 0.0], [0.0, 0.0, -rig.k2 / rig.m2, -rig.c2 / rig.m2]],
        [0.0; 2],
        [1.0 / rig.m1, 0.0],
    );
    let start = State { x1: 1e-3, v1: -0.1, x2: 2e-3, v2: 0.3 };
    let steady = Steady::new(&rig, &sine).unwrap();
    let flight = crate::flow::tests::flight(&rig, &steady, rig.gap, &start, 0.7);
    let longest = 1.0 / mode.rate.max(sine.omega());
    let (mut state, mut time) = (start, 0.0);
    for _ in 0..40 {
        // Terms of the force in powers of time.
        let mut force = [0.0; ORDER + 1];
        let (mut re, mut im) =
            (0.5 * (0.7 + sine.omega() * time).cos(), 0.5 * (0.7 + sine.omega() * time).sin());
        for (k, f) in force.iter_mut().enumerate() {
            *f = re;
            let step = sine.omega() * longest / (k + 1) as f64;
            (re, im) = (-im * step, re * step);
        }
        let piece = mode.fly(&state, &force, longest);
        for part in [0.2, 0.9] {
            let (found, exact) = (piece.state(part * longest), flight.state(time + part * longest));
            // Rounding of 0.3 m/s, and of a phase up to 40 rad, over 40 pieces.
            assert!((found.v1 - exact.v1).abs() < 1e-14 && (found.v2 - exact.v2).abs() < 1e-14);
            assert!((found.x1 - exact.x1).abs() < 1e-15 && (found.x2 - exact.x2).abs() < 1e-15);
        }
        state = piece.state(longest);
        time += longest;
    }
}

#[test]
fn falls_and_integrals_of_quantities() {
    // x₁ = cos t with the rate −sin t; the force 2 and the offset −2 cancel.
    let mode = Linear::new([[-1.0, 0.0, 0.0, 0.0], [0.0; 4]], [0.0; 2], [0.0; 2]);
    let mut force = [0.0; ORDER + 1];
    force[0] = 2.0;
    let quantity = Quantity { weights: [1.0, 0.0, 0.0, 0.0], force: 1.0, offset: -2.0 };
    let start = State { x1: f64::cos(1.0), v1: -f64::sin(1.0), ..State::REST };
    let piece = mode.fly(&start, &force, 1.0);
    let course = piece.read(&quantity, &force);
    let fall = course.first_fall().unwrap();
    assert!((fall - (std::f64::consts::FRAC_PI_2 - 1.0)).abs() < 4.0 * f64::EPSILON);
    assert!((course.integral(0.7) - (f64::sin(1.7) - f64::sin(1.0))).abs() < 4.0 * f64::EPSILON);
    assert!((quantity.value(&start, 2.0) - f64::cos(1.0)).abs() < 4.0 * f64::EPSILON);
    assert_eq!(quantity.times(-1.0).times(-1.0), quantity);
    assert_eq!(mode.fly(&start, &force, 0.0).read(&quantity, &force).first_fall(), None);
}
