//! `vibro model orbit --impacts --cycles` and `vibro model continue`: keys, values against closed forms,
//! error messages.

use super::{complaint, json, text, vibro};
use num_complex::Complex64;
use serde_json::Value;
use std::f64::consts::TAU;

/// Mass in kg, stiffness in N/m and damper in N s/m of both masses of the thesis' rig, and its gap in m.
const MASSES: [[f64; 3]; 2] = [[0.125, 135.0, 0.1], [0.094, 128.0, 0.1]];
const GAP: f64 = 1e-3;

/// Impulse over approach velocity in kg: M(1 + R) with the reduced mass M.
fn exchange(restitution: f64) -> f64 {
    let [m1, m2] = MASSES.map(|m| m[0]);
    m1 * m2 / (m1 + m2) * (1.0 + restitution)
}

/// Receptance 1/(k − mω² + icω) of a mass in m/N.
fn receptance(mass: usize, omega: f64) -> Complex64 {
    let [m, k, c] = MASSES[mass];
    Complex64::new(k - m * omega * omega, c * omega).inv()
}

/// ω in rad/s at the frequency ratio ν = ω/Ω₁.
fn omega(nu: f64) -> f64 {
    nu * (MASSES[0][1] / MASSES[0][0]).sqrt()
}

/// Relative residual of the closed form for an impulse J once in `cycles` cycles of F₀ cos ωt: (C² +
/// (P/ω)²)J² + 2ΔCJ + Δ² − A², divided by the sum of the magnitudes of its terms. Δ is the gap, A the
/// amplitude of mass 1 without impacts. The periodic Green's function is χ(t) = e^{−bt}[sin λt + B sin
/// λ(T−t)]/(mλ(1 + B² − 2B cos λT)) with B = e^{−bT}, b = c/2m in 1/s, λ = √(k/m − b²) in rad/s and T =
/// cycles/frequency in s. C is the sum of both χ(0), P that of 1/(M(1+R)) and
/// both χ̇(T⁻) (Babitsky 1998).
fn left(force: f64, frequency: f64, gap: f64, restitution: f64, impulse: f64, cycles: f64) -> f64 {
    let (omega, period) = (TAU * frequency, cycles / frequency);
    let (mut c, mut p) = (0.0, 1.0 / exchange(restitution));
    for [m, k, damper] in MASSES {
        let b = damper / (2.0 * m);
        let lambda = (k / m - b * b).sqrt();
        let (decay, (sin, cos)) = ((-b * period).exp(), (lambda * period).sin_cos());
        let scale = m * lambda * (1.0 + decay * decay - 2.0 * decay * cos);
        c += decay * sin / scale;
        p += decay * (lambda * cos - b * sin - decay * lambda) / scale;
    }
    let a = force * receptance(0, omega).norm();
    let terms =
        [(c * c + (p / omega).powi(2)) * impulse * impulse, 2.0 * gap * c * impulse, gap * gap, -a * a];
    terms.iter().sum::<f64>() / terms.iter().map(|t| t.abs()).sum::<f64>()
}

fn list<'a>(value: &'a Value, key: &str) -> &'a [Value] {
    value[key].as_array().unwrap_or_else(|| panic!("no list {key} in {value}"))
}

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("no number {key} in {value}"))
}

fn multipliers(orbit: &Value) -> Vec<Complex64> {
    let z = |z: &Value| Complex64::new(z[0].as_f64().unwrap(), z[1].as_f64().unwrap());
    list(orbit, "multipliers").iter().map(z).collect()
}

/// Runs `vibro model …` with arguments separated by spaces.
fn model(typed: &str) -> Value {
    json(&["model"].into_iter().chain(typed.split(' ')).collect::<Vec<_>>())
}

fn refused(typed: &str, code: i32) -> String {
    complaint(&["model"].into_iter().chain(typed.split(' ')).collect::<Vec<_>>(), code)
}

/// The scene of docs/commands.md in which the motion of one impact a cycle has doubled its period (flip).
const TWICE: &str = "--frequency 6.3 --force 0.9 --set restitution=0.9 --impacts 2 --cycles 2";

#[test]
fn motions_of_several_impacts_have_their_keys_and_keep_the_laws_of_their_impacts() {
    let (force, frequency, restitution, cycles) = (0.9, 6.3, 0.9, 2.0);
    let found = model(&format!("orbit {TWICE} --gap-std 1e-6"));
    let orbits = list(&found, "orbits");
    assert!(!orbits.is_empty());
    assert!(found["scene"]["gap"] == GAP && found["no_impact"]["possible"].is_boolean());
    let codes: Vec<&Value> = list(&found, "findings").iter().map(|f| &f["code"]).collect();
    assert_eq!(codes, ["orbits-perhaps-more"]);
    for orbit in orbits {
        for key in ["impulse", "frequency", "min_gap", "spectral_radius", "grazing_distance"] {
            assert!(orbit[key].is_number(), "{key}");
        }
        for key in ["exists", "admissible", "stable", "robust", "near_grazing"] {
            assert!(orbit[key].is_boolean(), "{key}");
        }
        for key in ["peak_to_peak", "fundamental", "fundamental_phase"] {
            assert_eq!(list(orbit, key).len(), 2, "{key}");
        }
        let beats = list(orbit, "impacts");
        assert_eq!((beats.len(), &orbit["cycles"]), (2, &Value::from(2)));
        // Newton's last step is below 1e-10 and converges quadratically. What remains are rounding
        // errors, which the result amplifies some tens of times.
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-11 * b.abs(), "{a} {b} in {orbit}");
        for beat in beats {
            close(number(beat, "impulse"), exchange(restitution) * number(beat, "approach_velocity"));
        }
        let sum = |key: &str| beats.iter().map(|b| number(b, key)).sum::<f64>();
        close(sum("interval"), cycles / frequency);
        close(number(orbit, "impulse"), sum("impulse"));
        // Each of p impacts shrinks the volume of the state space by R², and the dampers shrink it between
        // impacts: det = R^{2p} exp(−2(b₁+b₂)T).
        let decay: f64 = MASSES.iter().map(|[m, _, c]| c / (2.0 * m)).sum();
        let det: Complex64 = multipliers(orbit).iter().product();
        close(det.re, restitution.powi(4) * (-2.0 * decay * cycles / frequency).exp());
        assert!(det.im.abs() < 1e-11);
        // Impacts of impulse J at the phases φ have the line (2/T)ΣJe^{−iφ} at the frequency of the force.
        let omega = TAU * frequency;
        let blows: Complex64 = beats
            .iter()
            .map(|b| {
                Complex64::from_polar(2.0 * frequency / cycles * number(b, "impulse"), -number(b, "phase"))
            })
            .sum();
        let lines = [(force - blows) * receptance(0, omega), blows * receptance(1, omega)];
        for (mass, line) in lines.iter().enumerate() {
            close(orbit["fundamental"][mass].as_f64().unwrap(), line.norm());
        }
        assert_eq!(orbit["stable"], number(orbit, "spectral_radius") < 1.0);
    }
}

#[test]
fn one_impact_in_several_cycles_is_the_closed_form() {
    // Without impacts mass 1 moves farther than the gap (A > Δ), so the product of both roots is negative.
    for cycles in [1, 2, 3] {
        let found = model(&format!("orbit --frequency 11 --force 0.5 --cycles {cycles}"));
        let impulses: Vec<f64> = list(&found, "orbits").iter().map(|o| number(o, "impulse")).collect();
        assert!(impulses.len() == 2 && impulses[0] > 0.0 && impulses[1] < 0.0, "{impulses:?}");
        for impulse in impulses {
            let left = left(0.5, 11.0, GAP, 0.7, impulse, f64::from(cycles));
            // Some fifty rounding errors.
            assert!(left.abs() < 1e-14, "{left} at {impulse} N s");
        }
    }
    // The thesis' rig at ν = 2.1, 0.5 N and R = 0.7: the published value of the second root, with all digits
    // of a double. The root amplifies rounding errors less than 100 times.
    let found = model(&format!("orbit --force 0.5 --frequency {}", omega(2.1) / TAU));
    let impulse = number(&list(&found, "orbits")[1], "impulse");
    assert!((impulse / -0.008_944_428_353_726_736 - 1.0).abs() < 1e-13, "{impulse}");
}

#[test]
fn a_branch_has_its_keys_and_each_point_is_the_closed_form() {
    let start = "--force 0.5 --frequency 11";
    for (over, from, to) in
        [("frequency", 8.0, 14.0), ("force", 0.05, 2.0), ("gap", -1e-3, 5e-3), ("restitution", 0.0, 1.0)]
    {
        let found = model(&format!("continue --over {over} {start} --from={from} --to {to}"));
        assert_eq!(found["over"], over);
        assert_eq!(list(&found, "one_impact"), [0; 0]);
        let branches = list(&found, "branches");
        assert!(!branches.is_empty());
        for branch in branches {
            let points = list(branch, "points");
            assert!(points.len() > 8, "{over}");
            for point in points {
                let value = number(point, "value");
                assert!(value > from - 1e-9 && value < to + 1e-9, "{over} {value}");
                let of = |name: &str, own: f64| if name == over { value } else { own };
                let (force, frequency) = (of("force", 0.5), of("frequency", 11.0));
                let (gap, restitution) = (of("gap", GAP), of("restitution", 0.7));
                let left = left(force, frequency, gap, restitution, number(point, "impulse"), 1.0);
                // Newton's last step on the branch is below 1e-10 and converges quadratically.
                assert!(left.abs() < 1e-12, "{over} {value}: {left}");
            }
            let ends = list(branch, "ends");
            let known = ["range", "grazing", "closed", "lost", "points"];
            assert!(ends.len() == 2 && ends.iter().all(|e| known.contains(&e.as_str().unwrap())), "{ends:?}");
            for mark in list(branch, "marks") {
                let after = mark["after"].as_u64().unwrap() as usize;
                assert!(after + 1 < points.len() && mark["kind"].is_string(), "{mark}");
                // A mark lies between its neighbours on the branch, so within their steps of both.
                let at = |v: &Value| number(v, "value");
                let (a, b, m) = (at(&points[after]), at(&points[after + 1]), at(&mark["orbit"]));
                let step = (a - b).abs() + 0.05 * m.abs();
                assert!((m - a).abs() <= step && (m - b).abs() <= step, "{over} {a} {m} {b}");
            }
        }
    }
}

#[test]
fn a_branch_passes_the_peak_of_the_thesis_and_grazes_where_the_linear_motion_does() {
    // Reference values of the rig at 0.5 N and R = 0.7: the approach velocity has its maximum of 0.46903 m/s
    // at ν = 2.00992, and the amplitude without impacts falls below the gap at ν = 2.168715614919.
    let found = model("continue --force 0.5 --frequency 11 --from 8 --to 14 --step 0.01");
    let all: Vec<&Value> = list(&found, "branches").iter().collect();
    let points = all.iter().flat_map(|b| list(b, "points"));
    let speed = |p: &Value| number(&p["impacts"][0], "approach_velocity");
    let fastest = points.max_by(|a, b| speed(a).total_cmp(&speed(b))).unwrap();
    // Near the maximum the velocity falls with the square of the distance along the branch: by less than
    // 1e-3 at steps of 0.01.
    assert!((speed(fastest) / 0.46903 - 1.0).abs() < 1e-3, "{fastest}");
    assert!((TAU * number(fastest, "value") / omega(2.00992) - 1.0).abs() < 5e-3, "{fastest}");
    let grazing: Vec<f64> = all
        .iter()
        .flat_map(|b| list(b, "marks"))
        .filter(|m| m["kind"] == "grazing")
        .map(|m| TAU * number(&m["orbit"], "value") / omega(2.168_715_614_919) - 1.0)
        .collect();
    // The frequency of grazing is found by bisection to 1e-11 of a step. At grazing the
    // frequency depends on the square of the impulse, so the impulse is known to the square root of that.
    assert!(grazing.iter().any(|off| off.abs() < 1e-6), "{grazing:?}");
}

#[test]
fn motions_of_two_cycles_are_drawn_beside_the_flips_of_one() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let found = model(&format!("continue {TWICE} --from 5 --to 8 --out {}", text(&out)));
    let values = |branches: &str| -> Vec<f64> {
        let marks = list(&found, branches).iter().flat_map(|b| list(b, "marks"));
        let flips = marks.filter(|m| m["kind"] == "flip").map(|m| &m["orbit"]);
        flips
            .map(|orbit| {
                if branches == "one_impact" {
                    let near = multipliers(orbit).iter().map(|z| (z + 1.0).norm()).fold(1.0, f64::min);
                    assert!(near < 1e-6, "{orbit}");
                }
                number(orbit, "value")
            })
            .collect()
    };
    // Motions of twice the period begin and end where a multiplier of one impact a cycle is −1. There a
    // difference of 1e-2 between both halves of the motion changes the frequency by the square of it, 1e-4.
    let (twice, once) = (values("branches"), values("one_impact"));
    assert!(!twice.is_empty());
    for flip in &twice {
        assert!(once.iter().any(|f| (f / flip - 1.0).abs() < 1e-4), "{twice:?} {once:?}");
    }
    for point in list(&found, "branches").iter().flat_map(|b| list(b, "points")) {
        assert_eq!((list(point, "impacts").len(), &point["cycles"]), (2, &Value::from(2)));
    }
    for name in ["branches.svg", "branches.png", "branches.csv", "marks.csv", "points.csv"] {
        assert!(out.join(name).is_file(), "{name}");
    }
}

#[test]
fn a_search_that_finds_nothing_says_so() {
    // The force moves mass 1 by F₀|L₁| = 0.02 mm, so the masses do not meet over a gap of 1 mm.
    let found = model("orbit --force 0.001 --frequency 6.3 --impacts 2 --cycles 3");
    assert!(list(&found, "orbits").is_empty() && found["no_impact"]["possible"] == true);
    assert_eq!(found["findings"][0]["code"], "no-orbit-found");
    let printed = vibro(&["model", "orbit", "--force", "0.001", "--frequency", "6.3", "--impacts", "2"]);
    assert!(String::from_utf8_lossy(&printed.stderr).contains("No motion with 2 impacts in 1 cycle "));
}

#[test]
fn impossible_counts_say_which_and_what_to_type() {
    for command in
        ["orbit --force 0.9 --frequency 6.3", "continue --force 0.9 --frequency 6.3 --from 5 --to 8"]
    {
        for (typed, found, hint) in [
            ("--impacts 0 --cycles 2", "0 impacts in a period; expected 1 to 32", "try: 1 (--impacts)"),
            ("--impacts 2 --cycles 0", "0 cycles in a period; expected 1 to 32", "try: 1 (--cycles)"),
            ("--impacts 33 --cycles 2", "33 impacts in a period; expected 1 to 32", "try: 32 (--impacts)"),
            ("--impacts 2 --cycles 33", "33 cycles in a period; expected 1 to 32", "try: 32 (--cycles)"),
            ("--impacts 1.5", "--impacts is 1.5", "expected a whole number"),
            ("--impacts=-1", "--impacts is -1", "expected a whole number, 0 or more"),
            ("--cycles two", "--cycles is two", "expected a whole number"),
        ] {
            let said = refused(&format!("{command} {typed}"), 2);
            assert!(said.contains(found) && said.contains(hint), "{command} {typed}: {said}");
        }
    }
    // The closed form takes any number of cycles except 0.
    let said = refused("orbit --force 0.9 --frequency 6.3 --cycles 0", 2);
    assert!(
        said.contains("0 cycles in a period; expected 1 or more") && said.contains("try: 1 (--cycles)"),
        "{said}"
    );
}

#[test]
fn impossible_ranges_say_where_and_what_to_type() {
    for (typed, found, hint) in [
        (
            "--from 8 --to 8",
            "frequency from 8 to 8 Hz; expected the lower end first",
            "try: a higher upper end (--from, --to)",
        ),
        (
            "--from 12 --to 8",
            "frequency from 12 to 8 Hz; expected the lower end first",
            "try: swap both ends (--from, --to)",
        ),
        (
            "--from 0 --to 14",
            "frequency is 0 Hz; expected a finite value above 0",
            "try: another lower end (--from)",
        ),
        ("--from=-1 --to 14", "frequency is -1 Hz", "(--from)"),
        ("--from nan --to 14", "frequency is NaN Hz", "(--from)"),
        ("--from 8 --to inf", "frequency is inf Hz", "try: another upper end (--to)"),
        (
            "--from 12 --to 14",
            "the start at frequency 11 Hz is outside the range; expected a start from 12 to 14 Hz",
            "(--frequency)",
        ),
        (
            "--over force --from 1 --to 2",
            "the start at force 0.5 N is outside the range; expected a start from 1 to 2 N",
            "(--force)",
        ),
        (
            "--over force --from 0 --to 1",
            "force from 0 N; expected a lower end above 0",
            "try: a lower end of 0.01 (--from)",
        ),
        ("--over gap --from 2e-3 --to 3e-3", "the start at gap 0.001 m is outside the range", "(--set)"),
        (
            "--over restitution --from 0 --to 1.5",
            "restitution is 1.5; expected a value from 0 to 1",
            "(--to)",
        ),
        (
            "--over restitution --from=-0.5 --to 1",
            "restitution is -0.5; expected a value from 0 to 1",
            "(--from)",
        ),
        ("--over m1 --from 0.1 --to 0.2", "--over is m1", "one of frequency, force"),
        ("--over impulse --from 0.1 --to 0.2", "--over is impulse", "one of frequency, force"),
        ("--from 8 --to 14 --step 0", "steps of 0; expected a step from 1e-6 to 1", "try: 0.05 (--step)"),
        ("--from 8 --to 14 --step nan", "steps of NaN", "(--step)"),
        ("--from 8", "needs --to NUMBER", "try: vibro model continue --help"),
    ] {
        let said = refused(&format!("continue --force 0.5 --frequency 11 {typed}"), 2);
        assert!(said.contains(found) && said.contains(hint), "{typed}: {said}");
    }
}

#[test]
fn a_start_without_motion_or_force_is_refused() {
    for (typed, code, found, hint) in [
        // The masses never meet.
        (
            "--force 0.001 --from 8 --to 14",
            1,
            "no motion with 1 impact in 1 cycle at frequency 11 Hz",
            "`vibro model response`",
        ),
        // Seven impacts in a cycle would need a much smaller gap.
        (
            "--force 0.5 --frequency 11 --impacts 7 --from 8 --to 14",
            1,
            "no motion with 7 impacts in 1 cycle at frequency 11 Hz",
            "`vibro model map`",
        ),
        ("--over force --force 0.001 --frequency 11 --from 1e-4 --to 1", 1, "at force 0.001 N", "(--force)"),
        ("--over gap --force 0.001 --frequency 11 --from 1e-4 --to 1", 1, "at gap 0.001 m", "(--set)"),
        (
            "--over restitution --force 0.001 --frequency 11 --from 0 --to 1",
            1,
            "at restitution 0.7\n",
            "(--set)",
        ),
        ("--force 0 --from 8 --to 14", 2, "a force or impulse of 0", "(--force, --impulse)"),
        ("--force 0 --impacts 2 --from 8 --to 14", 2, "a force or impulse of 0", "(--force, --impulse)"),
        ("--from 8 --to 14", 2, "nothing drives the rig", "--force"),
        ("--impulse 0.009 --from 4 --to 6", 2, "no sine; expected a sine force", "(--force)"),
        ("--force 0.5 --over force --from 0.1 --to 2", 2, "has no frequency", "(--frequency)"),
    ] {
        let said = refused(&format!("continue {typed}"), code);
        assert!(said.contains(found) && said.contains(hint), "{typed}: {said}");
    }
    for (typed, found) in
        [("--force 0", "a force or impulse of 0"), ("--impulse 0.009", "expected a sine force")]
    {
        let said = refused(&format!("orbit --frequency 5 --impacts 2 {typed}"), 2);
        assert!(said.contains(found) && said.contains("(--force"), "{typed}: {said}");
    }
}
