use super::*;

/// The example without gravity, far from all contacts.
fn afloat() -> Machine {
    let mut machine = Machine { gravity: 0.0, ..Machine::example() };
    (machine.striker.strike, machine.intermediate.travel) = (1.0, 0.5);
    machine
}

fn course(turns: usize, tolerance: f64) -> Course {
    Course { judged: turns, tolerance, ..Course::turns(turns) }
}

fn at(positions: [f64; 3], velocities: [f64; 3]) -> Start {
    Start { positions, velocities }
}

#[test]
fn small_motion_on_the_sealed_cushion_has_its_natural_frequency() {
    let mut machine = afloat();
    let cushion = machine.cushion;
    let frequency = cushion.natural_frequency(machine.striker.mass);
    let omega = std::f64::consts::TAU * frequency;
    // n p₀A²/(m V₀), with V₀ = A L₀ + V_d.
    let volume = cushion.area * cushion.length + cushion.dead_volume;
    let stiffness = cushion.exponent * cushion.ambient * cushion.area.powi(2) / volume;
    assert!((omega * omega * machine.striker.mass / stiffness - 1.0).abs() < 1e-14);
    // A turn is a period; the piston does not move.
    machine.crank = Crank { radius: 1e-20, rod: 1.0, frequency };
    let amplitude = 1e-4 * cushion.length;
    let start = Some(at([amplitude, 1.0, 1.0], [0.0; 3]));
    let run = run(&machine, Rung::Sealed, &Course { start, samples: 4, ..course(2, 1e-13) }).unwrap();
    // The second turn begins where the first did. The frequency changes by some (a/L₀)² = 1e-8; a step's
    // error of 1e-13 p is 1e-9 of the change of the pressure.
    let again = &run.turns[1].samples;
    assert!((again[0].positions[0] / amplitude - 1.0).abs() < 1e-8);
    assert!((again[0].velocities[0] / (amplitude * omega)).abs() < 1e-7);
    // The trough is less deep than the crest is high, by some a/L₀.
    assert!((again[2].positions[0] / amplitude + 1.0).abs() < 3e-4);
}

#[test]
fn a_sealed_cushion_keeps_its_polytrope_and_gives_back_its_work() {
    for exponent in [1.0, 1.2, 1.4] {
        let mut machine = afloat();
        machine.cushion.exponent = exponent;
        let cushion = machine.cushion;
        let start = Some(at([0.0, 1.0, 1.0], [0.0; 3]));
        let run = run(&machine, Rung::Sealed, &Course { start, samples: 50, ..course(3, 1e-12) }).unwrap();
        let constant = cushion.ambient * cushion.rest_volume().powf(exponent);
        for turn in &run.turns {
            for sample in &turn.samples {
                let volume = cushion.volume(sample.positions[0], sample.piston);
                // Some hundred steps of 1e-12, and the dense output between their ends.
                assert!((sample.pressure * volume.powf(exponent) / constant - 1.0).abs() < 1e-9);
            }
            let book = turn.book;
            assert!(book.flow.abs() < 1e-9 && book.impacts == 0.0, "{book:?}");
            assert!((book.piston - book.kinetic - book.air).abs() < 1e-9, "{book:?}");
        }
    }
}

#[test]
fn energy_and_momentum_balance_on_every_rung() {
    let machine = Machine::example();
    for rung in &Rung::ALL[1..] {
        for speed in [7.0, 20.0, 45.0] {
            // Energies of some joules: an error of the tolerance in each of some hundred steps, magnified
            // where a step ends within by an event.
            for (tolerance, held) in [(1e-12, 1e-9), (1e-9, 1e-6)] {
                let machine = machine.clone().at_speed(speed);
                balances(&run(&machine, *rung, &course(12, tolerance)).unwrap(), &machine, held);
            }
        }
    }
}

/// Energies in J and momenta in N s of a run balance to `held`.
fn balances(run: &Run, machine: &Machine, held: f64) {
    let weight = machine.gravity * (machine.striker.mass + machine.intermediate.mass + machine.bit.mass);
    let mut before = 0.0;
    for turn in &run.turns {
        let what = format!("{:?} {} Hz", run.rung, machine.crank.frequency);
        assert!(turn.book.residual.abs() < held, "{what}: {:?}", turn.book);
        for part in [turn.book.impacts, turn.book.contacts, turn.book.seal] {
            assert!(part >= -1e-3 * held, "{what}: {:?}", turn.book);
        }
        let error = turn.momentum - before - (weight / machine.crank.frequency - turn.handle - turn.damper);
        assert!(error.abs() < held, "{what}: {error:e}");
        before = turn.momentum;
        for impact in turn.impacts.iter().filter(|impact| impact.duration == 0.0) {
            let [a, b] = [impact.before, impact.after].map(|v| v[0] - v[1]);
            let contact = machine.contacts[impact.interface as usize];
            assert!((b + contact.restitution * a).abs() < 1e-14 * 10.0);
        }
    }
}

#[test]
fn without_flow_the_flow_model_is_the_sealed_one() {
    let mut machine = Machine::example();
    let start = Some(at([0.0, machine.striker.strike, machine.striker.strike], [0.0; 3]));
    machine.flow.vents.clear();
    let course = Course { start, ..course(4, 1e-12) };
    let sealed = run(&machine, Rung::Sealed, &course).unwrap();
    let speeds = |run: &Run| -> Vec<f64> {
        run.turns.iter().flat_map(|turn| &turn.impacts).map(|impact| impact.before[0]).collect()
    };
    let expected = speeds(&sealed);
    assert!(expected.len() > 5);
    // What flows is proportional to the conductance: 1e-9 of that of a leakage of 1e-9 m³/(s Pa).
    machine.flow.leakage = 1e-18;
    for (found, expected) in speeds(&run(&machine, Rung::Vented, &course).unwrap()).iter().zip(expected) {
        assert!((found - expected).abs() < 1e-7, "{found} {expected}");
    }
}

#[test]
fn the_example_shows_the_three_motions_of_the_thesis() {
    let look = |speed: f64| {
        let course = Course { samples: 200, ..Course::turns(40) };
        let run = run(&Machine::example().at_speed(speed), Rung::Compliant, &course).unwrap();
        let samples = || run.turns.iter().flat_map(|turn| &turn.samples).map(|sample| sample.velocities[0]);
        let (up, down) = (samples().fold(0.0, f64::min), samples().fold(0.0, f64::max));
        (run, up, down)
    };
    // Low: it follows the piston at about 0.5 m/s up and down, and lands without a blow.
    let (low, up, down) = look(7.0);
    assert_eq!((low.regime, low.rate, low.caught), (Regime::NoBlow, 0.0, None));
    assert!((-0.6..-0.3).contains(&up) && (0.3..0.6).contains(&down), "{up} {down}");
    // Medium: up as before, in proportion to the speed; a peak of the pressure drives it faster than the
    // piston.
    let (medium, up, _) = look(18.0);
    let speed =
        |run: &Run| run.turns.iter().filter_map(|turn| turn.blow).map(|b| b.speed).fold(0.0, f64::max);
    assert!(medium.rate > 0.0 && (-1.6..-0.8).contains(&up), "{up}");
    assert!((2.0..4.0).contains(&speed(&medium)), "{}", speed(&medium));
    // Full: a blow at about 7.5 m/s in every turn, from rest on.
    let (full, ..) = look(45.0);
    assert_eq!(full.regime, Regime::EveryTurn);
    assert!(full.caught.unwrap() < 10);
    assert!((7.2..7.8).contains(&speed(&full)), "{}", speed(&full));
    assert!((2.0..5.0).contains(&full.blow_energy.unwrap()) && full.blow_scatter.unwrap() < 0.05);
    let bit = full.bit_energy.unwrap();
    assert!(bit > 0.3 * full.blow_energy.unwrap() && bit < full.blow_energy.unwrap());
}

#[test]
fn a_chatter_ends_after_the_sum_of_its_flights() {
    let (height, restitution) = (1e-3, 0.6);
    let mut machine = afloat().at_speed(4.0);
    machine.gravity = 9.81;
    machine.contacts[2] = Contact::rigid(restitution);
    // The bit falls on a rigid damper; the intermediate piston falls far behind it.
    let start = Some(at([0.0, 0.6, 1.0 - height], [0.0; 3]));
    let course = Course { start, samples: 1000, ..course(1, 1e-12) };
    let turn = run(&machine, Rung::Sealed, &course).unwrap().turns.remove(0);
    let fall = (2.0 * height / machine.gravity).sqrt();
    let end = fall * (1.0 + restitution) / (1.0 - restitution);
    let times: Vec<f64> = turn.impacts.iter().map(|impact| impact.time).collect();
    for (n, time) in times.iter().enumerate() {
        // Fall and n rebounds of 2Rⁿ times its duration; a position of 1 m is rounded to ε, a velocity of
        // 1e-3 m/s at the last impacts.
        let powers = restitution * (1.0 - restitution.powi(n as i32)) / (1.0 - restitution);
        assert!((time - fall * (1.0 + 2.0 * powers)).abs() < 1e-12, "{n} {time}");
    }
    assert!(times.len() > 10 && turn.chatters == 1 && end - times.last().unwrap() < 1e-5);
    // At rest the damper carries the weight; all of the energy m g h is lost.
    for sample in turn.samples.iter().filter(|sample| sample.angle > 1e-3 + end * 4.0 * std::f64::consts::TAU)
    {
        assert!((sample.damper / (machine.bit.mass * machine.gravity) - 1.0).abs() < 1e-12);
        assert!(sample.velocities[2] == 0.0 && (sample.positions[2] - 1.0).abs() < 1e-12);
    }
    let energy = machine.bit.mass * machine.gravity * height;
    assert!((turn.book.impacts - energy).abs() < 1e-10);
    // Without loss a low rebound never ends.
    machine.contacts[2] = Contact::rigid(1.0);
    let start = Some(at([0.0, 0.6, 1.0 - 1e-10], [0.0; 3]));
    let error = run(&machine, Rung::Sealed, &Course { start, ..course }).err().unwrap();
    assert!(error.to_string().contains("more than 20000 events in a turn"), "{error}");
}

#[test]
fn a_striker_sticks_until_the_force_exceeds_the_friction() {
    let mut machine = afloat();
    machine.crank.radius = 0.004;
    machine.striker.friction = 1e3;
    let start = Some(at([0.0, 1.0, 1.0], [0.0; 3]));
    let stuck = run(&machine, Rung::Friction, &Course { start, samples: 20, ..course(2, 1e-10) }).unwrap();
    for sample in stuck.turns.iter().flat_map(|turn| &turn.samples) {
        assert!(sample.velocities[0] == 0.0 && sample.positions[0] == 0.0, "{sample:?}");
    }
    assert_eq!(stuck.turns[1].book.seal, 0.0);
    // The force of the sealed cushion reaches 5 N where V = V₀(1 + F/(p₀A))^{−1/n}.
    machine.striker.friction = 5.0;
    machine.flow = Flow::SEALED;
    let moved = run(&machine, Rung::Friction, &Course { start, samples: 2000, ..course(1, 1e-12) }).unwrap();
    let cushion = machine.cushion;
    let part = (1.0 + 5.0 / (cushion.ambient * cushion.area)).powf(-1.0 / cushion.exponent);
    let limit = cushion.rest_volume() * (1.0 - part) / cushion.area;
    let samples = &moved.turns[0].samples;
    for sample in samples.iter().take_while(|sample| sample.angle < 3.0) {
        // A sample just beyond the limit may have moved by less than can be seen.
        assert!(sample.positions[0] == 0.0 || sample.piston > limit, "{sample:?}");
        assert!(sample.positions[0] > 0.0 || sample.piston < 1.1 * limit, "{sample:?}");
    }
}

#[test]
fn the_prescribed_striker_has_the_largest_speed_of_the_piston() {
    let machine = Machine::example();
    let run = run(&machine, Rung::Prescribed, &course(5, 1e-9)).unwrap();
    let speed = machine.crank.at(machine.crank.fastest())[1];
    for turn in &run.turns {
        assert_eq!(turn.blow.unwrap().speed, speed);
    }
    assert!((run.rate / machine.crank.frequency - 1.0).abs() < 1e-14 && run.steps == 0);
    // Striker on intermediate piston on bit: R = 0.8 for both.
    let bit = 1.8 * 0.28 / 0.71 * 1.8 * 0.14 / 0.42 * speed;
    assert!((run.bit_energy.unwrap() / (0.5 * 0.43 * bit * bit) - 1.0).abs() < 1e-12);
}

#[test]
fn the_ladder_chooses_the_cheapest_rung_within_its_tolerance() {
    let machine = Machine::example();
    let course = Course::turns(12);
    let ladder = climb(&machine, &course, 1e-3).unwrap();
    assert_eq!(ladder.chosen, Rung::Compliant);
    assert!(ladder.steps[0].error.unwrap() > 0.3, "a thrown striker is far too slow");
    let cost: Vec<usize> = ladder.steps.iter().map(|step| step.run.as_ref().unwrap().steps).collect();
    assert!(cost[1] < cost[2] && cost[3] < cost[4], "{cost:?}");
    assert_eq!(climb(&machine, &course, f64::INFINITY).unwrap().chosen, Rung::Prescribed);
}

#[test]
fn contacts_shorter_than_the_travel_of_waves_are_found() {
    let mut machine = Machine::example();
    let short = run(&machine, Rung::Compliant, &Course::turns(10)).unwrap().wave_limits;
    let limit = short.iter().find(|limit| limit.interface == Interface::Bit).unwrap();
    // 0.3 m of steel: 0.12 ms there and back; m c/l.
    assert!((limit.travel - 0.6 / 5100.0).abs() < 1e-18 && limit.contact < limit.travel);
    assert!((limit.impedance - 0.43 * 5100.0 / 0.3).abs() < 1e-9);
    machine.bit.length = 0.01;
    assert!(run(&machine, Rung::Compliant, &Course::turns(10)).unwrap().wave_limits.is_empty());
}

#[test]
fn impossible_machines_and_starts_are_refused() {
    let refused = |machine: &Machine, start: Option<Start>| {
        run(machine, Rung::Friction, &Course { start, ..Course::turns(2) }).err().unwrap().to_string()
    };
    let mut machine = Machine::example();
    let overlap =
        Some(at([machine.striker.strike + 1e-3, machine.striker.strike, machine.striker.strike], [0.0; 3]));
    let found = refused(&machine, overlap);
    assert!(found.contains("overlap by 0.00100 m"), "{found}");
    let behind = Some(at([-0.03, machine.striker.strike, machine.striker.strike], [0.0; 3]));
    assert!(refused(&machine, behind).contains("behind the piston"));
    machine.crank.rod = 0.01;
    assert!(refused(&machine, None).contains("crank.rod is 0.01 m"));
    machine = Machine::example();
    machine.flow.vents.reverse();
    assert!(refused(&machine, None).contains("flow.vents with positions"));
}

#[test]
fn a_machine_that_changes_at_top_dead_centre_goes_on() {
    let machine = Machine::example();
    let start = Start::rest(&machine);
    let mut plain = Motion::new(&machine, Rung::Compliant, &start, 1e-9).unwrap();
    let mut other = plain.clone();
    let mut slower = machine.clone().at_speed(40.0);
    slower.striker.friction = 4.0;
    for _ in 0..12 {
        // The same numbers change nothing but roundings: 1e-12 m is the error of a step, 1e-9 of 1 mm.
        other.change(&machine).unwrap();
        let [one, two] = [&mut plain, &mut other].map(|motion| motion.turn(Some(1)).unwrap());
        assert_eq!(one.impacts.len(), two.impacts.len());
        assert!(one.end.iter().zip(two.end).all(|(a, b)| (a - b).abs() < 1e-12), "{one:?} {two:?}");
    }
    let end = plain.turn(Some(1)).unwrap();
    plain.change(&slower).unwrap();
    let next = plain.turn(Some(4)).unwrap();
    assert_eq!((next.samples[0].positions, next.samples[0].piston), (end.end, 0.0));
    // 13 turns of 1/45 s; the impacts of the next lie in its 1/40 s. The energy book closes within the error
    // of the integration, 1e-9 in each of some 200 steps of 4 J.
    let begun = 13.0 / 45.0;
    assert!(!next.impacts.is_empty());
    assert!(next.impacts.iter().all(|impact| (begun..begun + 1.0 / 40.0).contains(&impact.time)));
    assert!(next.book.residual.abs() < 1e-6, "{}", next.book.residual);
    slower.bit.mass = 0.5;
    assert!(plain.change(&slower).unwrap_err().to_string().contains("another mass or gap"));
}
