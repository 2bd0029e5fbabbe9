use super::*;

const RATE: f64 = 1000.0;

fn reference() -> Vec<(String, Vec<f64>)> {
    include_str!("../../../../fixtures/filters/reference.csv")
        .lines()
        .map(|line| {
            let mut cells = line.split(',');
            let name = cells.next().unwrap().to_owned();
            (name, cells.map(|c| c.parse().unwrap()).collect())
        })
        .collect()
}

fn causal(filter: &Filter, values: &[f64]) -> Vec<f64> {
    let mut out = values.to_vec();
    filter.causal(&mut out, 0.0);
    out
}

fn named(text: &str) -> Filter {
    let words: Vec<&str> = text.split(' ').collect();
    let (order, corner) = (words[1].parse().unwrap(), words[2].parse().unwrap());
    match words[0] {
        "low" => Filter::low_pass(corner, order, RATE),
        _ => Filter::high_pass(corner, order, RATE),
    }
    .unwrap()
}

#[test]
fn agrees_with_scipy() {
    let reference = reference();
    let record = &reference[0].1;
    let mut worst = 0.0f64;
    for (name, expected) in &reference[1..] {
        let (way, filter) = name.split_once(' ').unwrap();
        if filter.starts_with("band") {
            continue;
        }
        let filter = named(filter);
        let found =
            if way == "causal" { causal(&filter, record) } else { filter.zero_phase(record).unwrap() };
        assert_eq!(found.len(), expected.len());
        for (a, b) in found.iter().zip(expected) {
            worst = worst.max((a - b).abs());
        }
        // Values of order one pass at most eight sections, and each forgets its rounding within some ten
        // samples.
        assert!(worst < 1e-12, "{name}: {worst:e}");
    }
    println!("largest difference from scipy: {worst:e}");
}

#[test]
fn corners_are_where_they_are_said() {
    let root = 0.5f64.sqrt();
    for order in 1..=MOST {
        let filters = [
            (Filter::low_pass(123.0, order, RATE).unwrap(), vec![123.0]),
            (Filter::high_pass(77.0, order, RATE).unwrap(), vec![77.0]),
            (Filter::smoothing(80.0, RATE).unwrap(), vec![80.0]),
        ];
        for (filter, corners) in filters {
            for corner in corners {
                // Sixteen sections with a few roundings each, times the slope that their sharp poles have at
                // the corner.
                let gain = filter.response(corner).norm();
                assert!((gain / root - 1.0).abs() < 1e-12, "{filter}: {gain}");
            }
        }
    }
}

#[test]
fn settled_filters_stand_still() {
    for filter in [
        Filter::low_pass(5.0, 5, RATE).unwrap(),
        Filter::high_pass(5.0, 5, RATE).unwrap(),
        Filter::smoothing(5.0, RATE).unwrap(),
    ] {
        let mut out = vec![3.0; 1000];
        filter.causal(&mut out, 3.0);
        let level = 3.0 * filter.response(0.0).re;
        // Rounding of the states: the poles keep it for 1/(2π·5 Hz) = 32 samples, and each section amplifies
        // it by as much.
        assert!(out.iter().all(|v| (v - level).abs() < 1e-9), "{filter}");
    }
}

#[test]
fn smoothing_is_the_recursion() {
    let filter = Filter::smoothing(20.0, RATE).unwrap();
    let alpha = filter.sections[0].b[0];
    let (record, mut y) = (&reference()[0].1, 0.0);
    for (x, found) in record.iter().zip(causal(&filter, record)) {
        y += alpha * (x - y);
        assert!((y - found).abs() < 1e-14);
    }
}

#[test]
fn impossible_filters_are_refused() {
    for (corner, order, rate) in
        [(0.0, 2, RATE), (500.0, 2, RATE), (f64::NAN, 2, RATE), (10.0, 0, RATE), (10.0, 17, RATE)]
    {
        assert!(Filter::low_pass(corner, order, rate).is_err());
        assert!(Filter::high_pass(corner, order, rate).is_err());
    }
    let filter = Filter::low_pass(10.0, 4, RATE).unwrap();
    let error = filter.zero_phase(&[1.0; 15]).unwrap_err().to_string();
    assert!(error.contains("15 samples") && error.contains("more than 15"), "{error}");
    assert!(filter.zero_phase(&[1.0; 16]).is_ok());
    let mut gap = vec![1.0; 50];
    gap[20] = f64::NAN;
    assert!(filter.zero_phase(&gap).unwrap_err().to_string().contains("sample 20"));
}
