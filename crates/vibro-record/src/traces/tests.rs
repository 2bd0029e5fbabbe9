use super::*;
use crate::units::Unit;

#[test]
fn two_channels_of_one_name_go_by_their_numbers() {
    let twins = [Meta::new("a", Unit::opaque("V")), Meta::new("a", Unit::opaque("V"))];
    let found = |wanted| find_channel(Path::new("x"), wanted, twins.iter().map(Meta::called));
    assert!(found("a").unwrap_err().to_string().contains("2 channels are called"));
    assert_eq!(found("2").unwrap(), 1);
}

#[test]
fn a_name_in_another_case_is_that_of_the_only_channel_it_can_be() {
    let all = ["Force", "Kraft Ä", "a", "A"].map(|name| Meta::new(name, Unit::opaque("V")));
    let found = |wanted| find_channel(Path::new("x"), wanted, all.iter().map(Meta::called));
    assert_eq!((found("force").unwrap(), found("KRAFT ä").unwrap(), found("A").unwrap()), (0, 1, 3));
    assert!(found("forces").unwrap_err().to_string().contains("no channel"));
}

#[test]
fn a_quantity_is_the_name_of_the_only_channel_that_has_it() {
    let all = [("Hammer", "N"), ("Acc 1", "m/s²"), ("Acc 2", "m/s²")];
    let all = all.map(|(name, unit)| Meta::new(name, Unit::parse(unit).unwrap()));
    let found = |wanted| find_channel(Path::new("x"), wanted, all.iter().map(Meta::called)).unwrap_err();
    assert!(found("Force").to_string().contains("try: \"Hammer\""), "{}", found("Force"));
    assert!(found("acceleration").to_string().contains("try: one of these names"));
}

/// Two files of one clock, each with its own time origin. At 1 kHz a hundredth of a sample is 10 µs.
#[test]
fn traces_of_two_files_begin_together_wherever_they_count_from() {
    let trace = |origin: f64, start: f64| {
        let mut meta = Meta::new("a", Unit::opaque("V"));
        meta.origin = origin;
        Trace { meta, axis: crate::Axis::time(start, 1e-3, 4), values: vec![0.0; 4] }
    };
    let together = |a, b| Traces::from_memory(vec![a, b]).map(|traces| traces.frames());
    assert_eq!(together(trace(1.7e9, 0.0), trace(1.7e9, 5e-6)).unwrap(), 4);
    assert_eq!(together(trace(1.7e9, 0.5), trace(1.7e9 + 0.5, 0.0)).unwrap(), 4);
    let apart = together(trace(1.7e9, 0.0), trace(1.7e9 + 0.003, 0.0)).unwrap_err().to_string();
    assert!(apart.contains("sampled together"), "{apart}");
}

#[test]
fn samples_that_were_looked_at_are_still_handed_out() {
    let all: Vec<f64> = (0..3 * BLOCK).map(|i| i as f64).collect();
    let axis = crate::Axis::time(0.0, 1e-3, all.len());
    let trace = Trace { meta: Meta::new("a", Unit::opaque("V")), axis, values: all.clone() };
    for looked_at in [0, 1, BLOCK + 1, usize::MAX] {
        let mut traces = Traces::from_memory(vec![trace.clone()]).unwrap();
        traces.calibrate(0, 2.0).unwrap();
        for _ in 0..2 {
            let seen = traces.peek(looked_at).unwrap();
            assert!(seen.first().map_or(0, Vec::len) >= looked_at.min(all.len()));
        }
        let mut block = Vec::new();
        while traces.append(&mut block).unwrap() > 0 {}
        let doubled: Vec<f64> = all.iter().map(|v| 2.0 * v).collect();
        assert!(block[0] == doubled, "{looked_at}");
    }
}
