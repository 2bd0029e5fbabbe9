//! Pictures as PNG (ISO/IEC 15948).
//!
//! Only the bundled font is used, and no date or machine is written: equal drawings give equal bytes
//! everywhere.

use crate::{Drawing, Image, canvas, font};
use resvg::tiny_skia::{Color, FilterQuality, Pixmap, PixmapPaint, Transform};
use resvg::usvg;
use vibro_record::{Error, Result};

impl Drawing {
    /// The picture as PNG of `dpi` dots per inch (30 to 1200; 300 is usual in print), on white, in the
    /// bundled font, with the resolution noted in the file.
    ///
    /// # Errors
    /// If the picture is too large to be held in memory as pixels.
    pub fn png(&self, dpi: f64) -> Result<Vec<u8>> {
        let dpi = if dpi.is_nan() { 300.0 } else { dpi.clamp(30.0, 1200.0) };
        let refused = |why: String| Error::refused(format!("the figure \"{}\" {why}", self.name));
        let (width, height) = (self.size.0 * self.scale, self.size.1 * self.scale);
        let pixels = |mm: f64| (mm / 25.4 * dpi).round().max(1.0) as u32;
        let (across, down) = (pixels(width), pixels(height));
        let mut pixmap = Some((across, down))
            .filter(|(w, h)| u64::from(*w) * u64::from(*h) <= MOST)
            .and_then(|(w, h)| Pixmap::new(w, h))
            .ok_or_else(|| {
                refused(format!("would have {across} × {down} pixels at {dpi} dots per inch"))
                    .hint("fewer dots per inch, or the SVG, which has no pixels")
            })?;
        pixmap.fill(Color::WHITE);
        let points = (dpi * self.scale) as f32 / 72.0;
        for Image { place, pixels } in &self.canvas.images {
            let scale = |size: f64, cells: u32| size as f32 / cells as f32 * points;
            let (sx, sy) = (scale(place.w, pixels.width()), scale(place.h, pixels.height()));
            let transform =
                Transform::from_row(sx, 0.0, 0.0, sy, place.x as f32 * points, place.y as f32 * points);
            let paint = PixmapPaint { quality: FilterQuality::Nearest, ..PixmapPaint::default() };
            pixmap.draw_pixmap(0, 0, pixels.as_ref(), &paint, transform, None);
        }
        let mut options = usvg::Options { font_family: font::NAME.to_owned(), ..usvg::Options::default() };
        options.fontdb_mut().load_font_data(font::BYTES.to_vec());
        // Without the cell images, which lie under everything else.
        let text = canvas::document(self.size, 1.0, &self.name, &[], &self.canvas.body);
        let tree = usvg::Tree::from_str(&text, &options)
            .map_err(|e| refused(format!("cannot be turned into pixels: {e}")))?;
        let transform =
            Transform::from_scale(across as f32 / tree.size().width(), down as f32 / tree.size().height());
        resvg::render(&tree, transform, &mut pixmap.as_mut());
        Ok(encoded(&pixmap, Some(dpi)))
    }
}

/// Most pixels of a picture, 1.1 GB in memory: four squares of a double column's width at 1200 dots per inch.
const MOST: u64 = 280_000_000;

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
