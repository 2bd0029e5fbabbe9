use super::*;
use crate::reader::Reader;
use vibro_record::Fact;

/// Rows of a phone: three axes and `last` computed from them, printed with the given number of decimals.
fn marked(decimals: usize, last: impl Fn([f64; 3]) -> f64) -> Vec<Vec<Finding>> {
    let row = |i: i32| {
        let t = f64::from(i) / 200.0;
        let [x, y, z] = [(58.0 * t).sin(), 0.3 * (58.0 * t).cos(), 0.2 * (91.0 * t).sin()];
        format!("{t},{x:.decimals$},{y:.decimals$},{z:.decimals$},{:.decimals$}\n", last([x, y, z]))
    };
    let text = "t (s),x (g),y (g),z (g),a (g)\n".to_owned() + &(0..900).map(row).collect::<String>();
    let (reader, path) = (Reader::new(), "x.csv");
    let source = crate::source::Source::memory(path, text.as_bytes()).unwrap();
    let read = reader.read(&source).unwrap().records;
    let read: Vec<Vec<Finding>> = read.iter().map(|record| record.meta().findings.clone()).collect();
    let surveyed: Vec<_> = reader.headers(&source).unwrap().1.into_iter().map(|h| h.findings).collect();
    assert_eq!(read, surveyed);
    read
}

/// Channels: a counter, a small component, a large component, and their magnitude.
#[test]
fn the_channel_to_name_is_the_component_that_moves_most() {
    let row = |i: i32| {
        let (x, y) = ((0.3 * f64::from(i)).sin() / 8.0, (0.3 * f64::from(i)).sin());
        format!("{},{i},{x},{y},{}\n", f64::from(i) / 200.0, x.hypot(y))
    };
    let text = "t (s),beat (g),x (g),y (g),a (g)\n".to_owned() + &(0..200).map(row).collect::<String>();
    let read = Reader::new().from_reader("x.csv", text.as_bytes()).unwrap();
    let said = read.trace(None, None).unwrap_err().to_string();
    assert!(said.contains("channel = \"y\""), "{said}");
}

#[test]
fn the_length_of_a_vector_is_told_from_what_is_measured() {
    let length = |v: [f64; 3]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
    let caution = Finding::caution("magnitude").name("components", "x, y, z");
    for decimals in [2, 5, 12] {
        let found = marked(decimals, length);
        assert_eq!(found, [vec![], vec![], vec![], vec![caution.clone()]], "{decimals}");
    }
    assert_eq!(marked(5, |[x, y, _]| x.hypot(y))[3][0].fact("components"), Some(&Fact::Name("x, y".into())));
    // No magnitudes: a copy, a rectified channel, and a magnitude with an error of 5 %.
    for other in [|v: [f64; 3]| v[0], |v: [f64; 3]| v[0].abs(), |v: [f64; 3]| 1.05 * v[0].hypot(v[1])] {
        assert_eq!(marked(5, other), vec![vec![]; 4]);
    }
}
