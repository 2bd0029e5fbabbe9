use crate::reader::Reader;
use crate::recording::Recording;
use crate::write::{Storage, Target};
use vibro_record::units::Unit;
use vibro_record::{Axis, Meta, Record, Result, Trace};

fn read(name: &str, bytes: &[u8], span: (f64, f64)) -> Result<Recording> {
    Reader::new().span(Some(span)).from_reader(name, bytes)
}

#[test]
fn a_part_has_the_samples_and_times_of_the_whole() {
    // 100 samples at 8 Hz: all times are exact in a double.
    let values: Vec<f64> = (0..100).map(|i| f64::from(i) / 128.0).collect();
    let meta = Meta::new("v", Unit::parse("m/s").unwrap());
    let trace = Trace { meta, axis: Axis::time(2.0, 0.125, 100), values };
    let row = |(i, v): (usize, &f64)| format!("{},{v}\n", trace.axis.at(i));
    let rows = trace.values.iter().enumerate().map(row).collect::<Vec<_>>().concat();
    let mut wave = Vec::new();
    Target::Wav.write(&[Record::Trace(trace.clone())], Storage::default(), &mut wave).unwrap();
    for (name, bytes) in [("x.csv", format!("time [s],v [m/s]\n{rows}").as_bytes()), ("x.wav", &wave)] {
        let Record::Trace(part) = read(name, bytes, (3.0, 4.0)).unwrap().records.remove(0) else { panic!() };
        assert_eq!(part.axis, Axis::time(3.0, 0.125, 8), "{name}");
        assert_eq!(part.values, trace.values[8..16], "{name}");
        let all = read(name, bytes, (0.0, 1e9)).unwrap().records.remove(0);
        assert_eq!(all.len(), 100, "{name}");
        let beyond = |to: f64| {
            let record = read(name, bytes, (3.0, to)).unwrap().records.remove(0);
            record.meta().findings.iter().any(|found| found.code == "span-beyond-record")
        };
        // The record ends at 2 s + 100/8 s.
        assert!(beyond(99.0) && !beyond(14.5) && !beyond(f64::INFINITY), "{name}");
        let said = read(name, bytes, (20.0, 30.0)).unwrap_err().to_string();
        assert!(said.contains("no sample from 20 to 30 s; expected a part of 2 to 14.5 s"), "{said}");
        assert!(read(name, bytes, (4.0, 3.0)).unwrap_err().to_string().contains("a time, and a later one"));
    }
}

#[test]
fn parts_have_open_ends_and_count_from_1970_where_the_file_does() {
    let rows = (0..100).map(|i| format!("{}.5,{i}\n", 1_700_000_000 + i)).collect::<Vec<_>>().concat();
    let text = format!("timestamp,a (V)\n{rows}");
    let begun = 1_700_000_000.5;
    let ends = (f64::NEG_INFINITY, f64::INFINITY);
    for (span, first, n) in [
        ((10.0, 20.0), 10.0, 10),
        ((begun + 10.0, begun + 20.0), 10.0, 10),
        ((begun + 90.0, ends.1), 90.0, 10),
        ((ends.0, begun + 5.0), 0.0, 5),
        ((95.0, ends.1), 95.0, 5),
    ] {
        let Record::Trace(part) = read("x.csv", text.as_bytes(), span).unwrap().records.remove(0) else {
            panic!()
        };
        assert_eq!((part.values[0], part.values.len()), (first, n), "{span:?}");
    }
}

#[test]
fn what_is_not_over_time_has_no_part() {
    let said = read("x.csv", b"frequency [Hz],a [m]\n0,1\n1,2\n2,3\n", (0.0, 1.0)).unwrap_err();
    assert!(said.to_string().contains("no record is over time"), "{said}");
}
