//! Pictures as PNG (ISO/IEC 15948).
//!
//! Nothing of the time or the machine is written, so equal pixels give equal bytes everywhere.

use resvg::tiny_skia::Pixmap;

/// PNG file of pixels that are fully opaque or fully transparent, with the resolution `dpi` if stated. Partly
/// transparent pixels would need their colours divided by alpha.
pub(super) fn encoded(pixmap: &Pixmap, dpi: Option<f64>) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, pixmap.width(), pixmap.height());
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_pixel_dims(dpi.map(|dpi| {
        let per_metre = (dpi / 0.0254).round() as u32;
        png::PixelDimensions { xppu: per_metre, yppu: per_metre, unit: png::Unit::Meter }
    }));
    // Line art and cells compress best without a filter (clause 12.7 of the standard).
    encoder.set_deflate_compression(png::DeflateCompression::Level(4));
    encoder.set_filter(png::Filter::NoFilter);
    // Writing to memory does not fail.
    let _ = encoder.write_header().and_then(|mut writer| writer.write_image_data(pixmap.data()));
    file
}

#[cfg(test)]
mod tests {
    use super::*;
    use resvg::tiny_skia::PremultipliedColorU8;

    #[test]
    fn pixels_are_read_back() {
        let mut pixmap = Pixmap::new(30, 30).unwrap();
        for (i, pixel) in pixmap.pixels_mut().iter_mut().enumerate() {
            *pixel = PremultipliedColorU8::from_rgba((i % 256) as u8, (i / 256) as u8, 7, 255).unwrap();
        }
        assert_eq!(Pixmap::decode_png(&encoded(&pixmap, Some(300.0))).unwrap(), pixmap);
        assert_eq!(Pixmap::decode_png(&encoded(&pixmap, None)).unwrap(), pixmap);
    }
}
