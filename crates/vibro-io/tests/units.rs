//! Units that are stated for single channels of a file, by name or by number.

use vibro_io::Reader;
use vibro_record::units::Unit;
use vibro_record::{Record, Trace};

/// Two channels without units.
const HAMMER: &str = "time [s],Hammer,Acc\n0,1,2\n0.1,-3,4\n0.2,5,6.1\n";

/// A reader with these units of channels.
fn reader(units: &[(&str, &str)]) -> Reader {
    let stated = units.iter().map(|(name, unit)| ((*name).to_owned(), Unit::parse(unit).unwrap()));
    Reader::new().channel_units(stated.collect())
}

fn traces(reader: &Reader, text: &str) -> Vec<Trace> {
    let all = reader.from_reader("a.csv", text.as_bytes()).unwrap().records;
    all.into_iter().map(|r| if let Record::Trace(trace) = r { trace } else { panic!("no trace") }).collect()
}

/// The channel is converted to the same bits as by the unit of all channels, and nothing is left to say.
#[test]
fn each_channel_has_the_unit_that_is_stated_for_it() {
    for units in [[("Hammer", "N"), ("Acc", "g")], [("1", "N"), ("acc", "g")]] {
        let [force, acc] = &traces(&reader(&units), HAMMER)[..] else { panic!("two channels") };
        let all_g = traces(&Reader::new().unit(Unit::parse("g")), HAMMER);
        assert_eq!((force.meta.unit.symbol(), &*force.values), ("N", &[1.0, -3.0, 5.0][..]));
        assert_eq!((acc.meta.unit.symbol(), &acc.values), ("m/s²", &all_g[1].values));
        assert!(force.meta.findings.is_empty() && acc.meta.findings.is_empty(), "{:?}", acc.meta.findings);
    }
}

/// mm/s of the file is taken back: 2 mm/s that are g stand for 2 g. Both factors round once.
#[test]
fn a_unit_of_the_file_is_overridden_and_said_once() {
    let text = HAMMER.replace("Acc", "Acc (mm/s)");
    let stated = reader(&[("Acc", "g")]);
    let all = traces(&stated, &text);
    assert!((all[1].values[0] / (2.0 * 9.806_65) - 1.0).abs() < 3.0 * f64::EPSILON);
    let codes: Vec<&str> = all[1].meta.findings.iter().map(|f| &*f.code).collect();
    assert_eq!(codes, ["unit-overrides-file"]);
    // A survey reads the same range.
    let (_, headers, _) = {
        let folder = std::env::temp_dir().join(format!("vibro-units-{}.csv", std::process::id()));
        std::fs::write(&folder, &text).unwrap();
        let found = stated.survey(&folder).unwrap();
        std::fs::remove_file(folder).unwrap();
        found
    };
    assert_eq!((headers[1].max, headers[1].unit.as_str()), (Some(all[1].values[2]), "m/s²"));
    // The other channels have the unit of all.
    let both = traces(&reader(&[("Acc", "N")]).unit(Unit::parse("g")), HAMMER);
    assert_eq!([0, 1].map(|i| both[i].meta.unit.symbol()), ["m/s²", "N"]);
    assert!(both[1].values == [2.0, 4.0, 6.1] && both[1].meta.findings.is_empty());
}

#[test]
fn an_unknown_channel_and_two_units_of_one_are_refused() {
    let error = |units: &[(&str, &str)]| {
        reader(units).from_reader("a.csv", HAMMER.as_bytes()).unwrap_err().to_string()
    };
    let unknown = error(&[("Hamer", "N")]);
    for words in ["a.csv", "\"Hamer\"", "1 \"Hammer\", 2 \"Acc\"", "try: \"Hammer\""] {
        assert!(unknown.contains(words), "{unknown}");
    }
    assert!(error(&[("Acc", "N"), ("2", "g")]).contains("two units of channel \"2\", N and g"));
}

/// A wave file is streamed: the unit of a channel turns its fraction of full scale into 1 of that unit.
#[test]
fn a_channel_of_a_stream_has_its_unit() {
    let samples: Vec<u8> = [16_384i16, 8192, -16_384, 0].iter().flat_map(|v| v.to_le_bytes()).collect();
    let mut bytes = b"RIFF\0\0\0\0WAVEfmt \x10\0\0\0\x01\0\x02\0".to_vec();
    bytes.extend([1000u32.to_le_bytes(), 4000u32.to_le_bytes(), [4, 0, 16, 0]].concat());
    bytes.extend([b"data".as_slice(), &8u32.to_le_bytes(), &samples].concat());
    bytes[4..8].copy_from_slice(&44u32.to_le_bytes());
    let path = std::env::temp_dir().join(format!("vibro-units-{}.wav", std::process::id()));
    std::fs::write(&path, bytes).unwrap();
    let mut stream = reader(&[("channel 2", "mm/s"), ("1", "N")]).stream_channels(&path, &["2"]).unwrap();
    let mut block = Vec::new();
    stream.next_block(&mut block).unwrap();
    std::fs::remove_file(path).unwrap();
    assert_eq!((block, stream.channels()[0].unit.symbol()), (vec![vec![0.25e-3, 0.0]], "m/s"));
    let codes: Vec<&str> = stream.channels()[0].findings.iter().map(|f| &*f.code).collect();
    assert_eq!(codes, ["full-scale-stated"]);
}
