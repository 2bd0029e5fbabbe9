//! Draws figures as pixels: cells of maps first, then lines and texts over them.

use crate::canvas::Lettering;
use crate::png::encoded;
use crate::{Drawing, Image, canvas};
use resvg::tiny_skia::{Color, FilterQuality, Pixmap, PixmapPaint, Transform};
use resvg::usvg;
use vibro_record::{Error, Result};

impl Drawing {
    /// The picture as PNG with `dpi` dots per inch (30 to 1200; 300 is usual in print), on white, in the
    /// bundled font. The resolution is stored in the file.
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
            .filter(|(w, h)| u64::from(*w) * u64::from(*h) <= MOST_PIXELS)
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
        // Without the cell images, which lie under everything else. Texts are outlines of the bundled font.
        let elements = (&*self.canvas.elements, Lettering::Outlines);
        let text = canvas::document(self.size, 1.0, &self.name, &[], elements);
        let tree = usvg::Tree::from_str(&text, &usvg::Options::default())
            .map_err(|e| refused(format!("cannot be turned into pixels: {e}")))?;
        let transform =
            Transform::from_scale(across as f32 / tree.size().width(), down as f32 / tree.size().height());
        resvg::render(&tree, transform, &mut pixmap.as_mut());
        Ok(encoded(&pixmap, Some(dpi)))
    }
}

/// Most pixels of a picture: 1.1 GB in memory. A square as wide as a double column (178 mm) has a quarter of
/// them at 1200 dots per inch.
const MOST_PIXELS: u64 = 280_000_000;
