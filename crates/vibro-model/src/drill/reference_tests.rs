//! Ten drawn machines against an integration by scipy, `fixtures/reference/drill/drill.py`.

use super::motion::Motion;
use super::{
    Bit, Book, Contact, Crank, Cushion, Flow, Impact, Interface, Intermediate, Machine, Rung, Start, Striker,
    Turn, Vent,
};
use crate::law::Law;

const REFERENCE: &str = include_str!("../../../../fixtures/reference/drill/drill.csv");

fn machine(rows: &[(&str, Vec<f64>)]) -> (Machine, Start) {
    let of = |name: &'static str| rows.iter().filter(move |row| row.0 == name).map(|row| &row.1);
    let m = of("machine").next().unwrap();
    let start = of("start").next().unwrap();
    let vents = of("vents").next().unwrap().chunks(2);
    let contacts: Vec<Contact> = of("contact")
        .map(|c| {
            let law = match c[1] as u32 {
                0 => None,
                1 => Some(Law::spring(c[2], c[4])),
                2 => Some(Law::hertz(c[2])),
                _ => Some(Law::curved(c[2], c[3], c[4])),
            };
            Contact { restitution: c[0], law }
        })
        .collect();
    let machine = Machine {
        crank: Crank { radius: m[0], rod: m[1], frequency: m[2] },
        cushion: Cushion {
            area: m[3],
            length: m[4],
            dead_volume: m[5],
            exponent: m[6],
            ambient: m[7],
            temperature: m[8],
        },
        flow: Flow {
            leakage: m[9],
            critical_ratio: m[10],
            vents: vents.map(|pair| Vent { position: pair[0], area: pair[1] }).collect(),
        },
        striker: Striker { mass: m[11], friction: m[12], damping: m[13], strike: m[16] },
        intermediate: Intermediate { mass: m[14], travel: m[17] },
        bit: Bit { mass: m[15], length: 0.3, clearance: m[18] },
        contacts: contacts.try_into().unwrap(),
        gravity: m[19],
    };
    let three = |i: usize| [start[i], start[i + 1], start[i + 2]];
    (machine, Start { positions: three(0), velocities: three(3) })
}

#[test]
fn ten_drawn_machines_move_as_in_an_independent_integration() {
    let rows: Vec<(&str, Vec<f64>)> = REFERENCE
        .lines()
        .map(|line| {
            let mut cells = line.split(',');
            (cells.next().unwrap(), cells.map(|cell| cell.parse().unwrap()).collect())
        })
        .collect();
    let machines: Vec<_> = rows.chunk_by(|_, next| next.0 != "machine").collect();
    assert_eq!(machines.len(), 10);
    for (index, rows) in machines.into_iter().enumerate() {
        let (machine, start) = machine(rows);
        let mut motion = Motion::new(&machine, Rung::Compliant, &start, 3e-14).unwrap();
        let turns: Vec<Turn> = (0..2).map(|_| motion.turn(Some(0)).unwrap()).collect();
        let impacts: Vec<&Impact> = turns.iter().flat_map(|turn| &turn.impacts).collect();
        let expected: Vec<_> = rows.iter().filter(|row| row.0 == "impact").map(|row| &row.1).collect();
        assert_eq!(impacts.len(), expected.len(), "machine {index}");
        // Steps err by 3e-14 in both; impacts and the compression of the air magnify this by up to some
        // thousand. Velocities and displacements are compared relative to 10 m/s and 20 mm, times to a turn.
        let speed = 10.0;
        for (impact, row) in impacts.iter().zip(expected) {
            assert_eq!(impact.interface, Interface::ALL[row[0] as usize], "machine {index}");
            let time = (impact.time - row[1]) * machine.crank.frequency;
            let found = [impact.before, impact.after].concat();
            let velocities = found.iter().zip(&row[2..]).map(|(a, b)| (a - b).abs() / speed);
            let error = velocities.fold(time.abs(), f64::max);
            assert!(error < 1e-9, "machine {index}, {:?} at {}: {error:e}", impact.interface, impact.time);
        }
        let end = &rows.iter().find(|row| row.0 == "end").unwrap().1;
        let sum = |of: fn(&Book) -> f64| turns.iter().map(|turn| of(&turn.book)).sum::<f64>();
        let works = [sum(|book| book.piston), sum(|book| book.seal), sum(|book| book.contacts)];
        let found = [&motion.state()[..], &works].concat();
        assert_eq!(found.len(), end.len());
        let scales = [0.02, 0.02, 0.02, speed, speed, speed, 1e5, 2e-5, 1.0, 1.0, 1.0];
        for (i, ((a, b), scale)) in found.iter().zip(end).zip(scales).enumerate() {
            assert!((a - b).abs() < 1e-9 * scale.max(b.abs()), "machine {index}, {i}: {a} {b}");
        }
    }
}
