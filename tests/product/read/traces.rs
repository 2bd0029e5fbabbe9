//! Traces read block by block, compared with reading the whole file.

use std::path::{Path, PathBuf};
use vibroimpact::Error;
use vibroimpact::read::Reader;
use vibroimpact::record::Traces;
use vibroimpact::record::{Axis, Meta, Record, Trace};
use vibroimpact::units::Unit;
use vibroimpact::write::{Storage, Target};

fn trace(name: &str, unit: &str, rate: f64, values: Vec<f64>) -> Record {
    let meta = Meta::new(name, Unit::parse(unit).unwrap());
    Record::Trace(Trace { meta, axis: Axis::time(0.5, 1.0 / rate, values.len()), values })
}

fn file(folder: &Path, name: &str, records: &[Record]) -> PathBuf {
    let path = folder.join(name);
    let mut out = Vec::new();
    Target::of(&path).unwrap().write(records, Storage::default(), &mut out).unwrap();
    std::fs::write(&path, out).unwrap();
    path
}

fn all(traces: &mut Traces) -> (Vec<Vec<f64>>, usize) {
    let mut columns = vec![Vec::new(); traces.channels().len()];
    let (mut block, mut blocks) = (Vec::new(), 0);
    while traces.next_block(&mut block).unwrap() > 0 {
        for (column, part) in columns.iter_mut().zip(&block) {
            column.extend_from_slice(part);
        }
        blocks += 1;
    }
    (columns, blocks)
}

/// Streaming gives the same values and findings as reading the whole file.
#[test]
fn streaming_agrees_with_reading() {
    let folder = tempfile::tempdir().unwrap();
    let values = |k: usize| (0..50_000).map(|i| ((i * 7 + k) % 1009) as f64 * 0.37).collect::<Vec<f64>>();
    let records = [trace("force", "N", 51_200.0, values(0)), trace("velocity", "m/s", 51_200.0, values(5))];
    for name in ["x.wav", "x.ufb", "x.csv"] {
        let path = file(folder.path(), name, &records);
        let recording = Reader::new().from_path(&path).unwrap();
        let mut traces = Reader::new().stream(&path).unwrap();
        assert_eq!((traces.frames(), traces.start()), (50_000, 0.5), "{name}");
        assert!((traces.rate() / 51_200.0 - 1.0).abs() < 1e-9);
        let metas: Vec<&Meta> = recording.records.iter().map(Record::meta).collect();
        assert_eq!(traces.channels().iter().collect::<Vec<_>>(), metas, "{name}");
        let (columns, blocks) = all(&mut traces);
        assert!(blocks > 2, "{name}");
        assert_eq!(traces.findings(), recording.all_findings(), "{name}");
        for (column, record) in columns.iter().zip(&recording.records) {
            let Record::Trace(whole) = record else { panic!() };
            assert!(*column == whole.values, "{name}");
        }
        let mut one = Reader::new().stream_channels(&path, &["velocity"]).unwrap();
        assert_eq!(one.channels().len(), 1);
        assert!(all(&mut one).0[0] == columns[1], "{name}");
        let mut turned = Reader::new().stream(&path).unwrap();
        turned.keep(&[1, 0]);
        turned.keep(&[1]);
        assert_eq!(turned.channels()[0].name, "force");
        assert!(all(&mut turned).0[0] == columns[0], "{name}");
    }
}

#[test]
fn a_channel_is_found_by_name_or_number() {
    let folder = tempfile::tempdir().unwrap();
    let records = [trace("2", "N", 8.0, vec![1.0; 4]), trace("b", "m", 8.0, vec![2.0; 4])];
    let traces = Reader::new().stream(file(folder.path(), "x.ufb", &records)).unwrap();
    // A channel name takes precedence over a channel number.
    assert_eq!(
        (traces.channel("2").unwrap(), traces.channel("1").unwrap(), traces.channel("b").unwrap()),
        (0, 0, 1)
    );
    let error = traces.channel("3").unwrap_err().to_string();
    assert!(error.contains("no channel \"3\"") && error.contains("1 \"2\", 2 \"b\""), "{error}");
}

#[test]
fn channels_that_were_not_sampled_together_are_refused_with_both_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let rates = [trace("a", "N", 8.0, vec![1.0; 4]), trace("b", "m", 16.0, vec![2.0; 4])];
    let path = file(folder.path(), "rates.ufb", &rates);
    let error = Reader::new().stream(&path).err().unwrap().to_string();
    assert!(error.contains("a rate of 8 Hz") && error.contains("16 Hz"), "{error}");
    assert_eq!(Reader::new().stream_channels(&path, &["b"]).unwrap().rate(), 16.0);
    let lengths = [trace("a", "N", 8.0, vec![1.0; 4]), trace("b", "m", 8.0, vec![2.0; 5])];
    let path = file(folder.path(), "lengths.ufb", &lengths);
    let error = Reader::new().stream(&path).err().unwrap().to_string();
    assert!(error.contains("4 samples") && error.contains("\"b\" 5"), "{error}");
}

#[test]
fn a_file_without_a_clock_asks_for_the_rate() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.txt");
    std::fs::write(&path, "1\n2\n3\n4\n").unwrap();
    let error = Reader::new().stream(&path).err().unwrap().to_string();
    assert!(error.contains("(rate, base_band)"), "{error}");
    assert_eq!(Reader::new().rate(Some(100.0)).stream(&path).unwrap().rate(), 100.0);
}

#[test]
fn missing_samples_of_a_wave_are_refused_with_their_frames_or_kept() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.wav");
    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: 48_000,
        bits_per_sample: 32,
        sample_format: hound::SampleFormat::Float,
    };
    let mut writer = hound::WavWriter::create(&path, spec).unwrap();
    for i in 0..100_000 {
        writer.write_sample(if i == 99_000 || i == 99_002 { f32::NAN } else { 0.5f32 }).unwrap();
    }
    writer.finalize().unwrap();
    let read = |reader: Reader| {
        let (mut traces, mut block, mut missing) = (reader.stream(&path)?, Vec::new(), 0);
        while traces.next_block(&mut block)? > 0 {
            missing += block[0].iter().filter(|v| v.is_nan()).count();
        }
        Ok::<usize, Error>(missing)
    };
    let error = read(Reader::new()).unwrap_err().to_string();
    assert!(error.contains("2 samples NaN") && error.contains("99000 of channel 1, 99002 of"), "{error}");
    assert_eq!(read(Reader::new().allow_missing(true)).unwrap(), 2);
}

#[test]
fn a_calibration_multiplies_what_comes() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(folder.path(), "x.wav", &[trace("a", "m/s", 48_000.0, vec![0.5; 10])]);
    let mut traces = Reader::new().stream(&path).unwrap();
    traces.calibrate(0, -4.0).unwrap();
    assert_eq!(all(&mut traces).0[0], [-2.0; 10]);
    assert!(traces.calibrate(0, 0.0).is_err() && traces.calibrate(1, 1.0).is_err());
}
