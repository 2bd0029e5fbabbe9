//! Storage of the values of a data set 58, as record 7 states it; the values follow as record 12.

/// Ordinate data types of record 7: code, complex, double precision.
pub(crate) const KINDS: [(i64, bool, bool); 4] =
    [(2, false, false), (4, false, true), (5, true, false), (6, true, true)];

/// Storage of values: the eight cases of the standard.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layout {
    /// Whether each value has a real and an imaginary part.
    pub complex: bool,
    /// Whether values have double precision. The abscissa never has it.
    pub double: bool,
    /// Whether the abscissa is even and therefore not stored.
    pub even: bool,
}

impl Layout {
    /// Numbers per point: abscissa (if uneven), real part, imaginary part (if complex).
    pub fn columns(self) -> usize {
        1 + usize::from(self.complex) + usize::from(!self.even)
    }

    /// Number of the case in the standard, 1 to 8.
    pub fn case(self) -> u8 {
        1 + u8::from(!self.even) + 2 * u8::from(self.complex) + 4 * u8::from(self.double)
    }

    /// Field widths of one line of text: 6E13.5, 4E20.12, 2(E13.5,E20.12) or E13.5,2E20.12.
    pub fn widths(self) -> &'static [usize] {
        match (self.double, self.even, self.complex) {
            (false, _, _) => &[13; 6],
            (true, true, _) => &[20; 4],
            (true, false, false) => &[13, 20, 13, 20],
            (true, false, true) => &[13, 20, 20],
        }
    }

    /// Bytes of one point in binary. `wide`: the abscissa has the precision of the values, which the
    /// standard does not provide for.
    pub fn point_size(self, wide: bool) -> usize {
        let value = if self.double { 8 } else { 4 };
        let abscissa = if wide { value } else { 4 };
        value * (1 + usize::from(self.complex)) + if self.even { 0 } else { abscissa }
    }
}
