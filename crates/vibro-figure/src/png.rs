//! Pictures as PNG (ISO/IEC 15948): drawings turned into pixels, and the small images inside drawings.
//!
//! Only the bundled font is used and nothing of the time or the machine is written, so equal drawings give
//! equal bytes everywhere.

use super::colour::Rgb;
use super::draw::{Drawing, Image};
use super::font;
use flate2::write::ZlibEncoder;
use flate2::{Compression, Crc};
use resvg::tiny_skia::{Color, FilterQuality, Pixmap, PixmapPaint, PremultipliedColorU8, Transform};
use resvg::usvg::{self, fontdb};
use std::collections::HashMap;
use std::io::Write;
use std::sync::{Arc, OnceLock};
use vibro_record::{Error, Result};

/// Pixels of a drawing at `dpi` dots per inch (30 to 1200), on white, with the resolution noted in the file.
///
/// # Errors
/// If the drawing is too large for its pixels to be held.
pub(super) fn rasterised(drawing: &Drawing, dpi: f64) -> Result<Vec<u8>> {
    let dpi = if dpi.is_nan() { 300.0 } else { dpi.clamp(30.0, 1200.0) };
    let refused = |why: String| Error::refused(format!("the figure \"{}\" {why}", drawing.name()));
    let (width, height) = drawing.size();
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
    let points = dpi as f32 / 72.0;
    for image in drawing.images() {
        paint(image, points, &mut pixmap);
    }
    let options = usvg::Options { fontdb: fonts(), font_family: font::NAME.to_owned(), ..Default::default() };
    let tree = usvg::Tree::from_str(&drawing.lines_and_texts(), &options)
        .map_err(|e| refused(format!("cannot be turned into pixels: {e}")))?;
    let scale = |pixels: u32, size: f32| pixels as f32 / size;
    let transform = Transform::from_scale(
        scale(pixmap.width(), tree.size().width()),
        scale(pixmap.height(), tree.size().height()),
    );
    resvg::render(&tree, transform, &mut pixmap.as_mut());
    Ok(compact(&pixmap, dpi))
}

/// Pixels of the largest picture: four times a double column as high as wide at 1200 dots per inch, in memory 1.1 GB.
const MOST: u64 = 280_000_000;

/// The pixels with a palette where 256 colours are enough, as they are for black lines with soft edges; else
/// with three bytes each.
fn compact(pixmap: &Pixmap, dpi: f64) -> Vec<u8> {
    let (width, height) = (pixmap.width(), pixmap.height());
    // The picture is opaque, so the premultiplied channels are the colours.
    let colour = |p: &PremultipliedColorU8| Rgb(p.red(), p.green(), p.blue());
    let mut indices: HashMap<Rgb, u8> = HashMap::new();
    let mut palette = Vec::new();
    let mut cells = Vec::with_capacity(pixmap.pixels().len());
    let mut last: Option<(Rgb, u8)> = None;
    for now in pixmap.pixels().iter().map(colour) {
        // Long runs are of one colour.
        let known = last.filter(|(colour, _)| *colour == now).map(|(_, index)| index);
        let index = if let Some(index) = known.or_else(|| indices.get(&now).copied()) {
            index
        } else {
            let Ok(index) = u8::try_from(palette.len()) else { break };
            palette.push(now);
            indices.insert(now, index);
            index
        };
        last = Some((now, index));
        cells.push(index);
    }
    if cells.len() == pixmap.pixels().len() {
        let rows = cells.chunks(width as usize).map(<[u8]>::to_vec);
        return encoded(width, height, Colours::Opaque(&palette), rows, Some(dpi));
    }
    let rows = pixmap
        .pixels()
        .chunks(width as usize)
        .map(|row| row.iter().flat_map(|p| [p.red(), p.green(), p.blue()]).collect::<Vec<u8>>());
    encoded(width, height, Colours::Direct, rows, Some(dpi))
}

/// A cell image as a PNG with palette.
pub(super) fn indexed(image: &Image) -> Vec<u8> {
    let width = image.width.max(1);
    let height = image.cells.len() / width;
    let rows = image.cells.chunks(width).map(<[u8]>::to_vec);
    encoded(width as u32, height as u32, Colours::Holed(&image.palette), rows, None)
}

fn fonts() -> Arc<fontdb::Database> {
    static FONTS: OnceLock<Arc<fontdb::Database>> = OnceLock::new();
    let load = || {
        let mut fonts = fontdb::Database::new();
        fonts.load_font_data(font::BYTES.to_vec());
        Arc::new(fonts)
    };
    FONTS.get_or_init(load).clone()
}

/// Puts the cells of an image in their place, each as a block of its colour.
fn paint(image: &Image, scale: f32, onto: &mut Pixmap) {
    let width = image.width.max(1);
    let height = image.cells.len() / width;
    let Some(mut cells) = Pixmap::new(width as u32, height as u32) else { return };
    for (pixel, &index) in cells.pixels_mut().iter_mut().zip(&image.cells) {
        if let Some(&Rgb(r, g, b)) = image.palette.get(usize::from(index)).filter(|_| index > 0) {
            *pixel = PremultipliedColorU8::from_rgba(r, g, b, 255).unwrap_or(*pixel);
        }
    }
    let place = image.place;
    let transform = Transform::from_row(
        place.w as f32 / width as f32 * scale,
        0.0,
        0.0,
        place.h as f32 / height as f32 * scale,
        place.x as f32 * scale,
        place.y as f32 * scale,
    );
    let paint = PixmapPaint { quality: FilterQuality::Nearest, ..PixmapPaint::default() };
    onto.draw_pixmap(0, 0, cells.as_ref(), &paint, transform, None);
}

#[derive(Clone, Copy)]
enum Colours<'a> {
    /// Three bytes a pixel.
    Direct,
    /// One byte a pixel.
    Opaque(&'a [Rgb]),
    /// One byte a pixel; index 0 is transparent.
    Holed(&'a [Rgb]),
}

fn encoded(
    width: u32,
    height: u32,
    colours: Colours<'_>,
    rows: impl Iterator<Item = Vec<u8>>,
    dpi: Option<f64>,
) -> Vec<u8> {
    let kind = if matches!(colours, Colours::Direct) { 2 } else { 3 };
    let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
    let [w, h] = [width.to_be_bytes(), height.to_be_bytes()];
    chunk(&mut file, *b"IHDR", &[&w[..], &h[..], &[8, kind, 0, 0, 0]].concat());
    if let Some(dpi) = dpi {
        let per_metre = ((dpi / 0.0254).round() as u32).to_be_bytes();
        chunk(&mut file, *b"pHYs", &[&per_metre[..], &per_metre[..], &[1]].concat());
    }
    if let Colours::Opaque(palette) | Colours::Holed(palette) = colours {
        chunk(&mut file, *b"PLTE", &palette.iter().flat_map(|c| [c.0, c.1, c.2]).collect::<Vec<u8>>());
    }
    if matches!(colours, Colours::Holed(_)) {
        chunk(&mut file, *b"tRNS", &[0]);
    }
    let mut deflate = ZlibEncoder::new(Vec::new(), Compression::new(3));
    for row in rows {
        // Filter 0, none: line art and palettes compress best as they are (clause 12.7).
        let _ = deflate.write_all(&[0]).and_then(|()| deflate.write_all(&row));
    }
    // Writing to memory does not fail.
    chunk(&mut file, *b"IDAT", &deflate.finish().unwrap_or_default());
    chunk(&mut file, *b"IEND", &[]);
    file
}

fn chunk(file: &mut Vec<u8>, kind: [u8; 4], data: &[u8]) {
    file.extend_from_slice(&(data.len() as u32).to_be_bytes());
    file.extend_from_slice(&kind);
    file.extend_from_slice(data);
    let mut crc = Crc::new();
    crc.update(&kind);
    crc.update(data);
    file.extend_from_slice(&crc.sum().to_be_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::Rect;

    #[test]
    fn pixels_are_read_back_with_and_without_a_palette() {
        for colours in [2u32, 256, 257, 900] {
            let mut pixmap = Pixmap::new(30, 30).unwrap();
            for (i, pixel) in pixmap.pixels_mut().iter_mut().enumerate() {
                let n = i as u32 % colours;
                *pixel = PremultipliedColorU8::from_rgba((n % 256) as u8, (n / 256) as u8, 7, 255).unwrap();
            }
            let file = compact(&pixmap, 300.0);
            // The colour type stands after signature, length, name, width, height and depth.
            assert_eq!(file[25], if colours > 256 { 2 } else { 3 });
            assert_eq!(Pixmap::decode_png(&file).unwrap(), pixmap);
        }
    }

    #[test]
    fn a_cell_image_is_read_back_by_another_decoder() {
        let image = Image {
            place: Rect { x: 0.0, y: 0.0, w: 3.0, h: 2.0 },
            width: 3,
            cells: vec![1, 2, 0, 2, 2, 1],
            palette: vec![Rgb(0, 0, 0), Rgb(10, 20, 30), Rgb(200, 100, 0)],
        };
        let read = Pixmap::decode_png(&indexed(&image)).unwrap();
        assert_eq!((read.width(), read.height()), (3, 2));
        let seen: Vec<_> = read.pixels().iter().map(|p| (p.red(), p.green(), p.blue(), p.alpha())).collect();
        let [a, b, none] = [(10, 20, 30, 255), (200, 100, 0, 255), (0, 0, 0, 0)];
        assert_eq!(seen, [a, b, none, b, b, a]);
        let mut onto = Pixmap::new(6, 4).unwrap();
        paint(&image, 2.0, &mut onto);
        let at = |x, y| onto.pixel(x, y).map(|p| (p.red(), p.green(), p.blue(), p.alpha())).unwrap();
        assert_eq!([at(0, 0), at(1, 1), at(2, 0), at(5, 1), at(5, 3), at(4, 2)], [a, a, b, none, a, a]);
    }
}
