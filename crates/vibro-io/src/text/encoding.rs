//! Decodes bytes to text, in any code page of an instrument.

use chardetng::{EncodingDetector, Iso2022JpDetection, Utf8Detection};
use encoding_rs::Encoding;
use std::borrow::Cow;

/// Number of first bytes that distinguish text from binary data.
pub const LOOK: usize = 2048;

/// Whether the first bytes look like text: UTF-16, or no control characters except blanks, line ends, form
/// feeds and the end mark of DOS (0x1A).
pub(crate) fn is_text(head: &[u8]) -> bool {
    let control = |b: &u8| *b < 0x20 && !b"\t\n\r\x0c\x1a".contains(b);
    !head[..head.len().min(LOOK)].iter().any(control) || is_utf16(head)
}

/// Whether the bytes are UTF-16, by their byte order mark.
pub(crate) fn is_utf16(head: &[u8]) -> bool {
    head.starts_with(&[0xff, 0xfe]) || head.starts_with(&[0xfe, 0xff])
}

/// Name of the encoding of a text by its first bytes; `None` for UTF-8.
pub fn name(head: &[u8]) -> Option<&'static str> {
    if is_utf16(head) {
        return Some("UTF-16");
    }
    if let Some(encoding) = foreign(head) {
        return Some(encoding.name());
    }
    std::str::from_utf8(head).is_err_and(|e| e.error_len().is_some()).then_some("Latin-1")
}

/// The encoding of a text with words in another script, such as Shift JIS, GBK or Windows-1251; `None` for
/// UTF-8 and Latin-1.
///
/// Single characters among ASCII, as in `µm` or `Prüfkörper`, are always taken as Latin-1.
pub(crate) fn foreign(head: &[u8]) -> Option<&'static Encoding> {
    const FEWEST: usize = 4;
    let pairs = || head.windows(2).filter(|pair| !pair[0].is_ascii() && !pair[1].is_ascii());
    let utf8 = std::str::from_utf8(head).map_or_else(|e| e.error_len().is_none(), |_| true);
    if utf8 || is_utf16(head) || pairs().count() < FEWEST {
        return None;
    }
    let mut detector = EncodingDetector::new(Iso2022JpDetection::Deny);
    detector.feed(head, true);
    let found = detector.guess(None, Utf8Detection::Allow);
    (![encoding_rs::UTF_8, encoding_rs::WINDOWS_1252].contains(&found)).then_some(found)
}

/// Whether any CR is followed by a byte other than LF or CR. The last byte of a head that was `cut` off is
/// not examined.
pub(crate) fn lone_cr(bytes: &[u8], cut: bool) -> bool {
    // Fast for most files, which have no CR at all.
    bytes.contains(&b'\r')
        && (bytes.windows(2).any(|w| w[0] == b'\r' && !matches!(w[1], b'\r' | b'\n'))
            || (!cut && bytes.last() == Some(&b'\r')))
}

/// Replaces every CR by LF unless an LF follows. Several CRs before an LF stay one line end: text that was
/// converted twice has them.
pub(crate) fn with_lf(mut bytes: Vec<u8>) -> Vec<u8> {
    let mut before_lf = false;
    for b in bytes.iter_mut().rev() {
        if *b == b'\r' && !before_lf {
            *b = b'\n';
        } else {
            before_lf = matches!(*b, b'\n' | b'\r');
        }
    }
    bytes
}

/// Decodes to text without a byte order mark: UTF-8 is borrowed, UTF-16 converted, all else read as
/// Latin-1.
///
/// Latin-1 gives every byte a character, so nothing is lost and an error can quote it. An unpaired
/// surrogate of UTF-16 becomes U+FFFD.
pub(crate) fn decode(bytes: &[u8]) -> Cow<'_, str> {
    if is_utf16(bytes) {
        let unit = if bytes[0] == 0xff { u16::from_le_bytes } else { u16::from_be_bytes };
        let units: Vec<u16> = bytes.as_chunks().0.iter().map(|pair| unit(*pair)).collect();
        return String::from_utf16_lossy(&units).trim_start_matches('\u{feff}').to_owned().into();
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    match std::str::from_utf8(bytes) {
        Ok(text) => text.into(),
        Err(_) => bytes.iter().map(|b| char::from(*b)).collect::<String>().into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn utf16(text: &str, big: bool) -> Vec<u8> {
        text.encode_utf16().flat_map(|u| if big { u.to_be_bytes() } else { u.to_le_bytes() }).collect()
    }

    #[test]
    fn utf8_is_borrowed_and_its_mark_dropped() {
        assert!(matches!(decode("µm".as_bytes()), Cow::Borrowed("µm")));
        assert!(matches!(decode(b"\xef\xbb\xbfm/s"), Cow::Borrowed("m/s")));
    }

    #[test]
    fn latin1_superscripts() {
        assert_eq!(decode(b"g\xb2/Hz"), "g²/Hz");
        assert_eq!(decode(b"\xb5m"), "µm");
    }

    #[test]
    fn words_of_other_scripts_are_told_from_latin1() {
        for (text, encoding) in [
            ("サンプリング周波数(Hz),1000\n時間,変位 μm\n", encoding_rs::SHIFT_JIS),
            ("采样频率,1000\n时间,通道一加速度\n", encoding_rs::GBK),
            ("Частота дискретизации;1000\nвремя;ускорение\n", encoding_rs::WINDOWS_1251),
        ] {
            let bytes = encoding.encode(text).0;
            assert_eq!(name(&bytes), Some(encoding.name()));
            assert_eq!(encoding.decode(&bytes).0, text);
        }
        for text in
            ["time [s];a [µm];b [µm/m];c [µm]\n", "Kräfte über Prüfkörper: ±10 µV, 20 °C\n", "g²/Hz;g²/Hz"]
        {
            let latin1: Vec<u8> = text.chars().map(|c| u8::try_from(c).unwrap()).collect();
            assert_eq!(name(&latin1), Some("Latin-1"), "{text}");
        }
        assert_eq!(name("変位 サンプリング".as_bytes()), None);
    }

    #[test]
    fn utf16_with_a_mark() {
        let text = "time [s];v [µm/s]\r\n0,5;√2\r\n";
        for big in [false, true] {
            assert_eq!(decode(&utf16(&format!("\u{feff}{text}"), big)), text);
        }
        // An odd last byte and an unpaired surrogate do not prevent decoding of the rest.
        let mut cut = utf16("ab\u{1f600}", false);
        cut.truncate(cut.len() - 1);
        assert_eq!(decode(&[b"\xff\xfe", cut.as_slice()].concat()), "ab\u{fffd}");
    }

    #[test]
    fn zeros_alone_are_not_text() {
        assert!(!is_text(&[0; 64]));
        assert!(!is_text(b"ab\0\0cd"));
        assert!(is_text(b"1.5\r\n2.5\r\n\x1a"));
        assert!(is_text(&utf16("\u{feff}1,5\r\n", false)));
    }

    proptest! {
        #[test]
        fn never_panics(bytes in proptest::collection::vec(any::<u8>(), 0..64)) {
            let _ = decode(&bytes);
            let _ = is_text(&bytes);
        }
    }
}
