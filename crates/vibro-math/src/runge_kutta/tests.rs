use super::*;

/// A rooted tree, by its subtrees.
#[derive(Debug, Clone, PartialEq)]
struct Tree(Vec<Tree>);

impl Tree {
    fn order(&self) -> usize {
        1 + self.0.iter().map(Tree::order).sum::<usize>()
    }

    /// Density γ(t): the order times the densities of all subtrees (Butcher 1963).
    fn density(&self) -> f64 {
        self.order() as f64 * self.0.iter().map(Tree::density).product::<f64>()
    }

    /// Elementary weight Φᵢ(t) of each stage.
    fn weights(&self, rows: &[&[f64]], stages: usize) -> Vec<f64> {
        let below: Vec<Vec<f64>> = self.0.iter().map(|t| t.weights(rows, stages)).collect();
        let row = |i: usize| if i == 0 { &[][..] } else { rows[i - 1] };
        let inner = |i: usize, w: &[f64]| row(i).iter().zip(w).map(|(a, w)| a * w).sum::<f64>();
        (0..stages).map(|i| below.iter().map(|w| inner(i, w)).product()).collect()
    }
}

/// All rooted trees up to an order; there are 1, 1, 2, 4, 9, 20, 48, 115 of each order.
fn trees(highest: usize) -> Vec<Tree> {
    let mut all = vec![Tree(Vec::new())];
    for order in 2..=highest {
        // Every multiset of smaller trees whose orders sum to one less.
        let mut found = Vec::new();
        extend(&all, 0, order - 1, &mut Vec::new(), &mut found);
        all.extend(found);
    }
    all
}

fn extend(all: &[Tree], from: usize, rest: usize, chosen: &mut Vec<Tree>, found: &mut Vec<Tree>) {
    if rest == 0 {
        found.push(Tree(chosen.clone()));
    }
    for (i, tree) in all.iter().enumerate().skip(from) {
        if tree.order() <= rest {
            chosen.push(tree.clone());
            extend(all, i, rest - tree.order(), chosen, found);
            chosen.pop();
        }
    }
}

/// Largest |Σ bᵢΦᵢ(t) − wanted/γ(t)| over the trees of each order.
fn defects<S: Scheme>(weights: &[f64], highest: usize, wanted: impl Fn(usize) -> f64) -> Vec<f64> {
    let mut worst = vec![0.0_f64; highest + 1];
    for tree in trees(highest) {
        let phi = tree.weights(S::ROWS, S::NODES.len());
        let sum: f64 = weights.iter().zip(&phi).map(|(b, w)| b * w).sum();
        let order = tree.order();
        worst[order] = worst[order].max((sum - wanted(order) / tree.density()).abs());
    }
    worst
}

/// Weights of the stages in the dense output at `part` of the step, found by setting one derivative after
/// another to 1.
fn dense_weights<S: Scheme>(part: f64) -> Vec<f64> {
    (0..S::NODES.len())
        .map(|stage| {
            let mut rates = [[0.0; 1]; STAGES];
            rates[stage][0] = 1.0;
            let end = S::ROWS[S::END_STAGE - 1].get(stage).copied().unwrap_or(0.0);
            let terms = S::dense(&rates, 1.0, &[0.0], &[end]);
            terms.iter().rev().fold(0.0, |sum, term| sum * part + term[0])
        })
        .collect()
}

fn check<S: Scheme>(order: usize, dense: usize) {
    // Products of weights up to 43 and cancelling sums of them: some 1e3 roundings.
    let tolerance = 1e3 * f64::EPSILON;
    for (i, row) in S::ROWS.iter().enumerate() {
        let sum: f64 = row.iter().sum();
        assert!((sum - S::NODES[i + 1]).abs() < tolerance, "row {i}");
    }
    let step = defects::<S>(S::ROWS[S::END_STAGE - 1], order + 1, |_| 1.0);
    assert!(step[..=order].iter().all(|d| *d < tolerance), "{step:?}");
    assert!(step[order + 1] > 1e-7, "the order is no higher: {step:?}");
    for part in [0.1, 0.37, 0.5, 0.81, 1.0] {
        let weights = dense_weights::<S>(part);
        let found = defects::<S>(&weights, dense, |order| part.powi(order as i32));
        assert!(found.iter().all(|d| *d < tolerance), "{part}: {found:?}");
    }
}

#[test]
fn orders_by_every_rooted_tree() {
    let counts: Vec<usize> =
        (1..=8).map(|order| trees(8).iter().filter(|t| t.order() == order).count()).collect();
    assert_eq!(counts, [1, 1, 2, 4, 9, 20, 48, 115]);
    check::<DormandPrince>(5, 4);
    check::<Dop853>(8, 7);
}

#[test]
fn estimates_of_error_have_their_orders() {
    let tolerance = 1e3 * f64::EPSILON;
    let zero = |weights: &[f64], order: usize, defects: Vec<f64>| {
        assert!(defects[..=order].iter().all(|d| *d < tolerance), "{weights:?} {defects:?}");
        assert!(defects[order + 1] > 1e-7, "{defects:?}");
    };
    zero(&dormand_prince::ERROR, 4, defects::<DormandPrince>(&dormand_prince::ERROR, 5, |_| 0.0));
    zero(&dop853::ERROR5, 5, defects::<Dop853>(&dop853::ERROR5, 6, |_| 0.0));
    let mut third: Vec<f64> = Dop853::ROWS[11].to_vec();
    for (stage, weight) in dop853::THIRD {
        third[stage] -= weight;
    }
    zero(&third, 3, defects::<Dop853>(&third, 4, |_| 0.0));
}

/// Integrates y″ = −y up to t = 20; returns the largest errors at the ends of steps and inside them, and the
/// number of steps.
fn oscillator<S: Scheme>(relative: f64) -> (f64, f64, usize) {
    let f = |_: f64, y: &[f64; 2]| [y[1], -y[0]];
    let tolerance = Tolerance { relative, floor: [1.0; 2] };
    let mut integrator = Integrator::<S, 2>::new(f, 0.0, [1.0, 0.0], 0.1, tolerance);
    let (mut at_end, mut inside, mut steps) = (0.0_f64, 0.0_f64, 0);
    while integrator.time() < 20.0 {
        let step = integrator.step(f, 20.0).unwrap();
        steps += 1;
        for part in [0.3, 0.7] {
            let t = part * step.duration;
            inside = inside.max((step.at(t)[0] - (step.start + t).cos()).abs());
            // Up to the rounding of both values.
            let way = (step.at(t)[0] - step.at(0.0)[0]).abs();
            assert!(way <= step.reach()[0] + 4.0 * f64::EPSILON);
        }
        at_end = at_end.max((step.end[0] - (step.start + step.duration).cos()).abs());
    }
    assert_eq!(integrator.time(), 20.0);
    (at_end, inside, steps)
}

#[test]
fn errors_follow_the_tolerance() {
    for relative in [1e-6, 1e-9, 1e-12] {
        let (at_end, inside, steps) = oscillator::<DormandPrince>(relative);
        // Each step errs by less than the tolerance; an oscillator neither enlarges nor reduces errors.
        assert!(at_end < relative * steps as f64, "{relative}: {at_end}");
        assert!(inside < 20.0 * relative * steps as f64, "{relative}: {inside}");
        let (at_end, inside, steps) = oscillator::<Dop853>(relative);
        assert!(at_end < relative * steps as f64, "{relative}: {at_end}");
        // The dense output has order 7, the steps have order 8.
        assert!(inside < 20.0 * relative * steps as f64, "{relative}: {inside}");
    }
}

#[test]
fn the_first_event_is_found_within_a_step() {
    let f = |_: f64, y: &[f64; 2]| [y[1], -y[0]];
    let tolerance = Tolerance { relative: 1e-13, floor: [1.0; 2] };
    let mut integrator = Integrator::<Dop853, 2>::new(f, 0.0, [1.0, 0.0], 0.5, tolerance);
    let fall = loop {
        let step = integrator.step(f, 10.0).unwrap();
        // cos t = 0.5 at π/3.
        if let Some(t) = step.first_fall(&[1.0, 0.0], -0.5) {
            break step.start + t;
        }
    };
    assert!((fall - std::f64::consts::FRAC_PI_3).abs() < 1e-12, "{fall}");
}

#[test]
fn what_cannot_be_integrated_is_refused() {
    let tolerance = Tolerance { relative: 1e-10, floor: [1.0] };
    // y′ = y²: infinite at t = 1.
    let f = |_: f64, y: &[f64; 1]| [y[0] * y[0]];
    let mut integrator = Integrator::<Dop853, 1>::new(f, 0.0, [1.0], 0.1, tolerance);
    let error = (0..10_000).find_map(|_| integrator.step(f, 2.0).err()).unwrap();
    assert!(error.to_string().contains("no step is small enough"), "{error}");
    assert!(integrator.time() < 1.0 + 1e-9);
    let f = |_: f64, _: &[f64; 1]| [f64::NAN];
    let mut integrator = Integrator::<DormandPrince, 1>::new(f, 0.0, [1.0], 0.1, tolerance);
    assert!(integrator.step(f, 2.0).is_err());
}
