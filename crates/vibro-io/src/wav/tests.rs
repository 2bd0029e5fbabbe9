use super::*;
use crate::format::Format;
use crate::reader::Header;
use crate::reader::Reader;
use crate::recording::Recording;
use crate::tests::has_finding;
use proptest::prelude::*;
use vibro_record::units::Quantity;

/// A wave file of one fmt and one data chunk.
fn wav(tag: u16, channels: u16, bits: u16, samples: &[u8]) -> Vec<u8> {
    chunks(&[(b"fmt ", fmt(tag, channels, bits)), (b"data", samples.to_vec())])
}

fn fmt(tag: u16, channels: u16, bits: u16) -> Vec<u8> {
    let frame = channels * bits.div_ceil(8);
    let mut out = Vec::new();
    out.extend(tag.to_le_bytes());
    out.extend(channels.to_le_bytes());
    out.extend(48_000u32.to_le_bytes());
    out.extend((48_000 * u32::from(frame)).to_le_bytes());
    out.extend(frame.to_le_bytes());
    out.extend(bits.to_le_bytes());
    out
}

fn extensible(tag: u16, channels: u16, container: u16, valid: u16) -> Vec<u8> {
    let mut out = fmt(0xfffe, channels, container);
    out.extend(22u16.to_le_bytes());
    out.extend(valid.to_le_bytes());
    out.extend(0u32.to_le_bytes());
    out.extend(tag.to_le_bytes());
    out.extend([0, 0, 0, 0, 0x10, 0, 0x80, 0, 0, 0xaa, 0, 0x38, 0x9b, 0x71]);
    out
}

fn chunks(list: &[(&[u8; 4], Vec<u8>)]) -> Vec<u8> {
    let mut body = Vec::new();
    for (id, content) in list {
        body.extend(*id);
        body.extend((content.len() as u32).to_le_bytes());
        body.extend(content);
        body.extend(std::iter::repeat_n(0, content.len() % 2));
    }
    let mut out = b"RIFF".to_vec();
    out.extend((body.len() as u32 + 4).to_le_bytes());
    out.extend(b"WAVE");
    out.extend(body);
    out
}

fn read_bytes(bytes: &[u8]) -> Result<Recording> {
    Reader::new().read(&Source::memory("x.wav", bytes)?)
}

fn values(bytes: &[u8]) -> Vec<Vec<f64>> {
    let recording = read_bytes(bytes).unwrap();
    recording
        .records
        .into_iter()
        .map(|r| match r {
            Record::Trace(t) => t.values,
            other => panic!("{other:?}"),
        })
        .collect()
}

fn pcm16(values: &[i16]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

#[test]
fn every_kind_of_sample_is_a_fraction_of_full_scale() {
    assert_eq!(values(&wav(1, 1, 8, &[0, 128, 255])), [[-1.0, 0.0, 127.0 / 128.0]]);
    assert_eq!(
        values(&wav(1, 2, 16, &pcm16(&[-32_768, 16_384, 1, 0]))),
        [[-1.0, 1.0 / 32_768.0], [0.5, 0.0]]
    );
    assert_eq!(values(&wav(1, 1, 24, &[0, 0, 0x80, 0xff, 0xff, 0xff])), [[-1.0, -1.0 / 8_388_608.0]]);
    assert_eq!(values(&wav(1, 1, 32, &[0, 0, 0, 0x40])), [[0.5]]);
    assert_eq!(values(&wav(3, 1, 32, &0.1f32.to_le_bytes())), [[f64::from(0.1f32)]]);
    assert_eq!(values(&wav(3, 1, 64, &0.1f64.to_le_bytes())), [[0.1]]);
}

#[test]
fn a_record_says_what_it_is() {
    let recording = read_bytes(&wav(1, 2, 16, &pcm16(&[1, 2, 3, 4, 5, 6]))).unwrap();
    let [Record::Trace(left), Record::Trace(right)] = recording.records.as_slice() else { panic!() };
    assert_eq!((left.meta.name.as_str(), right.meta.name.as_str()), ("channel 1", "channel 2"));
    assert_eq!((left.meta.unit.symbol(), left.meta.quantity), ("FS", Quantity::Other));
    assert_eq!(left.meta.findings, [Finding::caution("uncalibrated")]);
    assert_eq!(left.meta.declared_n, Some(3));
    assert_eq!(left.axis, Axis::time(0.0, 1.0 / 48_000.0, 3));
    assert!(recording.findings.is_empty());
    assert_eq!(recording.format, Format::Wav);
}

#[test]
fn the_extensible_form_names_its_sub_format() {
    let float = chunks(&[(b"fmt ", extensible(3, 1, 32, 32)), (b"data", 0.25f32.to_le_bytes().to_vec())]);
    assert_eq!(values(&float), [[0.25]]);
    let padded = chunks(&[(b"fmt ", extensible(1, 1, 32, 24)), (b"data", vec![0, 0, 0, 0x40])]);
    assert_eq!(values(&padded), [[0.5]]);
    assert!(read_bytes(&padded).unwrap().findings[0].code == "bits-left-justified");
    let strange = chunks(&[(b"fmt ", extensible(0x99, 1, 32, 32)), (b"data", vec![0; 4])]);
    assert!(read_bytes(&strange).unwrap_err().to_string().contains("0x0099"));
}

#[test]
fn unknown_and_odd_chunks_are_passed_over() {
    let list = b"INFOICMT\x06\0\0\0drill\0ISFT\x03\0\0\0abc\0".to_vec();
    let whole = chunks(&[
        (b"bext", vec![7; 5]),
        (b"fmt ", fmt(1, 1, 16)),
        (b"junk", vec![1]),
        (b"data", pcm16(&[8192])),
        (b"LIST", list),
    ]);
    assert_eq!(values(&whole), [[0.25]]);
    let notes = &read_bytes(&whole).unwrap().records[0].meta().notes.clone();
    assert_eq!(*notes, [("ICMT".into(), "drill".into()), ("ISFT".into(), "abc".into())]);
    // The same without the zero byte after the odd chunk, which some writers leave out.
    let at = whole.windows(4).position(|w| w == b"junk").unwrap();
    let unpadded = [&whole[..at + 9], &whole[at + 10..]].concat();
    assert_eq!(values(&unpadded), [[0.25]]);
}

#[test]
fn a_length_that_was_never_filled_in_means_to_the_end() {
    for size in [0, 0xffff_ffffu32] {
        let mut bytes = wav(1, 1, 16, &pcm16(&[1, -1, 2, -2]));
        bytes[40..44].copy_from_slice(&size.to_le_bytes());
        let recording = read_bytes(&bytes).unwrap();
        assert_eq!(recording.records[0].len(), 4);
        assert_eq!(recording.records[0].meta().declared_n, None);
        assert!(has_finding(&recording.findings, "length-open", &["frames=4"]), "{:?}", recording.findings);
    }
}

#[test]
fn a_truncated_file_says_both_numbers() {
    let mut bytes = wav(1, 1, 16, &pcm16(&[1, -1, 2, -2]));
    bytes.truncate(bytes.len() - 3);
    let recording = read_bytes(&bytes).unwrap();
    assert_eq!(recording.records[0].len(), 2);
    assert_eq!(recording.records[0].meta().declared_n, Some(4));
    assert!(
        has_finding(&recording.findings, "fewer-values", &["declared=4", "n=2"]),
        "{:?}",
        recording.findings
    );
    assert!(has_finding(&recording.findings, "part-of-frame", &["bytes=1"]), "{:?}", recording.findings);
}

/// A header that declares 10 GB, followed by 20 bytes.
fn huge(form: [u8; 4]) -> Vec<u8> {
    let mut ds64 = 10_000_000_000u64.to_le_bytes().to_vec();
    ds64.extend(10_000_000_000u64.to_le_bytes());
    ds64.extend([0; 12]);
    let mut bytes = chunks(&[(b"ds64", ds64), (b"fmt ", fmt(1, 1, 16)), (b"data", vec![1; 20])]);
    bytes[..4].copy_from_slice(&form);
    let at = bytes.len() - 24;
    bytes[at..at + 4].fill(0xff);
    bytes
}

#[test]
fn rf64_takes_its_length_from_ds64_and_allocates_what_is_there() {
    for form in [*b"RF64", *b"BW64"] {
        let recording = read_bytes(&huge(form)).unwrap();
        let Record::Trace(trace) = &recording.records[0] else { panic!() };
        assert_eq!(trace.values.len(), 10);
        assert!(trace.values.capacity() < 100);
        assert_eq!(trace.meta.declared_n, Some(5_000_000_000));
        assert!(
            has_finding(&recording.findings, "fewer-values", &["declared=5000000000"]),
            "{:?}",
            recording.findings
        );
        let source = Source::memory("x.wav", huge(form)).unwrap();
        let mut stream = Wave::open(&source, &Options::default()).unwrap();
        assert_eq!(stream.frames(), 10);
        let mut block = Vec::new();
        assert_eq!(stream.append(&mut block).unwrap(), 10);
        assert!(block[0].capacity() < 100);
    }
}

#[test]
fn what_is_not_read_is_named() {
    let cases: [(Vec<u8>, &str); 7] = [
        (wav(7, 1, 8, &[1, 2]), "tag 0x0007"),
        (wav(1, 0, 16, &[1, 2]), "0 channels"),
        (wav(1, 1, 64, &[0; 8]), "integers of 64 bits"),
        (wav(1, 1, 16, &[]), "0 bytes of samples"),
        (wav(1, 1, 16, &[1]), "1 bytes of samples"),
        (chunks(&[(b"data", vec![0; 4])]), "no fmt chunk"),
        (chunks(&[(b"fmt ", fmt(1, 1, 16))]), "no data chunk"),
    ];
    for (bytes, word) in cases {
        let error = read_bytes(&bytes).unwrap_err().to_string();
        assert!(error.contains(word) && error.contains("x.wav, byte"), "{error}");
    }
    let mut uneven = fmt(1, 2, 16);
    uneven[12] = 5;
    let error = read_bytes(&chunks(&[(b"fmt ", uneven), (b"data", vec![0; 10])])).unwrap_err().to_string();
    assert!(error.contains("5 bytes a frame"), "{error}");
}

#[test]
fn missing_samples_are_refused_with_their_frames_or_kept() {
    let samples: Vec<u8> = [0.5f32, f32::NAN, f32::INFINITY].iter().flat_map(|v| v.to_le_bytes()).collect();
    let bytes = wav(3, 1, 32, &samples);
    let error = read_bytes(&bytes).unwrap_err().to_string();
    assert!(error.contains("2 samples NaN") && error.contains("1 of channel 1, 2 of channel 1"), "{error}");
    let kept = Reader::new().allow_missing(true).from_reader("x.wav", bytes.as_slice()).unwrap();
    let Record::Trace(trace) = &kept.records[0] else { panic!() };
    assert!(trace.values[0] == 0.5 && trace.values[1].is_nan() && trace.values[2].is_nan());
}

#[test]
fn statements_of_a_person_win_with_a_doubt() {
    let bytes = wav(3, 1, 32, &2.5f32.to_le_bytes());
    let plain = read_bytes(&bytes).unwrap();
    assert!(plain.records[0].meta().findings[1] == Finding::caution("beyond-full-scale").number("max", 2.5));
    let reader = Reader::new().rate(Some(1000.0)).unit(Unit::parse("mm/s"));
    let recording = reader.from_reader("x.wav", bytes.as_slice()).unwrap();
    let Record::Trace(trace) = &recording.records[0] else { panic!() };
    assert_eq!((trace.values[0], trace.meta.unit.symbol()), (2.5 * 1e-3, "m/s"));
    assert_eq!(trace.rate(), Some(1000.0));
    assert!(
        has_finding(&trace.meta.findings, "statement-overrides-file", &["file=48000", "used=1000"]),
        "{:?}",
        trace.meta.findings
    );
    assert!(
        has_finding(&trace.meta.findings, "full-scale-stated", &["unit=mm/s"]),
        "{:?}",
        trace.meta.findings
    );
    let error = Reader::new().base_band(Some(100.0)).from_reader("x.wav", bytes.as_slice()).unwrap_err();
    assert!(error.to_string().contains("base band"));
}

/// Survey and stream must agree with reading the whole file, also across the borders of blocks.
#[test]
fn survey_and_stream_agree_with_reading() {
    let n = 60_000usize;
    // 7 and 11 have no common factor with 65536, so the sequence has no short period.
    let samples: Vec<i16> =
        (0..3 * n).map(|i| (i.wrapping_mul(7).wrapping_add(11 * (i % 3))) as i16).collect();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("three.wav");
    std::fs::write(&path, wav(1, 3, 16, &pcm16(&samples))).unwrap();
    let recording = Reader::new().from_path(&path).unwrap();
    let (format, headers, findings) = Reader::new().survey(&path).unwrap();
    assert_eq!((format, findings), (Format::Wav, recording.findings.clone()));
    assert_eq!(headers, recording.records.iter().map(Header::of).collect::<Vec<_>>());
    let mut stream = Wave::open(&Source::file(&path).unwrap(), &Options::default()).unwrap();
    assert_eq!((stream.channels.len(), stream.channels[0].rate(), stream.frames()), (3, Some(48_000.0), n));
    let (mut block, mut blocks, mut at) = (Vec::new(), 0, 0);
    loop {
        block.iter_mut().for_each(Vec::clear);
        let frames = stream.append(&mut block).unwrap();
        if frames == 0 {
            break;
        }
        for i in 0..frames {
            for (c, column) in block.iter().enumerate() {
                assert_eq!(column[i], f64::from(samples[3 * (at + i) + c]) / 32_768.0);
            }
        }
        at += frames;
        blocks += 1;
    }
    assert_eq!(at, n);
    assert!(blocks > 1);
}

#[test]
fn values_that_leave_the_range_of_numbers_are_refused() {
    let bytes = wav(3, 1, 64, &1e308f64.to_le_bytes());
    let reader = Reader::new().unit(Unit::parse("km"));
    let error = reader.from_reader("x.wav", bytes.as_slice()).unwrap_err().to_string();
    assert!(error.contains("x.wav: the value 1e308"), "{error}");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.wav");
    std::fs::write(&path, bytes).unwrap();
    assert!(reader.survey(&path).is_err());
}

proptest! {
    /// The reference is hound, an independent writer of wave files.
    #[test]
    fn agrees_with_another_writer(
        bits in prop::sample::select(vec![8u16, 16, 24, 32]), channels in 1u16..4,
        samples in prop::collection::vec(any::<i32>(), 1..50),
    ) {
        let samples: Vec<i32> = samples.iter().map(|s| s >> (32 - bits)).collect();
        let frames = samples.len() / usize::from(channels);
        prop_assume!(frames > 0);
        let spec = hound::WavSpec {
            channels, sample_rate: 51_200, bits_per_sample: bits, sample_format: hound::SampleFormat::Int,
        };
        let mut file = std::io::Cursor::new(Vec::new());
        let mut writer = hound::WavWriter::new(&mut file, spec).unwrap();
        for s in &samples[..frames * usize::from(channels)] {
            writer.write_sample(*s).unwrap();
        }
        writer.finalize().unwrap();
        let columns = values(file.get_ref());
        prop_assert_eq!(columns.len(), usize::from(channels));
        for (c, column) in columns.iter().enumerate() {
            prop_assert_eq!(column.len(), frames);
            for (i, v) in column.iter().enumerate() {
                let expected = f64::from(samples[i * usize::from(channels) + c]) / 2f64.powi(i32::from(bits) - 1);
                prop_assert_eq!(*v, expected);
            }
        }
    }

    #[test]
    fn never_panics_on_random_chunks(
        form in prop::sample::select(vec![*b"RIFF", *b"RF64", *b"BW64"]), tail in prop::collection::vec(any::<u8>(), 0..200),
    ) {
        let bytes = [form.as_slice(), b"\0\0\0\0WAVE", &tail].concat();
        let _ = read_bytes(&bytes);
    }

    #[test]
    fn never_panics_on_changed_bytes(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6), cut in any::<prop::sample::Index>(),
    ) {
        let list = b"INFOICMT\x06\0\0\0drill\0".to_vec();
        let whole = chunks(&[
            (b"LIST", list), (b"fmt ", extensible(1, 2, 16, 16)), (b"data", pcm16(&[1, 2, 3, 4, 5, 6])),
        ]);
        for mut bytes in [whole, huge(*b"RF64")] {
            for (index, value) in &changes {
                let at = index.index(bytes.len());
                bytes[at] = *value;
            }
            let _ = read_bytes(&bytes);
            bytes.truncate(cut.index(bytes.len()).max(1));
            let _ = read_bytes(&bytes);
        }
    }
}
