//! The six programs of appendix A.2 as printed: jsnew, jsdnew and jsdtw under a sine, jinew, jidnew and
//! jidtw under impulses. Each of their errors can be corrected separately, which shows its effect.

use crate::scene::{grid, peak, rig, under_sine};
use crate::sheet::{Claim, Sheet};
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};
use vibroimpact::Result;
use vibroimpact::figure::{AxisSpec, Figure, Ink, Legend, Plot, Series, Stroke};
use vibroimpact::model::{Green, Rig};

/// An error in a printed program.
#[derive(Clone, Copy, PartialEq)]
pub enum Slip {
    /// A² − Δ² is set to 0 if its magnitude is below 1e-6 m², which is Δ².
    Threshold,
    /// χ̇₁(T⁻) + χ̇₂(T⁻) is replaced by this multiple of −1/(2M). The factor 1 is correct without dampers;
    /// c₂ is left out.
    Slopes(f64),
    /// J is computed with M in place of M(1 + R).
    Exchange,
    /// Sine: sin φ has Ω₁² − ω² in place of (Ω₁² − ω²)²/ω². Impulses: τ is φ/ω in place of φ/Ω₁.
    Phase,
    /// The response to the impulse is taken a period earlier at all times, since one `if` decides for the
    /// whole row.
    Earlier,
}
use Slip::{Earlier, Exchange, Phase, Slopes, Threshold};

/// A program: a sine of amplitude `size` (N) if `sine`, else impulses of `size` (N s) without the damper
/// c₁.
pub struct Program {
    rig: Rig,
    sine: bool,
    size: f64,
    slips: &'static [Slip],
}

/// Results of a program at one frequency ratio. They are complex where the program takes the root of a
/// negative number or the arcsine of a number beyond 1; Matlab draws their real part.
pub struct Printed {
    pub impulse: Complex64,
    /// Largest displacements in m; that of mass 2 is measured from mass 1.
    pub largest: [f64; 2],
    /// |x₁ − x₂ − Δ| at the impact in m.
    pub miss: f64,
    /// Time from the impulse to the impact, in periods.
    pub timing: f64,
}

/// The terms that a program adds up at one frequency.
struct Parts {
    omega: f64,
    natural: f64,
    /// χ₁, χ₂ in m/(N s), and the sum of their slopes before the impact.
    green: [Green; 2],
    slopes: f64,
    /// A₁ of the thesis, under impulses.
    unit: f64,
    /// Sine: A and ω. Impulses: 2FA₁|sin(Ω₁T/2)| and Ω₁, which give the same quadratic equation for J.
    amplitude: f64,
    rate: f64,
}

impl Program {
    fn has(&self, slip: Slip) -> bool {
        self.slips.contains(&slip)
    }

    fn parts(&self, nu: f64) -> Result<Parts> {
        let rig = &self.rig;
        let natural = (rig.k1 / rig.m1).sqrt();
        // ν is relative to the damped natural frequency; c₁ is 0 under impulses.
        let omega = nu * (natural.powi(2) - (rig.c1 / rig.m1 / 2.0).powi(2)).sqrt();
        let period = TAU / omega;
        let [first, second] = rig.oscillators();
        let green = [Green::new(rig.m1, first, period)?, Green::new(rig.m2, second, period)?];
        let stated = self.slips.iter().find_map(|s| if let Slopes(n) = s { Some(n) } else { None });
        let slopes =
            stated.map_or(green[0].slope_before + green[1].slope_before, |n| -n / (2.0 * rig.reduced_mass()));
        let opening = 1.0 - (natural * period).cos();
        let unit = 1.0 / (2.0 * rig.m1 * natural * opening);
        let (amplitude, rate) = if self.sine {
            (self.size * rig.receptances(omega)[0].norm(), omega)
        } else {
            (self.size * unit * (2.0 * opening).sqrt(), natural)
        };
        Ok(Parts { omega, natural, green, slopes, unit, amplitude, rate })
    }

    /// J: the root with the positive sign; 0 if its real part is negative.
    fn exchanged(&self, parts: &Parts) -> Complex64 {
        let exchange = if self.has(Exchange) { self.rig.reduced_mass() } else { self.rig.exchange() };
        let c = parts.green[0].start + parts.green[1].start;
        let p = (1.0 / exchange + parts.slopes) / parts.rate;
        let excess = parts.amplitude.powi(2) - self.rig.gap.powi(2);
        let excess = if self.has(Threshold) && excess.abs() < 1e-6 { 0.0 } else { excess };
        let root = Complex64::from((parts.amplitude * c).powi(2) + p * p * excess).sqrt();
        let impulse = (root - self.rig.gap * c) / (p * p + c * c);
        if impulse.re < 0.0 { Complex64::default() } else { impulse }
    }

    /// sin φ under a sine, sin Ω₁τ under impulses.
    fn sine_of_phase(&self, parts: &Parts, impulse: Complex64) -> Complex64 {
        let (rig, p) = (&self.rig, 1.0 / self.rig.exchange() + parts.slopes);
        let (omega, natural) = (parts.omega, parts.natural);
        if self.sine {
            let off = natural.powi(2) - omega.powi(2);
            let off = if self.has(Phase) { off } else { (off / omega).powi(2) };
            return -impulse * p * Complex64::from(rig.c1.powi(2) + rig.m1.powi(2) * off).sqrt() / self.size;
        }
        let (c, turn) = (parts.green[0].start + parts.green[1].start, TAU * natural / omega);
        let opened = rig.gap + impulse * c - impulse * p / natural * turn.sin() / (1.0 - turn.cos());
        opened / (2.0 * self.size * parts.unit)
    }

    /// Runs the program at the frequency ratio `nu`.
    pub fn at(&self, nu: f64) -> Result<Printed> {
        let parts = self.parts(nu)?;
        let [a, b] = &parts.green;
        let impulse = self.exchanged(&parts);
        let sine = self.sine_of_phase(&parts, impulse);
        let passive = |t: f64| impulse * b.at(t).0 + self.rig.gap;
        let active = |phase: Complex64, t: f64| self.driven(&parts, phase, t) - impulse * a.at(t).0;
        let met = |phase: Complex64| (active(phase, 0.0) - passive(0.0)).norm();
        let [one, other] = if sine.re < 0.0 {
            [(-sine).asin() + PI, TAU - (-sine).asin()]
        } else {
            [PI - sine.asin(), sine.asin()]
        };
        let phase = if met(one) < met(other) { one } else { other };
        let period = TAU / parts.omega;
        let times: Vec<f64> = (0..=100).map(|i| f64::from(i) * period / 100.0).collect();
        let top = |x: &dyn Fn(f64) -> Complex64| times.iter().map(|t| x(*t).norm()).fold(0.0, f64::max);
        let largest = [top(&|t| active(phase, t)), top(&passive)];
        let lead = phase.re / if self.has(Phase) { parts.omega } else { parts.natural };
        Ok(Printed { impulse, largest, miss: met(phase), timing: lead / period })
    }

    /// Displacement of mass 1 in m without impacts, at the time `t` (s) after the impact.
    fn driven(&self, parts: &Parts, phase: Complex64, t: f64) -> Complex64 {
        let &Parts { omega, natural, unit, amplitude, .. } = parts;
        if self.sine {
            return amplitude * (phase + omega * t).cos();
        }
        let (period, lead) = (TAU / omega, phase / if self.has(Phase) { omega } else { natural });
        let since = lead + t;
        // At the impact itself the programs do not shift the time into the period.
        let inside = t == 0.0 || since.re <= period && !self.has(Earlier);
        let since = if inside { since } else { since - period };
        self.size * unit * ((natural * since).sin() + (natural * (period - since)).sin())
    }
}

/// Positions of the peaks of a value over ν.
pub fn peaks(nu: &[f64], value: impl Fn(f64) -> f64) -> Vec<f64> {
    let all: Vec<f64> = nu.iter().map(|nu| value(*nu)).collect();
    let inner = all.windows(3).zip(nu.iter().skip(1));
    inner.filter(|(w, _)| w[1] > w[0] && w[1] > w[2]).map(|(_, nu)| *nu).collect()
}

pub fn told(nu: &[f64]) -> String {
    let all: Vec<String> = nu.iter().map(|nu| format!("{nu:.2}")).collect();
    if all.is_empty() { "none".to_owned() } else { all.join(", ") }
}

pub fn sine(restitution: f64, damper: f64, size: f64, slips: &'static [Slip]) -> Program {
    Program { rig: Rig { c1: damper, c2: damper, ..rig(restitution) }, sine: true, size, slips }
}

pub fn impulses(restitution: f64, c2: f64, size: f64, slips: &'static [Slip]) -> Program {
    Program { rig: Rig { c1: 0.0, c2, ..rig(restitution) }, sine: false, size, slips }
}

/// The figures of x₁ under impulses: number, R, and c₂ in N s/m.
pub const SCENES: [(&str, f64, f64); 3] = [("3.13", 1.0, 0.0), ("3.14", 0.7, 0.0), ("3.15", 0.7, 0.1)];

pub const JSNEW: &[Slip] = &[Threshold];
pub const JIDTW: &[Slip] = &[Slopes(1.0), Phase];
const JSDNEW: &[Slip] = &[Threshold, Exchange, Phase];
pub const JIDNEW: &[Slip] = &[Threshold, Slopes(2.0), Phase, Earlier];

pub fn impulse(program: &Program, nu: f64) -> f64 {
    program.at(nu).map_or(f64::NAN, |p| p.impulse.re)
}

pub fn largest(program: &Program, nu: f64) -> f64 {
    program.at(nu).map_or(f64::NAN, |p| p.largest[0])
}

pub fn sheet() -> Result<Sheet> {
    let mut claims = of_sine()?;
    claims.extend(of_impulses()?);
    let (near, all) = (grid(0.9, 1.2, 601), grid(0.7501, 2.4901, 88));
    let line = |nu: &[f64], program: &Program, of: fn(&Program, f64) -> f64| -> Vec<f64> {
        nu.iter().map(|nu| of(program, *nu)).map(|v| if v > 0.0 { v } else { f64::NAN }).collect()
    };
    let series = |name: &str, nth, nu: &[f64], y: Vec<f64>| {
        let stroke = if nth == 0 { Stroke::Solid } else { Stroke::Dashed };
        Series::line(name, nu.to_vec(), y).ink(Ink::Nth(nth)).stroke(stroke)
    };
    let x1 = |slips| line(&near, &sine(0.7, 0.1, 0.5, slips), largest);
    let j = |slips| line(&all, &impulses(1.0, 0.0, 0.009, slips), impulse);
    let axis = |label: &str, unit: &str| AxisSpec::new(label, unit).log();
    let figure = Figure::double("Programs of appendix A.2")
        .height(85.0)
        .columns(2)
        .panel(
            Plot::new(crate::scene::ratio(0.9, 1.2), axis("Largest x₁", "m"))
                .title("(a) jsdnew, figure 3.6")
                .with(series("as printed", 0, &near, x1(JSDNEW)))
                .with(series("sin φ put right", 1, &near, x1(&[Threshold, Exchange])))
                .with(series("M(1 + R), too", 2, &near, x1(JSNEW)))
                .legend(Legend::Above),
        )
        .panel(
            Plot::new(crate::scene::ratio(0.75, 2.5), axis("Impulse J", "N s"))
                .title("(b) jinew, figure 3.10")
                .with(series("as printed", 0, &all, j(JIDNEW)))
                .with(series("−1/(2m₁) − 1/(2m₂)", 1, &all, j(&[Threshold, Slopes(1.0), Phase, Earlier])))
                .legend(Legend::Above),
        )
        .caption(
            "(a) Largest x₁ under a sine of 0.5 N, R = 0.7, by jsdnew. (b) Impulse under impulses of 0.009 N s, R = 1, c₂ = 0, by jinew.",
        );
    Ok(Sheet::new("programs", "Figures 3.6, 3.10 and appendix A.2: the programs as printed", figure, claims))
}

fn of_sine() -> Result<Vec<Claim>> {
    let mut claims = Vec::new();
    for force in [0.05, 0.1, 0.5, 0.9] {
        let program = sine(1.0, 0.1, force, JSNEW);
        let top = |nu: Vec<f64>| {
            let best = nu.into_iter().max_by(|a, b| impulse(&program, *a).total_cmp(&impulse(&program, *b)));
            best.unwrap_or(f64::NAN)
        };
        let (fine, _) = peak(1.5, 2.4, |nu| Some(impulse(&program, nu)));
        let mut why = format!("without its steps of 0.01 the peak is at {fine:.3}");
        if force < 0.5 {
            why += "; where there is no motion, the threshold makes a root, whose peak does not move with the force";
        }
        let what = format!("R 1, F₀ {force} N: ν of the clapping resonance");
        let steps = grid(1.2, 2.9, 171);
        claims.push(Claim::number(
            format!("3.4, jsnew as printed, {what}"),
            "2.13",
            top(steps),
            (2, ""),
            &why,
        ));
        let steps = grid(1.2101, 2.9901, 90);
        let what = format!("3.4, jsnew with the ν of its comment, {what}");
        claims.push(Claim::number(what, "2.13", top(steps), (2, ""), "its steps are 0.02"));
    }
    let open = sine(1.0, 0.1, 0.05, &[]).at(2.12)?.impulse;
    claims.push(Claim::told(
        "3.4, jsnew without its threshold, F₀ 0.05 N: J at ν 2.12",
        "–",
        format!("{:.3} + {:.3}i N s", open.re, open.im),
        true,
        "complex: no motion, and the real part that Matlab draws has its peak there, too",
    ));
    claims.extend(of_displacements());
    for (figure, nu, force) in [("3.8", 2.131, 0.5), ("3.9", 1.0501, 0.05)] {
        let printed = sine(0.7, 0.0, force, &[Threshold, Slopes(2.0)]).at(nu)?.impulse.re;
        let undamped = Rig { c1: 0.0, c2: 0.0, ..rig(0.7) };
        let right = under_sine(&undamped, force, nu).first().map_or(f64::NAN, |o| o.impulse);
        let why = "without dampers it has −1/(2M) twice in the place of −1/(2m₁) − 1/(2m₂); near A = Δ its threshold acts, too";
        let printed = format!("{:.3}", 1e3 * printed);
        let what = format!("{figure}, jsdtw as printed, R 0.7, c 0, F₀ {force} N, ν {nu}: J");
        claims.push(Claim::number(what, &printed, 1e3 * right, (3, "mN s"), why));
    }
    Ok(claims)
}

/// The frequency ratios of jsdnew as printed (figure 3.7), and those in its comment (figure 3.6).
fn lists() -> [Vec<f64>; 2] {
    let printed = [grid(0.75, 0.91, 17), vec![1.03], grid(1.041, 1.091, 6), grid(1.2, 2.9, 171)];
    [printed.concat(), grid(0.7501, 2.9901, 225)]
}

/// Claims: peaks of x₁ from jsdnew, with and without its errors.
fn of_displacements() -> Vec<Claim> {
    let [printed, all] = lists();
    let claim = |what: &str, nu: &[f64], slips, thesis: &str, why: &str| {
        let program = sine(0.7, 0.1, 0.5, slips);
        let found = peaks(nu, |nu| largest(&program, nu));
        let low: Vec<f64> = found.into_iter().filter(|nu| *nu < 1.2).collect();
        let here = format!("{}; contact missed by {:.2} mm at most", told(&low), 1e3 * missed(&program, nu));
        Claim::told(format!("{what}: peaks of x₁ below ν 1.2"), thesis, here, thesis == "–", why)
    };
    let flank = "its list of ν leaves the peaks out, but not their flank at 1.03";
    let slip = "the motions have no peak there: sin φ has Ω₁² − ω² in the place of (Ω₁² − ω²)²/ω², and a parenthesis is missing";
    let masses = "J is computed with M, sin φ with M(1 + R)";
    let alone = "the grazing resonance alone: the peaks are slips, and not masses that pass through each other; the miss is above ν 1.9, where the threshold acts or the root is complex";
    let towards = "1, and another towards 1.123";
    vec![
        claim("3.7, jsdnew as printed", &printed, JSDNEW, "one, about 1.05", flank),
        claim("3.6, jsdnew with all ν of its comment", &all, JSDNEW, towards, slip),
        claim("3.6, sin φ put right", &all, &[Threshold, Exchange], "–", masses),
        claim("3.6, M(1 + R) put right, too", &all, JSNEW, "–", alone),
    ]
}

/// Largest |x₁ − x₂ − Δ| at the impact in m over these frequency ratios.
fn missed(program: &Program, nu: &[f64]) -> f64 {
    nu.iter().map(|nu| program.at(*nu).map_or(0.0, |p| p.miss)).fold(0.0, f64::max)
}

/// Claims: whether the impact of jidnew lies at the contact, for figures 3.13 to 3.15.
fn of_contact() -> Vec<Claim> {
    let all = grid(0.7501, 2.9901, 113);
    let worst = |slips: &'static [Slip]| {
        let of = |(_, restitution, c2)| 1e3 * missed(&impulses(restitution, c2, 0.009, slips), &all);
        SCENES.map(of).into_iter().fold(0.0, f64::max)
    };
    let [printed, slopes, turned, right] =
        [JIDNEW, &[Threshold, Phase, Earlier], &[Threshold, Earlier], &[Earlier]].map(worst);
    vec![
        Claim::told(
            "3.13 to 3.15, jidnew as printed: τ = φ/ω at each ν",
            "a row of numbers",
            "one number; `tau(N)=ttau(N)` then stops it",
            false,
            "`/` of two rows is a least-squares quotient; `./` is meant, and taken here in all rows",
        ),
        Claim::told(
            "3.13 to 3.15, jidnew: contact missed by, at most",
            "0",
            format!(
                "{printed:.2} mm as printed, {slopes:.2} mm with χ̇ put right, {turned:.2} mm with φ/Ω₁, too"
            ),
            printed < 0.01,
            &format!("3.43 and 3.44 give Ω₁τ, not ωτ; the rest is the threshold's, {right:.2} mm without it"),
        ),
    ]
}

fn of_impulses() -> Result<Vec<Claim>> {
    let masses: &[Slip] = &[Threshold, Slopes(1.0), Phase, Earlier];
    let [printed, right] = [JIDNEW, masses].map(|slips| impulse(&impulses(1.0, 0.0, 0.009, slips), 2.1301));
    let [without, with] = [masses, &[]].map(|slips| 1e3 * impulse(&impulses(0.7, 0.1, 0.009, slips), 1.0501));
    let [first, second] = [1.0501, 2.1301].map(|nu| impulse(&impulses(0.7, 0.0, 0.009, JIDNEW), nu));
    let reduced = impulse(&impulses(0.7, 0.1, 0.009, JIDNEW), 1.0501);
    let over_time = |slips| impulses(0.7, 0.1, 0.005, slips).at(1.501);
    let [slow, fast] = [over_time(JIDTW)?, over_time(&[Slopes(1.0)])?];
    let mut claims = vec![
        Claim::told(
            "3.10, jinew as printed, R 1, c₂ 0: J at ν 2.1301",
            "a large peak",
            format!("{:.4} mN s", 1e3 * printed),
            printed > 0.1,
            "it has −1/(2M) twice, as jidnew has: the clapping peak is lost, so figure 3.10 was not made by it",
        ),
        Claim::told(
            "3.10, with −1/(2m₁) − 1/(2m₂), as jidtw has",
            "a large peak",
            format!("{right:.2} N s"),
            right > 0.1,
            "as a root of 3.42; it is no motion, see the antiresonance",
        ),
        Claim::told(
            "3.11, jinew as printed, R 0.7, c₂ 0: J at ν 1.0501 and 2.1301",
            "first dominates, second reduced",
            format!("{:.1} and {:.3} mN s", 1e3 * first, 1e3 * second),
            second < first && second < 0.5 * right,
            "it may have drawn figure 3.11",
        ),
        Claim::told(
            "3.12, jinew as printed, R 0.7, c₂ 0.1: J at ν 1.0501",
            "first reduced by c₂",
            format!("{:.1} mN s", 1e3 * reduced),
            reduced < first,
            "it may have drawn figure 3.12",
        ),
        Claim::number(
            "3.12, 3.15, with −1/(2m₁) − 1/(2m₂), as jidtw has, R 0.7, c₂ 0.1, ν 1.0501: J",
            &format!("{without:.2}"),
            with,
            (2, "mN s"),
            &format!(
                "c₂ is left out of χ̇₂, in jinew and jidnew, too, which makes J {:.0} % too large",
                100.0 * (without / with - 1.0)
            ),
        ),
        Claim::told(
            "jidtw as printed, F 0.005 N s, ν 1.501, R 0.7: τ",
            "0 < τ < T",
            format!("{:.3} T, with φ/Ω₁ {:.3} T", slow.timing, fast.timing),
            fast.timing < 1.0,
            &format!(
                "the slip moves a root that is none into the period, where it misses the contact by {:.2} mm",
                1e3 * slow.miss
            ),
        ),
    ];
    claims.extend(of_contact());
    Ok(claims)
}
