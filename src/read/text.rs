//! Bytes to text, whatever the instrument's code page.

use std::borrow::Cow;

/// Whether the bytes look like text.
pub fn is_text(head: &[u8]) -> bool {
    is_utf16(head) || head.iter().all(|b| *b >= 0x20 || b"\t\n\r\x0c\x1a".contains(b))
}

/// Whether the bytes are UTF-16.
pub fn is_utf16(head: &[u8]) -> bool {
    head.starts_with(&[0xff, 0xfe]) || head.starts_with(&[0xfe, 0xff])
}

/// Text.
pub fn decode(bytes: &[u8]) -> Cow<'_, str> {
    String::from_utf8_lossy(bytes)
}
